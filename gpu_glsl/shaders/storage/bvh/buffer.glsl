// The bounding volume hierarchy in buffer textures: a tree over instances, and one an object.
//
// An object's vertices and boxes are stored in its own frame, without rounding: as the two-level
// grid's are (storage/two_level_grid/buffer.glsl says how). The tree over instances is in the
// world.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "shared/bvh_layout.h"

// The objects' trees: fixed once they are built.
UBUFFER(bvh_nodes)
BUFFER(bvh_vertices)      // in the leaves' order, so that a leaf's triangles lie together
UBUFFER(bvh_primitives)   // the triangle in each slot
UBUFFER(bvh_roots)        // of each instance's object: a node

// The top level.
UBUFFER(bvh_top_nodes)
UBUFFER(bvh_top_instances)  // the instance in each slot
BUFFER(bvh_instances)

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

struct Triangle {
    vec3 v0;
    vec3 v1;
    vec3 v2;
};

// A ray in an object's frame. t means the same in all frames.
struct DoubleRay {
    dvec3 org;
    dvec3 dir;
};

struct Box {
    vec3 lower;
    vec3 upper;
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
    return node_of(FETCHBUFFER(bvh_nodes, at), FETCHBUFFER(bvh_nodes, at + 1),
                   FETCHBUFFER(bvh_nodes, at + 2), FETCHBUFFER(bvh_nodes, at + 3));
}

Node fetch_top_node(uint index) {
    int at = int(index) * kBvhNodeTexels;
    return node_of(FETCHBUFFER(bvh_top_nodes, at), FETCHBUFFER(bvh_top_nodes, at + 1),
                   FETCHBUFFER(bvh_top_nodes, at + 2), FETCHBUFFER(bvh_top_nodes, at + 3));
}

Triangle fetch_triangle(int slot) {
    int at = slot * kBvhTriangleTexels;
    return Triangle(vec3(FETCHBUFFER(bvh_vertices, at)), vec3(FETCHBUFFER(bvh_vertices, at + 1)),
                    vec3(FETCHBUFFER(bvh_vertices, at + 2)));
}

uint fetch_primitive(int slot) { return FETCHBUFFER(bvh_primitives, slot).x; }
uint fetch_top_instance(int slot) { return FETCHBUFFER(bvh_top_instances, slot).x; }

uint fetch_root(uint inst_id) { return FETCHBUFFER(bvh_roots, int(inst_id)).x; }

Box fetch_object_box(uint inst_id) {
    int at = int(inst_id) * kBvhInstanceTexels + 6;
    return Box(vec3(FETCHBUFFER(bvh_instances, at)), vec3(FETCHBUFFER(bvh_instances, at + 1)));
}

// A row of the map to the object's frame, applied to a point or a direction.
double row_times(vec4 row, vec4 rest, dvec3 v) {
    PRECISE double sum = (double(row.x) + double(rest.x)) * v.x +
                         (double(row.y) + double(rest.y)) * v.y +
                         (double(row.z) + double(rest.z)) * v.z;
    return sum;
}

// The ray in the frame of the instance's object. The instance's place is taken off first, which
// seldom rounds, so that a large translation costs no digits. What is rounded here is rounded for
// all triangles of the object alike: they see one and the same ray.
DoubleRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kBvhInstanceTexels;
    vec4 x = FETCHBUFFER(bvh_instances, at);
    vec4 y = FETCHBUFFER(bvh_instances, at + 1);
    vec4 z = FETCHBUFFER(bvh_instances, at + 2);
    vec4 x_rest = FETCHBUFFER(bvh_instances, at + 3);
    vec4 y_rest = FETCHBUFFER(bvh_instances, at + 4);
    vec4 z_rest = FETCHBUFFER(bvh_instances, at + 5);
    dvec3 from = dvec3(ray.org) - dvec3(x.w, y.w, z.w);
    dvec3 dir = dvec3(ray.dir);
    DoubleRay local;
    local.org = dvec3(row_times(x, x_rest, from) - double(x_rest.w),
                      row_times(y, y_rest, from) - double(y_rest.w),
                      row_times(z, z_rest, from) - double(z_rest.w));
    local.dir = dvec3(row_times(x, x_rest, dir), row_times(y, y_rest, dir),
                      row_times(z, z_rest, dir));
    return local;
}
