//! strategy: grid
//! summary: the robust tracer: drift-free two-level grid walk, watertight triangle test
//! source: after Adinetz & Berezin, c. 2006; Amanatides & Woo 1987; Woop, Benthin & Wald 2013
//! structure: two_level_grid
//! storage: buffer
//! entries: fragment compute
//! gl: 4.0
//! twin: yes

// A grid tracer that loses nothing: the same two levels as the paper's, with every place where
// rounding could lose, invent or swap a hit closed.
//
// 1. All of a grid is stored in the grid's own frame, exactly, and the ray is brought there with
//    twice the digits (storage/two_level_grid/buffer.glsl).
// 2. The ray's origin is moved to where it enters the grid, so that rounding goes with the grid's
//    size and not with the ray's length.
// 3. Cells are integers, and their planes are computed, not added up (lib/grid/walk.glsl).
// 4. A hit counts wherever it lies; the walk ends when the nearest is not beyond the cell's end.
// 5. The triangle test says by how much rounding can have decided (lib/grid/watertight.glsl).
// 6. Where it can have, twice the digits decide (lib/grid/contest.glsl).
#pragma once
#include "lib/grid/contest.glsl"
#include "lib/grid/walk.glsl"

// ---- The object level --------------------------------------------------------------------------

// Enters the triangles of one instance that the ray meets in [t_first, t_last].
void walk_instance(uint inst_id, Ray ray, float t_first, float t_last, INOUT(Contest) contest) {
    if (inst_id < contest.next.inst_id) return;  // settled in an earlier round
    LocalRay local = to_instance(inst_id, ray);
    Grid grid = fetch_grid(fetch_grid_of_instance(inst_id));

    // The course is the same from whichever cell of the top level the instance is met, so that a
    // triangle met twice gives the same t twice; the walk covers the part that was asked for.
    Course course = course_in(grid, local, contest.start, ray.tmax);
    float begin = greater(t_first - course.start, 0.0);
    float end = lesser(t_last - course.start, course.leave);
    if (!(begin <= end)) return;
    Heat heat = open_heat(contest, inst_id, course.start, ray);
    Shear shear = shear_of(course.org, course.org_rest, course.dir, largest(abs(local.org)));
    Walk walk = begin_walk(grid, course, begin);

    bool done = false;
    for (int steps = step_budget(grid); steps > 0; --steps) {
        count_cell();
        NOTE_CELL(inst_id, walk.cell);
        CellList list = fetch_cell(grid, walk.cell);
        int k = 0;
        for (; k < list.count; ++k) {
            uint prim_id = fetch_triangle_reference(list.first + k);
            NOTE_TEST(inst_id, prim_id);
            Crossing crossing;
            if (may_cross(fetch_triangle(grid, prim_id), shear, crossing)) {
                enter(heat, prim_id, crossing);
            }
        }
        if (k < list.count) break;  // the driver ended the loop: `done` stays false
        float t_exit = smallest(walk.t_exit);
        done = !(t_exit < end) || heat.bound <= t_exit || !next_cell(grid, course, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
    close_heat(heat, inst_id, course.start, contest);
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

void walk_scene(Ray ray, INOUT(Contest) contest) {
    Grid grid = fetch_top_grid();
    Course course = course_in(grid, to_top_level(ray), contest.start, ray.tmax);
    if (!(course.leave >= 0.0)) return;
    Walk walk = begin_walk(grid, course, 0.0);

    bool done = false;
    for (int steps = step_budget(grid); steps > 0; --steps) {
        count_cell();
        NOTE_CELL(kNoId, walk.cell);
        CellList list = fetch_top_cell(grid, walk.cell);
        Span span = span_in_cell(grid, course, walk.cell);
        // The two levels start their t at different places: give the difference its rounding.
        const float kRounding = 9.5367431640625e-7;  // 2^-20: eight ulps
        float slack = kRounding * abs(course.start);
        int k = 0;
        for (; k < list.count; ++k) {
            walk_instance(fetch_instance_reference(list.first + k), ray,
                          course.start + span.enter - slack, course.start + span.leave + slack,
                          contest);
        }
        if (k < list.count) break;  // as above
        float t_exit = smallest(walk.t_exit);
        done = !(t_exit < course.leave) || bound_from(contest, course.start) <= t_exit ||
               !next_cell(grid, course, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
}

Hit closest_hit(Ray ray) {
    Winner winner = Winner(no_hit(), Pair(infinity(), 0.0));
    if (!is_traceable(ray)) return winner.hit;

    // One round, but where more than two surfaces are closer to each other than rounding. Each
    // settles at least one of them.
    const int kMostRounds = 4096;
    Contest contest = open_contest(ray);
    bool done = false;
    for (int rounds = kMostRounds; rounds > 0; --rounds) {
        walk_scene(ray, contest);
        settle(contest, ray, winner);
        done = !is_somebody(contest.left_out);
        if (done) break;
        reopen(contest, winner.t);
    }
    if (!done) ray_flags |= kFlagExhausted;
    return winner.hit;
}
