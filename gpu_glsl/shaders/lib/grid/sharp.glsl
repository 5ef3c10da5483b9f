// One triangle's hit with twice the digits: what decides where rounding leaves open whether, or in
// which order, surfaces are hit.
//
// The same formulas as in lib/grid/watertight.glsl, on the same course: from where the ray enters the
// grid, so that what moving it there lost is lost for all triangles alike. What these digits cannot
// tell from an edge counts as on the edge, for both triangles that have it: no ray slips between
// them, at corners neither.
#pragma once
#include "lib/grid/walk.glsl"
#include "lib/grid/watertight.glsl"

struct SharpHit {
    bool is_hit;  // false as well for a ray in the triangle's plane
    Pair t;       // normalised
    float error;  // of t, at most
    float u;
    float v;
};

// A coordinate of a corner as seen from the ray's origin.
Pair seen_from(float org, float org_rest, float corner) {
    Pair difference = two_sum(corner, -org);
    PRECISE float lo = difference.lo - org_rest;
    return two_sum(difference.hi, lo);
}

struct SharpCorner {
    Pair x;
    Pair y;
    Pair z;
};

SharpCorner sharply_sheared(vec3 org, vec3 org_rest, Pair shear_x, Pair shear_y, vec3 corner) {
    Pair x = seen_from(org.x, org_rest.x, corner.x);
    Pair y = seen_from(org.y, org_rest.y, corner.y);
    Pair z = seen_from(org.z, org_rest.z, corner.z);
    return SharpCorner(normalised(add_product(x, negated(shear_x), z)),
                       normalised(add_product(y, negated(shear_y), z)), z);
}

// An edge function, and 0 where it is no larger than it can be wrong: pairs keep 2^-48, x and y
// lose eight times that of `reach` at most, in two products of two.
Pair sharp_edge(SharpCorner from, SharpCorner to, float reach) {
    Pair w = normalised(add_product(pair_product(to.x, from.y), negated(to.y), from.x));
    float width = abs(from.x.hi) + abs(from.y.hi) + abs(to.x.hi) + abs(to.y.hi);
    float doubt = 64.0 * half_ulp() * half_ulp() * reach * width;
    if (abs(w.hi) <= doubt) return Pair(0.0, 0.0);
    return w;
}

SharpHit sharp_hit(Ray ray, uint inst_id, uint prim_id) {
    LocalRay local = to_instance(inst_id, ray);
    Grid grid = fetch_grid(fetch_grid_of_instance(inst_id));
    Triangle triangle = fetch_triangle(grid, prim_id);
    Course course = course_in(grid, local, ray.tmin, ray.tmax);

    int axis = largest_axis(local.dir);
    vec3 d = turned(local.dir, axis);
    vec3 d_rest = turned(local.dir_rest, axis);
    Pair along = Pair(d.z, d_rest.z);
    Pair shear_x = pair_quotient(Pair(d.x, d_rest.x), along);
    Pair shear_y = pair_quotient(Pair(d.y, d_rest.y), along);
    vec3 org = turned(course.org, axis);
    vec3 org_rest = turned(course.org_rest, axis);
    SharpCorner a = sharply_sheared(org, org_rest, shear_x, shear_y, turned(triangle.v0, axis));
    SharpCorner b = sharply_sheared(org, org_rest, shear_x, shear_y, turned(triangle.v1, axis));
    SharpCorner c = sharply_sheared(org, org_rest, shear_x, shear_y, turned(triangle.v2, axis));

    float reach = 1.0 + largest(abs(course.org));
    Pair w0 = sharp_edge(b, c, reach);
    Pair w1 = sharp_edge(c, a, reach);
    Pair w2 = sharp_edge(a, b, reach);
    bool is_outside = (w0.hi < 0.0 || w1.hi < 0.0 || w2.hi < 0.0) &&
                      (w0.hi > 0.0 || w1.hi > 0.0 || w2.hi > 0.0);
    Pair area = pair_sum(pair_sum(w0, w1), w2);
    if (is_outside || area.hi == 0.0) return SharpHit(false, Pair(infinity(), 0.0), 0.0, 0.0, 0.0);

    Pair z = add_product(add_product(pair_product(w0, a.z), w1, b.z), w2, c.z);
    Pair t = pair_quotient(pair_quotient(normalised(z), area), along);
    t = pair_sum(Pair(course.start, 0.0), t);

    // As in lib/grid/watertight.glsl: the weights' error times the depth, and what is done with z.
    vec3 x = vec3(abs(a.x.hi), abs(b.x.hi), abs(c.x.hi));
    vec3 y = vec3(abs(a.y.hi), abs(b.y.hi), abs(c.y.hi));
    float width = greater(largest(x), largest(y));
    float depth = greater(a.z.hi, greater(b.z.hi, c.z.hi)) - lesser(a.z.hi, lesser(b.z.hi, c.z.hi));
    float share = lesser(12.0 * width / abs(area.hi) * depth, 1.0 / half_ulp());
    float error = 64.0 * half_ulp() * half_ulp() * reach * (1.0 + share) / abs(along.hi);
    return SharpHit(true, t, error, w1.hi / area.hi, w2.hi / area.hi);
}
