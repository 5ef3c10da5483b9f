// Entry: given rays, one a fragment.
#include "lib/given_rays.glsl"

layout(location = 0) out vec4 out_hit;        // t, u, v
layout(location = 1) out uvec4 out_ids;       // prim_id, inst_id, flags
layout(location = 2) out uvec4 out_counters;  // cells, tests, references, rays

Ray ray_again(Ray ray) { return ray; }  // (strategies/grid.glsl)

void main() {
    reset_counters();
    Hit hit = closest_hit(given_ray(ivec2(gl_FragCoord.xy)));
    out_hit = vec4(hit.t, hit.u, hit.v, 0.0);
    out_ids = uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u);
    out_counters = uvec4(cells_visited, triangle_tests, references_read, 1u);
}
