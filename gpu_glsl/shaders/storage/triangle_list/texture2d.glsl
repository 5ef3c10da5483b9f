// Triangles and instances alone: all that a tracer without a structure reads. An address is a
// number, which powers of two turn into the place of a texel.
#pragma once
#define ADDRESS int
#include "lib/dialect.glsl"
#include "shared/triangle_list_layout.h"
#include "shared/two_level_layout.h"

TEXTURE2D(triangles)
TEXTURE2D(instances)
CONSTANT(int, log2_triangles_per_row)
CONSTANT(int, log2_instances_per_row)

struct ListedInstance {
    vec4 row0;  // of object_from_world
    vec4 row1;
    vec4 row2;
    int first_triangle;  // of the object, in the order of the triangle texture
    int triangle_count;
};

// Texel k of record `index`, of records of `texels` texels.
ivec2 listed_texel(int index, int k, int texels, int log2_per_row) {
    int column = index & ((1 << log2_per_row) - 1);
    return ivec2(column * texels + k, index >> log2_per_row);
}

vec4 fetch_instance_row(int index, int k) {
    return FETCH2D(instances,
                   listed_texel(index, k, kListedInstanceTexels, log2_instances_per_row));
}

ListedInstance fetch_listed_instance(int index) {
    vec4 numbers = fetch_instance_row(index, 3);
    return ListedInstance(fetch_instance_row(index, 0), fetch_instance_row(index, 1),
                          fetch_instance_row(index, 2), int(numbers.x), int(numbers.y));
}

vec4 fetch_plane(int triangle, int k) {
    return FETCH2D(triangles, listed_texel(triangle, k, kTriangleTexels, log2_triangles_per_row));
}

uint fetch_prim_id(int triangle, int first_triangle) { return uint(triangle - first_triangle); }
