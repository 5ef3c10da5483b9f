//! strategy: grid
//! summary: the robust tracer: drift-free two-level grid walk over empty space, watertight triangles
//! source: after Adinetz & Berezin, c. 2006; Amanatides & Woo 1987; Cohen & Sheffer 1994; Woop, Benthin & Wald 2013
//! structure: two_level_grid
//! storage: buffer ssbo
//! entries: fragment compute
//! gl: 4.3
//! twin: yes
//! param: skip_empty integer 1 cross empty space at once; 0 walks it cell by cell
//! param: test_boxes integer 1 walk through an instance only if the ray meets its box; 0 if both are in a cell
//! param: decide choice(doubles,floats) doubles what decides where floats cannot tell; floats err
//! param: any_hit integer 1 shadow rays end at the first sure hit; 0 finds their nearest
//! param: specialise integer 1 leave out what the scene lacks; 0: one shader for all scenes

// A grid tracer that loses nothing and wastes little: the same two levels as the paper's, with
// every place where rounding could lose, invent or swap a hit closed.
//
// 1. All of a grid is stored in the grid's own frame, exactly, and the ray is brought there in
//    doubles (storage/two_level_grid/grid_buffers.glsl).
// 2. The ray's origin is moved to where it enters the grid, so that rounding goes with the grid's
//    size and not with the ray's length. From there on all numbers are floats.
// 3. Cells are whole numbers, their planes are computed, not added up, and empty space is crossed
//    at once (lib/grid/walk.glsl).
// 4. A hit counts wherever it lies; the walk ends when the nearest is not beyond the cell's end.
// 5. The triangle test says by how much rounding can have decided (lib/triangle/rule_out.glsl).
// 6. Where it can have, doubles decide (lib/triangle/decide.glsl).
#pragma once
#include "lib/grid/walk.glsl"
#include "lib/loops.glsl"
#include "lib/triangle/candidates.glsl"
#include "lib/triangle/decide_in_floats.glsl"

// Invocations of a group that casts rays (entry/cast_compute.glsl). The compiler of an H100 (driver
// 580) settles for fewer registers if there are two warps: more of them run, and the longer texts
// spill.
#if NEEDS(has_top_level)
#define GROUP_SIZE 32
#else
#if NEEDS(has_linear_maps)
#define GROUP_SIZE 32
#else
#define GROUP_SIZE 64
#endif
#endif

CONSTANT(bool, has_top_level)  // false: one instance, and no grid over it
CONSTANT(int, decide)
const int kInFloats = 1;  // of decide

// ---- The object level --------------------------------------------------------------------------

// What floats found out about one instance, and where they stopped.
struct Findings {
    Candidates candidates;
    float start;   // t of the ray where its course begins
    bool is_over;  // the walk went to its end
    float t_exit;  // if a third triangle was open: where the course leaves the cell it stopped in, ...
    vec3 left;     // ... for one with so many cells left, biased
};

Findings no_findings() {
    return Findings(candidates_before(0.0, kNoId), 0.0, false, 0.0, vec3(0.0, 0.0, 0.0));
}

