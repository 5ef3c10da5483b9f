// The watertight ray-triangle test (Woop, Benthin, Wald 2013).
//
// The triangle is moved into a frame where the ray is the z axis. A corner comes out the same
// whichever triangle it is a corner of, and the sign of an edge function is exact for the corners
// that came out; so two triangles that share an edge agree on which side of it the ray passes, and
// no ray slips between them, at corners neither.
#pragma once
#include "lib/exact.glsl"
#include "lib/math.glsl"
#include "lib/ray.glsl"

// A ray made ready for testing triangles.
struct Shear {
    vec3 org;
    vec3 org_rest;
    int axis;      // of the largest component of the direction: it becomes z
    float x;       // how much of z to take from x ...
    float y;       // ... and from y
    float z;       // 1 / the largest component
};

vec3 turned(vec3 v, int axis) {
    return axis == 0 ? vec3(v.y, v.z, v.x) : (axis == 1 ? vec3(v.z, v.x, v.y) : v);
}

Shear shear_of(vec3 org, vec3 org_rest, vec3 dir) {
    vec3 size = abs(dir);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    vec3 d = turned(dir, axis);
    return Shear(org, org_rest, axis, d.x / d.z, d.y / d.z, 1.0 / d.z);
}

// A corner in the ray's frame; z in units of the direction's largest component.
vec3 sheared(Shear shear, vec3 corner) {
    PRECISE vec3 p = (corner - shear.org) - shear.org_rest;
    p = turned(p, shear.axis);
    PRECISE float x = p.x - shear.x * p.z;
    PRECISE float y = p.y - shear.y * p.z;
    return vec3(x, y, p.z);
}

// Ties at an equal t go to the lower instance, then to the lower triangle, so that no order of
// visits can show in a hit.
bool is_nearer(float t, uint prim_id, uint inst_id, Hit hit) {
    return t < hit.t || (t == hit.t && (inst_id < hit.inst_id ||
                                        (inst_id == hit.inst_id && prim_id < hit.prim_id)));
}

// `start`: t of the ray at shear.org.
void intersect_triangle(Triangle triangle, uint prim_id, uint inst_id, Shear shear, float start,
                        Ray ray, INOUT(Hit) hit) {
    count_test();
    NOTE_TEST(inst_id, prim_id);
    vec3 a = sheared(shear, triangle.v0);
    vec3 b = sheared(shear, triangle.v1);
    vec3 c = sheared(shear, triangle.v2);

    // Edge functions, twice the areas that the ray's point makes with each edge.
    float w0 = difference_of_products(c.x, b.y, c.y, b.x);
    float w1 = difference_of_products(a.x, c.y, a.y, c.x);
    float w2 = difference_of_products(b.x, a.y, b.y, a.x);
    if ((w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0)) return;
    float area = w0 + w1 + w2;
    if (area == 0.0) return;

    float t = start + (w0 * a.z + w1 * b.z + w2 * c.z) / area * shear.z;
    if (t >= ray.tmin && t <= ray.tmax && is_nearer(t, prim_id, inst_id, hit)) {
        NOTE_HIT(t);
        hit = Hit(t, w1 / area, w2 / area, prim_id, inst_id);
    }
}
