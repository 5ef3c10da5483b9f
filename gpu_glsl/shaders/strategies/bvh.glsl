//! strategy: bvh
//! summary: a bounding volume hierarchy, to compare grids with: two levels, binned SAH
//! source: Wald 2007; Aila & Laine 2009; Ize 2013; Woop, Benthin & Wald 2013
//! structure: bvh
//! storage: buffer ssbo
//! entries: fragment compute
//! gl: 4.3
//! twin: yes
//! default: no
//! param: any_hit integer 1 shadow rays end at the first sure hit, those of an image only on a software renderer; 0 finds their nearest
//! param: records choice(auto,floats,fixed) auto what a triangle test reads: 48 bytes of floats or 32 of fixed-point numbers; auto: fixed on a software renderer
//! param: persistent choice(auto,on,off) auto a compute shader's invocations take ray after ray from a queue; auto: on a GPU that gains by it, for more rays than it casts at once
//! param: specialise integer 1 leave out what the scene lacks; 0: one shader for all scenes

// The other classical structure, in the same single pass and as clean as the grid, so that grid
// against tree is a comparison of structures and of nothing else.
//
// 1. All of an object is stored in its own frame, exactly; the ray is brought there in doubles, and
//    its origin is moved to where it enters the object (storage/instance_rows.glsl,
//    lib/course.glsl).
// 2. Floats go down the tree, through boxes that are widened by what rounding may be wrong by
//    (lib/bvh/descent.glsl).
// 3. The triangle test says by how much rounding can have decided (lib/triangle/rule_out.glsl);
//    what floats leave open waits for the end of the walk (lib/triangle/candidates.glsl).
// 4. There doubles decide (lib/triangle/decide.glsl).
#pragma once
#include "lib/bvh/descent.glsl"
#include "lib/loops.glsl"
#include "lib/triangle/candidates.glsl"

CONSTANT(bool, has_top_level)  // false: one instance, and no tree over it

// ---- The object level --------------------------------------------------------------------------

// What floats found out about one instance, and where they stopped.
struct Findings {
    Candidates candidates;  // by their slots; a leaf, or what is left of it, is a place
    float start;            // t of the ray where its course begins
    bool is_over;           // the walk went to its end
};

// Walks through the tree of an instance's object, from a node or leaf on, to the end of the stack.
// What begins behind t = `t_nearest`, the nearest hit's so far, is not looked at; on this instance
// that is the hit in slot `found`.
//
// It returns at its end only, and gives every variable a value before any branch: one that a branch
// alone sets is kept, by compilers that cannot tell, in registers all round the loop that calls
// this.
Findings walk_in_floats(uint inst_id, Ray ray, double t_nearest, uint found, uint reference) {
    Box box = fetch_object_box(inst_id);
    Course course = course_in(box, to_instance(inst_id, ray), ray.tmin, ray.tmax);
    // From here on t is that of the course.
    Candidates candidates =
        candidates_before(raised(t_along(course, min(t_nearest, double(ray.tmax)))), found);
    Sight sight = sight_from(course.org, course.dir, box.upper);
    BoxRay boxes = box_ray(course, box);
    bool is_over = course.leave < 0.0;
    bool is_walking = !is_over;
    if (is_walking) {
        do {
            // Down to the next leaf.
            if (is_inner(reference)) {
                do {
                    count_cell();
                    NOTE_CELL(inst_id, ivec3(int(node_index(reference)), 0, 0));
                    Node node = fetch_node(node_index(reference));
                    reference = step_down(node, boxes, candidates.behind);
                } while (is_inner(reference));
            }
            is_over = reference == kBvhNothing;
            if (is_over) break;

            // Its triangles. A hit that answers the ray does not end this loop, and a third open
            // triangle only a turn later (strategies/grid.glsl).
            count_cell();
            NOTE_CELL(inst_id, ivec3(first_slot(reference), 0, 0));
            bool is_in_leaf = true;
            for (;;) {
                if (candidates.is_full) break;
                int slot = first_slot(reference);
                is_in_leaf = slot_count(reference) > 1u;
                count_test();
                NOTE_TEST(inst_id, fetch_primitive(slot));
                Planes planes = fetch_planes(slot);
                Weights weights = weights_of(planes, sight);
                if (may_cross(weights, sight)) {
                    // (A triangle is in one leaf alone, and so always new. The only one of an
                    // object is on both sides of the root: doubles are asked twice, and say the
                    // same.)
                    Crossing crossing = crossing_of(planes, weights, sight);
                    take_in(uint(slot), reference, true, crossing, candidates);
                }
                if (!is_in_leaf) break;
                reference = without_first_slot(reference);
            }
            is_walking = !candidates.is_full;
            if (is_walking) reference = take_up(candidates.behind);
            is_over = is_walking && reference == kBvhNothing;
        } while (is_walking && !is_over);
    }
    return Findings(candidates, course.start, is_over);
}

