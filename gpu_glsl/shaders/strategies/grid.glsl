//! strategy: grid
//! summary: the robust tracer: drift-free two-level grid walk over empty space, watertight triangles
//! source: after Adinetz & Berezin, c. 2006; Amanatides & Woo 1987; Cohen & Sheffer 1994; Woop, Benthin & Wald 2013
//! structure: two_level_grid
//! storage: buffer ssbo
//! entries: fragment compute
//! gl: 4.3
//! twin: yes

// A grid tracer that loses nothing and wastes little: the same two levels as the paper's, with every
// place where rounding could lose, invent or swap a hit closed.
//
// 1. All of a grid is stored in the grid's own frame, exactly, and the ray is brought there in
//    doubles (storage/two_level_grid/grid_buffers.glsl).
// 2. The ray's origin is moved to where it enters the grid, so that rounding goes with the grid's
//    size and not with the ray's length. From there on all numbers are floats.
// 3. Cells are integers, their planes are computed, not added up, and empty space is crossed at once
//    (lib/grid/walk.glsl).
// 4. A hit counts wherever it lies; the walk ends when the nearest is not beyond the cell's end.
// 5. The triangle test says by how much rounding can have decided (lib/triangle/rule_out.glsl).
// 6. Where it can have, doubles decide (lib/triangle/decide.glsl).
#pragma once
#include "lib/grid/walk.glsl"
#include "lib/triangle/decide.glsl"

CONSTANT(bool, one_instance)  // then there is no top level

// The nearest hit of the instances walked through so far.
struct Nearest {
    double t;
    Hit hit;
};

bool is_before(uint inst_id, uint prim_id, Hit other) {
    return inst_id < other.inst_id || (inst_id == other.inst_id && prim_id < other.prim_id);
}

// ---- The object level --------------------------------------------------------------------------

// t between which the nearest hit lies, from the start of a course on; infinite if there is none.
struct Bracket {
    float from;
    float to;
};

// A number's two ulps, to be on the safe side of its rounding.
float two_ulps(float x) { return (4.0 * half_ulp()) * abs(x); }

Bracket bracket_of(double t, float start) {
    float about = float(t - double(start));
    if (!(about < infinity())) return Bracket(infinity(), infinity());
    return Bracket(about - two_ulps(about), about + two_ulps(about));
}

// Finds the nearest hit on one instance, where the ray meets it in [t_first, t_last].
//
// Floats walk and test. They find out which triangle is hit first, but for an `open` one, of which
// they cannot tell whether it is hit, or before the nearest. It waits: a nearer hit may settle the
// question. When the walk is over, or a second one would have to wait, doubles decide. (A walk that
// decided on its way would pay for it at every test: a software renderer goes through both sides
// of a branch, and a GPU keeps registers for both.)
void walk_instance(uint inst_id, Ray ray, float t_first, float t_last, INOUT(Nearest) nearest) {
    int grid_number = fetch_grid_of_instance(inst_id);
    Grid grid = fetch_grid(grid_number);
    // The course is the same from whichever cell of the top level the instance is met, so that a
    // triangle met twice gives the same t twice; the walk covers the part that was asked for.
    Course course = course_in(grid, to_instance(inst_id, ray), ray.tmin, ray.tmax);
    float begin = greater(t_first - course.start, 0.0);
    float end = lesser(t_last - course.start, course.leave);
    if (!(begin <= end)) return;
    Sight sight = sight_along(course.ray);
    Walk walk = begin_walk(grid, course, begin);
    uint octant = octant_shift(walk);

    // From here on t counts from the start of the course.
    float t_inside = ray.tmin - course.start;
    float t_before = ray.tmax - course.start;
    t_inside += two_ulps(t_inside);
    t_before -= t_before < infinity() ? two_ulps(t_before) : 0.0;
    Bracket bracket = bracket_of(nearest.t, course.start);
    uint found = nearest.hit.inst_id == inst_id ? nearest.hit.prim_id : kNoId;
    uint open = kNoId;

    int steps = step_budget(grid);
    CELL cell = fetch_cell(grid, walk.cell);
    int at = first_reference(cell);
    bool is_in_list = !is_empty_cell(cell);
    bool is_over = false;
    count_cell();
    NOTE_CELL(inst_id, walk.cell);
    const int kMostRounds = 1 << 20;
    for (int rounds = kMostRounds; rounds > 0 && !is_over; --rounds) {
        bool is_full = false;  // another triangle is open
        for (; steps > 0 && !is_over && !is_full;) {
            // The triangles of this cell.
            const int kMostReferences = 1 << 30;
            for (int left = kMostReferences; left > 0 && is_in_list && !is_full; --left) {
                uint reference = fetch_triangle_reference(at);
                uint prim_id = referenced(reference);
                NOTE_TEST(inst_id, prim_id);
                Crossing crossing;
                bool is_hit = may_cross(fetch_triangle(grid, prim_id), sight, crossing) &&
                              crossing.from <= bracket.to && crossing.to >= t_inside &&
                              prim_id != found && prim_id != open;
                bool is_clear = crossing.is_sure && crossing.to < bracket.from &&
                                crossing.from > t_inside && crossing.to < t_before;
                if (is_hit && is_clear) {
                    found = prim_id;
                    bracket = Bracket(crossing.from, crossing.to);
                } else if (is_hit) {
                    is_full = open != kNoId;
                    if (!is_full) open = prim_id;
                }
                if (!is_full) {
                    ++at;
                    is_in_list = !is_last_reference(reference);
                }
            }
            if (is_in_list) break;  // to decide, or the driver ended the loop

            // On to the next cell that is full.
            bool is_empty = true;
            for (; steps > 0 && is_empty && !is_over; --steps) {
                ivec3 last = far_corner(cell, walk.cell, walk.step, octant);
                vec3 t_exit = exit_t(walk, last);
                is_over = !(smallest(t_exit) < lesser(end, bracket.to)) ||
                          !next_cell(grid, last, t_exit, walk);
                if (!is_over) {
                    count_cell();
                    NOTE_CELL(inst_id, walk.cell);
                    cell = fetch_cell(grid, walk.cell);
                    is_empty = is_empty_cell(cell);
                }
            }
            at = first_reference(cell);
            is_in_list = !is_over && !is_empty;
        }
        if (!is_over && !is_full) break;  // the driver ended a loop

        // Doubles decide, first about what floats found, then about what they left open.
        float start = course.start;
        LocalRay local = moved_from_afar(to_instance(inst_id, ray), start);
        int questions = found != kNoId && open != kNoId ? 2 : 1;
        for (int k = 0; k < questions; ++k) {
            uint prim_id = k == 0 && found != kNoId ? found : open;
            if (prim_id != kNoId) {
                SharpHit sharp = sharp_hit(local, fetch_triangle(grid, prim_id));
                double t = sharp.t + double(start);
                if (sharp.is_hit && t >= double(ray.tmin) && t <= double(ray.tmax) &&
                    (t < nearest.t ||
                     (t == nearest.t && is_before(inst_id, prim_id, nearest.hit)))) {
                    nearest = Nearest(t, Hit(float(t), sharp.u, sharp.v, prim_id, inst_id));
                }
            }
        }
        found = nearest.hit.inst_id == inst_id ? nearest.hit.prim_id : kNoId;
        open = kNoId;
        bracket = bracket_of(nearest.t, course.start);
    }
    if (!is_over) ray_flags |= kFlagExhausted;
}

