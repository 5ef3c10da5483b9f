// The flat grid in shader storage buffers (storage/flat_grid/flat_cells.glsl). What is read once a
// ray or a decision stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"

STORAGE(cells_block, uint, cells)
STORAGE(references_block, uint, references)
STORAGE(planes_block, vec4, planes)
STORAGE(corners_block, uint, corners)
STORAGE(vertices_block, uint, vertices)

uint cell_word(int index) { return FETCHSTORAGE(cells, index); }
uint reference_word(int index) { return FETCHSTORAGE(references, index); }
vec4 planes_texel(int index) { return FETCHSTORAGE(planes, index); }
uint corner_word(int index) { return FETCHSTORAGE(corners, index); }
uint vertex_word(int index) { return FETCHSTORAGE(vertices, index); }

#include "storage/flat_grid/flat_cells.glsl"
