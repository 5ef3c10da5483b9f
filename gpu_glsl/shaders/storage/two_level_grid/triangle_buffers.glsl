// Lists and triangles of objects in buffer textures, as storage/two_level_grid/grid_buffers.glsl
// asks for them.
#pragma once
#include "lib/renderer.glsl"

WORD_TABLE(references)
RECORD_TABLE(planes)
UBUFFER(corners)
BUFFER(vertices)

uint reference_word(int index) { return FETCHWORD(references, index); }
uvec4 planes_texel(int index) { return FETCHTEXEL(planes, index); }
uvec4 corners_texel(int index) { return FETCHBUFFER(corners, index); }
vec4 vertex_texel(int index) { return FETCHBUFFER(vertices, index); }
