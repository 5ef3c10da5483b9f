// Small scenes for tests, and a comparison of scenes by bits.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "core/scene.h"

namespace onepass::test {

/// One quad of two triangles in the plane z = 0, from -1 to 1, facing +z; one group a triangle, one
/// instance, two materials, a light and a camera at z = 5 that looks at it.
inline Scene quad_scene() {
    Scene scene;
    scene.name = "quad";
    Object quad;
    quad.name = "quad";
    quad.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    quad.triangles = {{0, 1, 2}, {0, 2, 3}};
    quad.groups = {{"lower", 0, 1}, {"upper", 1, 1}};
    scene.objects = {quad};
    scene.materials.resize(2);
    scene.materials[0].name = "first";
    scene.materials[1].name = "second";
    scene.instances = {{"only", 0, affine_identity(), {0, 1}}};
    scene.lights = {{"lamp", vec3(0, 0, 4), vec3(1)}};
    Camera camera = look_at(vec3(0, 0, 5), vec3(0), vec3(0, 1, 0), 0.8f);
    camera.name = "front";
    scene.cameras = {camera};
    return scene;
}

/// Every float of a scene as its bits, so that -0 and 0 differ.
inline std::vector<uint32_t> float_bits(const Scene& scene) {
    std::vector<uint32_t> bits;
    const auto add = [&](float f) { bits.push_back(std::bit_cast<uint32_t>(f)); };
    const auto add_vector = [&](const vec3& v) {
        add(v.x);
        add(v.y);
        add(v.z);
    };
    const auto add_affine = [&](const Affine& m) {
        for (int column = 0; column < 4; ++column) add_vector(m[column]);
    };
    for (const Object& object : scene.objects) {
        for (const vec3& p : object.positions) add_vector(p);
        for (const vec3& n : object.normals) add_vector(n);
    }
    for (const Instance& instance : scene.instances) add_affine(instance.world_from_object);
    for (const Material& material : scene.materials) {
        add_vector(material.diffuse);
        add_vector(material.specular);
        add(material.shininess);
        add(material.reflectivity);
    }
    for (const PointLight& light : scene.lights) {
        add_vector(light.position);
        add_vector(light.intensity);
    }
    for (const Camera& camera : scene.cameras) {
        add_affine(camera.world_from_camera);
        add(camera.vertical_fov);
    }
    for (const AnimatedNode& node : scene.animation.nodes) {
        add_affine(node.parent_from_base);
        add_vector(node.translation);
        add_vector(vec3(node.rotation));
        add(node.rotation.w);
        add_vector(node.scale);
    }
    for (const AnimationChannel& channel : scene.animation.channels) {
        for (float time : channel.times) add(time);
        for (const vec4& value : channel.values) add_vector(vec3(value));
        for (const vec4& value : channel.values) add(value.w);
    }
    for (const CarriedInstance& carried : scene.animation.carried) {
        add_affine(carried.node_from_object);
    }
    add_vector(scene.background);
    add_vector(scene.ambient);
    return bits;
}

/// Equal as values, and every float equal bit by bit.
inline testing::AssertionResult same_bits(const Scene& a, const Scene& b) {
    if (a.name != b.name) return testing::AssertionFailure() << a.name << " and " << b.name;
    if (!(a == b)) return testing::AssertionFailure() << "the scenes differ";
    const std::vector<uint32_t> bits_a = float_bits(a);
    const std::vector<uint32_t> bits_b = float_bits(b);
    for (size_t i = 0; i < bits_a.size(); ++i) {
        if (bits_a[i] != bits_b[i]) {
            return testing::AssertionFailure()
                   << "float " << i << ": " << std::bit_cast<float>(bits_a[i]) << " and "
                   << std::bit_cast<float>(bits_b[i]);
        }
    }
    return testing::AssertionSuccess();
}

}  // namespace onepass::test
