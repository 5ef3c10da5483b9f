// The rays that are given to fragments, one to each or two (lib/grid/pairs.glsl).
//
// They lie in a buffer in the order in which they were given, and go to fragments in that in which
// a software renderer goes through those: in strips 64 wide, one row of blocks of 4 x 4 after the
// other. So it reads them one after the other, and rays that follow each other run together: 8 on
// a CPU, on a GPU the 8 x 4 of a warp, more or less. (device_io.cpp: texel_at.)
#pragma once
#include "lib/ray.glsl"

BUFFER(given_rays)             // of each: org, tmin; dir, tmax
UNIFORM(int, strip_fragments)  // of a strip

// A fragment's place in that order: which ray it is given, if it is given one.
int place_at(ivec2 at) {
    int place = 16 * (at.x >> 2 & 15) + 4 * (at.y & 3) + (at.x & 3);
    return (at.x >> 6) * strip_fragments + (at.y >> 2) * 256 + place;
}

Ray given_ray(int index) {
    vec4 origin = FETCHBUFFER(given_rays, 2 * index);
    vec4 direction = FETCHBUFFER(given_rays, 2 * index + 1);
    return Ray(vec3(origin), origin.w, vec3(direction), direction.w);
}

Ray given_ray(ivec2 at) { return given_ray(place_at(at)); }
