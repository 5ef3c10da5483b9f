// Compute form: the best hits, which intersect owns, and the work that the kernels count.
#pragma once
#include "streaming/compute/state.glsl"

layout(std430) buffer HitStateBuffer { vec4 hit_texels[]; };
layout(std430) buffer HitIdBuffer { uvec2 hit_ids[]; };

HitState load_own_hit(uint control) {
    return unpack_hit(control, hit_texels[ray_index], hit_ids[ray_index]);
}
Hit load_hit(uint control) { return load_own_hit(control).hit; }
float load_hit_t(uint control) {
    return unpack_hit(control, hit_texels[ray_index], uvec2(0u)).hit.t;
}
void store_hit(vec4 texel, uvec2 ids) {
    hit_texels[ray_index] = texel;
    hit_ids[ray_index] = ids;
}
