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
//! param: any_hit integer 1 shadow rays end at the first sure hit, those of an image only on a software renderer; 0 finds their nearest
//! param: records choice(auto,floats,fixed) auto what a triangle test reads: 48 bytes of floats or 32 of fixed-point numbers; auto: fixed on a software renderer
//! param: pairs choice(auto,on,off) auto a fragment casts two given rays; auto: if a software renderer gains by it
//! param: persistent choice(auto,on,off) auto a compute shader's invocations take ray after ray from a queue; auto: on a GPU that gains by it, for more rays than it casts at once
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
    float t_exit;  // if a third triangle was open: where the course leaves the cell it stopped in
    vec3 left;     // and, biased, how many cells are left from there on
};

Findings no_findings() {
    return Findings(candidates_before(0.0, kNoId), 0.0, false, 0.0, vec3(0.0, 0.0, 0.0));
}

// A ray on its way through an instance's grid, and the triangles that it tests. t: of the course.
struct Walker {
    uint inst_id;
    Grid grid;
    Sight sight;
    uint octant;
    float start;    // t of the ray where the course begins
    float end;      // where the walk ends at the latest
    Walk walk;      // at the cell that comes next
    CELL cell;      // what is stored of it
    float t_exit;   // where the course leaves the cell at hand
    int at;         // in that cell's list: the triangle to be tested ...
    uint next;      // ... and its reference
    bool in_list;
    bool is_over;   // the walk went to its end
    Candidates candidates;
};

bool is_before_end(Walker walker) {
    return walker.t_exit < min(walker.end, walker.candidates.behind);
}

bool is_in_empty_cell(Walker walker) { return is_empty_cell(walker.cell); }

// A ray made ready for a walk through an instance's grid, over its part [t_first, t_last], from
// where an earlier walk stopped, if it did. What begins behind t = `t_nearest` of the ray, the
// nearest hit's so far, is not looked at; on this instance that is the hit on triangle `found`.
Walker begin_walker(uint inst_id, Ray ray, float t_first, float t_last, double t_nearest,
                    uint found, Findings earlier) {
    Walker walker;
    walker.inst_id = inst_id;
    walker.grid = fetch_walked_grid(inst_id);
    // The course is the same from whichever cell of the top level the instance is met, so that a
    // triangle met twice gives the same t twice; the walk covers the part that was asked for.
    Course course = course_in(walker.grid, to_walked_grid(inst_id, ray), ray.tmin, ray.tmax);
    walker.start = course.start;
    float begin = greater(t_along(course, double(t_first)), 0.0);
    walker.end = lesser(t_along(course, double(t_last)), course.leave);
    walker.is_over = course.leave < 0.0 || !(begin <= walker.end);
    walker.candidates =
        candidates_before(raised(t_along(course, min(t_nearest, double(ray.tmax)))), found);
    walker.sight = sight_from(course.org, course.dir, walker.grid.upper);
    walker.walk = begin_walk(walker.grid, course, begin);
    walker.octant = octant_shift(walker.walk);
    walker.end = min(walker.end, smallest(walker.walk.t_leave));

    walker.in_list = earlier.candidates.is_full;
    walker.at = int(earlier.candidates.full_at);
    walker.next = 0u;
    walker.t_exit = earlier.t_exit;
    if (walker.in_list) walker.walk.left = earlier.left;
    bool goes_on = walker.in_list ? is_before_end(walker) : !walker.is_over;
    walker.cell = no_cell();
    if (goes_on) walker.cell = fetch_cell(walker.grid, walker.walk);
    return walker;
}

// Behind the empty cells ahead.
void cross_empty_cells(INOUT(Walker) walker) {
    count_cell();
    NOTE_CELL(walker.inst_id, cell_of(walker.grid, walker.walk));
    walker.t_exit =
        leave_cells(walker.walk, left_behind_empty(walker.cell, walker.walk, walker.octant));
    walker.is_over = !is_before_end(walker);
    if (!walker.is_over) walker.cell = fetch_cell(walker.grid, walker.walk);
}

// Into a full cell, whose list comes next; the walk goes on behind it.
void enter_full_cell(INOUT(Walker) walker) {
    count_cell();
    NOTE_CELL(walker.inst_id, cell_of(walker.grid, walker.walk));
    walker.at = first_reference(walker.cell);
    walker.t_exit = leave_cells(walker.walk, left_behind_full(walker.cell, walker.walk));
    walker.in_list = true;
}

void fetch_next_cell(INOUT(Walker) walker) {
    if (is_before_end(walker)) walker.cell = fetch_cell(walker.grid, walker.walk);
}

