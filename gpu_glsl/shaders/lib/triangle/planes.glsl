// A triangle's planes, and what a test on them finds out.
#pragma once
#include "lib/bits.glsl"
#include "lib/math.glsl"
#include "shared/planes_layout.h"

CONSTANT(bool, has_fixed_planes)  // records of fixed-point numbers, else of floats

// The record of pack/barycentric_planes.h.
struct Planes {
    uvec4 a;
    uvec4 b;
    uvec4 c;  // of floats only
};

int planes_texels() { return has_fixed_planes ? kFixedPlanesTexels : kFloatPlanesTexels; }

// The weights of the corners where the ray meets the triangle's plane, times det; it is there at
// t = dist / det. The weights have one unit, det and dist another.
struct Weights {
    float u;
    float v;
    float w;
    float det;
    float dist;
};
