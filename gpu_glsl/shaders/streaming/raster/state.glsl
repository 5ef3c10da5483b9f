// Raster form: the state in textures, a ray a texel.
//
// A pass cannot write the texture it reads, so each kernel's part of the state is kept twice, on
// side 0 and side 1. A pass reads the kernel's own part on one side and writes the other; the host
// swaps them from pass to pass. A fragment that the depth test kills writes nothing, and so its
// newest state stays where it was: on its own side, which the control word names for each part. A
// ray whose newest state lies on the side that a pass is to write sits that pass out
// (raster/mask.glsl). So nothing is ever copied just to keep the sides alike, and stale texels are
// never read.
//
// The control word needs no second side: kernels write it and read the mask pass's copy of it.
#pragma once
#include "streaming/state.glsl"

uniform usampler2D control_copy;

// What other kernels own.
TEXTURE2D(walk4_0)
TEXTURE2D(walk4_1)
TEXTURE2D(walk5_0)
TEXTURE2D(walk5_1)
TEXTURE2D(hit0_0)
TEXTURE2D(hit0_1)
uniform usampler2D hit_ids_0;
uniform usampler2D hit_ids_1;
uniform int first_row;  // of the image, in the textures' row 0
#define HERE ivec2(gl_FragCoord.xy)

// The texel on the side where the ray's newest state of a part lies.
vec4 newest(uint control, uint side, sampler2D side_0, sampler2D side_1) {
    return (control & side) == 0u ? FETCH2D(side_0, HERE) : FETCH2D(side_1, HERE);
}
uvec4 newest(uint control, uint side, usampler2D side_0, usampler2D side_1) {
    return (control & side) == 0u ? FETCH2D(side_0, HERE) : FETCH2D(side_1, HERE);
}

bool open_state() { return true; }
void close_state(bool has_ray, uint turn) {}

ivec2 pixel_of_ray() { return HERE + ivec2(0, first_row); }

uint load_control() { return FETCH2D(control_copy, HERE).x; }

vec4 load_walk_e(uint control) { return newest(control, kWalkSide, walk4_0, walk4_1); }
vec4 load_walk_f(uint control) { return newest(control, kWalkSide, walk5_0, walk5_1); }

Hit load_hit(uint control) {
    uvec4 ids = newest(control, kHitSide, hit_ids_0, hit_ids_1);
    return unpack_hit(control, newest(control, kHitSide, hit0_0, hit0_1), ids.xy).hit;
}
float load_hit_t(uint control) {
    return unpack_hit(control, newest(control, kHitSide, hit0_0, hit0_1), uvec2(0u)).hit.t;
}
