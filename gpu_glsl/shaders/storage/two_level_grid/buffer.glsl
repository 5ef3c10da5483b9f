// The two-level grid in buffer textures (storage/two_level_grid/grid_buffers.glsl).
#pragma once
#include "lib/dialect.glsl"

UBUFFER(cells)
UBUFFER(references)
BUFFER(triangles)

uint cell_word(int index) { return FETCHBUFFER(cells, index).x; }
uint reference_word(int index) { return FETCHBUFFER(references, index).x; }
vec4 triangle_texel(int index) { return FETCHBUFFER(triangles, index); }

#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"