// Tests a triangle of the list. Which one is next is asked for before the one at hand is fetched;
// behind the last list lies a word for that.
void test_next_triangle(INOUT(Walker) walker) {
    uint listed = referenced(walker.next);
    walker.in_list = !is_last_reference(walker.next);
    walker.next = reference_word(walker.at + 1);
    count_test();
    NOTE_TEST(named(walker.inst_id, listed).inst_id, prim_id_of(named(walker.inst_id, listed)));
    Planes planes = fetch_planes(walker.grid, listed);
    Weights weights = weights_of(planes, walker.sight);
    if (may_cross(weights, walker.sight)) {
        Crossing crossing = crossing_of(planes, weights, walker.sight);
        bool is_new = listed != walker.candidates.found && listed != walker.candidates.open &&
                      listed != walker.candidates.other;
        take_in(listed, uint(walker.at), is_new, crossing, walker.candidates);
    }
}

Findings findings_of(Walker walker) {
    return Findings(walker.candidates, walker.start, walker.is_over, walker.t_exit,
                    walker.walk.left);
}

// Walks through an instance's grid and tests its triangles.
//
// It returns at its end only, and gives every variable a value before any branch: one that a branch
// alone sets is kept, by compilers that cannot tell, in registers all round the loop that calls
// this. Loops ask at their end whether to turn: a software renderer may have no other jumps, and
// goes through one that asks at its beginning once more than it turns. (Whether a driver ended one
// before that, no variable here can tell: lib/loops.glsl does.)
Findings walk_in_floats(uint inst_id, Ray ray, float t_first, float t_last, double t_nearest,
                        uint found, Findings earlier) {
    Walker walker = begin_walker(inst_id, ray, t_first, t_last, t_nearest, found, earlier);
    bool is_walking = !walker.is_over;
    if (is_walking) {
        do {
            if (!walker.in_list) {
                if (is_in_empty_cell(walker)) {
                    do {
                        cross_empty_cells(walker);
                    } while (!walker.is_over && is_in_empty_cell(walker));
                }
                if (walker.is_over) break;
                enter_full_cell(walker);
                // The next cell's word is asked for before the triangles of the one at hand are
                // tested.
                fetch_next_cell(walker);
            }
            // A hit that answers the ray does not end this loop, and a third open triangle only a
            // turn later: a CPU, which guesses at the loop's end, then learns early whether it was
            // right.
            walker.next = fetch_triangle_reference(walker.at);
            for (;;) {
                if (walker.candidates.is_full) break;
                test_next_triangle(walker);
                if (!walker.in_list) break;
                count_reference();
                ++walker.at;
            }
            walker.in_list = false;
            is_walking = !walker.candidates.is_full;
            walker.is_over = is_walking && !is_before_end(walker);
        } while (is_walking && !walker.is_over);
    }
    return findings_of(walker);
}

// A triangle that doubles are asked about. `listed`: what the walk's lists call it.
struct Asked {
    uint listed;
    Name name;
    Grid grid;  // of its object
    Corners corners;
    Triangle triangle;
};

Asked fetch_asked(uint inst_id, uint listed) {
    Asked asked;
    asked.listed = listed;
    asked.name = named(inst_id, listed);
    asked.grid = fetch_grid(fetch_grid_of_instance(asked.name.inst_id));
    asked.corners = fetch_corners(asked.grid, asked.name.slot);
    asked.triangle = fetch_triangle(asked.corners);
    return asked;
}

// Asks whether it is hit before the nearest so far, and makes it the nearest if so. `start`: of the
// course.
void decide_on(uint inst_id, Ray ray, float start, Asked asked, INOUT(Nearest) nearest) {
    SharpHit sharp;
    double t;
    if (decide == kInFloats) {
        Grid walked = fetch_walked_grid(inst_id);
        Course course = course_in(walked, to_walked_grid(inst_id, ray), ray.tmin, ray.tmax);
        Sight sight = sight_from(course.org, course.dir, walked.upper);
        sharp = blunt_hit(sight, fetch_planes(walked, asked.listed));
        t = double(start) + sharp.t * inverse_of_power(course.length_of_t);
    } else {
        LocalRay local = to_instance(asked.name.inst_id, ray);
        start = start_in_instance(asked.grid, local, ray, start);
        local = moved_from_afar(local, start);
        sharp = sharp_hit(local, asked.triangle);
        t = double(start) + sharp.t;
    }
    take_nearer(sharp, t, ray, asked.name.inst_id, asked.corners.prim_id, asked.listed, nearest);
}

