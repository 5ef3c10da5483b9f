// Lists and triangles of objects in shader storage buffers, as
// storage/two_level_grid/grid_buffers.glsl asks for them.
#pragma once
#include "lib/dialect.glsl"

STORAGE(references_block, uint, references)
STORAGE(planes_block, vec4, planes)
STORAGE(corners_block, uint, corners)
STORAGE(vertices_block, uint, vertices)

uint reference_word(int index) { return FETCHSTORAGE(references, index); }
vec4 planes_texel(int index) { return FETCHSTORAGE(planes, index); }
uint corner_word(int index) { return FETCHSTORAGE(corners, index); }
uint vertex_word(int index) { return FETCHSTORAGE(vertices, index); }
