// Irregular grids in shader storage buffers (storage/irregular_grid/irregular_cells.glsl). What is
// read once a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"
#include "storage/two_level_grid/triangle_blocks.glsl"

STORAGE(nodes_block, uint, nodes)
STORAGE(cells_block, uvec4, cells)

uint node_word(int index) { return FETCHSTORAGE(nodes, index); }
uvec4 cell_record(int index) { return FETCHSTORAGE(cells, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