// Walks through an instance's grid and tests its triangles, from where an earlier walk stopped, if
// it did. What begins behind t = `t_nearest`, the nearest hit's so far, is not looked at; on this
// instance that is the hit on triangle `found`.
//
// It returns at its end only, and gives every variable a value before any branch: one that a branch
// alone sets is kept, by compilers that cannot tell, in registers all round the loop that calls
// this. Loops ask at their end whether to turn: a software renderer has no other jumps, and goes
// through one that asks at its beginning once more than it turns. (Whether a driver ended one before
// that, no variable here can tell: lib/loops.glsl does.)
Findings walk_in_floats(uint inst_id, Ray ray, float t_first, float t_last, double t_nearest,
                        uint found, Findings earlier) {
    Findings now = no_findings();
    Grid grid = fetch_walked_grid(inst_id);
    // The course is the same from whichever cell of the top level the instance is met, so that a
    // triangle met twice gives the same t twice; the walk covers the part that was asked for.
    Course course = course_in(grid, to_walked_grid(inst_id, ray), ray.tmin, ray.tmax);
    now.start = course.start;
    // From here on t is that of the course.
    float begin = greater(t_along(course, double(t_first)), 0.0);
    float end = lesser(t_along(course, double(t_last)), course.leave);
    now.is_over = course.leave < 0.0 || !(begin <= end);
    Candidates candidates =
        candidates_before(raised(t_along(course, min(t_nearest, double(ray.tmax)))), found);
    Sight sight = sight_from(course.org, course.dir, grid.upper);
    Walk walk = begin_walk(grid, course, begin);
    uint octant = octant_shift(walk);
    end = min(end, smallest(walk.t_leave));

    // The next cell's word is asked for before the triangles of the one at hand are tested.
    bool is_resumed = earlier.candidates.is_full;
    int at = int(earlier.candidates.full_at);
    float t_exit = earlier.t_exit;
    if (is_resumed) walk.left = earlier.left;
    bool goes_on = is_resumed ? t_exit < min(end, candidates.behind) : !now.is_over;
    CELL cell = no_cell();
    if (goes_on) cell = fetch_cell(grid, walk);
    bool is_walking = !now.is_over;
    if (is_walking) {
        do {
            // On to the next full cell.
            if (!is_resumed) {
                if (is_empty_cell(cell)) {
                    do {
                        count_cell();
                        NOTE_CELL(inst_id, cell_of(grid, walk));
                        t_exit = leave_cells(walk, left_behind_empty(cell, walk, octant));
                        now.is_over = !(t_exit < min(end, candidates.behind));
                        if (!now.is_over) cell = fetch_cell(grid, walk);
                    } while (!now.is_over && is_empty_cell(cell));
                }
                if (now.is_over) break;
                count_cell();
                NOTE_CELL(inst_id, cell_of(grid, walk));
                at = first_reference(cell);
                t_exit = leave_cells(walk, left_behind_full(cell, walk));
                if (t_exit < min(end, candidates.behind)) cell = fetch_cell(grid, walk);
            }
            is_resumed = false;

            // Its triangles. A hit that answers the ray does not end this loop, and a third open
            // triangle only a turn later: a CPU, which guesses at the loop's end, then learns early
            // whether it was right. Which one is next is asked for before the one at hand is
            // fetched; behind the last list lies a word for that.
            uint next = fetch_triangle_reference(at);
            for (;;) {
                if (candidates.is_full) break;
                uint reference = next;
                next = reference_word(at + 1);
                uint listed = referenced(reference);
                bool is_in_list = !is_last_reference(reference);
                count_test();
                NOTE_TEST(named(inst_id, listed).inst_id, prim_id_of(named(inst_id, listed)));
                Planes planes = fetch_planes(grid, listed);
                Weights weights = weights_of(planes, sight);
                if (may_cross(weights, sight)) {
                    Crossing crossing = crossing_of(planes, weights, sight);
                    bool is_new = listed != candidates.found && listed != candidates.open &&
                                  listed != candidates.other;
                    take_in(listed, uint(at), is_new, crossing, candidates);
                }
                if (!is_in_list) break;
                count_reference();
                ++at;
            }
            is_walking = !candidates.is_full;
            now.is_over = is_walking && !(t_exit < min(end, candidates.behind));
        } while (is_walking && !now.is_over);
    }
    now.candidates = candidates;
    now.t_exit = t_exit;
    now.left = walk.left;
    return now;
}

