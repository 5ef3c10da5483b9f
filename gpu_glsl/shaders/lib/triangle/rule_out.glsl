// Which triangles a ray may hit, in floats: barycentric coordinates from planes computed beforehand
// (after Havel & Herout 2010), by a test that never says no where rounding leaves it open.
//
// A triangle is its own plane and two more, on which a barycentric coordinate is 0. The ray meets
// the first at t = dist / det; multiplied by det, the three coordinates there need no division.
// A triangle is ruled out only if they differ in sign by more than they can be wrong, and surely
// hit only if they agree by more than that. Between the two, lib/triangle/decide.glsl decides in
// doubles.
#pragma once
#include "lib/bits.glsl"
#include "lib/math.glsl"
#include "lib/ray.glsl"

// A ray made ready for testing triangles. Its origin is counted from the centre of a box of edges of at
// most 1 around them, its direction's largest component is 1/2 to 1, and its t is a length there,
// from its own origin on.
struct Sight {
    vec3 org;
    vec3 dir;
    float reach;  // at least 1, and at least twice the origin's largest coordinate
};

Sight sight_from(vec3 org, vec3 dir) {
    return Sight(org, dir, greater(1.0, 2.0 * largest(abs(org))));
}

// The record of pack/barycentric_planes.h: floats, in the twin of doubles as well.
const float kRecordHalfUlp = 5.9604644775390625e-8;  // 2^-24
struct Planes {
    vec4 face;    // dot(xyz, p) = w on the triangle's plane
    vec4 first;   // dot(xyz, p) + w: the weight of the second corner
    vec4 second;  // of the third corner
};

// Where a ray crosses a triangle, from the sight's origin on.
struct Crossing {
    float t;
    float error;   // t is wrong by less than this
    bool is_sure;  // false if it may be nowhere
};

// The weights of the corners where the ray meets the triangle's plane, times det; it is there at
// t = dist / det.
struct Weights {
    float u;
    float v;
    float w;
    float det;
    float dist;
};

Weights weights_of(Planes planes, Sight sight) {
    vec3 dir = sight.dir;
    vec3 org = sight.org;
    vec4 face = planes.face;
    float det = face.x * dir.x + face.y * dir.y + face.z * dir.z;
    float dist = face.w - face.x * org.x - face.y * org.y - face.z * org.z;
    vec3 point = org * det + dir * dist;
    vec4 first = planes.first;
    vec4 second = planes.second;
    float v = first.x * point.x + first.y * point.y + first.z * point.z + first.w * det;
    float w = second.x * point.x + second.y * point.y + second.z * point.z + second.w * det;
    return Weights(det - v - w, v, w, det, dist);
}

// What a weight may be wrong by.
float doubt_of(Sight sight) { return (22.0 * kRecordHalfUlp) * sight.reach; }

// False if the ray misses the triangle.
//
// The bounds, with u = 2^-24 (the record is of floats, whatever the arithmetic), A and B the sums of
// the absolute components of `first` and `second`, and c = 1 / (A + B + 1) that of `face`. From the
// rounding of record and ray, and of each operation, products and sums apart: det is off by 5 u c and
// dist by 5 u c; for a point in the triangle, the point times det by 11 u c, and a weight times det
// by (18.5 A + 10) u c; the third, det without the other two, by less than 22 u, whatever A and B. An
// origin outside the box raises all errors alike. (If computed weights are all beyond 22 u, the
// point is in the triangle or next to it, and the bound holds as well.) t is off by less than
// 12 u c (1 + |t|) / |det|, if |det| is more than 48 u c; if not, t may be anything.
bool may_cross(Weights weights, Sight sight) {
    float least = min(weights.u, min(weights.v, weights.w));
    float most = max(weights.u, max(weights.v, weights.w));
    return min(-least, most) <= doubt_of(sight);
}

// Of a ray that may: where. Few do, and so the division waits until it is known.
Crossing crossing_of(Planes planes, Weights weights, Sight sight) {
    vec4 face = planes.face;
    float det = weights.det;
    float error = (12.0 * kRecordHalfUlp) * sight.reach * (abs(face.x) + abs(face.y) + abs(face.z));
    bool is_steep = abs(det) > 4.0 * error;
    float inverse = 1.0 / det;
    float t = mix(0.0, weights.dist * inverse, is_steep);
    error = mix(infinity(), error * (1.0 + abs(t)) * abs(inverse), is_steep);
    float least = min(weights.u, min(weights.v, weights.w));
    float most = max(weights.u, max(weights.v, weights.w));
    return Crossing(t, error, max(least, -most) > doubt_of(sight) && !has_sign(face.w));
}
