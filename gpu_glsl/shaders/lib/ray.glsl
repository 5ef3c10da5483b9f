// Rays, hits, and the counts and flags that go with them. core/types.h says what each field means.
#pragma once
#include "lib/bits.glsl"
#include "lib/dialect.glsl"

struct Ray {
    vec3 org;
    float tmin;
    vec3 dir;
    float tmax;
};

struct Hit {
    float t;
    float u;
    float v;
    uint prim_id;
    uint inst_id;
};

const uint kNoId = 0xFFFFFFFFu;

Hit no_hit() { return Hit(infinity(), 0.0, 0.0, kNoId, kNoId); }
bool is_hit(Hit hit) { return hit.inst_id != kNoId; }

// False for a ray that hits nothing by definition: a number that is none or not finite, a direction
// of 0, a reversed interval.
bool is_traceable(Ray ray) {
    bool moves = ray.dir.x != 0.0 || ray.dir.y != 0.0 || ray.dir.z != 0.0;
    return is_finite(ray.org) && is_finite(ray.dir) && moves && is_finite(ray.tmin) &&
           is_number(ray.tmax) && ray.tmin >= 0.0 && ray.tmin <= ray.tmax;
}

// What a path's ray is for: the light that a shadow ray goes to, or kSurfaceRay, which stands for a
// primary or reflection ray. A shadow ray ends at its light, the others nowhere.
const int kSurfaceRay = -1;
float path_tmax(int light) { return light == kSurfaceRay ? infinity() : 1.0; }

// Work done since the last reset_counters(). A strategy counts as it goes; the compiler drops it
// all when count_work is false.
CONSTANT(bool, count_work)
uint cells_visited;
uint triangle_tests;
uint references_read;
uint rays_cast;

// RayFlag bits. An exhausted budget is a result, not an accident: it is always reported.
const uint kFlagExhausted = 1u;
uint ray_flags;

void reset_counters() {
    cells_visited = 0u;
    triangle_tests = 0u;
    references_read = 0u;
    rays_cast = 0u;
    ray_flags = 0u;
}
void count_cell() {
    if (count_work) ++cells_visited;
}
void count_test() {
    if (count_work) ++triangle_tests;
}
void count_reference() {
    if (count_work) ++references_read;
}
