// The flat grid in buffer textures (storage/flat_grid/flat_cells.glsl).
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

#include "storage/flat_grid/flat_cells.glsl"
