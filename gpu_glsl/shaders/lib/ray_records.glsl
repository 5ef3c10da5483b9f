// Given rays and their answers in storage buffers, as compute shaders read and write them. Who
// includes this says which ray is an invocation's:
//
//   int ray_index()
#pragma once
#include "lib/ray.glsl"
#include "lib/records.glsl"

layout(std430, binding = 0) volatile readonly buffer RayBuffer { RayRecord rays[]; };
layout(std430, binding = 1) writeonly buffer HitBuffer { HitRecord hits[]; };
#if NEEDS(count_work)
layout(std430, binding = 2) writeonly buffer CounterBuffer {
    uvec4 counters[];  // cells, tests, references, rays
};
#endif

UNIFORM(int, ray_count)

int ray_index();

Ray read_ray() {
    RayRecord record = rays[ray_index()];
    return Ray(record.origin.xyz, record.origin.w, record.direction.xyz, record.direction.w);
}

// (strategies/grid.glsl) `volatile` above makes it a reading indeed.
Ray ray_again(Ray ray) { return read_ray(); }

void cast_ray() {
    reset_counters();
    Hit hit = closest_hit(read_ray());
    int index = ray_index();
    hits[index] = HitRecord(vec4(hit.t, hit.u, hit.v, 0.0),
                            uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u));
#if NEEDS(count_work)
    counters[index] = uvec4(cells_visited, triangle_tests, references_read, 1u);
#endif
}
