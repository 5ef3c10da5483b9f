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
//! param: local_planes integer 0 store planes relative to the triangle's first corner (D18)
//! param: edge_slack real 0 tolerance of every edge, in units of its rounding (D19)
//! deviation: D11 edge_tolerance=1 la + lb may exceed 1 by 0.4 %
//! deviation: D10 clip_to_cell=0 a hit counts only inside the current cell
//! deviation: D9a accumulate_ts=0 plane distances are added up and drift
//! deviation: D9b step_ties=0 a tie steps several axes at once
//! deviation: D8 guard_zero=1 a direction component of 0 divides to infinity or NaN
//! deviation: D19 edge_slack=3 edges have no tolerance for rounding
//! deviation: D18 local_planes=1 planes are in absolute object coordinates

// The paper's ray casting procedure.
//
// The scene is divided twice: a uniform grid over the instances' boxes, and for each object a
// uniform grid over its triangles. A ray walks the first; in each cell it meets instances; for each
// of those it is taken to object space and walks the second; in each cell it meets triangles.
//
// Numbers D1 to D19 refer to the deviation table of gpu_glsl/README.md: where the printed text
// cannot run, what stands here instead, and which of its behaviours are kept behind a switch. The
// chapters: walking a grid, the triangle test, the object level, and below the top level, where it
// begins.
#pragma once
#include "lib/paper/walk.glsl"
#include "lib/paper/triangle.glsl"
#include "lib/paper/object_level.glsl"

// ---- The top level: one merged loop (figure 3) -----------------------------------------------

// Each turn either intersects the next instance of the current cell's list or, when the list is at
// its end, steps to the next cell.
Hit closest_hit(Ray ray) {
    Hit hit = no_hit();
    Grid grid = fetch_grid(top_grid_address());
    Walk walk = begin_walk(grid, ray.org, ray.dir, ray.tmin, ray.tmax);
    if (missed(walk, grid)) return hit;

    NOTE_CELL(kNoId, cell_number(walk, grid));
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
            NOTE_CELL(kNoId, cell_number(walk, grid));
            list = list_of_cell(walk);
        }
    }
    if (!done) ray_flags |= kFlagExhausted;
    return hit;
}
