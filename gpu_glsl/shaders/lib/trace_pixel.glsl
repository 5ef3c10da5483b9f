// A pixel in a single pass: its whole ray tree in one loop.
//
// Adinetz & Berezin, section 4: one fragment shader traces everything through one ray-casting
// procedure. So there is one call of closest_hit(), and the loop around it asks what the next ray
// is for.
#pragma once
#include "lib/query.glsl"
#include "lib/shading.glsl"

// (strategies/grid.glsl) A pixel's rays are nowhere but in registers.
Ray ray_again(Ray ray) { return ray; }

Pixel trace_pixel(ivec2 pixel) {
    Ray ray = primary_ray(pixel);
    Path path = begin_path();
    int ray_budget = (max_depth + 1) * (light_count + 1);
    for (int i = 0; i < ray_budget; ++i) {
        any_hit_suffices = any_shadow_query && path.light != kSurfaceRay;
        Hit hit = closest_hit(ray);
        ++rays_cast;
        if (!next_ray(path, hit, ray)) break;
    }
    return path.pixel;
}
