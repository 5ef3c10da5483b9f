// Entry: given rays, one an invocation.
#include "lib/ray.glsl"

// A group of one warp, where a strategy asks for no other. (On an H100, driver 580, 64 invocations
// halve the rate of those whose text needs more registers than compilers then give.)
#ifndef GROUP_SIZE
#define GROUP_SIZE 32
#endif
layout(local_size_x = GROUP_SIZE) in;

struct RayRecord {
    vec4 origin;     // org, tmin
    vec4 direction;  // dir, tmax
};
struct HitRecord {
    vec4 hit;   // t, u, v
    uvec4 ids;  // prim_id, inst_id, flags
};
layout(std430, binding = 0) volatile readonly buffer RayBuffer { RayRecord rays[]; };
layout(std430, binding = 1) writeonly buffer HitBuffer { HitRecord hits[]; };
#if NEEDS(count_work)
layout(std430, binding = 2) writeonly buffer CounterBuffer {
    uvec4 counters[];  // cells, tests, references, rays
};
#endif

UNIFORM(int, ray_count)

int ray_index() {
    // Groups are laid out in two dimensions, because one holds at most 65,535 of them.
    return int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x +
               gl_LocalInvocationID.x);
}

Ray read_ray() {
    RayRecord record = rays[ray_index()];
    return Ray(record.origin.xyz, record.origin.w, record.direction.xyz, record.direction.w);
}

// (strategies/grid.glsl) `volatile` above makes it a reading indeed.
Ray ray_again(Ray ray) { return read_ray(); }

void main() {
    int index = ray_index();
    if (index >= ray_count) return;
    reset_counters();
    Hit hit = closest_hit(read_ray());
    hits[index] = HitRecord(vec4(hit.t, hit.u, hit.v, 0.0),
                            uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u));
#if NEEDS(count_work)
    counters[index] = uvec4(cells_visited, triangle_tests, references_read, 1u);
#endif
}
