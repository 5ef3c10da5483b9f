// One triangle's hit with twice the digits: what decides where rounding leaves open whether, or in
// which order, surfaces are hit.
//
// The same formulas as in lib/grid/watertight.glsl. What these digits cannot tell from an edge
// counts as on the edge, for both triangles that have it: no ray slips between them, at corners
// neither.
#pragma once
#include "lib/grid/walk.glsl"
#include "lib/grid/watertight.glsl"

struct SharpHit {
    bool is_hit;  // false as well for a ray in the triangle's plane
    Pair t;       // normalised
    float u;
    float v;
};

// A number and how large those were that it was made of: it is wrong by some of their last places.
struct SharpNumber {
    Pair value;
    float made_of;
};

// A coordinate of a corner as seen from the ray's origin. `lost`: what moving it was made of.
SharpNumber seen_from(float org, float org_rest, float lost, float corner) {
    Pair difference = two_sum(corner, -org);
    PRECISE float lo = difference.lo - org_rest;
    Pair seen = two_sum(difference.hi, lo);
    return SharpNumber(seen, abs(seen.hi) + abs(org_rest) / half_ulp() + lost);
}

struct SharpCorner {
    SharpNumber x;
    SharpNumber y;
    SharpNumber z;
};

SharpNumber sharply_sheared(SharpNumber x, Pair shear, SharpNumber z) {
    // What is far smaller is lost where numbers are denormal.
    const float kLeast = 8.470329472543003e-22;  // 2^-70: 8 u^2 of it is 2^-115
    Pair value = normalised(add_product(x.value, negated(shear), z.value));
    return SharpNumber(value, x.made_of + abs(shear.hi) * z.made_of + kLeast);
}

SharpCorner sharp_corner(vec3 org, vec3 org_rest, float lost, Pair shear_x, Pair shear_y,
                         vec3 corner) {
    SharpNumber x = seen_from(org.x, org_rest.x, lost, corner.x);
    SharpNumber y = seen_from(org.y, org_rest.y, lost, corner.y);
    SharpNumber z = seen_from(org.z, org_rest.z, lost, corner.z);
    return SharpCorner(sharply_sheared(x, shear_x, z), sharply_sheared(y, shear_y, z), z);
}

// An edge function; 0 where it is no larger than it can be wrong. x and y are wrong by 8 u^2 of
// what they are made of (u = half_ulp(); a difference, a quotient, a product, a difference), so two
// products are by that of each factor times the other, and by their own roundings: 32 u^2 is twice
// that.
Pair sharp_edge(SharpCorner from, SharpCorner to) {
    Pair w = pair_product(to.x.value, from.y.value);
    w = normalised(add_product(w, negated(to.y.value), from.x.value));
    float made_of = (abs(to.x.value.hi) * from.y.made_of + to.x.made_of * abs(from.y.value.hi)) +
                    (abs(to.y.value.hi) * from.x.made_of + to.y.made_of * abs(from.x.value.hi));
    if (abs(w.hi) <= 32.0 * half_ulp() * half_ulp() * made_of) return Pair(0.0, 0.0);
    return w;
}

SharpHit sharp_hit(Ray ray, uint inst_id, uint prim_id) {
    LocalRay local = to_instance(inst_id, ray);
    Grid grid = fetch_grid(fetch_grid_of_instance(inst_id));
    Triangle triangle = fetch_triangle(grid, prim_id);

    // A ray from afar is moved to where it enters the grid: pairs hold some 2^-46 of its way, and
    // what moving loses is lost for all triangles alike. One from close by is taken as it is.
    const float kNear = 16.0;  // in sizes of the object
    float far = largest(abs(local.org));
    float lost = 0.0;
    Course course;
    course.org = local.org;
    course.org_rest = local.org_rest;
    course.start = 0.0;
    if (far > kNear) {
        course = course_in(grid, local, ray.tmin, ray.tmax);
        lost = far;
    }

    int axis = largest_axis(local.dir);
    vec3 d = turned(local.dir, axis);
    vec3 d_rest = turned(local.dir_rest, axis);
    Pair along = Pair(d.z, d_rest.z);
    Pair shear_x = pair_quotient(Pair(d.x, d_rest.x), along);
    Pair shear_y = pair_quotient(Pair(d.y, d_rest.y), along);
    vec3 org = turned(course.org, axis);
    vec3 org_rest = turned(course.org_rest, axis);
    vec3 v0 = turned(triangle.v0, axis);
    vec3 v1 = turned(triangle.v1, axis);
    vec3 v2 = turned(triangle.v2, axis);
    SharpCorner a = sharp_corner(org, org_rest, lost, shear_x, shear_y, v0);
    SharpCorner b = sharp_corner(org, org_rest, lost, shear_x, shear_y, v1);
    SharpCorner c = sharp_corner(org, org_rest, lost, shear_x, shear_y, v2);

    Pair w0 = sharp_edge(b, c);
    Pair w1 = sharp_edge(c, a);
    Pair w2 = sharp_edge(a, b);
    bool is_outside = (w0.hi < 0.0 || w1.hi < 0.0 || w2.hi < 0.0) &&
                      (w0.hi > 0.0 || w1.hi > 0.0 || w2.hi > 0.0);
    Pair area = pair_sum(pair_sum(w0, w1), w2);
    if (is_outside || area.hi == 0.0) return SharpHit(false, Pair(infinity(), 0.0), 0.0, 0.0);

    Pair z = pair_product(w0, a.z.value);
    z = add_product(add_product(z, w1, b.z.value), w2, c.z.value);
    Pair t = pair_quotient(pair_quotient(normalised(z), area), along);
    t = pair_sum(Pair(course.start, 0.0), t);
    return SharpHit(true, t, w1.hi / area.hi, w2.hi / area.hi);
}
