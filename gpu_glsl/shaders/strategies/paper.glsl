//! strategy: paper
//! summary: the published single-pass tracer: two-level uniform grid, plane-equation triangles
//! source: Adinetz & Berezin, Implementing Classical Ray Tracing on GPU, MSU, c. 2006, section 4, figures 2 and 3
//! structure: two_level_grid
//! storage: texture2d
//! entries: fragment compute
//! gl: 3.3
//! twin: yes
//! param: edge_tolerance real 1.004 upper bound of la + lb in the triangle test (D11); 1 is exact
//! param: clip_to_cell integer 1 count a hit only inside the current cell (D10); 0 takes any hit up to the best
//! param: accumulate_ts integer 1 add up the plane distances of the cell walk (D9); 0 recomputes them
//! param: step_ties integer 1 step all axes that tie at once (D9); 0 steps one axis at a time
//! param: guard_zero integer 0 replace direction components near zero before dividing (D8)

// The paper's ray casting procedure.
//
// The scene is divided twice: a uniform grid over the instances' boxes, and for each object a uniform
// grid over its triangles. A ray walks the first; in each cell it meets instances; for each of those
// it is taken to object space and walks the second; in each cell it meets triangles.
//
// Numbers D1 to D17 refer to the deviation table of gpu_glsl/README.md: where the printed text cannot
// run, what stands here instead, and which of its behaviours are kept behind a switch.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"
#include "storage/two_level_grid/texture2d.glsl"

CONSTANT(float, edge_tolerance)
CONSTANT(int, clip_to_cell)
CONSTANT(int, accumulate_ts)
CONSTANT(int, step_ties)
CONSTANT(int, guard_zero)

// ---- Walking a grid (figure 2) ---------------------------------------------------------------

// A walk through the cells of one grid, in cell-texture coordinates.
struct Walk {
    vec3 org;       // r_g = a r_0 + b
    vec3 dir;       // k_g = a k
    vec3 voxel;     // lower corner of the current cell
    vec3 sign_dir;  // from this cell to the next, on each axis (D4: sign(k) * l)
    vec3 next_ts;   // t of the cell's exit plane on each axis
    vec3 delta_ts;  // t across one cell on each axis
    float t_start;  // the ray's part inside the cell: the paper's [vstart, vend]
    float t_end;
    float t_exit;   // where the ray leaves the grid, or ends
};

// D8: a component of 0 divides to infinity, and 0 / 0 to NaN when the origin lies in a cell plane.
vec3 guarded(vec3 dir) {
    float least = 1e-12 * largest(abs(dir));
    return vec3(abs(dir.x) < least ? least : dir.x, abs(dir.y) < least ? least : dir.y,
                abs(dir.z) < least ? least : dir.z);
}

// t of the exit planes of the current cell.
vec3 exit_ts(Walk walk) {
    vec3 planes = walk.voxel + step(vec3(0.0), walk.sign_dir) * cell_size();
    return (planes - walk.org) / walk.dir;
}

// D13: whether the walk is in a cell of its grid. It is not once t has drifted past the grid's border
// before the ray's exit, or when the ray's numbers are not finite.
bool in_grid(Walk walk, Grid grid) {
    vec3 centre = walk.voxel + 0.5 * cell_size();
    return centre.x > grid.lower.x && centre.y > grid.lower.y && centre.z > grid.lower.z &&
           centre.x < grid.upper.x && centre.y < grid.upper.y && centre.z < grid.upper.z;
}

// Takes the part of the ray in [t_start, t_stop] to the cell where it enters the grid. A ray that
// misses the grid comes back with t_start > t_exit.
Walk begin_walk(Grid grid, vec3 org, vec3 dir, float t_start, float t_stop) {
    Walk walk;
    vec3 l = cell_size();
    walk.org = grid.a * org + grid.b;
    walk.dir = grid.a * dir;
    if (guard_zero == 1) walk.dir = guarded(walk.dir);

    // Clip to the grid's box.
    vec3 t_lower = (grid.lower - walk.org) / walk.dir;
    vec3 t_upper = (grid.upper - walk.org) / walk.dir;
    walk.t_start = greater(t_start, largest(lesser(t_lower, t_upper)));
    walk.t_exit = lesser(t_stop, smallest(greater(t_lower, t_upper)));

    // The cell of the entry point (D5: floor, not ceil; D14: never outside the box).
    vec3 entry = walk.org + walk.dir * walk.t_start;
    walk.voxel = lesser(greater(floor(entry / l) * l, grid.lower), grid.upper - l);

    walk.sign_dir = sign(walk.dir) * l;
    walk.delta_ts = l / abs(walk.dir);
    walk.next_ts = exit_ts(walk);
    walk.t_end = lesser(smallest(walk.next_ts), walk.t_exit);  // D6: clipped to the grid
    return walk;
}

