// One triangle's hit in double precision: what decides once floats have not ruled it out.
//
// The same formulas as in lib/grid/watertight.glsl. What these digits cannot tell from an edge
// counts as on the edge, for both triangles that have it: no ray slips between them, at corners
// neither.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"

// The nearest hit so far. t is compared as it is here; equal ones go to the lower instance, then to
// the lower triangle, so that the order of visits cannot show.
struct Nearest {
    double t;
    float u;
    float v;
    uint prim_id;
    uint inst_id;
};

Hit hit_of(Nearest nearest) {
    return Hit(float(nearest.t), nearest.u, nearest.v, nearest.prim_id, nearest.inst_id);
}

// A corner in the ray's frame, with how large the numbers were that it was made of.
struct DoubleCorner {
    dvec3 at;
    double x_of;
    double y_of;
};

dvec3 double_turned(dvec3 v, int axis) {
    return axis == 0 ? dvec3(v.y, v.z, v.x) : (axis == 1 ? dvec3(v.z, v.x, v.y) : v);
}

DoubleCorner double_corner(dvec3 org, double shear_x, double shear_y, int axis, vec3 corner) {
    PRECISE dvec3 p = dvec3(corner) - org;
    p = double_turned(p, axis);
    PRECISE double x = p.x - shear_x * p.z;
    PRECISE double y = p.y - shear_y * p.z;
    return DoubleCorner(dvec3(x, y, p.z), abs(p.x) + abs(shear_x * p.z),
                        abs(p.y) + abs(shear_y * p.z));
}

// An edge function; 0 where it is no larger than it can be wrong. x and y are wrong by 4 u of what
// they are made of (u = 2^-53; two differences, a quotient, a product), so two products are by that
// of each factor times the other, and by their own roundings: 16 u is twice that.
double double_edge(DoubleCorner from, DoubleCorner to) {
    const double kDoubt = 1.7763568394002505e-15;  // 2^-49: 16 u
    PRECISE double w = to.at.x * from.at.y - to.at.y * from.at.x;
    double made_of = (abs(to.at.x) * from.y_of + to.x_of * abs(from.at.y)) +
                     (abs(to.at.y) * from.x_of + to.y_of * abs(from.at.x));
    return abs(w) <= kDoubt * made_of ? double(0.0) : w;
}

// Takes the triangle if it is hit within the ray's interval, before the nearest so far.
void decide(DoubleRay local, int axis, Triangle triangle, uint inst_id, uint prim_id, Ray ray,
            INOUT(Nearest) nearest) {
    dvec3 dir = double_turned(local.dir, axis);
    double shear_x = dir.x / dir.z;
    double shear_y = dir.y / dir.z;
    DoubleCorner a = double_corner(local.org, shear_x, shear_y, axis, triangle.v0);
    DoubleCorner b = double_corner(local.org, shear_x, shear_y, axis, triangle.v1);
    DoubleCorner c = double_corner(local.org, shear_x, shear_y, axis, triangle.v2);

    double w0 = double_edge(b, c);
    double w1 = double_edge(c, a);
    double w2 = double_edge(a, b);
    bool is_outside = (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0);
    PRECISE double area = w0 + w1 + w2;
    if (is_outside || area == 0.0) return;

    PRECISE double z = w0 * a.at.z + w1 * b.at.z + w2 * c.at.z;
    PRECISE double t = z / (area * dir.z);
    bool is_lower = inst_id < nearest.inst_id ||
                    (inst_id == nearest.inst_id && prim_id < nearest.prim_id);
    bool is_before = t < nearest.t || (t == nearest.t && is_lower);
    if (!is_before || !(t >= double(ray.tmin)) || !(t <= double(ray.tmax))) return;
    nearest = Nearest(t, float(w1 / area), float(w2 / area), prim_id, inst_id);
    NOTE_HIT(hit_of(nearest));
}
