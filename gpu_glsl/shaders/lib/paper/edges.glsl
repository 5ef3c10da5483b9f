// What counts as inside a triangle's edges, and from where its planes are measured: the printed
// test in rounded arithmetic, and what it costs to mend it (D11, D18, D19 of gpu_glsl/README.md).
#pragma once
#include "lib/math.glsl"

CONSTANT(float, edge_tolerance)
CONSTANT(float, edge_slack)
CONSTANT(int, local_planes)

// D18: the ray's origin as the planes are to be told of it. As printed, planes are absolute, and t
// loses the digits that the object's distance from its own origin takes.
vec3 plane_origin(ADDRESS triangle, vec3 org) {
    return local_planes == 1 ? org - vec3(fetch_plane(triangle, 3)) : org;
}

// D19: how far rounding may move a side's coordinate at org + dir t: 2^-24, half an ulp, of all the
// terms that went into it. As printed there is no such slack: a ray along a shared edge can round
// to the outside of both triangles. A slack of 3 closes every crack that was found, 1 nearly all;
// from 2 on, some hits lie farther beside the triangle than a float ray can tell.
float side_rounding(vec4 side, vec3 org, vec3 dir, float t) {
    vec3 reach = abs(org) + abs(dir * t);
    return 5.9604645e-8 * (plane_along(abs(side), reach) + abs(side.w));
}
float side_slack(vec4 side, vec3 org, vec3 dir, float t) {
    return edge_slack > 0.0 ? edge_slack * side_rounding(side, org, dir, t) : 0.0;
}
