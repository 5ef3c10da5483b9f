// Raster form: an image's render targets, those of entry/fragment.glsl.
#include "streaming/raster/resolve_state.glsl"

layout(location = 0) out vec4 out_color;
layout(location = 1) out vec4 out_hit;        // t, u, v
layout(location = 2) out uvec4 out_ids;       // prim_id, inst_id, flags, bytes of the grid read
layout(location = 3) out vec4 out_normal;
layout(location = 4) out uvec4 out_counters;  // cells, tests, references, rays

void store_pixel(vec3 color, Hit hit, uint flags, vec3 normal, uvec4 counters, uint bytes) {
    out_color = vec4(color, 1.0);
    out_hit = vec4(hit.t, hit.u, hit.v, 0.0);
    out_ids = uvec4(hit.prim_id, hit.inst_id, flags, bytes);
    out_normal = vec4(normal, 0.0);
    out_counters = counters;
}
