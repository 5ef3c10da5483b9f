// The triangle test on records of fixed-point numbers: 32 bytes (shared/planes_layout.h). After
// Wald (2004) and Baldwin & Weber (2016): along the axis k on which its normal is longest, the
// triangle's plane is p.k + a p.i + b p.j = d, with |a| and |b| at most 1, and on that plane a
// corner's weight is a sum of p.i, p.j and 1 alone. Nine numbers say what twelve do otherwise.
//
// All is in units of words: det and dist 2^31, weights 2^62.
//
// The bounds, with u = 2^-24, c the record's scale, and A and B the sums |first.i| + |first.j| and
// |second.i| + |second.j|: scaled, A + B + c is at most 1. For coordinates of at most 1/2,
// |first.d| and |second.d| are at most A / 2 and B / 2. A number of the record is off by u for its
// low byte and by half an ulp as a float, 2 u at most; d by half an ulp and 2^-30. From this, the
// rounding of the ray, and that of each operation, products and sums apart: det is off by 9.5 u and
// dist by 9.4 u; for a point in the triangle, the point times det by 20.4 u; a weight times c det
// by (32.7 A + 6 + 3 c) u; and the third, c det without the other two, by
// (32.7 (A + B) + 24.5 c + 12) u, less than 45 u. Where coordinates are beyond 1/2 an ulp is twice
// as large at once: 47.5 u there, times twice the largest. Sums in another order, as a compiler may
// have them, take 1.5 u more. So the doubt is 50 u. t is off by less than 27 u (1 + |t|) / |det|,
// if |det| is more than 108 u.
#pragma once
#include "lib/triangle/planes.glsl"

const float kUnitOfDet = 2147483648.0;               // 2^31
const float kDoubtOfFixed = 13743895347200.0;        // 50 u, in units of 2^62
const float kShareOfFixed = 2.5145709514617920e-10;  // 27 / 50, for det in units of 2^31

float fixed_number(uint word) { return float(int(word)); }

Weights weights_by_fixed(Planes planes, vec3 org, vec3 dir) {
    uvec4 face = planes.a;   // a, b, d, first.i
    uvec4 sides = planes.b;  // first.j, first.d, second.i, second.j
    bool is_x = (sides.y & kAlongX) != 0u;
    bool is_z = (sides.y & kAlongZ) != 0u;
    float dir_i = mix(dir.x, dir.y, is_x);
    float dir_j = mix(dir.z, dir.y, is_z);
    float dir_k = mix(mix(dir.y, dir.x, is_x), dir.z, is_z);
    float org_i = mix(org.x, org.y, is_x);
    float org_j = mix(org.z, org.y, is_z);
    float org_k = mix(mix(org.y, org.x, is_x), org.z, is_z);

    float a = fixed_number(face.x);
    float b = fixed_number(face.y);
    float d = 4.0 * fixed_number(face.z);
    float det = kUnitOfDet * dir_k + a * dir_i + b * dir_j;
    float dist = d - kUnitOfDet * org_k - a * org_i - b * org_j;
    float point_i = org_i * det + dir_i * dist;
    float point_j = org_j * det + dir_j * dist;

    uint ninth = (face.x << 24) | ((face.y & 255u) << 16) | ((face.w & 255u) << 8);
    float scale = uintBitsToFloat(((sides.x & 255u) << kScaleShift) + kLeastScale);
    float v = fixed_number(face.w) * point_i + fixed_number(sides.x) * point_j +
              fixed_number(sides.y) * det;
    float w = fixed_number(sides.z) * point_i + fixed_number(sides.w) * point_j +
              fixed_number(ninth) * det;
    return Weights(scale * det - v - w, v, w, det, dist);
}

// How wrong det may be where a weight is less wrong than `doubt`.
float error_of_det_by_fixed(Planes planes, float doubt) {
    const float kAnything = 1e20;
    return mix(kShareOfFixed * doubt, kAnything, (planes.b.y & kNoPlanes) != 0u);
}

bool are_thin_fixed(Planes planes) { return (planes.b.y & kThinPlanes) != 0u; }
