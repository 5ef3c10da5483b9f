// One triangle's hit in doubles: what decides where rounding leaves open whether, or in which
// order, surfaces are hit.
//
// The same plane as in lib/triangle/rule_out.glsl. A corner's place there depends on the ray and
// the corner alone, so all triangles that share it see it at the same place: seen along the ray
// the mesh is moved by some 2^-52, but stays whole. An edge function is the same for both its
// triangles, and one that is no larger than its rounding counts as on the edge, for both: no ray
// slips between them, at corners neither.
#pragma once
#include "lib/triangle/rule_out.glsl"

struct SharpHit {
    bool is_hit;  // false as well for a ray in the triangle's plane
    double t;
    float u;
    float v;
};

// Twice the area that the origin makes with the edge from a to b; 0 where it is no larger than the
// rounding of its products, 2 half ulps of each.
double sharp_edge(double ax, double ay, double bx, double by) {
    const double kHalfUlp = double(1.1102230246251565e-16);  // 2^-53
    PRECISE double there = bx * ay;
    PRECISE double back = by * ax;
    PRECISE double w = there - back;
    return abs(w) <= (4.0 * kHalfUlp) * (abs(there) + abs(back)) ? double(0.0) : w;
}

// v without its axis `axis`, then that axis.
dvec3 turned(dvec3 v, int axis) {
    return axis == 0 ? dvec3(v.y, v.z, v.x) : (axis == 1 ? dvec3(v.z, v.x, v.y) : v);
}

SharpHit sharp_hit(LocalRay ray, Triangle triangle) {
    // The corners as seen from the ray's origin, the direction's largest component ahead.
    int axis = largest_axis(vec3(ray.dir));
    dvec3 dir = turned(ray.dir, axis);
    dvec3 a = turned(dvec3(triangle.v0) - ray.org, axis);
    dvec3 b = turned(dvec3(triangle.v1) - ray.org, axis);
    dvec3 c = turned(dvec3(triangle.v2) - ray.org, axis);
    double per_length = double(1.0) / dir.z;
    double slope_x = dir.x * per_length;
    double slope_y = dir.y * per_length;
    PRECISE double ax = a.x - slope_x * a.z;
    PRECISE double ay = a.y - slope_y * a.z;
    PRECISE double bx = b.x - slope_x * b.z;
    PRECISE double by = b.y - slope_y * b.z;
    PRECISE double cx = c.x - slope_x * c.z;
    PRECISE double cy = c.y - slope_y * c.z;

    double w0 = sharp_edge(bx, by, cx, cy);
    double w1 = sharp_edge(cx, cy, ax, ay);
    double w2 = sharp_edge(ax, ay, bx, by);
    bool is_outside = (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0);
    double area = w0 + w1 + w2;
    if (is_outside || area == 0.0) return SharpHit(false, double(infinity()), 0.0, 0.0);

    double share = double(1.0) / area;
    PRECISE double t = ((w0 * a.z + w1 * b.z + w2 * c.z) * share) * per_length;
    return SharpHit(true, t, float(w1 * share), float(w2 * share));
}
