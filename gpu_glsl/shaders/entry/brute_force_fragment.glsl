// Entry: one chunk of tests for given rays, one a fragment; outputs as cast_fragment.glsl. What the
// last chunk put out comes back in three textures.
#include "brute_force/test_chunk.glsl"
#include "lib/given_rays.glsl"

TEXTURE2D(last_hit)
uniform usampler2D last_ids;
uniform usampler2D last_counters;
UNIFORM(bool, is_first_chunk)

layout(location = 0) out vec4 out_hit;        // t, u, v
layout(location = 1) out uvec4 out_ids;       // prim_id, inst_id, flags
layout(location = 2) out uvec4 out_counters;  // cells, tests, references, rays

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    reset_counters();
    Hit hit = no_hit();
    if (!is_first_chunk) {
        vec4 t_u_v = FETCH2D(last_hit, at);
        uvec4 ids = FETCH2D(last_ids, at);
        hit = Hit(t_u_v.x, t_u_v.y, t_u_v.z, ids.x, ids.y);
        ray_flags = ids.z;
        if (count_work) triangle_tests = FETCH2D(last_counters, at).y;
    }
    test_chunk(given_ray(at), hit);
    out_hit = vec4(hit.t, hit.u, hit.v, 0.0);
    out_ids = uvec4(hit.prim_id, hit.inst_id, ray_flags, 0u);
    out_counters = uvec4(0u, triangle_tests, 0u, 1u);
}
