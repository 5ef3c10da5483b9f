// Entry: given rays, one an invocation.
#include "lib/ray_records.glsl"

// A group of one warp, where a strategy asks for no other. (On an H100, driver 580, 64 invocations
// halve the rate of those whose text needs more registers than compilers then give.)
#ifndef GROUP_SIZE
#define GROUP_SIZE 32
#endif
layout(local_size_x = GROUP_SIZE) in;

int ray_index() {
    // Groups are laid out in two dimensions, because one holds at most 65,535 of them.
    return int((gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x +
               gl_LocalInvocationID.x);
}

void main() {
    if (ray_index() < ray_count) cast_ray();
}
