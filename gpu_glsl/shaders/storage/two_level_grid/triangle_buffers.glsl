// Lists and triangles of objects in buffer textures, as storage/two_level_grid/grid_buffers.glsl asks for
// them.
#pragma once
#include "lib/dialect.glsl"

UBUFFER(references)
BUFFER(planes)
UBUFFER(corners)
UBUFFER(vertices)

uint reference_word(int index) { return FETCHBUFFER(references, index).x; }
vec4 planes_texel(int index) { return FETCHBUFFER(planes, index); }
uint corner_word(int index) { return FETCHBUFFER(corners, index).x; }
uint vertex_word(int index) { return FETCHBUFFER(vertices, index).x; }
