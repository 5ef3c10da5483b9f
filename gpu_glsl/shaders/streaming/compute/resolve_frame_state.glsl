// Compute form: an image's records, those of entry/compute.glsl.
#include "streaming/compute/path_state.glsl"
#include "streaming/compute/work_state.glsl"

struct PixelRecord {
    vec4 color;
    vec4 hit;        // t, u, v
    uvec4 ids;       // prim_id, inst_id, flags, bytes of the grid read
    vec4 normal;
    uvec4 counters;  // cells, tests, references, rays
};
layout(std430) writeonly buffer PixelBuffer { PixelRecord pixels[]; };

void store_pixel(vec3 color, Hit hit, uint flags, vec3 normal, uvec4 counters, uint bytes) {
    pixels[ray_index] = PixelRecord(vec4(color, 1.0), vec4(hit.t, hit.u, hit.v, 0.0),
                              uvec4(hit.prim_id, hit.inst_id, flags, bytes), vec4(normal, 0.0),
                              counters);
}
