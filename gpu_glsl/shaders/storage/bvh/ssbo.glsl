// Bounding volume hierarchies in shader storage buffers (storage/bvh/trees.glsl). What is read once
// a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"

STORAGE(bvh_nodes_block, uvec4, bvh_nodes)
STORAGE(bvh_planes_block, uvec4, bvh_planes)
STORAGE(bvh_vertices_block, vec4, bvh_vertices)
STORAGE(bvh_primitives_block, uint, bvh_primitives)

uvec4 node_texel(int index) { return FETCHSTORAGE(bvh_nodes, index); }
uvec4 planes_texel(int index) { return FETCHSTORAGE(bvh_planes, index); }
vec4 vertex_texel(int index) { return FETCHSTORAGE(bvh_vertices, index); }
uint primitive_word(int index) { return FETCHSTORAGE(bvh_primitives, index); }

#include "storage/bvh/trees.glsl"
