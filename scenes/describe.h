// The words that scene descriptions are written in: materials, lights, cameras, and putting things
// into a scene. Internal to scenes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/scene.h"

namespace onepass {

inline constexpr float kSceneFov = 0.698131701f;  ///< 40 degrees

inline Material matte(const char* name, const vec3& color) {
    return {.name = name,
            .diffuse = color,
            .specular = vec3(0),
            .shininess = 1.0f,
            .reflectivity = 0.0f};
}

inline Material glossy(const char* name, const vec3& color, float shininess,
                       float specular = 0.5f) {
    return {.name = name,
            .diffuse = color,
            .specular = vec3(specular),
            .shininess = shininess,
            .reflectivity = 0.0f};
}

inline Material mirror(const char* name, const vec3& color, float reflectivity = 0.85f) {
    return {.name = name,
            .diffuse = color,
            .specular = vec3(0.8f),
            .shininess = 120.0f,
            .reflectivity = reflectivity};
}

inline PointLight light(const char* name, const vec3& position, const vec3& intensity) {
    return {.name = name, .position = position, .intensity = intensity};
}

inline Camera camera(const vec3& eye, const vec3& target, float fov = kSceneFov) {
    Camera result = look_at(eye, target, vec3(0, 1, 0), fov);
    result.name = "main";
    return result;
}

inline uint32_t add_material(Scene& scene, const Material& material) {
    scene.materials.push_back(material);
    return static_cast<uint32_t>(scene.materials.size()) - 1;
}

inline uint32_t add_object(Scene& scene, std::string name, Object object) {
    object.name = std::move(name);
    scene.objects.push_back(std::move(object));
    return static_cast<uint32_t>(scene.objects.size()) - 1;
}

inline void add_instance(Scene& scene, std::string name, uint32_t object,
                         const Affine& world_from_object, std::vector<uint32_t> materials) {
    scene.instances.push_back({std::move(name), object, world_from_object, std::move(materials)});
}

}  // namespace onepass
