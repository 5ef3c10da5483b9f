// Raster form: the ray of a texel, where shade makes the rays of an image.
#include "streaming/raster/state.glsl"

TEXTURE2D(path0_0)
TEXTURE2D(path0_1)
TEXTURE2D(path1_0)
TEXTURE2D(path1_1)

Ray load_ray(uint control) {
    vec4 origin = newest(control, kPathSide, path0_0, path0_1);
    vec4 direction = newest(control, kPathSide, path1_0, path1_1);
    return Ray(origin.xyz, 0.0, direction.xyz, path_tmax(light_of(control)));
}
