// Lists and triangles of objects in shader storage buffers, as
// storage/two_level_grid/grid_buffers.glsl asks for them.
#pragma once
#include "lib/dialect.glsl"

STORAGE(references_block, uint, references)
STORAGE(planes_block, uvec4, planes)
STORAGE(corners_block, uvec4, corners)
STORAGE(vertices_block, vec4, vertices)

uint reference_word(int index) { return FETCHSTORAGE(references, index); }
uvec4 planes_texel(int index) { return FETCHSTORAGE(planes, index); }
uvec4 corners_texel(int index) { return FETCHSTORAGE(corners, index); }
vec4 vertex_texel(int index) { return FETCHSTORAGE(vertices, index); }
