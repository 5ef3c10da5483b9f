// Bounding volume hierarchies in buffer textures (storage/bvh/trees.glsl).
#pragma once
#include "lib/renderer.glsl"

RECORD_TABLE(bvh_nodes)
RECORD_TABLE(bvh_planes)
BUFFER(bvh_vertices)
UBUFFER(bvh_primitives)

uvec4 node_texel(int index) { return FETCHTEXEL(bvh_nodes, index); }
uvec4 planes_texel(int index) { return FETCHTEXEL(bvh_planes, index); }
vec4 vertex_texel(int index) { return FETCHBUFFER(bvh_vertices, index); }
uint primitive_word(int index) { return FETCHBUFFER(bvh_primitives, index).x; }

#include "storage/bvh/trees.glsl"
