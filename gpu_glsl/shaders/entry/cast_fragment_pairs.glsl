// Entry: given rays, two a fragment.
#include "lib/given_rays.glsl"
#include "lib/grid/pairs.glsl"

layout(location = 0) out vec4 out_hit;         // t, u, v
layout(location = 1) out uvec4 out_ids;        // prim_id, inst_id, flags
layout(location = 2) out vec4 out_second_hit;  // of the other ray
layout(location = 3) out uvec4 out_second_ids;

Ray ray_again(Ray ray) { return ray; }  // (strategies/grid.glsl)

void main() {
    reset_counters();
    // The 8 fragments that run together have 16 rays that follow each other.
    int place = place_at(ivec2(gl_FragCoord.xy));
    int first = 2 * place - (place & 7);
    Answer a;
    Answer b;
    closest_hits(given_ray(first), given_ray(first + 8), a, b);
    out_hit = vec4(a.hit.t, a.hit.u, a.hit.v, 0.0);
    out_ids = uvec4(a.hit.prim_id, a.hit.inst_id, a.flags, 0u);
    out_second_hit = vec4(b.hit.t, b.hit.u, b.hit.v, 0.0);
    out_second_ids = uvec4(b.hit.prim_id, b.hit.inst_id, b.flags, 0u);
}
