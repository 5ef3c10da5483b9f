// Compute form: what traverse and intersect read and write: the rays, and what either kernel owns.
#pragma once
#include "streaming/compute/hit_state.glsl"
#include "streaming/compute/work_state.glsl"

// Given rays: org and tmin, dir and tmax, side by side. Of an image: the first two texels of the
// path.
layout(std430) readonly buffer RayBuffer { vec4 ray_texels[]; };
layout(std430) buffer WalkBuffer { vec4 walk_texels[]; };

Ray load_ray(uint control) {
    if (casting) {
        vec4 origin = ray_texels[2 * ray_index];
        vec4 direction = ray_texels[2 * ray_index + 1];
        return Ray(origin.xyz, origin.w, direction.xyz, direction.w);
    }
    vec4 origin = ray_texels[ray_index];
    vec4 direction = ray_texels[ray_index + ray_count];
    return Ray(origin.xyz, 0.0, direction.xyz, path_tmax(light_of(control)));
}

WalkTexels load_walks() {
    return WalkTexels(
        walk_texels[ray_index], walk_texels[ray_index + ray_count],
        walk_texels[ray_index + 2 * ray_count], walk_texels[ray_index + 3 * ray_count],
        walk_texels[ray_index + 4 * ray_count], walk_texels[ray_index + 5 * ray_count]);
}
void store_walks(WalkTexels texels) {
    walk_texels[ray_index] = texels.a;
    walk_texels[ray_index + ray_count] = texels.b;
    walk_texels[ray_index + 2 * ray_count] = texels.c;
    walk_texels[ray_index + 3 * ray_count] = texels.d;
    walk_texels[ray_index + 4 * ray_count] = texels.e;
    walk_texels[ray_index + 5 * ray_count] = texels.f;
}
vec4 load_walk_e(uint control) { return walk_texels[ray_index + 4 * ray_count]; }
vec4 load_walk_f(uint control) { return walk_texels[ray_index + 5 * ray_count]; }
