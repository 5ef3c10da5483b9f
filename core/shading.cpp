#include "core/shading.h"

#include <algorithm>

#include "core/error.h"

namespace onepass {

float secondary_offset(const Bounds& scene_bounds) {
    constexpr float kShareOfExtent = 0x1p-17f;
    constexpr float kShareOfCoordinates = 0x1p-20f;
    const vec3 extent = scene_bounds.extent();
    return std::max({extent.x, extent.y, extent.z}) * kShareOfExtent +
           scene_bounds.magnitude() * kShareOfCoordinates;
}

float offset_at(const ShadingScene& scene, const Ray& ray, float t) {
    const vec3 way = glm::abs(ray.dir * t);
    return scene.ray_offset + std::max({way.x, way.y, way.z}) * kOffsetOfWay;
}

ShadingScene::ShadingScene(const Scene& s) : scene(&s) {
    for (const Object& object : s.objects) object_boxes_.push_back(object_bounds(object));
    std::vector<Affine> world_from_object;
    world_from_object.reserve(s.instances.size());
    for (const Instance& instance : s.instances) {
        world_from_object.push_back(instance.world_from_object);
    }
    move(world_from_object);
}

void ShadingScene::move(std::span<const Affine> world_from_object) {
    ONEPASS_CHECK_EQ(world_from_object.size(), scene->instances.size());
    Bounds box;
    object_from_world.clear();
    for (size_t i = 0; i < world_from_object.size(); ++i) {
        box.extend(
            transform_bounds(world_from_object[i], object_boxes_[scene->instances[i].object]));
        object_from_world.push_back(Affine(inverse(world_from_object[i])));
    }
    ray_offset = secondary_offset(box);
}

SurfacePoint surface_point(const ShadingScene& scene, const Ray& ray, const Hit& hit) {
    const Instance& instance = scene.scene->instances[hit.inst_id];
    const Object& object = scene.scene->objects[instance.object];
    const uvec3 triangle = object.triangles[hit.prim_id];
    const Affine& object_from_world = scene.object_from_world[hit.inst_id];

    const vec3 v0 = object.positions[triangle.x];
    const vec3 v1 = object.positions[triangle.y];
    const vec3 v2 = object.positions[triangle.z];
    const vec3 object_normal = glm::normalize(glm::cross(v1 - v0, v2 - v0));

    SurfacePoint point;
    point.position = ray.org + ray.dir * hit.t;
    point.geometric_normal = glm::normalize(transform_normal(object_from_world, object_normal));
    if (glm::dot(point.geometric_normal, ray.dir) > 0.0f) {
        point.geometric_normal = -point.geometric_normal;
    }
    point.origin = point.position + point.geometric_normal * offset_at(scene, ray, hit.t);

    point.shading_normal = point.geometric_normal;
    if (!object.normals.empty()) {
        const vec3 interpolated = object.normals[triangle.x] * (1.0f - hit.u - hit.v) +
                                  object.normals[triangle.y] * hit.u +
                                  object.normals[triangle.z] * hit.v;
        point.shading_normal = glm::normalize(transform_normal(object_from_world, interpolated));
        if (glm::dot(point.shading_normal, point.geometric_normal) < 0.0f) {
            point.shading_normal = -point.shading_normal;
        }
    }

    const uint32_t group = group_of_triangle(object, hit.prim_id);
    point.material = &scene.scene->materials[instance.materials[group]];
    return point;
}

}  // namespace onepass
