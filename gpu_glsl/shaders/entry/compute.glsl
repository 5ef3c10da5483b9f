// Entry: one image in one dispatch. An invocation is a pixel.
#include "lib/trace_pixel.glsl"

layout(local_size_x = 8, local_size_y = 4) in;  // one warp: see cast_compute.glsl

struct PixelRecord {
    vec4 color;
    vec4 hit;       // t, u, v
    uvec4 ids;      // prim_id, inst_id, flags
    vec4 normal;
    uvec4 counters;  // cells, tests, references, rays
};
layout(std430, binding = 0) writeonly buffer PixelBuffer { PixelRecord pixels[]; };

UNIFORM(ivec2, image_size)

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (at.x >= image_size.x || at.y >= image_size.y) return;
    reset_counters();
    Pixel pixel = trace_pixel(at);
    pixels[at.y * image_size.x + at.x] = PixelRecord(
        vec4(pixel.color, 1.0),
        vec4(pixel.primary.t, pixel.primary.u, pixel.primary.v, 0.0),
        uvec4(pixel.primary.prim_id, pixel.primary.inst_id, ray_flags, 0u),
        vec4(pixel.normal, 0.0),
        uvec4(cells_visited, triangle_tests, references_read, rays_cast));
}
