// Irregular grids in shader storage buffers (storage/irregular_grid/irregular_cells.glsl). What is
// read once a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"

STORAGE(nodes_block, uint, nodes)
STORAGE(cells_block, uvec4, cells)
STORAGE(references_block, uint, references)
STORAGE(triangles_block, vec4, triangles)

uint node_word(int index) { return FETCHSTORAGE(nodes, index); }
uvec4 cell_record(int index) { return FETCHSTORAGE(cells, index); }
uint reference_word(int index) { return FETCHSTORAGE(references, index); }
vec4 triangle_texel(int index) { return FETCHSTORAGE(triangles, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
