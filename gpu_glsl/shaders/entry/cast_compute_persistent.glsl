// Entry: given rays, taken by invocations that stay until none is left: persistent threads (Aila &
// Laine 2009).
//
// A group is as large as OpenGL promises it may be, so that compilers must do with the registers
// that leave room for all of it: on an H100 64 an invocation, where they take some 96 in small
// groups, and half as many rays again wait for memory at once. A large group that casts one ray an
// invocation would wait for its slowest; here who has an answer goes on to the next ray.
//
// Most rays are a group's own from the start, in blocks, for rays that follow each other often read
// the same cells and triangles. The last ones are whose invocation asks first, so that all groups
// end together. Right for any number of groups, fast for as many as run at once.
#if NEEDS(has_ballots)
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
#include "lib/ray_records.glsl"
#include "shared/ray_queue_layout.h"

// A driver that ends loops (lib/loops.glsl) counts the turns of all rays that an invocation casts:
// there each takes one, and there is one for every ray.
CONSTANT(bool, ends_loops)

layout(local_size_x = 1024) in;  // kPersistentGroupSize

layout(std430, binding = 3) buffer QueueBuffer { uint counts[kQueueCounts]; };

UNIFORM(uint, own_rays)  // of each group: whole blocks

shared uint own_rays_taken;

// The rays in flight, by invocation: so none keeps a register for the number of its own.
shared int taken_rays[gl_WorkGroupSize.x];
int ray_index() { return taken_rays[gl_LocalInvocationIndex]; }

// Invocations that run together add to a count at once, one of them for all. Right whichever these
// are; where all of a subgroup do, its rays follow each other.
#if NEEDS(has_ballots)
uvec4 all_together() { return subgroupBallot(true); }
bool adds_for_all() { return subgroupElect(); }
uint how_many(uvec4 together) { return subgroupBallotBitCount(together); }
uint place_from(uint first, uvec4 together) {
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(together);
}
#else
uvec4 all_together() { return uvec4(1u); }
bool adds_for_all() { return true; }
uint how_many(uvec4 together) { return together.x; }
uint place_from(uint first, uvec4 together) { return first; }
#endif

uint take_own() {
    uvec4 together = all_together();
    uint first = 0u;
    if (adds_for_all()) first = atomicAdd(own_rays_taken, how_many(together));
    return place_from(first, together);
}

uint take_from_queue() {
    uvec4 together = all_together();
    uint first = 0u;
    if (adds_for_all()) first = atomicAdd(counts[kRaysTaken], how_many(together));
    return place_from(first, together);
}

void take_ray() {
    uint groups = gl_NumWorkGroups.x;
    uint ray = take_own();
    if (ray < own_rays) {
        uint block = ray / kRayBlock * groups + gl_WorkGroupID.x;
        ray = block * kRayBlock + ray % kRayBlock;
    } else {
        ray = own_rays * groups + take_from_queue();
    }
    taken_rays[gl_LocalInvocationIndex] = int(ray);
}

void main() {
    if (gl_LocalInvocationIndex == 0u) own_rays_taken = 0u;
    barrier();

    do {
        take_ray();
        if (ray_index() < ray_count) cast_ray();
    } while (ray_index() < ray_count && !ends_loops);

    // The last group leaves the queue as it was. (If each invocation counted, light rays would take
    // a sixth longer: gpu_glsl/README.md.)
    barrier();
    if (gl_LocalInvocationIndex == 0u &&
        atomicAdd(counts[kGroupsEnded], 1u) == gl_NumWorkGroups.x - 1u) {
        counts[kRaysTaken] = 0u;
        counts[kGroupsEnded] = 0u;
    }
}