// The ray once more, from where the entry has it: read again, it needs no registers meanwhile.
DECLARE(Ray ray_again(Ray ray))

// Finds the nearest hit on one instance, where the ray meets it in [t_first, t_last].
//
// Floats walk and test; when the walk is over, or has no room for what it found, doubles decide
// (lib/triangle/candidates.glsl). A walk that decided on its way would pay for it at every test: a
// software renderer may go through both sides of a branch, and a GPU keeps registers for both.
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
                decide_on(again, ray_again(ray), findings.start, fetch_asked(again, queue.asked),
                          nearest);
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

// A ray on its way through the top level, from instance to instance. t: of the course.
struct Descent {
    Grid grid;
    Course course;
    vec3 inverse;  // 1 / course.dir
    uint octant;
    float end;     // where the course ends
    float bound;   // where it ends for what is known of the ray's nearest hit
    Walk walk;
    TopCell cell;
    uint inst_id;  // an instance that the ray may meet ...
    bool is_met;
    bool is_over;  // ... or the end
};

// On to an instance that the ray may meet. Most are only in the same cell (balls-1: nine in ten).
void go_to_next_instance(double t_nearest, INOUT(Descent) descent) {
    descent.bound = lesser(descent.end, raised(t_along(descent.course, t_nearest)));
    descent.is_met = false;
    do {
        if (descent.cell.has_more) {
            do {
                uint reference = fetch_instance_reference(descent.cell.at);
                ++descent.cell.at;
                descent.cell.has_more = !is_last_reference(reference);
                descent.inst_id = referenced(reference);
                descent.is_met = test_boxes == 0 ||
                                 may_meet(descent.inst_id, descent.course, descent.inverse,
                                          descent.cell.part, descent.bound);
            } while (descent.cell.has_more && !descent.is_met);
        }
        if (!descent.is_met && !descent.cell.has_more) {
            float cube = empty_cube(descent.cell.word, descent.octant);
            float edge = mix(biased(1u), cube, is_empty_cell(descent.cell.word));
            float t = leave_cells(descent.walk, left_behind_cube(descent.walk, edge));
            descent.is_over = !(t < descent.bound);
            if (!descent.is_over) {
                descent.cell = top_cell_at(descent.grid, descent.course, descent.inverse,
                                           descent.walk);
            }
        }
    } while (!descent.is_met && !descent.is_over);
}

// Down to the first instance.
Descent begin_descent(Ray ray, double t_nearest) {
    Descent descent;
    descent.grid = fetch_top_grid();
    descent.course = course_in(descent.grid, to_top_level(ray), ray.tmin, ray.tmax);
    descent.walk = begin_walk(descent.grid, descent.course, 0.0);
    descent.octant = octant_shift(descent.walk);
    descent.inverse = 1.0 / descent.course.dir;
    descent.end = lesser(descent.course.leave, smallest(descent.walk.t_leave));
    descent.bound = 0.0;
    descent.cell = TopCell(0u, false, 0, Span(0.0, 0.0));
    descent.inst_id = kNoId;
    descent.is_met = false;
    descent.is_over = !(descent.course.leave >= 0.0);
    if (!descent.is_over) {
        descent.cell = top_cell_at(descent.grid, descent.course, descent.inverse, descent.walk);
        go_to_next_instance(t_nearest, descent);
    }
    return descent;
}

// The part of the ray for which an instance is walked through: that in the cell, in the ray's t.
Span part_in_cell(Descent descent) {
    Course course = descent.course;
    double t_of_length = inverse_of_power(course.length_of_t);
    float enter = course.start + float(double(descent.cell.part.enter) * t_of_length);
    float leave = course.start + float(double(descent.cell.part.leave) * t_of_length);
    // The two levels start their t at different places: give the difference its rounding.
    const float kRounding = 9.5367431640625e-7;  // 2^-20: eight ulps
    float slack = kRounding * greater(abs(course.start), abs(leave));
    return Span(enter - slack, leave + slack);
}

// Instances are looked for through all cells before one is walked through, so that rays which run
// together walk together.
void walk_scene(Ray ray, INOUT(Nearest) nearest) {
    Descent descent = begin_descent(ray, nearest.t);
    if (descent.is_met) {
        do {
            Span part = part_in_cell(descent);
            walk_instance(descent.inst_id, ray_again(ray), part.enter, part.leave, nearest);
            descent.is_met = false;
            if (is_enough(nearest)) {
                descent.is_over = true;
            } else {
                go_to_next_instance(nearest.t, descent);
            }
        } while (descent.is_met);
    }
    if (!descent.is_over) ray_flags |= kFlagExhausted;  // the driver ended a loop
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
