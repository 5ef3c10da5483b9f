// Vector arithmetic with every sum and every comparison spelled out.
//
// Drivers are free to order the sums of dot() and cross() as they like and to treat NaN in min()
// and max() as they like; here both are fixed, so that shader and twin round alike.
#pragma once
#include "lib/dialect.glsl"

// (mix() with a bool selects one of two numbers; for ?: some drivers branch.)
// A NaN in `b` loses, a NaN in `a` stays: the rule on which a traversal's NaN behaviour rests.
float lesser(float a, float b) { return mix(a, b, b < a); }
float greater(float a, float b) { return mix(a, b, b > a); }

vec3 lesser(vec3 a, vec3 b) { return vec3(lesser(a.x, b.x), lesser(a.y, b.y), lesser(a.z, b.z)); }
vec3 greater(vec3 a, vec3 b) {
    return vec3(greater(a.x, b.x), greater(a.y, b.y), greater(a.z, b.z));
}

float smallest(vec3 v) { return lesser(lesser(v.x, v.y), v.z); }
float largest(vec3 v) { return greater(greater(v.x, v.y), v.z); }

float dot3(vec3 a, vec3 b) {
    PRECISE float d = a.x * b.x + a.y * b.y + a.z * b.z;
    return d;
}

// The signed distance of point `p` from a plane (a, b, c, d), in units of its normal's length.
float plane_at(vec4 plane, vec3 p) {
    PRECISE float d = plane.x * p.x + plane.y * p.y + plane.z * p.z + plane.w;
    return d;
}

// The same without the plane's offset: how fast a direction leaves the plane.
float plane_along(vec4 plane, vec3 v) {
    PRECISE float d = plane.x * v.x + plane.y * v.y + plane.z * v.z;
    return d;
}

vec3 unit(vec3 v) { return v / sqrt(dot3(v, v)); }
