// Entry: given rays, taken from a queue by invocations that stay until it is empty: persistent
// threads (Aila & Laine 2009).
//
// A group is as large as OpenGL promises it may be, so that compilers must do with the registers
// that leave room for all of it: on an H100 64 an invocation, where they take some 96 in small
// groups, and half as many rays again wait for memory at once. A large group that casts one ray an
// invocation would wait for its slowest; here who has an answer goes on to the next ray. Any number
// of groups will do; as many as run at once are enough.
#if NEEDS(has_ballots)
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#include "lib/ray_records.glsl"

// A driver that ends loops (lib/loops.glsl) counts the turns of all rays that an invocation casts:
// there each takes one, and there is one for every ray.
CONSTANT(bool, ends_loops)

layout(local_size_x = 1024) in;

// Each 0 between dispatches.
layout(std430, binding = 3) buffer QueueBuffer {
    uint rays_taken;
    uint groups_ended;
};

// The next ray's number. Invocations that run together ask at once; right whichever these are:
// where all of a subgroup do, their rays follow each other.
uint take_ray() {
#if NEEDS(has_ballots)
    uvec4 together = subgroupBallot(true);
    uint first = 0u;
    if (subgroupElect()) first = atomicAdd(rays_taken, subgroupBallotBitCount(together));
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(together);
#else
    return atomicAdd(rays_taken, 1u);
#endif
}

// The rays in flight, by invocation: so none keeps a register for the number of its own.
shared int rays_in_flight[gl_WorkGroupSize.x];
int ray_index() { return rays_in_flight[gl_LocalInvocationIndex]; }

void main() {
    do {
        rays_in_flight[gl_LocalInvocationIndex] = int(take_ray());
        if (ray_index() < ray_count) cast_ray();
    } while (ray_index() < ray_count && !ends_loops);

    // The last group leaves the queue as it was. (Were invocations counted, light rays would take a
    // sixth longer: gpu_glsl/README.md.)
    barrier();
    uint groups = gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    if (gl_LocalInvocationIndex == 0u && atomicAdd(groups_ended, 1u) == groups - 1u) {
        rays_taken = 0u;
        groups_ended = 0u;
    }
}
