// The words in which a shader speaks to two compilers.
//
// Every strategy is compiled twice: as GLSL for the GPU, and as C++ (the twin, gpu_glsl/twin). What
// the two languages spell differently goes through the macros below; gpu_glsl/twin/twin_program.h
// gives their other meaning. All else is written in the subset both languages share: no swizzles
// longer than one letter, `1.0` and not `1.0f`, no array constructors.
#pragma once

#ifndef ONEPASS_TWIN

#define IN(T) in T
#define OUT(T) out T
#define INOUT(T) inout T

// A typed constant of the block that the host generates: this line only says that it is needed.
#define CONSTANT(T, name)
#define UNIFORM(T, name) uniform T name;

// A function that a later file defines.
#define DECLARE(function) function;

// `#if NEEDS(name)` ... `#else` ... `#endif`, of a constant of type bool: who composes the text
// leaves the other side out, so that a scene's shader does not even hold what the scene lacks. The
// twin compiles the first side for all scenes, and so asks the constant itself as well.

// Textures are sampled at level 0 with the nearest filter, at normalised coordinates (SAMPLE) or at
// integer ones (FETCH).
#define TEXTURE2D(name) uniform sampler2D name;
#define TEXTURE3D(name) uniform sampler3D name;
#define SAMPLE2D(name, uv) textureLod(name, uv, 0.0)
#define SAMPLE3D(name, uvw) textureLod(name, uvw, 0.0)
#define FETCH2D(name, ij) texelFetch(name, ij, 0)
#define SIZE2D(name) textureSize(name, 0)
#define SIZE3D(name) textureSize(name, 0)

// Buffers of floats and of unsigned integers, four, two or one to a texel, read by index.
#define BUFFER(name) uniform samplerBuffer name;
#define UBUFFER(name) uniform usamplerBuffer name;
#define FETCHBUFFER(name, index) texelFetch(name, index)

// The same buffers as storage blocks, for GL 4.3 and later: of `uint` or `vec4`.
#define STORAGE(block, T, name) layout(std430) readonly buffer block { T name[]; };
#define FETCHSTORAGE(name, index) name[index]

// What a walk did, for who wants to read it: the twin writes it down, a GPU does not. An inst_id of
// kNoId stands for the top level; a cell counts from its grid's lower corner; NOTE_HIT says that
// a hit of a triangle noted before was accepted.
#define NOTE_CELL(inst_id, cell)
#define NOTE_TEST(inst_id, prim_id)
#define NOTE_HIT(hit)

// A result that the driver may neither contract nor reorder. GLSL has the word from 4.0 on.
#if __VERSION__ >= 400
#define PRECISE precise
#else
#define PRECISE
#endif

#endif
