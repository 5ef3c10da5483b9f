// Raster form: the ray of a texel, where rays are given.
//
// A file of its own, and not a branch, because a driver may keep the textures of a branch that is
// never taken; those of path_ray.glsl do not exist here.
#include "lib/given_rays.glsl"
#include "streaming/raster/state.glsl"

Ray load_ray(uint control) { return given_ray(HERE); }
