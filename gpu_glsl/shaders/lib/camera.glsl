// Primary rays: core/camera.h, word for word.
#pragma once
#include "lib/ray.glsl"

UNIFORM(vec3, camera_eye)
UNIFORM(vec3, camera_corner)
UNIFORM(vec3, camera_dx)
UNIFORM(vec3, camera_dy)

// The ray through the centre of a pixel; (0, 0) is the top left one.
Ray primary_ray(ivec2 pixel) {
    float px = float(pixel.x) + 0.5;
    float py = float(pixel.y) + 0.5;
    PRECISE vec3 dir = camera_corner + camera_dx * px + camera_dy * py;
    return Ray(camera_eye, 0.0, dir, infinity());
}
