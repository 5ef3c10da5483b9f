// The published ray-triangle test (Adinetz & Berezin, section 4): plane equations, one expression.
#pragma once
#include "lib/math.glsl"
#include "lib/paper/edges.glsl"
#include "lib/ray.glsl"

// A triangle is its plane and its sides, scaled so that a dot product is a barycentric coordinate
// (D2). The test is one combined expression; its sum of coordinates has the printed slack (D11).
void intersect_triangle(ADDRESS triangle, vec3 org, vec3 dir, float t_start, float t_end,
                        uint inst_id, int first_triangle, INOUT(Hit) hit) {
    count_test();
    NOTE_TEST(inst_id, fetch_prim_id(triangle, first_triangle));
    vec4 plane = fetch_plane(triangle, 0);
    vec4 side_u = fetch_plane(triangle, 1);
    vec4 side_v = fetch_plane(triangle, 2);
    vec3 from = plane_origin(triangle, org);
    float t = -plane_at(plane, from) / plane_along(plane, dir);
    vec3 p = from + dir * t;
    float la = plane_at(side_u, p);
    float lb = plane_at(side_v, p);
    float slack_u = side_slack(side_u, from, dir, t);
    float slack_v = side_slack(side_v, from, dir, t);
    if (t >= t_start && t <= t_end && t < hit.t && la >= -slack_u && lb >= -slack_v &&
        la + lb <= edge_tolerance + (slack_u + slack_v)) {
        hit = Hit(t, la, lb, fetch_prim_id(triangle, first_triangle), inst_id);
        NOTE_HIT(hit);
    }
}
