#include "core/scene_needs.h"

#include <algorithm>

namespace onepass {

SceneNeeds scene_needs(const Scene& scene, const RenderSettings& settings) {
    const bool reflects =
        std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
            return std::any_of(
                instance.materials.begin(), instance.materials.end(),
                [&](uint32_t material) { return scene.materials[material].reflectivity > 0.0f; });
        });
    SceneNeeds needs;
    needs.light_count = static_cast<uint32_t>(scene.lights.size());
    needs.max_depth = reflects ? settings.max_depth : 0;
    needs.shadows = settings.shadows && needs.light_count > 0;
    needs.smooth_normals =
        std::any_of(scene.objects.begin(), scene.objects.end(),
                    [](const Object& object) { return !object.normals.empty(); });
    return needs;
}

}  // namespace onepass
