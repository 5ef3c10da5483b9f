// Entry: given rays, one a fragment, each a texel of two textures (device_io.cpp: texel_of_ray).
#include "lib/ray.glsl"

TEXTURE2D(ray_origins)     // org, tmin
TEXTURE2D(ray_directions)  // dir, tmax

layout(location = 0) out vec4 out_hit;        // t, u, v
layout(location = 1) out uvec4 out_ids;       // prim_id, inst_id, flags
layout(location = 2) out uvec4 out_counters;  // cells, tests, references, rays

Ray ray_again(Ray ray) { return ray; }  // (strategies/grid.glsl)

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 origin = FETCH2D(ray_origins, at);
    vec4 direction = FETCH2D(ray_directions, at);
    reset_counters();
    Hit hit = closest_hit(Ray(origin.xyz, origin.w, direction.xyz, direction.w));
    out_hit = vec4(hit.t, hit.u, hit.v, 0.0);
    out_ids = uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u);
    out_counters = uvec4(cells_visited, triangle_tests, references_read, 1u);
}
