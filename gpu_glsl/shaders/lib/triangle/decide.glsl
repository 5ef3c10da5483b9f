// One triangle's hit in doubles: what decides where rounding leaves open whether, or in which
// order, surfaces are hit.
//
// The test of Woop, Benthin & Wald (2013), seen along the ray. A corner's place across the ray
// depends on the ray and the corner alone, so all triangles that share it see it at the same place:
// the mesh is seen moved by some 2^-52, but whole. What these digits cannot tell from an edge
// counts as on the edge, for both triangles that have it: no ray slips between them, at corners
// neither.
#pragma once
#include "lib/local_ray.glsl"

struct Triangle {
    vec3 v0;
    vec3 v1;
    vec3 v2;
};

struct SharpHit {
    bool is_hit;  // false as well for a ray in the triangle's plane
    double t;
    float u;
    float v;
};

// A corner across and along the ray, and how large the numbers were that x and y were made of.
struct SharpCorner {
    dvec3 at;
    double x_of;
    double y_of;
};

int largest_axis(dvec3 v) {
    dvec3 size = abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
}

// v without its axis `axis`, then that axis.
dvec3 turned(dvec3 v, int axis) {
    return axis == 0 ? dvec3(v.y, v.z, v.x) : (axis == 1 ? dvec3(v.z, v.x, v.y) : v);
}

SharpCorner sharp_corner(dvec3 org, double slope_x, double slope_y, int axis, vec3 corner) {
    dvec3 p = dvec3(corner) - org;
    p = turned(p, axis);
    double x = p.x - slope_x * p.z;
    double y = p.y - slope_y * p.z;
    return SharpCorner(dvec3(x, y, p.z), abs(p.x) + abs(slope_x * p.z),
                       abs(p.y) + abs(slope_y * p.z));
}

// Twice the area that the ray's point makes with an edge; 0 where it is no larger than it can be
// wrong. x and y are wrong by 6 u of what they are made of (u = 2^-53; two differences, an inverse
// and a quotient, a product), so two products are by that of each factor times the other, and by
// their own roundings: 14 u, and 16 u covers it.
double sharp_edge(SharpCorner from, SharpCorner to) {
    const double kDoubt = double(1.7763568394002505e-15);  // 2^-49: 16 u
    double w = to.at.x * from.at.y - to.at.y * from.at.x;
    double made_of = (abs(to.at.x) * from.y_of + to.x_of * abs(from.at.y)) +
                     (abs(to.at.y) * from.x_of + to.y_of * abs(from.at.x));
    return abs(w) <= kDoubt * made_of ? double(0.0) : w;
}

// Whether a coordinate of three corners is 0 somewhere between them, within the 8 u that each can
// be wrong. Nearly edge-on, two edges may count as on the ray that only their common corner is
// near: this keeps such a triangle to its own extent.
bool may_span(double a, double a_of, double b, double b_of, double c, double c_of) {
    const double kError = double(8.8817841970012523e-16);  // 2^-50: 8 u
    bool is_below = a <= kError * a_of || b <= kError * b_of || c <= kError * c_of;
    bool is_above = a >= -kError * a_of || b >= -kError * b_of || c >= -kError * c_of;
    return is_below && is_above;
}

SharpHit sharp_hit(LocalRay ray, Triangle triangle) {
    int axis = largest_axis(ray.dir);
    dvec3 dir = turned(ray.dir, axis);
    double inverse_z = inverse_of(dir.z);
    double slope_x = dir.x * inverse_z;
    double slope_y = dir.y * inverse_z;
    SharpCorner a = sharp_corner(ray.org, slope_x, slope_y, axis, triangle.v0);
    SharpCorner b = sharp_corner(ray.org, slope_x, slope_y, axis, triangle.v1);
    SharpCorner c = sharp_corner(ray.org, slope_x, slope_y, axis, triangle.v2);

    double w0 = sharp_edge(b, c);
    double w1 = sharp_edge(c, a);
    double w2 = sharp_edge(a, b);
    bool is_outside = (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0);
    bool is_beside = !may_span(a.at.x, a.x_of, b.at.x, b.x_of, c.at.x, c.x_of) ||
                     !may_span(a.at.y, a.y_of, b.at.y, b.y_of, c.at.y, c.y_of);
    double area = w0 + w1 + w2;
    if (is_outside || is_beside || area == 0.0) {
        return SharpHit(false, double(infinity()), 0.0, 0.0);
    }

    double z = w0 * a.at.z + w1 * b.at.z + w2 * c.at.z;
    // One quotient, so that triangles that share a corner mostly say the same t there.
    double t = z / (area * dir.z);
    double inverse_area = inverse_of(area);
    return SharpHit(true, t, float(w1 * inverse_area), float(w2 * inverse_area));
}
