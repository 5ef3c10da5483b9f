// The part of a ray that a walk through an object may see, made ready for floats: it begins where
// the ray enters the object's box, so that rounding goes with the object's size and not with the
// ray's length.
#pragma once
#include "lib/local_ray.glsl"

// A part of the ray, in t.
struct Span {
    float enter;
    float leave;
};

// What the object lies in: the centre of a box, in the object's frame, and from there two corners.
struct Box {
    vec3 centre;
    vec3 lower;
    vec3 upper;
};

// Its t is a length in the object's frame, counted from where the ray enters the box.
struct Course {
    vec3 org;            // from the box's centre
    vec3 dir;            // its largest component 1/2 to 1, none 0
    float start;         // t of the whole ray at the origin
    double length_of_t;  // the course's t that go into one of the ray's
    float leave;         // where it ends, or a little behind the box; negative: it misses the box
};

// The ray's t as one of the course.
float t_along(Course course, double t) {
    return float((t - double(course.start)) * course.length_of_t);
}

// A number raised by two ulps, to be on the safe side of its rounding.
float raised(float t) { return t < infinity() ? t + (4.0 * half_ulp()) * abs(t) : t; }

// A component of 0 would divide to infinity, and 0 * infinity is no number. One of 2^-66 moves the
// ray by nothing within the box.
float guarded(float d) {
    const float kLeast = 1.3552527156068805e-20;
    return mix(d, mix(kLeast, -kLeast, d < 0.0), abs(d) < kLeast);
}

// Where the ray is in the box; enter > leave where it misses. The rounding of t is given to both
// ends: a box wrongly entered costs a few steps, one wrongly missed costs hits.
Span span_in_box(vec3 org, vec3 inverse, vec3 lower, vec3 upper) {
    const float kRounding = 4.76837158203125e-7;  // 2^-21: four ulps
    vec3 t_lower = (lower - org) * inverse;
    vec3 t_upper = (upper - org) * inverse;
    float enter = largest(lesser(t_lower, t_upper));
    float leave = smallest(greater(t_lower, t_upper));
    return Span(enter - kRounding * abs(enter), leave + kRounding * abs(leave));
}

// Moves the ray's origin to where the part [t_first, t_last] enters the box.
Course course_in(Box box, LocalRay ray, float t_first, float t_last) {
    Course course;
    course.length_of_t = length_scale(ray);
    double t_of_length = inverse_of_power(course.length_of_t);
    vec3 dir = vec3(ray.dir * t_of_length);
    course.dir = vec3(guarded(dir.x), guarded(dir.y), guarded(dir.z));
    LocalRay centred = LocalRay(ray.org - dvec3(box.centre), ray.dir);
    Span span = span_in_box(vec3(centred.org), 1.0 / course.dir, box.lower, box.upper);
    course.start = greater(t_first, float(double(span.enter) * t_of_length));
    course.org = vec3(moved(centred, course.start).org);
    course.leave = lesser(t_along(course, double(t_last)),
                          span.leave - float(double(course.start) * course.length_of_t));
    // A ray from so far away that floats do not hold it misses. (Nor would a walk along numbers
    // that are none be sure to end.)
    course.leave = mix(course.leave, -1.0, !is_finite(course.org));
    return course;
}
