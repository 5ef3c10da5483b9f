// Primary rays. gpu_glsl/shaders/lib/camera.glsl states the same arithmetic for the GPU.
#pragma once

#include <cmath>

#include "core/affine.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// A camera made ready for one image size: the ray through the centre of pixel (x, y) has
/// dir = corner + dx * (x + 0.5) + dy * (y + 0.5). Pixel (0, 0) is the top left one.
///
/// Units: dir has length 1 along the viewing axis, so a primary ray's t is its depth.
struct CameraFrame {
    vec3 eye{0.0f};
    vec3 corner{0.0f};
    vec3 dx{0.0f};
    vec3 dy{0.0f};
};

inline CameraFrame camera_frame(const Camera& camera, uint32_t width, uint32_t height) {
    const float half_height = std::tan(0.5f * camera.vertical_fov);
    const float half_width = half_height * static_cast<float>(width) / static_cast<float>(height);
    const Affine& m = camera.world_from_camera;
    const vec3 right = glm::normalize(m[0]);
    const vec3 up = glm::normalize(m[1]);
    const vec3 back = glm::normalize(m[2]);
    CameraFrame frame;
    frame.eye = m[3];
    frame.corner = up * half_height - right * half_width - back;
    frame.dx = right * (2.0f * half_width / static_cast<float>(width));
    frame.dy = up * (-2.0f * half_height / static_cast<float>(height));
    return frame;
}

inline Ray primary_ray(const CameraFrame& frame, uint32_t x, uint32_t y) {
    const float px = static_cast<float>(x) + 0.5f;
    const float py = static_cast<float>(y) + 0.5f;
    Ray ray;
    ray.org = frame.eye;
    ray.dir = frame.corner + frame.dx * px + frame.dy * py;
    return ray;
}

}  // namespace onepass