// ---- The top level -----------------------------------------------------------------------------

// The part of the ray within a cell of the top level that is widened as its lists are: what an
// instance of this cell must be walked through for.
Span span_in_cell(Grid grid, Course course, ivec3 cell) {
    const float kPad = 0.001;  // kBinningPad of core/grid/uniform_grid.h
    vec3 lower = grid.lower + (vec3(cell) - kPad) * grid.cell;
    vec3 upper = grid.lower + (vec3(cell) + (1.0 + kPad)) * grid.cell;
    return span_in_box(vec3(course.ray.org), 1.0 / course.dir, lower, upper);
}

void walk_scene(Ray ray, INOUT(Nearest) nearest) {
    Grid grid = fetch_top_grid();
    Course course = course_in(grid, to_top_level(ray), ray.tmin, ray.tmax);
    if (!(course.leave >= 0.0)) return;
    Walk walk = begin_walk(grid, course, 0.0);
    uint octant = octant_shift(walk);

    bool done = false;
    for (int steps = step_budget(grid); steps > 0; --steps) {
        count_cell();
        NOTE_CELL(kNoId, walk.cell);
        uint cell = fetch_top_cell(grid, walk.cell);
        bool is_list_done = is_empty_cell(cell);
        if (!is_list_done) {
            Span span = span_in_cell(grid, course, walk.cell);
            // The two levels start their t at different places: give the difference its rounding.
            const float kRounding = 9.5367431640625e-7;  // 2^-20: eight ulps
            float slack = kRounding * abs(course.start);
            const int kMostReferences = 1 << 30;
            int at = first_reference(cell);
            for (int left = kMostReferences; left > 0; --left) {
                uint reference = fetch_instance_reference(at);
                ++at;
                walk_instance(referenced(reference), ray, course.start + span.enter - slack,
                              course.start + span.leave + slack, nearest);
                is_list_done = is_last_reference(reference);
                if (is_list_done) break;
            }
        }
        if (!is_list_done) break;  // as above
        ivec3 last = last_cell(walk, empty_cube(cell, octant));
        vec3 t_exit = exit_t(walk, last);
        float bound = bracket_of(nearest.t, course.start).to;
        done = !(smallest(t_exit) < lesser(course.leave, bound)) ||
               !next_cell(grid, last, t_exit, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
}

Hit closest_hit(Ray ray) {
    if (!is_traceable(ray)) return no_hit();
    Nearest nearest = Nearest(double(infinity()), no_hit());
    if (one_instance) {
        walk_instance(0u, ray, ray.tmin, ray.tmax, nearest);
    } else {
        walk_scene(ray, nearest);
    }
    if (is_hit(nearest.hit)) NOTE_HIT(nearest.hit);
    return nearest.hit;
}
