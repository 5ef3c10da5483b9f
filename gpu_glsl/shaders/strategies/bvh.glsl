//! strategy: bvh
//! summary: a bounding volume hierarchy, to compare grids with: two levels, binned SAH
//! source: Wald 2007; Aila & Laine 2009; Ize 2013; Woop, Benthin & Wald 2013
//! structure: bvh
//! storage: buffer
//! entries: fragment compute
//! gl: 4.0
//! twin: yes
//! default: no
//! param: any_hit integer 1 shadow rays end at the first sure hit; 0 finds their nearest
//! param: specialise integer 1 leave out what the scene lacks; 0: one shader for all scenes

// The other classical structure, in the same single pass and as clean as the grid, so that grid
// against tree is a comparison of structures and of nothing else.
//
// 1. All of an object is stored in its own frame, exactly; the ray is brought there in double
//    precision, and its origin is moved to where it enters the object (storage/bvh/buffer.glsl).
// 2. Floats go down the tree, through boxes that are widened by what rounding may be wrong by
//    (lib/bvh/descent.glsl).
// 3. Floats rule out triangles that are surely missed (lib/triangle/rule_out.glsl); of the rest, on
//    average one or two a ray, double precision decides at once (lib/triangle/decide.glsl).
#pragma once
#include "lib/bvh/descent.glsl"
#include "lib/query.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"

// False: one instance, and no tree over it.
CONSTANT(bool, has_top_level)

// A walk visits each node and each leaf once at most, and there are not so many.
const int kMostSteps = 1 << 28;

// The nearest hit so far. t is compared as it is here; equal ones go to the lower instance, then to
// the lower triangle, so that the order of visits cannot show.
struct Nearest {
    double t;
    Hit hit;
};

// Takes the triangle if it is hit within the ray's interval, before the nearest so far. `local`
// begins at t = start of the ray.
void decide(LocalRay local, float start, Triangle triangle, uint inst_id, uint prim_id, Ray ray,
            INOUT(Nearest) nearest) {
    SharpHit sharp = sharp_hit(local, triangle);
    double t = sharp.t + double(start);
    bool is_lower = inst_id < nearest.hit.inst_id ||
                    (inst_id == nearest.hit.inst_id && prim_id < nearest.hit.prim_id);
    bool is_before = t < nearest.t || (t == nearest.t && is_lower);
    if (!sharp.is_hit || !is_before || !(t >= double(ray.tmin)) || !(t <= double(ray.tmax))) return;
    nearest = Nearest(t, Hit(float(t), sharp.u, sharp.v, prim_id, inst_id));
    NOTE_HIT(nearest.hit);
}

// The nearest hit's t, or the ray's end, counted from `start` and not rounded down. Nothing is
// within it once a hit answers the ray.
float bound_from(double start, Ray ray, Nearest nearest) {
    if (any_hit_suffices && is_hit(nearest.hit)) return -infinity();
    const float kUp = 1.0000002384185791015625;  // 1 + 2^-22
    double end = nearest.t < double(ray.tmax) ? nearest.t : double(ray.tmax);
    return float(end - start) * kUp;
}

// ---- The object level --------------------------------------------------------------------------

// An instance's ray for boxes and triangles: both see it from where it enters the object, so that
// rounding goes with the object's size and not with the ray's length.
struct Course {
    BoxRay boxes;
    Sight sight;
    float start;  // t of the ray at the origin of both; kMissed: it does not enter
    float length_of_t;  // the sight's t that go into one of the ray's
};

Course course_of(uint inst_id, LocalRay local, Ray ray, float t_last) {
    Box box = fetch_object_box(inst_id);
    vec3 dir = vec3(local.dir);
    vec3 org = vec3(local.org);
    float far = largest(abs(org));
    Course course;
    course.boxes = box_ray(org, dir, 4.0 * half_ulp() * far);
    course.start = entry_of(box.lower, box.upper, course.boxes, ray.tmin, t_last);
    if (course.start == kMissed) return course;
    // Before the object surely begins, by what entry_of() may be wrong by.
    const float kRounding = 9.5367431640625e-7;  // 2^-20
    course.start = greater(ray.tmin, course.start - kRounding * course.start);

    LocalRay entering = moved(local, course.start);
    org = vec3(entering.org);
    const float kLostByMoving = 1.7763568394002505e-15;  // 2^-49: 16 half ulps of a double
    course.boxes = box_ray(org, dir, 4.0 * half_ulp() * largest(abs(org)) + kLostByMoving * far);
    double length = length_scale(local);
    course.length_of_t = float(length);
    org = vec3(entering.org - dvec3(box.centre));
    course.sight = sight_from(org, vec3(local.dir * inverse_of_power(length)), box.upper - box.centre);
    return course;
}

