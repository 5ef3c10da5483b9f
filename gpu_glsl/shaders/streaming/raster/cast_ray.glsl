// Raster form: the ray of a texel, where rays are given.
//
// A file of its own, and not a branch, because a driver may keep the textures of a branch that is
// never taken; those of path_ray.glsl do not exist here.
#include "streaming/raster/state.glsl"

TEXTURE2D(ray_origins)     // org, tmin
TEXTURE2D(ray_directions)  // dir, tmax

Ray load_ray(uint control) {
    vec4 origin = FETCH2D(ray_origins, HERE);
    vec4 direction = FETCH2D(ray_directions, HERE);
    return Ray(origin.xyz, origin.w, direction.xyz, direction.w);
}