// Asks whether a triangle is hit before the nearest so far, and makes it the nearest if so.
// `start`: of the course; `listed`: what the walk's lists call the triangle.
void decide_on(uint inst_id, Ray ray, float start, uint listed, INOUT(Nearest) nearest) {
    Name name = named(inst_id, listed);
    Grid grid = fetch_grid(fetch_grid_of_instance(name.inst_id));
    Corners corners = fetch_corners(grid, name.slot);
    SharpHit sharp;
    double t;
    if (decide == kInFloats) {
        Grid walked = fetch_walked_grid(inst_id);
        Course course = course_in(walked, to_walked_grid(inst_id, ray), ray.tmin, ray.tmax);
        Sight sight = sight_from(course.org, course.dir, walked.upper);
        sharp = blunt_hit(sight, fetch_planes(walked, listed));
        t = double(start) + sharp.t * inverse_of_power(course.length_of_t);
    } else {
        LocalRay local = to_instance(name.inst_id, ray);
        start = start_in_instance(grid, local, ray, start);
        local = moved_from_afar(local, start);
        sharp = sharp_hit(local, fetch_triangle(corners));
        t = double(start) + sharp.t;
    }
    take_nearer(sharp, t, ray, name.inst_id, corners.prim_id, listed, nearest);
}

// The ray once more, from where the entry has it: read again, it needs no registers meanwhile.
DECLARE(Ray ray_again(Ray ray))

// Finds the nearest hit on one instance, where the ray meets it in [t_first, t_last].
//
// Floats walk and test; when the walk is over, or has no room for what it found, doubles decide
// (lib/triangle/candidates.glsl). A walk that decided on its way would pay for it at every test: a
// software renderer goes through both sides of a branch, and a GPU keeps registers for both.
//
// A GPU runs as many rays at once as their registers allow, so that the walk should keep nothing
// for the decision, nor the decision for a walk that seldom goes on. Hence `anew`.
void walk_instance(uint inst_id, Ray ray, float t_first, float t_last, INOUT(Nearest) nearest) {
    // (After each walk the nearest is made anew, so that a walk need not keep it.)
    Nearest before = nearest;
    double t_nearest = before.t;
    uint found = listed_in(before, inst_id);
    Findings findings = no_findings();
    do {
        uint again = anew(inst_id, findings.candidates.full_at);
        findings = walk_in_floats(again, ray, t_first, t_last, t_nearest, found, findings);
        nearest = before;
        Queue queue = queue_of(findings.candidates);
        if (queue.asked != kNoId) {
            do {
                again = anew(inst_id, queue.asked);
                decide_on(again, ray_again(ray), findings.start, queue.asked, nearest);
                queue = without_first(queue);
            } while (queue.asked != kNoId);
        }
        t_nearest = nearest.t;
        found = listed_in(nearest, inst_id);
        ray = ray_again(ray);
        if (!has_top_level) {
            t_first = ray.tmin;
            t_last = ray.tmax;
        }
    } while (findings.candidates.is_full && !is_enough(nearest));
    if (!findings.is_over && !is_enough(nearest)) ray_flags |= kFlagExhausted;
}

#if NEEDS(has_top_level)
// ---- The top level -----------------------------------------------------------------------------

// A cell of the top level that a walk is in.
struct TopCell {
    uint word;
    bool has_more;  // instances in its list, ...
    int at;         // ... from here on
    Span part;      // of the course: what they must be walked through for
};

// The part of the course is that within the cell, widened as the cell's list is.
TopCell top_cell_at(Grid grid, Course course, vec3 inverse, Walk walk) {
    count_cell();
    ivec3 place = cell_of(grid, walk);
    NOTE_CELL(kNoId, place);
    const float kPad = 1.0 / float(kListPadsACell);
    vec3 lower = grid.lower + (vec3(place) - kPad) * grid.cell;
    vec3 upper = grid.lower + (vec3(place) + (1.0 + kPad)) * grid.cell;
    uint word = top_cell_word(cell_index(walk));
    return TopCell(word, !is_empty_cell(word), first_reference(word),
                   span_in_box(course.org, inverse, lower, upper));
}