bool missed(Walk walk, Grid grid) {
    return !(walk.t_start <= walk.t_exit && in_grid(walk, grid));
}

// D3: asked before stepping, or the last cell is lost.
bool finished(Walk walk) { return !(walk.t_end < walk.t_exit); }

// nextVoxel(): crosses the nearest plane, or all planes at the same t. False if there is no next cell.
bool next_voxel(Grid grid, INOUT(Walk) walk) {
    if (finished(walk)) return false;
    bool x = walk.next_ts.x <= walk.t_end;
    bool y = walk.next_ts.y <= walk.t_end && (step_ties == 1 || !x);
    bool z = walk.next_ts.z <= walk.t_end && (step_ties == 1 || !(x || y));
    walk.t_start = walk.t_end;
    walk.voxel += vec3(x ? walk.sign_dir.x : 0.0, y ? walk.sign_dir.y : 0.0,
                       z ? walk.sign_dir.z : 0.0);
    if (accumulate_ts == 1) {
        walk.next_ts += vec3(x ? walk.delta_ts.x : 0.0, y ? walk.delta_ts.y : 0.0,
                             z ? walk.delta_ts.z : 0.0);
    } else {
        walk.next_ts = exit_ts(walk);
    }
    walk.t_end = lesser(smallest(walk.next_ts), walk.t_exit);
    return in_grid(walk, grid);
}

// D7: a cell is fetched at its centre, not at its corner, where two texels meet.
CellList list_of_cell(Walk walk) {
    count_cell();
    return fetch_cell(walk.voxel + 0.5 * cell_size());
}

// ---- Triangles -------------------------------------------------------------------------------

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

// ---- The object level: two nested loops ------------------------------------------------------

// Finds the nearest hit of one instance in [t_start, t_stop], if it is nearer than `hit`.
void intersect_instance(vec2 address, Ray ray, float t_start, float t_stop, INOUT(Hit) hit) {
    Instance instance = fetch_instance(address);
    vec3 org = vec3(plane_at(instance.row0, ray.org), plane_at(instance.row1, ray.org),
                    plane_at(instance.row2, ray.org));
    vec3 dir = vec3(plane_along(instance.row0, ray.dir), plane_along(instance.row1, ray.dir),
                    plane_along(instance.row2, ray.dir));
    Grid grid = fetch_grid(instance.grid);
    Walk walk = begin_walk(grid, org, dir, t_start, t_stop);
    if (missed(walk, grid)) return;

    bool done = false;
    for (int steps = 0; steps < grid.step_budget; ++steps) {
        CellList list = list_of_cell(walk);
        float t_first = clip_to_cell == 1 ? walk.t_start : t_start;
        float t_last = clip_to_cell == 1 ? walk.t_end : t_stop;
        int k = 0;
        for (; k < list.count; ++k) {
            intersect_triangle(fetch_reference(list.address), org, dir, t_first, t_last,
                               instance.inst_id, grid.first_triangle, hit);
            list.address = next_reference(list.address);
        }
        if (k < list.count) break;  // the driver ended the loop: `done` stays false
        done = hit.t <= walk.t_end || !next_voxel(grid, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
}

// ---- The top level: one merged loop (figure 3) -----------------------------------------------

// Each turn either intersects the next instance of the current cell's list or, when the list is at
// its end, steps to the next cell.
Hit closest_hit(Ray ray) {
    Hit hit = no_hit();
    Grid grid = fetch_grid(top_grid_address());
    Walk walk = begin_walk(grid, ray.org, ray.dir, ray.tmin, ray.tmax);
    if (missed(walk, grid)) return hit;

    CellList list = list_of_cell(walk);
    bool done = false;
    for (int steps = 0; steps < grid.step_budget; ++steps) {
        if (list.count > 0) {
            float t_first = clip_to_cell == 1 ? walk.t_start : ray.tmin;
            float t_last = clip_to_cell == 1 ? walk.t_end : ray.tmax;
            intersect_instance(fetch_reference(list.address), ray, t_first, t_last, hit);
            list.address = next_reference(list.address);
            --list.count;
        } else {
            done = hit.t <= walk.t_end || !next_voxel(grid, walk);
            if (done) break;
            list = list_of_cell(walk);
        }
    }
    if (!done) ray_flags |= kFlagExhausted;
    return hit;
}
