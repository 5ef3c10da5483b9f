// Irregular grids in buffer textures (storage/irregular_grid/irregular_cells.glsl).
#pragma once
#include "lib/dialect.glsl"
#include "storage/two_level_grid/triangle_buffers.glsl"

UBUFFER(nodes)
UBUFFER(cells)

uint node_word(int index) { return FETCHBUFFER(nodes, index).x; }
uvec4 cell_record(int index) { return FETCHBUFFER(cells, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
