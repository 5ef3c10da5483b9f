//! strategy: grid
//! summary: the robust tracer: drift-free two-level grid walk, watertight triangle test
//! source: after Adinetz & Berezin, c. 2006; Amanatides & Woo 1987; Woop, Benthin & Wald 2013
//! structure: two_level_grid
//! storage: buffer
//! entries: fragment compute
//! gl: 4.0
//! twin: yes
//! default: no

// A grid tracer that loses nothing: the same two levels as the paper's, with every place where
// rounding could lose or invent a hit closed.
//
// 1. All of a grid is stored in the grid's own frame (storage/two_level_grid/buffer.glsl).
// 2. The ray's origin is moved to where it enters the grid, so that rounding goes with the grid's
//    size and not with the ray's length. The moved ray is one of E_ray (core/judge.h).
// 3. Cells are integers, and their planes are computed, not added up (lib/grid/walk.glsl).
// 4. A hit counts wherever it lies; the walk ends when the best hit is not beyond the cell's end.
// 5. The triangle test is watertight (lib/grid/watertight.glsl).
#pragma once
#include "lib/grid/walk.glsl"
#include "lib/grid/watertight.glsl"

// ---- The object level --------------------------------------------------------------------------

// Finds the nearest hit of one instance in [t_first, t_last], if it is nearer than `hit`.
void intersect_instance(uint inst_id, Ray ray, float t_first, float t_last, INOUT(Hit) hit) {
    LocalRay local = to_instance(inst_id, ray);
    Grid grid = fetch_grid(fetch_grid_of_instance(inst_id));

    // The course is the same from whichever cell of the top level the instance is met, so that a
    // triangle met twice gives the same t twice; the walk covers the part that was asked for.
    Course course = course_in(grid, local, ray.tmin, ray.tmax);
    float begin = greater(t_first - course.start, 0.0);
    float end = lesser(t_last - course.start, course.leave);
    if (!(begin <= end)) return;
    Shear shear = shear_of(course.org, course.org_rest, course.dir);
    Walk walk = begin_walk(grid, course, begin);

    bool done = false;
    for (int steps = step_budget(grid); steps > 0; --steps) {
        count_cell();
        NOTE_CELL(inst_id, walk.cell);
        CellList list = fetch_cell(grid, walk.cell);
        int k = 0;
        for (; k < list.count; ++k) {
            uint prim_id = fetch_reference(list.first + k);
            intersect_triangle(fetch_triangle(grid, prim_id), prim_id, inst_id, shear,
                               course.start, ray, hit);
        }
        if (k < list.count) break;  // the driver ended the loop: `done` stays false
        float t_exit = smallest(walk.t_exit);
        done = !(t_exit < end) || hit.t - course.start <= t_exit || !next_cell(grid, course, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
}

// ---- The top level -----------------------------------------------------------------------------

// The part of the ray within a cell of the top level that is widened as its lists are: what an
// instance of this cell must be walked through for.
Span span_in_cell(Grid grid, Course course, ivec3 cell) {
    const float kPad = 0.001;  // kBinningPad of core/grid/uniform_grid.h
    vec3 lower = grid.lower + (vec3(cell) - kPad) * grid.cell;
    vec3 upper = grid.lower + (vec3(cell) + (1.0 + kPad)) * grid.cell;
    vec3 t_lower = (lower - course.org) * course.inverse;
    vec3 t_upper = (upper - course.org) * course.inverse;
    return Span(largest(lesser(t_lower, t_upper)), smallest(greater(t_lower, t_upper)));
}

Hit closest_hit(Ray ray) {
    Hit hit = no_hit();
    Grid grid = fetch_grid(kTopGrid);
    Course course = course_in(grid, to_top_level(ray), ray.tmin, ray.tmax);
    if (!(course.leave >= 0.0)) return hit;
    Walk walk = begin_walk(grid, course, 0.0);

    bool done = false;
    for (int steps = step_budget(grid); steps > 0; --steps) {
        count_cell();
        NOTE_CELL(kNoId, walk.cell);
        CellList list = fetch_cell(grid, walk.cell);
        Span span = span_in_cell(grid, course, walk.cell);
        // The two levels start their t at different places: give the difference its rounding.
        const float kRounding = 9.5367431640625e-7;  // 2^-20: eight ulps
        float slack = kRounding * abs(course.start);
        int k = 0;
        for (; k < list.count; ++k) {
            intersect_instance(fetch_reference(list.first + k), ray,
                               course.start + span.enter - slack, course.start + span.leave + slack,
                               hit);
        }
        if (k < list.count) break;  // as above
        float t_exit = smallest(walk.t_exit);
        done = !(t_exit < course.leave) || hit.t - course.start <= t_exit ||
               !next_cell(grid, course, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
    return hit;
}
