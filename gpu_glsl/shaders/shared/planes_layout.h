// Records of a triangle's planes, which floats test (lib/triangle/rule_out.glsl), in texels of four
// words. One text for C++ and GLSL.
#pragma once

// Floats: the triangle's own plane, and two on which a barycentric coordinate is 0
// (lib/triangle/float_planes.glsl).
const int kFloatPlanesTexels = 3;

// Fixed-point numbers: the same planes, seen along the axis on which the triangle's normal is
// longest (lib/triangle/fixed_planes.glsl). A word is a number in [-1, 1), 2^31 times; the low byte
// may be something else: read with the number it is part of it, and the packer takes it into
// account. Of d, in [-4, 4), a word is 2^29 times it, all of it.
//
//   word  number    low byte
//   0     a         bits 24 to 31 of the ninth number
//   1     b         bits 16 to 23 of it
//   2     d
//   3     first.i   bits 8 to 15 of it
//   4     first.j   the scale
//   5     first.d   kAlongX or kAlongZ (neither: along y); kThinPlanes or kNoPlanes
//   6     second.i
//   7     second.j
//   (8)   second.d  the ninth
//
// A scale byte s says that weights are scaled by the float of bits (s << 20) + kLeastScale, over
// 2^31: by 1 to 2^-31 in eighths of an octave.
const int kFixedPlanesTexels = 2;
const uint kLeastScale = 0x3F800000u;
const int kScaleShift = 20;
const uint kAlongX = 1u;
const uint kAlongZ = 2u;
const uint kThinPlanes = 4u;
const uint kNoPlanes = 8u;  // they have no room here: the triangle may be hit, at any t
