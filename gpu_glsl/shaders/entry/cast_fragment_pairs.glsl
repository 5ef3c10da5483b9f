// Entry: given rays, two a fragment.
#include "lib/given_rays.glsl"
#include "lib/grid/pairs.glsl"

layout(location = 0) out uvec4 out_hit;        // prim_id; t, u, v as bits
layout(location = 1) out uvec4 out_other_hit;  // of the other ray
layout(location = 2) out uvec4 out_instances;  // of each, inst_id and flags

Ray ray_again(Ray ray) { return ray; }  // (strategies/grid.glsl)

uvec4 words_of(Hit hit) {
    return uvec4(hit.prim_id, floatBitsToUint(vec3(hit.t, hit.u, hit.v)));
}

void main() {
    reset_counters();
    // The 8 fragments that run together have 16 rays that follow each other.
    int place = place_at(ivec2(gl_FragCoord.xy));
    int first = 2 * place - (place & 7);
    Answer a;
    Answer b;
    closest_hits(given_ray(first), given_ray(first + 8), a, b);
    out_hit = words_of(a.hit);
    out_other_hit = words_of(b.hit);
    out_instances = uvec4(a.hit.inst_id, a.flags, b.hit.inst_id, b.flags);
}
