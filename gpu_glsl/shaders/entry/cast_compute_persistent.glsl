// Entry: given rays, taken from a queue by invocations that stay until it is empty: persistent
// threads (Aila & Laine 2009).
//
// A group is as large as OpenGL promises it may be, so that compilers must do with the registers
// that leave room for all of it: on an H100 64 an invocation, where they take some 96 in small
// groups, and half as many rays again wait for memory at once. A large group that casts one ray an
// invocation would wait for its slowest; here who has an answer goes on to the next ray. There is
// an invocation for every ray: those that come when none is left end at once.
#if NEEDS(has_ballots)
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#include "lib/ray_records.glsl"

// A driver that ends loops (lib/loops.glsl) counts the turns of all rays that an invocation casts:
// there each takes one.
CONSTANT(bool, ends_loops)

layout(local_size_x = 1024) in;

// Each 0 between dispatches.
layout(std430, binding = 3) buffer QueueBuffer { uint counts[2]; };
const int kRaysTaken = 0;
const int kInvocationsEnded = 1;

// Adds one to a count for each invocation that runs together with this one, at once, and says what
// it was before this one's. Right whichever these are; where all of a subgroup do, its rays follow
// each other.
uint add_one(int count) {
#if NEEDS(has_ballots)
    uvec4 together = subgroupBallot(true);
    uint before = 0u;
    if (subgroupElect()) before = atomicAdd(counts[count], subgroupBallotBitCount(together));
    return subgroupBroadcastFirst(before) + subgroupBallotExclusiveBitCount(together);
#else
    return atomicAdd(counts[count], 1u);
#endif
}

// The rays in flight, by invocation: so none keeps a register for the number of its own.
shared int taken_rays[gl_WorkGroupSize.x];
int ray_index() { return taken_rays[gl_LocalInvocationIndex]; }

void main() {
    do {
        taken_rays[gl_LocalInvocationIndex] = int(add_one(kRaysTaken));
        if (ray_index() < ray_count) cast_ray();
    } while (ray_index() < ray_count && !ends_loops);

    uint invocations = gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x;
    if (add_one(kInvocationsEnded) == invocations - 1u) {
        counts[kRaysTaken] = 0u;
        counts[kInvocationsEnded] = 0u;
    }
}
