// Two targets of different kinds: floats from a table, integers from the pixel's place.
#include "lib/place.glsl"
#include "lib/place.glsl"

uniform sampler2D table;
uniform vec3 scale;
uniform int image_width;

layout(location = 0) out vec4 out_floats;
layout(location = 1) out uvec4 out_uints;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 texel = texelFetch(table, at, 0);
    out_floats = vec4(texel.xyz * scale, texel.w);
    out_uints = uvec4(place(at, image_width), 0xFFFFFFFFu, at);
}
