// The two-level grid in shader storage buffers (storage/two_level_grid/grid_buffers.glsl). What is read
// once a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"

STORAGE(cells_block, uint, cells)
STORAGE(references_block, uint, references)
STORAGE(triangles_block, vec4, triangles)

uint cell_word(int index) { return FETCHSTORAGE(cells, index); }
uint reference_word(int index) { return FETCHSTORAGE(references, index); }
vec4 triangle_texel(int index) { return FETCHSTORAGE(triangles, index); }

#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"
