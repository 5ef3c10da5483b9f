// Compute form: the records of given rays, those of lib/ray_records.glsl.
#include "streaming/compute/hit_state.glsl"
#include "streaming/compute/work_state.glsl"

struct HitRecord {
    vec4 hit;   // t, u, v
    uvec4 ids;  // prim_id, inst_id, flags, bytes of the grid read
};
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
