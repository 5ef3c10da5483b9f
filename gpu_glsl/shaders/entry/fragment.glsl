// Entry: one image in one draw. A fragment is a pixel.
#include "lib/trace_pixel.glsl"

layout(location = 0) out vec4 out_color;
layout(location = 1) out vec4 out_hit;       // t, u, v
layout(location = 2) out uvec4 out_ids;      // prim_id, inst_id, flags
layout(location = 3) out vec4 out_normal;
layout(location = 4) out uvec4 out_counters;  // cells, tests, references, rays

void main() {
    reset_counters();
    Pixel pixel = trace_pixel(ivec2(gl_FragCoord.xy));
    out_color = vec4(pixel.color, 1.0);
    out_hit = vec4(pixel.primary.t, pixel.primary.u, pixel.primary.v, 0.0);
    out_ids = uvec4(pixel.primary.prim_id, pixel.primary.inst_id, ray_flags, 0u);
    out_normal = vec4(pixel.normal, 0.0);
    out_counters = uvec4(cells_visited, triangle_tests, references_read, rays_cast);
}
