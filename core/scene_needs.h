// What a scene asks of a tracer, so that it never pays for what the scene lacks.
#pragma once

#include "core/render_settings.h"
#include "core/scene.h"

namespace onepass {

/// Becomes the typed constants of a shader variant (gpu_glsl) and nothing else.
struct SceneNeeds {
    uint32_t light_count = 0;
    uint32_t max_depth = 0;       ///< mirror bounces; 0 if nothing in the scene reflects
    bool shadows = false;         ///< asked for, and there is a light
    bool smooth_normals = false;  ///< some object has vertex normals

    bool operator==(const SceneNeeds&) const = default;
};

SceneNeeds scene_needs(const Scene& scene, const RenderSettings& settings);

}  // namespace onepass
