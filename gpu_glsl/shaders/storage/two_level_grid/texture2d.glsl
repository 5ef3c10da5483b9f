// The paper's storage: each triangle is stored once, and lists hold references to them (section 4).
//
// A reference is the place of a triangle's (or, from the top-level grid, an instance's) first
// texel. References may be stored as 16-bit floats; then no texture is larger than 1024 texels a
// side, because (k + 0.5) / W is exact in a half only up to there.
#pragma once
#include "storage/two_level_grid/tables2d.glsl"

vec2 fetch_triangle_reference(vec2 address) { return fetch_reference(address); }
vec2 next_triangle_reference(vec2 address) { return next_reference(address); }

// The triangle's place in the texture, counted in triangles, from its object's first on.
uint fetch_prim_id(vec2 triangle, int first_triangle) {
    ivec2 size = SIZE2D(triangles);
    ivec2 texel = ivec2(floor(triangle * vec2(size)));
    return uint((texel.y * size.x + texel.x) / kTriangleTexels - first_triangle);
}
