// The published ray-triangle test (Adinetz & Berezin, section 4): plane equations, one expression.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"
#include "storage/two_level_grid/texture2d.glsl"

CONSTANT(float, edge_tolerance)

// A triangle is its plane and its sides, scaled so that a dot product is a barycentric coordinate
// (D2). The test is one combined expression; its sum of coordinates has the printed slack (D11).
void intersect_triangle(vec2 address, vec3 org, vec3 dir, float t_start, float t_end, uint inst_id,
                        int first_triangle, INOUT(Hit) hit) {
    count_test();
    Triangle triangle = fetch_triangle(address);
    float t = -plane_at(triangle.plane, org) / plane_along(triangle.plane, dir);
    vec3 p = org + dir * t;
    float la = plane_at(triangle.side_u, p);
    float lb = plane_at(triangle.side_v, p);
    if (t >= t_start && t <= t_end && t < hit.t && la >= 0.0 && lb >= 0.0 &&
        la + lb <= edge_tolerance) {
        hit = Hit(t, la, lb, uint(triangle_index(address) - first_triangle), inst_id);
    }
}
