// What a GPU and a software renderer want said differently.
#pragma once
#include "lib/dialect.glsl"

CONSTANT(bool, is_software)            // a software renderer runs this
CONSTANT(bool, loads_texels_in_place)  // one that has whole texels sooner from images

// ---- Registers ---------------------------------------------------------------------------------

// n itself. On a GPU in a form of which compilers do not know that it is: they compute anew what
// depends on it, and keep no registers for what they computed before. On a CPU it is cheaper kept.
// `id`: any below 2^31, known late.
#if NEEDS(is_software)
uint anew(uint n, uint id) { return n; }
#else
uint anew(uint n, uint id) { return n + (id >> 31u); }
#endif

// ---- Tables ------------------------------------------------------------------------------------

// Buffers of a `uint` (words) or a `uvec4` (records) to a texel, which a walk reads at every step.
// A software renderer calls a function for each texel of a buffer texture; those of an image it
// loads in place. That is faster for words, and for whole texels with Mesa 22.3, not with 25.
#ifndef ONEPASS_TWIN
#if NEEDS(is_software)
#define WORD_TABLE(name) layout(r32ui) readonly uniform uimageBuffer name;
#define FETCHWORD(name, index) imageLoad(name, index).x
#else
#define WORD_TABLE(name) UBUFFER(name)
#define FETCHWORD(name, index) FETCHBUFFER(name, index).x
#endif
#if NEEDS(loads_texels_in_place)
#define RECORD_TABLE(name) layout(rgba32ui) readonly uniform uimageBuffer name;
#define FETCHTEXEL(name, index) imageLoad(name, index)
#else
#define RECORD_TABLE(name) UBUFFER(name)
#define FETCHTEXEL(name, index) FETCHBUFFER(name, index)
#endif
#endif
