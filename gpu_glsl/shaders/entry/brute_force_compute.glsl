// Entry: one chunk of tests for given rays, one an invocation. The hit so far waits in its record.
#include "brute_force/test_chunk.glsl"
#include "lib/records.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer RayBuffer { RayRecord rays[]; };
layout(std430, binding = 1) buffer HitBuffer { HitRecord hits[]; };
#if NEEDS(count_work)
layout(std430, binding = 2) buffer CounterBuffer {
    uvec4 counters[];  // cells, tests, references, rays
};
#endif

UNIFORM(int, ray_count)
UNIFORM(bool, is_first_chunk)

void main() {
    // Groups are laid out in two dimensions, because one holds at most 65,535 of them.
    int index = int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) *
                        gl_WorkGroupSize.x +
                    gl_LocalInvocationID.x);
    if (index >= ray_count) return;
    RayRecord record = rays[index];
    reset_counters();
    Hit hit = no_hit();
    if (!is_first_chunk) {
        HitRecord last = hits[index];
        hit = Hit(last.hit.x, last.hit.y, last.hit.z, last.ids.x, last.ids.y);
        ray_flags = last.ids.z;
#if NEEDS(count_work)
        triangle_tests = counters[index].y;
#endif
    }
    test_chunk(Ray(record.origin.xyz, record.origin.w, record.direction.xyz, record.direction.w),
               hit);
    hits[index] = HitRecord(vec4(hit.t, hit.u, hit.v, 0.0),
                            uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u));
#if NEEDS(count_work)
    counters[index] = uvec4(0u, triangle_tests, 0u, 1u);
#endif
}
