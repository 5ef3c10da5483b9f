// Reads every kind of table that a storage may use, at the pixel's place.
#include "lib/place.glsl"

uniform sampler3D volume;
uniform sampler2D halves;
uniform samplerBuffer floats;
uniform usamplerBuffer uints;
uniform ivec2 image_size;

layout(location = 0) out vec4 out_floats;
layout(location = 1) out uvec4 out_uints;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int k = place(at, image_size.x);
    out_floats = vec4(texelFetch(volume, ivec3(at, 1), 0).x, texelFetch(halves, at, 0).xy,
                      texelFetch(floats, k).x);
    out_uints = uvec4(texelFetch(uints, k).x, 0u, 0u, 0u);
}
