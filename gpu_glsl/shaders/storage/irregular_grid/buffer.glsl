// Irregular grids in buffer textures (storage/irregular_grid/irregular_cells.glsl).
#pragma once
#include "lib/renderer.glsl"
#include "storage/two_level_grid/triangle_buffers.glsl"

WORD_TABLE(nodes)
RECORD_TABLE(cells)

uint node_word(int index) { return FETCHWORD(nodes, index); }
uvec4 cell_record(int index) { return FETCHTEXEL(cells, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
