// The two-level grid in buffer textures (storage/two_level_grid/grid_buffers.glsl).
#pragma once
#include "lib/dialect.glsl"

UBUFFER(cells)
UBUFFER(references)
BUFFER(planes)
UBUFFER(corners)
UBUFFER(vertices)

uint cell_word(int index) { return FETCHBUFFER(cells, index).x; }
uint reference_word(int index) { return FETCHBUFFER(references, index).x; }
vec4 planes_texel(int index) { return FETCHBUFFER(planes, index); }
uint corner_word(int index) { return FETCHBUFFER(corners, index).x; }
uint vertex_word(int index) { return FETCHBUFFER(vertices, index).x; }

#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"
#include "storage/two_level_grid/walked_instance.glsl"
