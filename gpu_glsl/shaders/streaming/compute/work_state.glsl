// Compute form: counts of work, of all rays' traversal and then of all rays' intersection.
#pragma once
#include "streaming/compute/state.glsl"

layout(std430) buffer WorkBuffer { uvec4 work[]; };

uvec4 load_walk_work(uint control) { return count_work ? work[ray_index] : uvec4(0u); }
uvec4 load_hit_work(uint control) { return count_work ? work[ray_index + ray_count] : uvec4(0u); }
void store_work(uvec4 done) {
    if (count_work) work[ray_index + kernel * ray_count] += done;
}
