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

// A ray made ready for testing triangles. Its origin is counted from the centre of a box around them,
// its direction's largest component is 1/2 to 1, and its t is a length there, from its own origin on.
struct Sight {
    vec3 org;
    vec3 dir;
    float doubt;  // a weight of corners is wrong by less than this
};

const float kRecordHalfUlp = 5.9604644775390625e-8;  // 2^-24

// `half_box`: half of the box's edges. (The doubt is made here, because some compilers take nothing
// out of loops.)
Sight sight_from(vec3 org, vec3 dir, vec3 half_box) {
    float reach = greater(1.0, 2.0 * largest(greater(abs(org), half_box)));
    return Sight(org, dir, (22.0 * kRecordHalfUlp) * reach);
}

// The record of pack/barycentric_planes.h: floats, in the twin of doubles as well.
struct Planes {
    vec4 face;    // dot(xyz, p) = w on the triangle's plane
    vec4 first;   // dot(xyz, p) + w: the weight of the second corner
    vec4 second;  // of the third corner
};

// Where a ray crosses a triangle, from the sight's origin on.
struct Crossing {
    float t;
    float error;    // t is wrong by less than this
    bool is_known;  // false: t may be anything, whatever `error` says
    bool is_sure;   // false: it may be nowhere, or t is not known
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

// False if the ray misses the triangle.
//
// The bounds, with u = 2^-24 (the record is of floats, whatever the arithmetic), A and B the sums of
// the absolute components of `first` and `second`, and c = 1 / (A + B + 1) that of `face`. From the
// rounding of record and ray, and of each operation, products and sums apart: det is off by 5 u c and
// dist by 5 u c; for a point in the triangle, the point times det by 11 u c, and a weight times det
// by (18.5 A + 10) u c; the third, det without the other two, by less than 22 u, whatever A and B.
// This is so for coordinates of at most 1/2; larger ones, of the box or of the ray's origin, raise all
// errors by no more than they are larger. (If computed weights are all beyond 22 u, the
// point is in the triangle or next to it, and the bound holds as well.) t is off by less than
// 12 u c (1 + |t|) / |det|, if |det| is more than 48 u c; if not, t may be anything.
//
// (Comparisons and no min() or max(): each of those costs a software renderer three instructions, for
// the sake of NaN.)
bool may_cross(Weights weights, Sight sight) {
    float doubt = sight.doubt;
    bool has_negative = weights.u < -doubt || weights.v < -doubt || weights.w < -doubt;
    bool has_positive = weights.u > doubt || weights.v > doubt || weights.w > doubt;
    return !(has_negative && has_positive);
}

// Of a ray that may: where. Few do, and so the division waits until it is known. (Where t is not known,
// it and its error may be no numbers, of which drivers keep no rules: nothing rests on them.)
Crossing crossing_of(Planes planes, Weights weights, Sight sight) {
    const float kShare = 0.5455;  // 12/22, rounded up: of the doubt that counts for t
    vec4 face = planes.face;
    float doubt = sight.doubt;
    float error_of_det = kShare * doubt * (abs(face.x) + abs(face.y) + abs(face.z));
    bool is_known = abs(weights.det) > 4.0 * error_of_det;
    float inverse = 1.0 / weights.det;
    float t = weights.dist * inverse;
    bool are_negative = weights.u < -doubt && weights.v < -doubt && weights.w < -doubt;
    bool are_positive = weights.u > doubt && weights.v > doubt && weights.w > doubt;
    bool is_sure = is_known && (are_negative || are_positive) && !has_sign(face.w);
    return Crossing(t, error_of_det * (1.0 + abs(t)) * abs(inverse), is_known, is_sure);
}

// Whether a crossing may be at t = 0 to `end`.
bool may_be_within(Crossing crossing, float end) {
    bool is_within = crossing.t - crossing.error <= end && crossing.t + crossing.error >= 0.0;
    return is_within || !crossing.is_known;
}
