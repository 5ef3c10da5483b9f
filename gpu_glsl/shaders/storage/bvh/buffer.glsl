// The bounding volume hierarchy in buffer textures: a tree over instances, and one an object.
//
// An object's vertices and boxes are stored in its own frame, without rounding: as the two-level
// grid's are (storage/two_level_grid/grid_buffers.glsl says how). The tree over instances is in the
// world.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"
#include "shared/bvh_layout.h"

// The objects' trees: fixed once they are built.
UBUFFER(bvh_nodes)
BUFFER(bvh_planes)        // in the leaves' order, so that a leaf's triangles lie together
BUFFER(bvh_vertices)      // likewise
UBUFFER(bvh_primitives)   // the triangle in each slot
UBUFFER(bvh_roots)        // of each instance's object: a node
BUFFER(bvh_instances)

#if NEEDS(has_top_level)
// The top level.
UBUFFER(bvh_top_nodes)
UBUFFER(bvh_top_instances)  // the instance in each slot
#endif

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

struct Box {
    vec3 lower;
    vec3 upper;
    vec3 centre;
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

#if NEEDS(has_top_level)
Node fetch_top_node(uint index) {
    int at = int(index) * kBvhNodeTexels;
    return node_of(FETCHBUFFER(bvh_top_nodes, at), FETCHBUFFER(bvh_top_nodes, at + 1),
                   FETCHBUFFER(bvh_top_nodes, at + 2), FETCHBUFFER(bvh_top_nodes, at + 3));
}

uint fetch_top_instance(int slot) { return FETCHBUFFER(bvh_top_instances, slot).x; }
#endif

Planes fetch_planes(int slot) {
    int at = slot * kBvhPlanesTexels;
    return Planes(FETCHBUFFER(bvh_planes, at), FETCHBUFFER(bvh_planes, at + 1),
                  FETCHBUFFER(bvh_planes, at + 2));
}

Triangle fetch_triangle(int slot) {
    int at = slot * kBvhTriangleTexels;
    return Triangle(vec3(FETCHBUFFER(bvh_vertices, at)), vec3(FETCHBUFFER(bvh_vertices, at + 1)),
                    vec3(FETCHBUFFER(bvh_vertices, at + 2)));
}

uint fetch_primitive(int slot) { return FETCHBUFFER(bvh_primitives, slot).x; }

uint fetch_root(uint inst_id) { return FETCHBUFFER(bvh_roots, int(inst_id)).x; }

Box fetch_object_box(uint inst_id) {
    int at = int(inst_id) * kBvhInstanceTexels + 6;
    return Box(vec3(FETCHBUFFER(bvh_instances, at)), vec3(FETCHBUFFER(bvh_instances, at + 1)),
               vec3(FETCHBUFFER(bvh_instances, at + 2)));
}

// The ray in the frame of the instance's object. The instance's place is taken off first, which
// seldom rounds, so that a large translation costs no digits. What is rounded here is rounded for
// all triangles of the object alike: they see one and the same ray.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kBvhInstanceTexels;
    vec4 x = FETCHBUFFER(bvh_instances, at);
    vec4 y = FETCHBUFFER(bvh_instances, at + 1);
    vec4 z = FETCHBUFFER(bvh_instances, at + 2);
    vec4 x_rest = FETCHBUFFER(bvh_instances, at + 3);
    vec4 y_rest = FETCHBUFFER(bvh_instances, at + 4);
    vec4 z_rest = FETCHBUFFER(bvh_instances, at + 5);
    dvec3 row_x = dvec3(vec3(x)) + dvec3(vec3(x_rest));
    dvec3 row_y = dvec3(vec3(y)) + dvec3(vec3(y_rest));
    dvec3 row_z = dvec3(vec3(z)) + dvec3(vec3(z_rest));
    dvec3 from = dvec3(ray.org) - dvec3(vec3(x.w, y.w, z.w));
    dvec3 dir = dvec3(ray.dir);
    dvec3 origin = dvec3(vec3(x_rest.w, y_rest.w, z_rest.w));
    return LocalRay(
        dvec3(sharp_dot(row_x, from), sharp_dot(row_y, from), sharp_dot(row_z, from)) - origin,
        dvec3(sharp_dot(row_x, dir), sharp_dot(row_y, dir), sharp_dot(row_z, dir)));
}
