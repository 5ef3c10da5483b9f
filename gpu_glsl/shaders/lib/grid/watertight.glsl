// Which triangles a ray may hit: the test of Woop, Benthin & Wald (2013), made one that never says
// no where rounding leaves it open.
//
// The triangle is moved into a frame where the ray is the z axis, so that three edge functions of x
// and y say whether the ray passes inside. A triangle is ruled out only if they differ in sign by
// more than they can be wrong; one is surely hit only if they agree by more than that. Between the
// two, lib/grid/sharp.glsl decides with twice the digits.
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
    float blur;    // how far `org` may be from the ray, in units of half_ulp()
};

vec3 turned(vec3 v, int axis) {
    return axis == 0 ? vec3(v.y, v.z, v.x) : (axis == 1 ? vec3(v.z, v.x, v.y) : v);
}

int largest_axis(vec3 v) {
    vec3 size = abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
}

// `far`: the largest coordinate that the ray's origin had before it was moved to `org`; of it pairs
// keep all but some 2^-44, which is 2^-20 in units of half_ulp().
Shear shear_of(vec3 org, vec3 org_rest, vec3 dir, float far) {
    const float kLostByMoving = 9.5367431640625e-7;  // 2^-20
    int axis = largest_axis(dir);
    vec3 d = turned(dir, axis);
    return Shear(org, org_rest, axis, d.x / d.z, d.y / d.z, 1.0 / d.z, kLostByMoving * far);
}

// A corner in the ray's frame; z in units of the direction's largest component.
vec3 sheared(Shear shear, vec3 corner) {
    PRECISE vec3 p = (corner - shear.org) - shear.org_rest;
    p = turned(p, shear.axis);
    PRECISE float x = p.x - shear.x * p.z;
    PRECISE float y = p.y - shear.y * p.z;
    return vec3(x, y, p.z);
}

// Where a ray crosses a triangle: t, from shear.org on.
struct Crossing {
    float from;    // it is at least this ...
    float to;      // ... and at most this
    bool is_sure;  // false if it may be nowhere
};

// False if the ray misses the triangle.
//
// The bounds. With u = half_ulp(), `width` the largest |x| or |y| of the three corners and `reach`
// the largest coordinate that they were made of: x and y are wrong by at most 8 u reach (a
// difference, a rounded direction, a quotient, a product, a difference), so an edge function is by
// at most 35 u width reach; `doubt` is twice that. If all three
// are larger, their sum, the area, is wrong by less than half of itself. t is the mean of the
// corners' z weighted by them, so it is wrong by their error's share of the area times the depth of
// the triangle; and by 16 u reach for z and what is done with it. If in doubt, t is within the
// triangle.
bool may_cross(Triangle triangle, Shear shear, OUT(Crossing) crossing) {
    count_test();
    vec3 a = sheared(shear, triangle.v0);
    vec3 b = sheared(shear, triangle.v1);
    vec3 c = sheared(shear, triangle.v2);

    // Edge functions, twice the areas that the ray's point makes with each edge.
    PRECISE float w0 = c.x * b.y - c.y * b.x;
    PRECISE float w1 = a.x * c.y - a.y * c.x;
    PRECISE float w2 = b.x * a.y - b.y * a.x;
    vec3 size = greater(abs(a), greater(abs(b), abs(c)));
    // Along an axis and in the triangle's plane: nothing was rounded, and nothing crosses. Rays in
    // the planes of a lattice would have a doubt about every triangle there.
    if ((size.x == 0.0 && shear.x == 0.0) || (size.y == 0.0 && shear.y == 0.0)) return false;

    float width = greater(size.x, size.y);
    float z_near = lesser(a.z, lesser(b.z, c.z));
    float z_far = greater(a.z, greater(b.z, c.z));
    float reach = width + greater(abs(z_near), abs(z_far)) + shear.blur;
    float doubt = 72.0 * half_ulp() * reach * width;
    float least = lesser(w0, lesser(w1, w2));
    float most = greater(w0, greater(w1, w2));
    if (least < -doubt && most > doubt) return false;
    crossing.is_sure = least > doubt || most < -doubt;

    float error = 16.0 * half_ulp() * reach;
    if (crossing.is_sure) {
        float area = w0 + w1 + w2;
        float z = a.z + w1 / area * (b.z - a.z) + w2 / area * (c.z - a.z);
        error += lesser(3.0 * doubt / abs(area), 1.0) * (z_far - z_near);
        z_near = z;
        z_far = z;
    }
    z_near -= error;
    z_far += error;
    crossing.from = lesser(z_near * shear.z, z_far * shear.z);
    crossing.to = greater(z_near * shear.z, z_far * shear.z);
    return true;
}
