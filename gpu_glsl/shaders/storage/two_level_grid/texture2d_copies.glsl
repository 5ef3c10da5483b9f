// Copies instead of references: an object grid's list is a run of triangle records, so that a
// triangle is stored once for each cell it overlaps. The top level's lists are references.
//
// One fetch less for each test, and a texture several times as large: the paper prefers sharing.
#pragma once
#include "storage/two_level_grid/tables2d.glsl"

// The entry of the list is the triangle.
vec2 fetch_triangle_reference(vec2 address) {
    count_reference();
    return address;
}

vec2 next_triangle_reference(vec2 address) {
    return address + vec2(float(kTriangleTexels) / float(SIZE2D(triangles).x), 0.0);
}

// A copy's place says nothing of its number, so that the record carries it.
uint fetch_prim_id(vec2 triangle, int first_triangle) {
    return uint(int(fetch_plane(triangle, 3).w));
}
