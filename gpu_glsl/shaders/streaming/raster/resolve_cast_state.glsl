// Raster form: the render targets of given rays, those of entry/cast_fragment.glsl.
#include "streaming/raster/resolve_state.glsl"

layout(location = 0) out vec4 out_hit;        // t, u, v
layout(location = 1) out uvec4 out_ids;       // prim_id, inst_id, flags, bytes of the grid read
layout(location = 2) out uvec4 out_counters;  // cells, tests, references, rays

void store_answer(Hit hit, uint flags, uvec4 counters, uint bytes) {
    out_hit = vec4(hit.t, hit.u, hit.v, 0.0);
    out_ids = uvec4(hit.prim_id, hit.inst_id, flags, bytes);
    out_counters = counters;
}
