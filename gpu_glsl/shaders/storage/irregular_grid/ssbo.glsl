// Irregular grids in shader storage buffers (storage/irregular_grid/irregular_cells.glsl). What is
// read once a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"

STORAGE(nodes_block, uint, nodes)
STORAGE(cells_block, uvec4, cells)
STORAGE(references_block, uint, references)
STORAGE(planes_block, vec4, planes)
STORAGE(corners_block, uint, corners)
STORAGE(vertices_block, uint, vertices)

uint node_word(int index) { return FETCHSTORAGE(nodes, index); }
uvec4 cell_record(int index) { return FETCHSTORAGE(cells, index); }
uint reference_word(int index) { return FETCHSTORAGE(references, index); }
vec4 planes_texel(int index) { return FETCHSTORAGE(planes, index); }
uint corner_word(int index) { return FETCHSTORAGE(corners, index); }
uint vertex_word(int index) { return FETCHSTORAGE(vertices, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
