// The triangle test on records of floats: 48 bytes, no number of which has to be unpacked.
//
// The bounds, with u = 2^-24 (the record is of floats, whatever the arithmetic), A and B the sums
// of the absolute components of `first` and `second`, and c = 1 / (A + B + 1) that of `face`. From
// the rounding of record and ray, and of each operation, products and sums apart: det is off by
// 5 u c and dist by 5 u c; for a point in the triangle, the point times det by 11 u c, and a weight
// times det by (18.5 A + 10) u c; the third, det without the other two, by less than 22 u, whatever
// A and B. t is off by less than 12 u c (1 + |t|) / |det|, if |det| is more than 48 u c.
#pragma once
#include "lib/triangle/planes.glsl"

const float kDoubtOfFloats = 1.31130218505859375e-6;  // 22 u
const float kShareOfFloats = 0.5455;                  // 12 / 22, rounded up

// As dot(xyz, p) = w, or a corner's weight dot(xyz, p) + w.
vec4 float_plane(uvec4 texel) { return vec4(uintBitsToFloat(texel)); }

Weights weights_by_floats(Planes planes, vec3 org, vec3 dir) {
    vec4 face = float_plane(planes.a);
    vec4 first = float_plane(planes.b);
    vec4 second = float_plane(planes.c);
    float det = face.x * dir.x + face.y * dir.y + face.z * dir.z;
    float dist = face.w - face.x * org.x - face.y * org.y - face.z * org.z;
    vec3 point = org * det + dir * dist;
    float v = first.x * point.x + first.y * point.y + first.z * point.z + first.w * det;
    float w = second.x * point.x + second.y * point.y + second.z * point.z + second.w * det;
    return Weights(det - v - w, v, w, det, dist);
}

// How wrong det may be where a weight is less wrong than `doubt`.
float error_of_det_by_floats(Planes planes, float doubt) {
    vec4 face = float_plane(planes.a);
    return kShareOfFloats * doubt * (abs(face.x) + abs(face.y) + abs(face.z));
}

bool are_thin_floats(Planes planes) { return has_sign(float_plane(planes.a).w); }
