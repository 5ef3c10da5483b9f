// Small scenes and seeded rays for the tests of cpu_ref, made here so that no generator of the
// program is under test as well.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "core/catalogue.h"
#include "core/scene.h"

namespace onepass::test {

inline void add_triangle(Object& object, const vec3& a, const vec3& b, const vec3& c) {
    const auto first = static_cast<uint32_t>(object.positions.size());
    object.positions.insert(object.positions.end(), {a, b, c});
    object.triangles.push_back({first, first + 1, first + 2});
}

/// Two triangles (a, b, c) and (a, c, d) that share the corners of their diagonal.
inline void add_quad(Object& object, const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
    const auto first = static_cast<uint32_t>(object.positions.size());
    object.positions.insert(object.positions.end(), {a, b, c, d});
    object.triangles.push_back({first, first + 1, first + 2});
    object.triangles.push_back({first, first + 2, first + 3});
}

/// The square |x|, |y| <= half at height z.
inline void add_square(Object& object, float half, float z) {
    add_quad(object, {-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z});
}

/// A closed sphere: `slices` around, `stacks` from pole to pole, poles and seam shared.
inline Object make_sphere(uint32_t slices, uint32_t stacks, float radius, const vec3& centre) {
    Object object;
    object.positions.push_back(centre + vec3(0, 0, radius));
    for (uint32_t i = 1; i < stacks; ++i) {
        const double theta = std::numbers::pi * i / stacks;
        for (uint32_t j = 0; j < slices; ++j) {
            const double phi = 2.0 * std::numbers::pi * j / slices;
            const dvec3 p(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                          std::cos(theta));
            object.positions.push_back(centre + radius * vec3(p));
        }
    }
    object.positions.push_back(centre - vec3(0, 0, radius));

    const auto ring = [&](uint32_t i, uint32_t j) { return 1 + (i - 1) * slices + j % slices; };
    const auto last = static_cast<uint32_t>(object.positions.size() - 1);
    for (uint32_t j = 0; j < slices; ++j) {
        object.triangles.push_back({0, ring(1, j), ring(1, j + 1)});
        for (uint32_t i = 1; i + 1 < stacks; ++i) {
            object.triangles.push_back({ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)});
            object.triangles.push_back({ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)});
        }
        object.triangles.push_back({ring(stacks - 1, j), last, ring(stacks - 1, j + 1)});
    }
    return object;
}

inline void add_instance(Scene& scene, uint32_t object, const Affine& world_from_object,
                         uint32_t material = 0) {
    Instance instance;
    instance.object = object;
    instance.world_from_object = world_from_object;
    instance.materials = {material};
    scene.instances.push_back(instance);
}

/// Returns the object's index.
inline uint32_t add_object(Scene& scene, Object object) {
    object.groups = {{"", 0, static_cast<uint32_t>(object.triangles.size())}};
    scene.objects.push_back(std::move(object));
    return static_cast<uint32_t>(scene.objects.size() - 1);
}

inline ScenePtr checked(Scene scene) {
    validate(scene);
    return std::make_shared<const Scene>(std::move(scene));
}

inline ScenePtr one_object(Object object) {
    Scene scene;
    scene.materials.resize(1);
    add_instance(scene, add_object(scene, std::move(object)), affine_identity());
    return checked(std::move(scene));
}

/// Spheres placed by a rotation, a non-uniform scale with shear, a mirror, and a small scale.
inline ScenePtr instanced_spheres() {
    Scene scene;
    scene.materials.resize(1);
    const uint32_t ball = add_object(scene, make_sphere(24, 16, 1.0f, vec3(0)));
    const uint32_t off_centre = add_object(scene, make_sphere(12, 8, 0.5f, vec3(3, 1, -2)));
    const float c = std::cos(0.7f);
    const float s = std::sin(0.7f);
    add_instance(scene, ball, Affine(vec3(c, s, 0), vec3(-s, c, 0), vec3(0, 0, 1), vec3(-4, 0, 0)));
    add_instance(scene, ball,
                 Affine(vec3(2, 0, 0.3f), vec3(0.5f, 0.25f, 0), vec3(0, 0, 1.5f), vec3(4, 1, 0)));
    add_instance(scene, off_centre,
                 Affine(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(0, 3, 1)));
    add_instance(scene, off_centre,
                 Affine(vec3(0.01f, 0, 0), vec3(0, 0, 0.01f), vec3(0, 0.01f, 0), vec3(0, -3, 0)));
    return checked(std::move(scene));
}

/// Seeded numbers, the same on every machine: only the generator's bits are used.
class Random {
  public:
    explicit Random(uint32_t seed) : bits_(seed) {}
    /// In [0, 1).
    float unit() { return static_cast<float>(bits_() >> 8) * 0x1p-24f; }
    vec3 in_box(const Bounds& b) {
        const vec3 share(unit(), unit(), unit());
        return b.lower + share * b.extent();
    }
    uint32_t below(size_t count) { return static_cast<uint32_t>(bits_() % count); }

  private:
    std::mt19937 bits_;
};

inline Ray ray_between(const vec3& from, const vec3& to) { return {.org = from, .dir = to - from}; }

/// Rays between uniform points of a box twice as large as the scene's.
inline std::vector<Ray> random_rays(const Scene& scene, size_t count, uint32_t seed) {
    Bounds box = scene_bounds(scene);
    const vec3 margin = 0.5f * box.extent();
    box = {box.lower - margin, box.upper + margin};
    Random random(seed);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const vec3 from = random.in_box(box);
        rays.push_back(ray_between(from, random.in_box(box)));
    }
    return rays;
}

/// Rays from random points to corners (every other ray) and middles of edges.
inline std::vector<Ray> edge_rays(const Scene& scene, size_t count, uint32_t seed) {
    Bounds box = scene_bounds(scene);
    const vec3 margin = 0.5f * box.extent();
    box = {box.lower - margin, box.upper + margin};
    Random random(seed);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Instance& instance = scene.instances[random.below(scene.instances.size())];
        const Object& object = scene.objects[instance.object];
        const uvec3 triangle = object.triangles[random.below(object.triangles.size())];
        const vec3 a = transform_point(instance.world_from_object, object.positions[triangle.x]);
        const vec3 b = transform_point(instance.world_from_object, object.positions[triangle.y]);
        const vec3 target = rays.size() % 2 == 0 ? a : 0.5f * (a + b);
        rays.push_back(ray_between(random.in_box(box), target));
    }
    return rays;
}

}  // namespace onepass::test
