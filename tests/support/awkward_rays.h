// Rays that tracers dislike.
#pragma once

#include <limits>
#include <vector>

#include "core/scene.h"
#include "core/types.h"

namespace onepass::test {

/// Along axes, from inside cell planes, of zero length, not finite.
inline std::vector<Ray> awkward_rays(const Scene& scene) {
    const Bounds box = scene_bounds(scene);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays;
    const vec3 axes[] = {{1, 0, 0},  {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0},
                         {0, 0, -1}, {1, 1, 0}, {0, 1, 1}, {1, 0, -1}};
    for (const vec3& axis : axes) {
        for (float s = 0.05f; s < 1.0f; s += 0.1f) {
            const vec3 inside = box.lower + box.extent() * s;
            rays.push_back({inside, 0.0f, axis, kInfinity});
            rays.push_back({inside - axis * box.diagonal(), 0.0f, axis, kInfinity});
        }
    }
    for (const vec3& bad : {vec3(nan), vec3(kInfinity), vec3(0.0f), vec3(nan, 1, 0)}) {
        rays.push_back({box.centre(), 0.0f, bad, kInfinity});
        rays.push_back({bad, 0.0f, vec3(0, -1, 0), kInfinity});
    }
    rays.push_back({box.centre(), nan, vec3(0, -1, 0), kInfinity});
    rays.push_back({box.centre(), 0.0f, vec3(0, -1, 0), nan});
    rays.push_back({box.centre(), 2.0f, vec3(0, -1, 0), 1.0f});
    return rays;
}

}  // namespace onepass::test
