// Compute form: the records of given rays' answers.
#include "lib/records.glsl"
#include "streaming/compute/hit_state.glsl"
#include "streaming/compute/work_state.glsl"

layout(std430) writeonly buffer HitBuffer { HitRecord hits[]; };
#if NEEDS(count_work)
layout(std430) writeonly buffer CounterBuffer {
    uvec4 counters[];  // cells, tests, references, rays
};
#endif

void store_answer(Hit hit, uint flags, uvec4 counts, uint bytes) {
    hits[ray_index] = HitRecord(vec4(hit.t, hit.u, hit.v, 0.0),
                                uvec4(hit.prim_id, hit.inst_id, flags, bytes));
#if NEEDS(count_work)
    counters[ray_index] = counts;
#endif
}