// The nearest hit among the triangles of one instance, if it is nearer than what was found before.
void walk_instance(uint inst_id, Ray ray, INOUT(Nearest) nearest) {
    LocalRay local = to_instance(inst_id, ray);
    Course course = course_of(inst_id, local, ray, bound_from(0.0, ray, nearest));
    if (course.start == kMissed) return;
    double start = double(course.start);
    float bound = bound_from(start, ray, nearest);
    float sharp_start = course.start;
    LocalRay sharp = moved_from_afar(local, sharp_start);

    int base = stack_size;
    uint reference = fetch_root(inst_id);
    bool done = false;
    for (int budget = kMostSteps; budget > 0; --budget) {
        // Down to the next leaf.
        for (; budget > 0 && !is_leaf(reference); --budget) {
            count_cell();
            NOTE_CELL(inst_id, ivec3(int(reference), 0, 0));
            reference = step_down(fetch_node(reference), course.boxes, 0.0, bound);
            if (reference == kNoReference) reference = take_up(base, bound);
        }
        if (reference == kNoReference) {
            done = stack_size == base;  // or the driver ended a loop
            break;
        }
        // Its triangles.
        int slot = first_slot(reference);
        int end = slot + slot_count(reference);
        count_cell();
        NOTE_CELL(inst_id, ivec3(slot, 0, 0));
        for (; slot < end; ++slot) {
            NOTE_TEST(inst_id, fetch_primitive(slot));
            count_test();
            Planes planes = fetch_planes(slot);
            Weights weights = weights_of(planes, course.sight);
            if (!may_cross(weights, course.sight)) continue;
            Crossing crossing = crossing_of(planes, weights, course.sight);
            if (may_be_within(crossing, bound * course.length_of_t)) {
                count_reference();
                decide(sharp, sharp_start, fetch_triangle(slot), inst_id, fetch_primitive(slot), ray, nearest);
                bound = bound_from(start, ray, nearest);
            }
        }
        reference = take_up(base, bound);
    }
    if (!done) ray_flags |= kFlagExhausted;
    stack_size = base;
}

#if NEEDS(has_top_level)
// ---- The top level -----------------------------------------------------------------------------

void walk_scene(Ray ray, INOUT(Nearest) nearest) {
    BoxRay boxes = box_ray(ray.org, ray.dir, 0.0);
    uint reference = 0u;
    bool done = false;
    for (int budget = kMostSteps; budget > 0; --budget) {
        float bound = bound_from(0.0, ray, nearest);
        for (; budget > 0 && !is_leaf(reference); --budget) {
            count_cell();
            NOTE_CELL(kNoId, ivec3(int(reference), 0, 0));
            reference = step_down(fetch_top_node(reference), boxes, ray.tmin, bound);
            if (reference == kNoReference) reference = take_up(0, bound);
        }
        if (reference == kNoReference) {
            done = stack_size == 0;  // as above
            break;
        }
        int slot = first_slot(reference);
        int end = slot + slot_count(reference);
        for (; slot < end; ++slot) {
            count_reference();
            walk_instance(fetch_top_instance(slot), ray, nearest);
        }
        reference = take_up(0, bound_from(0.0, ray, nearest));
    }
    if (!done) ray_flags |= kFlagExhausted;
}
#endif

// ---- The whole ray -----------------------------------------------------------------------------

Hit closest_hit(Ray ray) {
    if (!is_traceable(ray)) return no_hit();
    Nearest nearest = Nearest(double(infinity()), no_hit());
    stack_size = 0;
    if (!has_top_level) walk_instance(0u, ray, nearest);
#if NEEDS(has_top_level)
    if (has_top_level) walk_scene(ray, nearest);
#endif
    return nearest.hit;
}
