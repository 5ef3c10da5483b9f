//! strategy: paper_claims
//! summary: the paper's tracer, with what it claims of loops, tests and vectors as switches
//! source: Adinetz & Berezin, Implementing Classical Ray Tracing on GPU, MSU, c. 2006, section 4
//! structure: two_level_grid
//! storage: texture2d texture2d_copies texture2d_virtual
//! entries: fragment compute
//! gl: 3.3
//! twin: yes
//! default: no
//! param: top_loop choice(merged,nested) merged one loop that steps or intersects (figure 3), or two nested ones
//! param: triangle_test choice(combined,sequential,early_out) combined one expression, one if after the other, or leaving once t is out of range
//! param: vectors choice(scalar,4d,3d) scalar plane equations as spelled-out sums, as dot(vec4, vec4) or as dot(vec3, vec3) + w
//! param: edge_tolerance real 1.004 upper bound of la + lb in the triangle test (D11); 1 is exact
//! param: clip_to_cell integer 1 count a hit only inside the current cell (D10); 0 takes any hit up to the best
//! param: accumulate_ts integer 1 add up the plane distances of the cell walk (D9); 0 recomputes them
//! param: step_ties integer 1 step all axes that tie at once (D9); 0 steps one axis at a time
//! param: guard_zero integer 0 replace direction components near zero before dividing (D8)
//! param: local_planes integer 0 store planes relative to the triangle's first corner (D18)
//! param: edge_slack real 0 tolerance of every edge, in units of its rounding (D19)
//! deviation: D11 edge_tolerance=1 la + lb may exceed 1 by 0.4 %
//! deviation: D10 clip_to_cell=0 a hit counts only inside the current cell
//! deviation: D9a accumulate_ts=0 plane distances are added up and drift
//! deviation: D9b step_ties=0 a tie steps several axes at once
//! deviation: D8 guard_zero=1 a direction component of 0 divides to infinity or NaN
//! deviation: D19 edge_slack=3 edges have no tolerance for rounding
//! deviation: D18 local_planes=1 planes are in absolute object coordinates

// The paper's algorithm once more, so that what it says of its own inner loops can be measured.
//
// Each claim is a typed constant and a plain `if`: the compiler keeps one side. With the defaults
// this is strategies/paper.glsl, hit for hit and bit for bit; a test holds that. With `vectors` set
// to 4d or 3d sums are the driver's dot(), in its own order. The storages are claims as well: what
// a cell's list holds, and how an address becomes a texel.
#pragma once
#include "lib/paper/walk.glsl"
#include "lib/paper/edges.glsl"

CONSTANT(int, top_loop)
CONSTANT(int, triangle_test)
CONSTANT(int, vectors)
const int kNested = 1;      // of top_loop
const int kSequential = 1;  // of triangle_test
const int kEarlyOut = 2;
const int k4d = 1;  // of vectors
const int k3d = 2;

// ---- Vectors: "4D vectors beat 3D" -------------------------------------------------------------

// n . p + d, as lib/math.glsl's plane_at().
float claimed_plane_at(vec4 plane, vec3 p) {
    if (vectors == k4d) return dot(plane, vec4(p, 1.0));
    if (vectors == k3d) return dot(vec3(plane), p) + plane.w;
    return plane_at(plane, p);
}

// n . v, as plane_along().
float claimed_plane_along(vec4 plane, vec3 v) {
    if (vectors == k4d) return dot(plane, vec4(v, 0.0));
    if (vectors == k3d) return dot(vec3(plane), v);
    return plane_along(plane, v);
}

// ---- The triangle test: "one combined expression", "an early-out branch" -----------------------

void intersect_triangle(ADDRESS triangle, vec3 org, vec3 dir, float t_start, float t_end,
                        uint inst_id, int first_triangle, INOUT(Hit) hit) {
    count_test();
    NOTE_TEST(inst_id, fetch_prim_id(triangle, first_triangle));
    vec4 plane = fetch_plane(triangle, 0);
    vec3 from = plane_origin(triangle, org);
    float t = -claimed_plane_at(plane, from) / claimed_plane_along(plane, dir);
    if (triangle_test == kEarlyOut && !(t >= t_start && t <= t_end && t < hit.t)) return;

    vec4 side_u = fetch_plane(triangle, 1);
    vec4 side_v = fetch_plane(triangle, 2);
    vec3 p = from + dir * t;
    float la = claimed_plane_at(side_u, p);
    float lb = claimed_plane_at(side_v, p);
    float slack_u = side_slack(side_u, from, dir, t);
    float slack_v = side_slack(side_v, from, dir, t);
    float la_lb_bound = edge_tolerance + (slack_u + slack_v);
    if (triangle_test == kSequential) {
        // Written so that NaN fails each of them.
        if (!(t >= t_start)) return;
        if (!(t <= t_end)) return;
        if (!(t < hit.t)) return;
        if (!(la >= -slack_u)) return;
        if (!(lb >= -slack_v)) return;
        if (!(la + lb <= la_lb_bound)) return;
        hit = Hit(t, la, lb, fetch_prim_id(triangle, first_triangle), inst_id);
        NOTE_HIT(hit);
    } else if (t >= t_start && t <= t_end && t < hit.t && la >= -slack_u && lb >= -slack_v &&
               la + lb <= la_lb_bound) {
        hit = Hit(t, la, lb, fetch_prim_id(triangle, first_triangle), inst_id);
        NOTE_HIT(hit);
    }
}

#include "lib/paper/object_level.glsl"

// ---- The top level: "a merged loop costs little" -----------------------------------------------

void intersect_next_instance(Walk walk, Ray ray, INOUT(CellList) list, INOUT(Hit) hit) {
    float t_first = clip_to_cell == 1 ? walk.t_start : ray.tmin;
    float t_last = clip_to_cell == 1 ? walk.t_end : ray.tmax;
    intersect_instance(fetch_reference(list.address), ray, t_first, t_last, hit);
    list.address = next_reference(list.address);
    --list.count;
}

// Merged, a turn takes one instance or one step; nested, a loop of its own empties the cell's list
// before each step.
Hit closest_hit(Ray ray) {
    Hit hit = no_hit();
    Grid grid = fetch_grid(top_grid_address());
    Walk walk = begin_walk(grid, ray.org, ray.dir, ray.tmin, ray.tmax);
    if (missed(walk, grid)) return hit;

    NOTE_CELL(kNoId, cell_number(walk, grid));
    CellList list = list_of_cell(walk);
    bool done = false;
    for (int steps = 0; steps < grid.step_budget; ++steps) {
        if (top_loop == kNested) {
            while (list.count > 0) intersect_next_instance(walk, ray, list, hit);
        } else if (list.count > 0) {
            intersect_next_instance(walk, ray, list, hit);
            continue;
        }
        done = hit.t <= walk.t_end || !next_voxel(grid, walk);
        if (done) break;
        NOTE_CELL(kNoId, cell_number(walk, grid));
        list = list_of_cell(walk);
    }
    if (!done) ray_flags |= kFlagExhausted;
    return hit;
}