// Asks whether the triangle in a slot is hit before the nearest so far, and so becomes it. `start`:
// of the course.
bool decide_on(uint inst_id, Ray ray, float start, uint slot, INOUT(Nearest) nearest) {
    LocalRay local = moved_from_afar(to_instance(inst_id, ray), start);
    SharpHit sharp = sharp_hit(local, fetch_triangle(int(slot)));
    return take_nearer(sharp, double(start) + sharp.t, ray, inst_id, fetch_primitive(int(slot)),
                       slot, nearest);
}

// The ray once more, from where the entry has it: read again, it needs no registers meanwhile.
DECLARE(Ray ray_again(Ray ray))

// Finds the nearest hit on one instance: floats walk and test, then doubles decide, as in
// strategies/grid.glsl, which says why it is written so.
void walk_instance(uint inst_id, Ray ray, INOUT(Nearest) nearest) {
    int base = stack_size;
    put_end_aside();
    Nearest before = nearest;
    double t_nearest = before.t;
    uint found = kNoId;
    uint reference = fetch_root(inst_id);
    Findings findings;
    do {
        uint again = anew(inst_id, uint(stack_size));
        findings = walk_in_floats(again, ray, t_nearest, found, reference);
        reference = findings.candidates.full_at;
        nearest = before;
        found = kNoId;
        Queue queue = queue_of(findings.candidates);
        if (queue.asked != kNoId) {
            do {
                again = anew(inst_id, queue.asked);
                if (decide_on(again, ray_again(ray), findings.start, queue.asked, nearest)) {
                    found = queue.asked;
                }
                queue = without_first(queue);
            } while (queue.asked != kNoId);
        }
        t_nearest = nearest.t;
        ray = ray_again(ray);
    } while (findings.candidates.is_full && !is_enough(nearest));
    if (!findings.is_over && !is_enough(nearest)) ray_flags |= kFlagExhausted;
    stack_size = base;
}

#if NEEDS(has_top_level)
// ---- The top level -----------------------------------------------------------------------------

void walk_scene(Ray ray, INOUT(Nearest) nearest) {
    Box box = fetch_top_box();
    Course course = course_in(box, to_top_level(ray), ray.tmin, ray.tmax);
    BoxRay boxes = box_ray(course, box);
    float behind = raised(t_along(course, double(ray.tmax)));
    uint reference = kBvhInner;
    put_end_aside();
    bool is_over = course.leave < 0.0;
    if (!is_over) {
        do {
            if (is_inner(reference)) {
                do {
                    count_cell();
                    NOTE_CELL(kNoId, ivec3(int(node_index(reference)), 0, 0));
                    reference = step_down(fetch_top_node(node_index(reference)), boxes, behind);
                } while (is_inner(reference));
            }
            is_over = reference == kBvhNothing;
            if (is_over) break;
            count_reference();
            walk_instance(fetch_top_instance(first_slot(reference)), ray, nearest);
            behind = raised(t_along(course, min(nearest.t, double(ray.tmax))));
            bool is_in_leaf = slot_count(reference) > 1u;
            reference = without_first_slot(reference);
            if (!is_in_leaf) reference = take_up(behind);
            is_over = is_enough(nearest) || reference == kBvhNothing;
        } while (!is_over);
    }
    if (!is_over) ray_flags |= kFlagExhausted;
}
#endif

// ---- The whole ray -----------------------------------------------------------------------------

Hit closest_hit(Ray ray) {
    Nearest nearest = no_nearest();
    stack_size = 0;
    if (is_traceable(ray)) {
        if (!has_top_level) walk_instance(0u, ray, nearest);
#if NEEDS(has_top_level)
        if (has_top_level) walk_scene(ray, nearest);
#endif
    }
    if (is_cut(ray)) ray_flags |= kFlagExhausted;
    if (is_hit(nearest.hit)) NOTE_HIT(nearest.hit);
    return nearest.hit;
}