// Whether the course is in an instance's box anywhere in that part, not before its start and not
// beyond t = `bound`. (Both boxes are wider than what floats lose of the course, so that wherever
// it meets the instance in this cell it is in both.)
bool may_meet(uint inst_id, Course course, vec3 inverse, Span part, float bound) {
    Box box = fetch_instance_box(inst_id);
    Span span = span_in_box(course.org, inverse, box.lower, box.upper);
    float enter = greater(span.enter, greater(part.enter, 0.0));
    return enter <= lesser(span.leave, lesser(part.leave, bound));
}

// What a walk through the top level came to.
struct Visit {
    uint inst_id;
    bool is_met;   // an instance
    bool is_over;  // or its end
};

// On to an instance that the ray may meet. Most are only in the same cell (balls-1: nine in ten).
Visit next_visit(Grid grid, Course course, vec3 inverse, uint octant, float bound, INOUT(Walk) walk,
                 INOUT(TopCell) cell) {
    Visit visit = Visit(kNoId, false, false);
    do {
        if (cell.has_more) {
            do {
                uint reference = fetch_instance_reference(cell.at);
                ++cell.at;
                cell.has_more = !is_last_reference(reference);
                visit.inst_id = referenced(reference);
                visit.is_met = test_boxes == 0 ||
                               may_meet(visit.inst_id, course, inverse, cell.part, bound);
            } while (cell.has_more && !visit.is_met);
        }
        if (!visit.is_met && !cell.has_more) {
            float cube = empty_cube(cell.word, octant);
            float edge = mix(biased(1u), cube, is_empty_cell(cell.word));
            visit.is_over = !(leave_cells(walk, left_behind_cube(walk, edge)) < bound);
            if (!visit.is_over) cell = top_cell_at(grid, course, inverse, walk);
        }
    } while (!visit.is_met && !visit.is_over);
    return visit;
}

// Instances are looked for through all cells before one is walked through, so that rays which run
// together walk together.
void walk_scene(Ray ray, INOUT(Nearest) nearest) {
    Grid grid = fetch_top_grid();
    Course course = course_in(grid, to_top_level(ray), ray.tmin, ray.tmax);
    if (!(course.leave >= 0.0)) return;
    Walk walk = begin_walk(grid, course, 0.0);
    uint octant = octant_shift(walk);
    vec3 inverse = 1.0 / course.dir;
    float end = lesser(course.leave, smallest(walk.t_leave));
    double t_of_length = inverse_of_power(course.length_of_t);

    float bound = lesser(end, raised(t_along(course, nearest.t)));
    TopCell cell = top_cell_at(grid, course, inverse, walk);
    Visit visit = next_visit(grid, course, inverse, octant, bound, walk, cell);
    if (visit.is_met) {
        do {
            float enter = course.start + float(double(cell.part.enter) * t_of_length);
            float leave = course.start + float(double(cell.part.leave) * t_of_length);
            // The two levels start their t at different places: give the difference its rounding.
            const float kRounding = 9.5367431640625e-7;  // 2^-20: eight ulps
            float slack = kRounding * greater(abs(course.start), abs(leave));
            walk_instance(visit.inst_id, ray_again(ray), enter - slack, leave + slack, nearest);
            bound = lesser(end, raised(t_along(course, nearest.t)));
            visit = Visit(visit.inst_id, false, true);
            if (!is_enough(nearest)) {
                visit = next_visit(grid, course, inverse, octant, bound, walk, cell);
            }
        } while (visit.is_met);
    }
    if (!visit.is_over) ray_flags |= kFlagExhausted;  // the driver ended a loop
}
#endif

// ---- The whole ray -----------------------------------------------------------------------------

Hit closest_hit(Ray ray) {
    Nearest nearest = no_nearest();
    if (is_traceable(ray)) {
        if (!has_top_level) walk_instance(kWholeScene, ray, ray.tmin, ray.tmax, nearest);
#if NEEDS(has_top_level)
        if (has_top_level) walk_scene(ray, nearest);
#endif
    }
    if (is_cut(ray)) ray_flags |= kFlagExhausted;
    if (is_hit(nearest.hit)) NOTE_HIT(nearest.hit);
    return nearest.hit;
}
