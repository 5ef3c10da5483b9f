// Bounding volume hierarchies in buffers: what storage/bvh/buffer.glsl and ssbo.glsl have in
// common. They fetch what a walk reads at every step, and what a decision reads:
//
//   uvec4 node_texel(int index)
//   uvec4 planes_texel(int index)   in the leaves' order, so that a leaf's triangles lie together
//   vec4 vertex_texel(int index)    likewise
//   uint primitive_word(int index)  the triangle in each slot
//
// There is a tree over the triangles of each object, and one over instances. An object's vertices
// are stored in its own frame, without rounding: as the two-level grid's are
// (storage/two_level_grid/grid_buffers.glsl says how). Boxes are counted from the centre of the
// object's, and rounded outwards.
#pragma once
#include "lib/course.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"
#include "shared/bvh_layout.h"
#include "storage/instance_rows.glsl"

UBUFFER(bvh_roots)  // of each instance's object: a reference
BUFFER(bvh_boxes)   // likewise: around the object

// One of a node's two children.
struct Child {
    vec3 lower;
    vec3 upper;
    uint reference;
};

struct Node {
    Child first;
    Child second;
};

vec3 corner_of(uint x, uint y, uint z) {
    return vec3(uintBitsToFloat(x), uintBitsToFloat(y), uintBitsToFloat(z));
}

Node node_of(uvec4 a, uvec4 b, uvec4 c, uvec4 d) {
    return Node(Child(corner_of(a.x, a.y, a.z), corner_of(a.w, b.x, b.y), b.z),
                Child(corner_of(b.w, c.x, c.y), corner_of(c.z, c.w, d.x), d.y));
}

Node fetch_node(uint index) {
    int at = int(index) * kBvhNodeTexels;
    return node_of(node_texel(at), node_texel(at + 1), node_texel(at + 2), node_texel(at + 3));
}

Planes fetch_planes(int slot) {
    int at = slot * planes_texels();
    return Planes(planes_texel(at), planes_texel(at + 1),
                  has_fixed_planes ? uvec4(0u) : planes_texel(at + 2));
}

Triangle fetch_triangle(int slot) {
    int at = slot * kBvhTriangleTexels;
    return Triangle(vec3(vertex_texel(at)), vec3(vertex_texel(at + 1)), vec3(vertex_texel(at + 2)));
}

uint fetch_primitive(int slot) { return primitive_word(slot); }

uint fetch_root(uint inst_id) { return FETCHBUFFER(bvh_roots, int(inst_id)).x; }

Box fetch_object_box(uint inst_id) {
    int at = int(inst_id) * kBvhBoxTexels;
    return Box(vec3(FETCHBUFFER(bvh_boxes, at)), vec3(FETCHBUFFER(bvh_boxes, at + 1)),
               vec3(FETCHBUFFER(bvh_boxes, at + 2)));
}

#if NEEDS(has_top_level)
// The tree over instances, in a frame of its own: from the centre of the scene.
UBUFFER(bvh_top_nodes)
UBUFFER(bvh_top_instances)  // the instance in each slot
UNIFORM(vec3, top_centre)
UNIFORM(float, top_scale)   // a power of two
UNIFORM(vec3, top_lower)
UNIFORM(vec3, top_upper)

Node fetch_top_node(uint index) {
    int at = int(index) * kBvhNodeTexels;
    return node_of(FETCHBUFFER(bvh_top_nodes, at), FETCHBUFFER(bvh_top_nodes, at + 1),
                   FETCHBUFFER(bvh_top_nodes, at + 2), FETCHBUFFER(bvh_top_nodes, at + 3));
}

uint fetch_top_instance(int slot) { return FETCHBUFFER(bvh_top_instances, slot).x; }

Box fetch_top_box() { return Box(vec3(0.0), top_lower, top_upper); }

LocalRay to_top_level(Ray ray) {
    double scale = double(top_scale);
    return LocalRay((dvec3(ray.org) - dvec3(top_centre)) * scale, dvec3(ray.dir) * scale);
}
#endif
