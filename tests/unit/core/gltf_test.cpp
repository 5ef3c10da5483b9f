// glTF: our own scenes survive a round trip bit by bit, foreign files are read with their node
// trees, and broken ones are refused with one clear sentence.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/io/load.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/files.h"
#include "tests/support/gltf_text.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

using test::append_bytes;
using test::contains;
using test::error_of;
using test::gltf_text;
using test::quad_scene;
using test::ScratchFolder;

// ---- Round trips ----

void expect_round_trip(const Scene& scene) {
    const ScratchFolder folder;
    for (const char* name : {"scene.glb", "scene.gltf"}) {
        SCOPED_TRACE(name);
        write_gltf(scene, folder.path() / name);
        const LoadedScene loaded = load_scene_file(folder.path() / name);
        EXPECT_TRUE(test::same_bits(scene, loaded.scene));
    }
}

TEST(GltfRoundTrip, is_bit_equal_for_balls_1) { expect_round_trip(make_balls_1()); }
TEST(GltfRoundTrip, is_bit_equal_for_the_instanced_scene) { expect_round_trip(make_instances()); }
TEST(GltfRoundTrip, is_bit_equal_for_big_small) { expect_round_trip(make_big_small()); }

/// A scene in which everything moves that can, out of the order of any tree walk.
Scene animated_scene() {
    Scene scene = quad_scene();
    Animation& animation = scene.animation;
    animation.name = "all kinds";
    animation.nodes = {
        {.name = "root", .parent = kNoId},
        {.name = "other root",
         .parent = kNoId,
         .parent_from_base = compose(translation(vec3(0.1f, -0.0f, 3)), shear_x_by_y(0.3f)),
         .translation = vec3(-0.0f, 0.7f, 1e-20f),
         .rotation = vec4(0.5f, -0.5f, 0.5f, 0.5f),
         .scale = vec3(1.1f, 0.3f, -2)},
        {.name = "child", .parent = 0, .parent_from_base = scaling(vec3(1.7f))},
        {.name = "", .parent = 1}};
    using Path = AnimationChannel::Path;
    using Interpolation = AnimationChannel::Interpolation;
    animation.channels = {
        {3, Path::scale, Interpolation::step, {0.1f, 0.3f}, {{1, 2, 3, 0}, {0.1f, 2, -0.0f, 0}}},
        {0,
         Path::rotation,
         Interpolation::linear,
         {0, 1},
         {{0, 0, 0, 1}, {0.1f, 0.2f, 0.3f, 0.9f}}},
        {0,
         Path::translation,
         Interpolation::cubic_spline,
         {1.0f / 3.0f},
         {{9, 8, 7, 0}, {0.1f, 0.2f, 0.3f, 0}, {-1, -2, -3, 0}}},
        {2,
         Path::rotation,
         Interpolation::cubic_spline,
         {2},
         {{1, 2, 3, 4}, {0, 0, 0.6f, 0.8f}, {5, 6, 7, 8}}}};

    const std::vector<DAffine> rest = rest_transforms(animation);
    const Affine tilted = compose(rotation(vec3(1, 2, 0), 20), scaling(vec3(0.3f, 1, 2)));
    // The order of instances is that of no walk through the nodes; one stands still between them.
    for (const uint32_t node : {3u, kNoId, 0u, 2u, 0u}) {
        const auto i = static_cast<uint32_t>(scene.instances.size());
        scene.instances.push_back({fmt::format("instance {}", i), 0, tilted, {1, i % 2}});
        if (node == kNoId) continue;
        const Affine node_from_object = i % 2 == 0 ? affine_identity() : tilted;
        scene.instances.back().world_from_object = carried_transform(rest[node], node_from_object);
        animation.carried.push_back({i, node, node_from_object});
    }
    return scene;
}

TEST(GltfRoundTrip, is_bit_equal_for_animated_scenes) {
    expect_round_trip(animated_scene());
    expect_round_trip(make_swarm(5, 2));
}

TEST(GltfRoundTrip, keeps_an_instance_that_stands_a_rounding_beside_its_rest_pose) {
    Scene scene = animated_scene();
    float& x = scene.instances[1].world_from_object[0].x;
    x = std::nextafter(x, 100.0f);
    expect_round_trip(scene);
}

TEST(GltfRoundTrip, an_animated_file_moves_as_the_scene_does) {
    const ScratchFolder folder;
    const Scene scene = make_balls_1();
    write_gltf(scene, folder.path() / "scene.glb");
    const Scene loaded = load_scene_file(folder.path() / "scene.glb").scene;
    for (const double time : {0.0, 0.37, 1.9}) {
        EXPECT_EQ(instance_transforms(loaded, time), instance_transforms(scene, time));
    }
}

TEST(GltfRoundTrip, keeps_the_floats_that_texts_and_sums_lose) {
    Scene scene = quad_scene();
    const float smallest = std::numeric_limits<float>::denorm_min();
    scene.objects[0].positions[0] = vec3(-0.0f, smallest, 16777217.0f);
    scene.objects[0].normals.assign(4, vec3(-0.0f, 0.1f, -1.0f / 3.0f));
    scene.instances[0].world_from_object =
        Affine(vec3(0.1f, -0.0f, 0.0f), vec3(-0.0f, -1.0f / 3.0f, 1e-20f), vec3(0.7f, 0.0f, 1.1f),
               vec3(-0.0f, smallest, 1e30f));
    scene.materials[0].diffuse = vec3(0.1f, 1.0f, -0.0f);
    scene.materials[0].specular = vec3(1.0f / 3.0f, smallest, 0.0f);
    scene.materials[0].shininess = 17.3f;
    scene.materials[0].reflectivity = std::nextafter(1.0f, 0.0f);
    scene.lights[0].position = vec3(-0.0f, 1e-30f, 3.3f);
    scene.lights[0].intensity = vec3(3.7f, smallest, 0.1f);
    for (int i = 1; i < 30; ++i) {  // a bright light's colour is divided on the way
        const auto f = static_cast<float>(i);
        scene.lights.push_back({"bright", vec3(1), vec3(0.1f * f, 3.7f + f, 1.0f / f)});
    }
    scene.lights.push_back({"dim", vec3(1), vec3(0.3f, 0.2f, 0.1f)});
    scene.cameras[0].world_from_camera[3] = vec3(-0.0f, 0.3f, 1e10f);
    scene.cameras[0].vertical_fov = 0.1f;
    scene.background = vec3(-0.0f, 0.1f, 2.5f);
    scene.ambient = vec3(smallest, 0.0f, 1.0f / 3.0f);
    expect_round_trip(scene);
}

TEST(GltfRoundTrip, keeps_objects_without_instances_and_instances_with_other_materials) {
    Scene scene = quad_scene();
    scene.objects.push_back(scene.objects[0]);  // equal, but another object
    scene.objects[1].name = "spare";
    scene.instances.push_back({"swapped", 0, affine_identity(), {1, 0}});
    scene.instances.push_back({"again", 0, affine_identity(), {0, 1}});
    scene.instances.push_back({"", 0, affine_identity(), {1, 1}});
    expect_round_trip(scene);
}

TEST(GltfRoundTrip, keeps_names_with_every_kind_of_character) {
    Scene scene = quad_scene();
    scene.name = "\"quoted\" \\ and \xC3\xA9";
    scene.objects[0].groups[0].name = "";
    scene.objects[0].groups[1].name = "a/b: \t c";
    scene.instances[0].name = "";
    scene.cameras[0].name = "";
    scene.lights[0].name = "";
    expect_round_trip(scene);
}

TEST(WriteGltf, refers_to_its_buffer_by_a_relative_uri_whatever_the_file_name) {
    const ScratchFolder folder;
    const Scene scene = quad_scene();
    const std::filesystem::path path = folder.path() / "50%41 +x y.gltf";
    write_gltf(scene, path);
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "50%41 +x y.bin"));
    EXPECT_TRUE(test::same_bits(scene, load_scene_file(path).scene));
}

TEST(WriteGltf, leaves_nothing_behind_when_it_fails) {
    const ScratchFolder folder;
    Scene scene = quad_scene();
    EXPECT_THROW(write_gltf(scene, folder.path() / "scene.obj"), Error);
    EXPECT_THROW(write_gltf(scene, folder.path() / "missing" / "scene.glb"), Error);
    std::filesystem::create_directory(folder.path() / "taken.glb");
    EXPECT_THROW(write_gltf(scene, folder.path() / "taken.glb"), Error);
    scene.name = "\xFF not UTF-8";
    EXPECT_THROW(write_gltf(scene, folder.path() / "name.glb"), Error);
    scene = quad_scene();
    scene.materials.clear();
    EXPECT_THROW(write_gltf(scene, folder.path() / "invalid.glb"), Error);

    std::filesystem::remove(folder.path() / "taken.glb");
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// ---- Foreign files ----

/// A triangle (0 0 0) (1 0 0) (0 1 0) and a fourth vertex (1 1 0), then indices of 1 and 2 bytes.
struct SmallBuffer {
    std::string bytes;
    size_t positions = 0;
    size_t byte_indices = 0;   ///< 0 1 2, and padding
    size_t short_indices = 0;  ///< 0 1 2 3, for strips and fans

    SmallBuffer() {
        positions = append_bytes<float>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
        byte_indices = append_bytes<uint8_t>(bytes, {0, 1, 2, 0});
        short_indices = append_bytes<uint16_t>(bytes, {0, 1, 2, 3});
    }
};

constexpr const char* kViews =
    R"("bufferViews": [{"buffer": 0, "byteLength": 48},
                       {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
       "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                     {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3},
                     {"bufferView": 1, "byteOffset": 4, "componentType": 5123, "type": "SCALAR",
                      "count": 4}], )";

std::string with_mesh(const std::string& primitive, const std::string& rest) {
    return gltf_text(SmallBuffer().bytes, std::string(kViews) + R"("meshes": [{"primitives": [)" +
                                              primitive + "]}], " + rest);
}

std::string one_node_file(const std::string& primitive) {
    return with_mesh(primitive, R"("nodes": [{"mesh": 0}])");
}

LoadedScene load_text(const std::string& text) {
    const ScratchFolder folder;
    return load_scene_file(folder.write("file.gltf", text));
}

using Triangles = std::vector<uvec3>;

TEST(Gltf, reads_indices_of_every_size_strips_fans_and_none) {
    const auto triangles = [](const std::string& members) {
        return load_text(one_node_file(R"({"attributes": {"POSITION": 0})" + members + "}"))
            .scene.objects[0]
            .triangles;
    };
    EXPECT_EQ(triangles(R"(, "indices": 1)"), (Triangles{{0, 1, 2}}));
    EXPECT_EQ(triangles(R"(, "indices": 2, "mode": 5)"), (Triangles{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(triangles(R"(, "indices": 2, "mode": 6)"), (Triangles{{1, 2, 0}, {2, 3, 0}}));
    EXPECT_EQ(triangles(R"(, "mode": 5)"), (Triangles{{0, 1, 2}, {1, 3, 2}}));
}

TEST(Gltf, composes_the_transforms_of_a_node_tree) {
    // Parent: moved by (10, 0, 0), turned by 90 degrees about z. Child: twice as large, moved.
    const LoadedScene loaded = load_text(
        with_mesh(R"({"attributes": {"POSITION": 0}, "indices": 1})",
                  R"("nodes": [{"name": "root", "children": [1, 2], "translation": [10, 0, 0],
                      "rotation": [0, 0, 0.70710678118654752, 0.70710678118654752]},
                     {"name": "first", "mesh": 0, "scale": [2, 2, 2], "translation": [1, 0, 0]},
                     {"name": "second", "mesh": 0,
                      "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}],
           "scenes": [{"nodes": [0]}])"));
    ASSERT_EQ(loaded.scene.instances.size(), 2u);
    EXPECT_EQ(loaded.scene.objects.size(), 1u);
    EXPECT_EQ(loaded.scene.instances[0].name, "first");
    const vec3 moved = transform_point(loaded.scene.instances[0].world_from_object, vec3(1, 0, 0));
    EXPECT_NEAR(glm::length(moved - vec3(10, 3, 0)), 0.0f, 1e-6f);  // an ulp of 10
    const Affine& second = loaded.scene.instances[1].world_from_object;
    EXPECT_NEAR(glm::length(transform_point(second, vec3(1, 0, 0)) - vec3(10, 1, 5)), 0.0f, 1e-6f);
}

TEST(Gltf, applies_strides_and_sparse_substitution) {
    std::string bytes;
    // Positions with a float of something else after each.
    append_bytes<float>(bytes, {0, 0, 0, 99, 1, 0, 0, 99, 0, 1, 0, 99});
    append_bytes<uint16_t>(bytes, {2, 0});           // at 48: the vertex to replace, padding
    append_bytes<float>(bytes, {0.0f, 7.0f, 0.5f});  // at 52: its new position
    const LoadedScene loaded = load_text(gltf_text(bytes, R"(
        "bufferViews": [{"buffer": 0, "byteLength": 48, "byteStride": 16},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 4},
                        {"buffer": 0, "byteOffset": 52, "byteLength": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3,
                       "sparse": {"count": 1,
                                  "indices": {"bufferView": 1, "componentType": 5123},
                                  "values": {"bufferView": 2}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}])"));
    EXPECT_EQ(loaded.scene.objects[0].positions,
              (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0.0f, 7.0f, 0.5f}}));
}

TEST(Gltf, supplies_what_is_missing_and_says_so) {
    const LoadedScene loaded =
        load_text(one_node_file(R"({"attributes": {"POSITION": 0}, "mode": 5},
                                                          {"attributes": {"POSITION": 0}, "mode": 0})"));
    EXPECT_EQ(loaded.scene.cameras.size(), 1u);
    EXPECT_EQ(loaded.scene.lights.size(), 1u);
    EXPECT_EQ(loaded.scene.materials.size(), 1u);
    std::string notes;
    for (const std::string& note : loaded.notes) notes += note + "\n";
    EXPECT_TRUE(contains(notes, "no camera"));
    EXPECT_TRUE(contains(notes, "no light"));
    EXPECT_TRUE(contains(notes, "no material"));
    EXPECT_TRUE(contains(notes, "1 primitive without triangles left out"));
}

TEST(Gltf, scales_candelas_and_moves_directional_lights_far_away) {
    const LoadedScene loaded =
        load_text(with_mesh(R"({"attributes": {"POSITION": 0}, "indices": 1})",
                            R"("nodes": [{"mesh": 0},
                     {"translation": [1, 2, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}},
                     {"extensions": {"KHR_lights_punctual": {"light": 1}}},
                     {"extensions": {"KHR_lights_punctual": {"light": 2}}}],
           "extensionsUsed": ["KHR_lights_punctual"],
           "extensions": {"KHR_lights_punctual": {"lights": [
               {"type": "point", "color": [1, 0.5, 0.25], "intensity": 200},
               {"type": "point", "intensity": 50},
               {"type": "directional", "intensity": 3}]}})"));
    ASSERT_EQ(loaded.scene.lights.size(), 3u);
    EXPECT_EQ(loaded.scene.lights[0].position, vec3(1, 2, 3));
    EXPECT_EQ(loaded.scene.lights[0].intensity, vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(loaded.scene.lights[1].intensity, vec3(0.25f));
    EXPECT_EQ(loaded.scene.lights[2].intensity, vec3(1));
    EXPECT_GT(loaded.scene.lights[2].position.z, 100.0f);  // it shines along -z
    std::string notes;
    for (const std::string& note : loaded.notes) notes += note + "\n";
    EXPECT_TRUE(contains(notes, "divided by 200"));
    EXPECT_TRUE(contains(notes, "1 directional light replaced"));
}

TEST(Gltf, facets_primitives_without_normals_beside_others_with_normals) {
    std::string bytes = SmallBuffer().bytes;
    append_bytes<float>(bytes, {0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0});  // at 60; the last is zero
    const LoadedScene loaded = load_text(gltf_text(bytes, R"(
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 60, "byteLength": 48}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                      {"bufferView": 1, "componentType": 5126, "type": "VEC3", "count": 4}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "mode": 5},
                                   {"attributes": {"POSITION": 0}, "mode": 5}]}],
        "nodes": [{"mesh": 0}])"));
    const Object& object = loaded.scene.objects[0];
    ASSERT_EQ(object.groups.size(), 2u);
    ASSERT_EQ(object.normals.size(), object.positions.size());
    EXPECT_EQ(object.normals[object.triangles[0].x], vec3(0, 1, 0));
    EXPECT_EQ(object.normals[3], vec3(0, 0, 1));  // repaired
    EXPECT_EQ(object.normals[object.triangles[2].x], vec3(0, 0, 1));
    EXPECT_EQ(object.positions[object.triangles[3].y], vec3(1, 1, 0));
}

// ---- Foreign animations ----

/// The triangle under a tree: "still" (a matrix) above "mover" above "mesh", and "aside" with a
/// mesh of its own. Channels are of the members `channels` and `samplers`; `bytes` follow the
/// mesh's.
struct AnimatedFile {
    std::string bytes = SmallBuffer().bytes;
    std::string views = R"({"buffer": 0, "byteLength": 48},
                           {"buffer": 0, "byteOffset": 48, "byteLength": 12})";
    std::string accessors = R"({"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                               {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3})";
    std::string mover = R"("translation": [1, 0, 0])";
    std::string channels;
    std::string samplers;
    std::string more_animations;
    int accessor_count = 2;
    int channel_count = 0;

    /// Adds an accessor of its own view; returns its index.
    template <class T>
    int add(const char* type, size_t components, int component_type, const std::vector<T>& values,
            const char* more = "") {
        while (bytes.size() % 4 != 0) bytes += '\0';
        const size_t offset = append_bytes<T>(bytes, values);
        views += fmt::format(R"(, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}})", offset,
                             values.size() * sizeof(T));
        accessors += fmt::format(
            R"(, {{"bufferView": {}, "componentType": {}, "type": "{}", "count": {}{}}})",
            accessor_count, component_type, type, values.size() / components, more);
        return accessor_count++;
    }
    int add_times(const std::vector<float>& times) { return add("SCALAR", 1, 5126, times); }

    void add_channel(int node, const char* path, int input, int output,
                     const char* interpolation = "LINEAR") {
        const char* comma = channel_count == 0 ? "" : ", ";
        channels += fmt::format(R"({}{{"sampler": {}, "target": {{"node": {}, "path": "{}"}}}})",
                                comma, channel_count++, node, path);
        samplers += fmt::format(R"({}{{"input": {}, "output": {}, "interpolation": "{}"}})", comma,
                                input, output, interpolation);
    }

    std::string text() const {
        return gltf_text(bytes,
                         fmt::format(R"("bufferViews": [{}], "accessors": [{}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
            "cameras": [{{"type": "perspective", "perspective": {{"yfov": 0.8, "znear": 0.1}}}}],
            "nodes": [{{"name": "still", "children": [1], "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 5,0,0,1]}},
                      {{"name": "mover", "children": [2, 3], {}}},
                      {{"name": "mesh", "mesh": 0, "translation": [0, 1, 0]}},
                      {{"name": "eye", "camera": 0, "translation": [0, 0, 9]}},
                      {{"name": "aside", "mesh": 0}}],
            "scenes": [{{"nodes": [0, 4]}}],
            "animations": [{{"name": "first", "channels": [{}], "samplers": [{}]}}{}])",
                                     views, accessors, mover, channels, samplers, more_animations));
    }
};

std::string all_notes(const LoadedScene& loaded) {
    std::string notes;
    for (const std::string& note : loaded.notes) notes += note + "\n";
    return notes;
}

TEST(GltfAnimation, moves_what_hangs_below_an_animated_node) {
    AnimatedFile file;
    file.add_channel(1, "translation", file.add_times({0, 2}),
                     file.add<float>("VEC3", 3, 5126, {0, 0, 0, 4, 0, 0}));
    const LoadedScene loaded = load_text(file.text());
    const Scene& scene = loaded.scene;
    EXPECT_EQ(scene.animation.name, "first");
    ASSERT_EQ(scene.instances.size(), 2u);
    // The still node's matrix: twice as large, moved by 5 along x. At rest the mover is at 1.
    EXPECT_EQ(scene.instances[0].world_from_object[3], vec3(7, 2, 0));
    EXPECT_EQ(instance_transforms(scene, 0.0)[0][3], vec3(5, 2, 0));
    EXPECT_EQ(instance_transforms(scene, 1.0)[0][3], vec3(9, 2, 0));
    EXPECT_EQ(instance_transforms(scene, 1.0)[0][0], vec3(2, 0, 0));
    EXPECT_EQ(instance_transforms(scene, 1.0)[1], affine_identity());
    EXPECT_TRUE(contains(all_notes(loaded), "1 camera of moving nodes stand still here"));
    EXPECT_EQ(scene.cameras[0].world_from_camera[3], vec3(7, 0, 18));
}

TEST(GltfAnimation, reads_rotations_of_every_component_type) {
    // A quarter turn about z, and the identity.
    const float s = std::sqrt(0.5f);
    const auto turned = [&](int accessor_type, const auto& values, const char* more) {
        AnimatedFile file;
        using T = typename std::decay_t<decltype(values)>::value_type;
        const int output = file.add<T>("VEC4", 4, accessor_type, values, more);
        file.add_channel(1, "rotation", file.add_times({0, 1}), output);
        return load_text(file.text()).scene.animation.channels[0].values;
    };
    const char* normalized = R"(, "normalized": true)";
    using Values = std::vector<vec4>;
    EXPECT_EQ(turned(5126, std::vector<float>{0, 0, s, s, 0, 0, 0, 1}, ""),
              (Values{{0, 0, s, s}, {0, 0, 0, 1}}));
    EXPECT_EQ(turned(5120, std::vector<int8_t>{0, 0, -90, 90, 0, 0, -128, 127}, normalized),
              (Values{{0, 0, -90.0f / 127.0f, 90.0f / 127.0f}, {0, 0, -1, 1}}));
    EXPECT_EQ(turned(5121, std::vector<uint8_t>{0, 0, 180, 180, 0, 0, 0, 255}, normalized),
              (Values{{0, 0, 180.0f / 255.0f, 180.0f / 255.0f}, {0, 0, 0, 1}}));
    EXPECT_EQ(
        turned(5122, std::vector<int16_t>{0, 0, 23170, 23170, 0, 0, -32768, 32767}, normalized),
        (Values{{0, 0, 23170.0f / 32767.0f, 23170.0f / 32767.0f}, {0, 0, -1, 1}}));
    EXPECT_EQ(turned(5123, std::vector<uint16_t>{0, 0, 46341, 46341, 0, 0, 0, 65535}, normalized),
              (Values{{0, 0, 46341.0f / 65535.0f, 46341.0f / 65535.0f}, {0, 0, 0, 1}}));
}

TEST(GltfAnimation, reads_steps_and_splines_in_their_layout) {
    AnimatedFile file;
    const int times = file.add_times({0, 1});
    file.add_channel(1, "scale", times, file.add<float>("VEC3", 3, 5126, {1, 1, 1, 2, 2, 2}),
                     "STEP");
    file.add_channel(1, "translation", times,
                     file.add<float>("VEC3", 3, 5126,
                                     {9, 9, 9, 0, 0, 0, 4, 0, 0,  //
                                      0, 0, 0, 1, 0, 0, 9, 9, 9}),
                     "CUBICSPLINE");
    const Scene scene = load_text(file.text()).scene;
    const Affine half = instance_transforms(scene, 0.5)[0];
    EXPECT_EQ(half[0].x, 2.0f) << "the step has not come yet";
    // x(1/2) = 1/8 of the first slope + 1/2 of the second value = 1; then 2 x + 5.
    EXPECT_EQ(half[3].x, 7.0f);
}

TEST(GltfAnimation, says_what_it_leaves_out) {
    AnimatedFile file;
    const int times = file.add_times({0, 1});
    const int places = file.add<float>("VEC3", 3, 5126, {0, 0, 0, 1, 0, 0});
    file.add_channel(1, "translation", times, places);
    file.add_channel(2, "weights", times, times);
    file.add_channel(2, "colour", times, times);
    file.more_animations = R"(, {"name": "second", "channels": [{"sampler": 0,
        "target": {"node": 4, "path": "translation"}}], "samplers": [{"input": 2, "output": 3}]})";
    const LoadedScene loaded = load_text(file.text());
    EXPECT_EQ(loaded.scene.animation.channels.size(), 1u);
    EXPECT_EQ(loaded.scene.animation.carried.size(), 1u);
    const std::string notes = all_notes(loaded);
    EXPECT_TRUE(contains(notes, "1 animation after the first ignored"));
    EXPECT_TRUE(contains(notes, "1 animation channel of morph targets ignored"));
    EXPECT_TRUE(contains(notes, "1 animation channel of other properties ignored"));
}

TEST(GltfAnimation, of_a_camera_alone_leaves_a_static_scene_and_says_so) {
    AnimatedFile file;
    file.add_channel(3, "translation", file.add_times({0, 1}),
                     file.add<float>("VEC3", 3, 5126, {0, 0, 9, 1, 0, 9}));
    const LoadedScene loaded = load_text(file.text());
    EXPECT_EQ(loaded.scene.animation, Animation{});
    EXPECT_TRUE(contains(all_notes(loaded), "animation 0 ('first') moves no mesh: ignored"));
    EXPECT_EQ(loaded.scene.instances[0].world_from_object[3], vec3(7, 2, 0));
}

TEST(GltfAnimation, a_channel_without_a_sampler_is_left_out_aloud) {
    AnimatedFile file;
    const int times = file.add_times({0, 1});
    file.add_channel(1, "translation", times, file.add<float>("VEC3", 3, 5126, {0, 0, 0, 1, 0, 0}));
    file.channels += R"(, {"target": {"node": 1, "path": "scale"}})";
    EXPECT_TRUE(contains(all_notes(load_text(file.text())), "tinygltf left something out"));
}

// ---- Broken files ----

void expect_refused(const std::string& text, const std::string& part) {
    const Error error = error_of([&] { load_text(text); });
    EXPECT_TRUE(contains(error.what(), part));
    EXPECT_TRUE(contains(error.parts().where, "file.gltf"));
    EXPECT_TRUE(test::is_clear(error));
}

constexpr const char* kTriangle = R"({"attributes": {"POSITION": 0}, "indices": 1})";

TEST(BrokenGltf, node_cycles_and_shared_children_are_refused) {
    expect_refused(
        with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}],
                                           "scenes": [{"nodes": [0]}])"),
        "its own descendant");
    expect_refused(
        with_mesh(kTriangle, R"("nodes": [{"children": [2]}, {"children": [2]}, {"mesh": 0}],
                                           "scenes": [{"nodes": [0, 1]}])"),
        "reached twice");
    // Without a scene a pure cycle has no root: nothing is left to show.
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "children": [0]}])"),
                   "no instances");
}

TEST(BrokenGltf, references_out_of_range_are_refused) {
    expect_refused(one_node_file(R"({"attributes": {"POSITION": 7}, "indices": 1})"), "accessor 7");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 3}])"), "mesh 3");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "children": [5]}])"), "node 5");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "camera": 0}])"), "camera 0");
    expect_refused(one_node_file(R"({"attributes": {"POSITION": 0}, "indices": 1, "material": 4})"),
                   "material 4");
}

TEST(BrokenGltf, vertex_indices_and_bytes_out_of_range_are_refused) {
    std::string text = one_node_file(R"({"attributes": {"POSITION": 0}, "indices": 2, "mode": 5})");
    const std::string count = R"("type": "VEC3", "count": 4)";
    std::string fewer = text;
    fewer.replace(fewer.find(count), count.size(), R"("type": "VEC3", "count": 3)");
    expect_refused(fewer, "mesh 0, primitive 0, triangle 1: got vertex index 3");
    std::string more = text;
    more.replace(more.find(count), count.size(), R"("type": "VEC3", "count": 5)");
    expect_refused(more, "5 elements of 12 bytes");
    std::string far_view = text;
    const std::string offset = R"("byteOffset": 48)";
    far_view.replace(far_view.find(offset), offset.size(), R"("byteOffset": 4800)");
    expect_refused(far_view, "4800");
}

TEST(BrokenGltf, numbers_that_are_not_finite_and_flat_transforms_are_refused) {
    std::string bytes = SmallBuffer().bytes;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(bytes.data() + 16, &nan, 4);
    expect_refused(
        gltf_text(bytes, std::string(kViews) +
                             R"("meshes": [{"name": "m", "primitives": [
                                            {"attributes": {"POSITION": 0}, "indices": 1}]}],
                                           "nodes": [{"mesh": 0}])"),
        "mesh 0 ('m'), primitive 0, triangle 0, vertex 1: got a position of (1, nan, 0)");
    expect_refused(
        with_mesh(kTriangle, R"("nodes": [{"name": "n", "mesh": 0, "scale": [1, 0, 1]}])"),
        "instance 0 ('n')");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "matrix": [1, 2, 3]}])"),
                   "3 numbers");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0, "translation": [1e39, 0, 0]}])"),
                   "inf");
}

TEST(BrokenGltf, animations_that_make_no_sense_are_refused) {
    const auto refused = [](const std::string& part, const auto& fill) {
        SCOPED_TRACE(part);
        AnimatedFile file;
        fill(file);
        expect_refused(file.text(), part);
    };
    const std::vector<float> two_places = {0, 0, 0, 1, 0, 0};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto places = [&](AnimatedFile& f) { return f.add<float>("VEC3", 3, 5126, two_places); };
    refused("key 1: got the time 0.5 s", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({1, 0.5f}), places(f));
    });
    refused("the time nan s", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, nan}), places(f));
    });
    refused("2 values", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1, 2}), places(f));
    });
    refused("6 for 2 times, of a cubic spline", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1}), places(f), "CUBICSPLINE");
    });
    refused("(1, nan, 0, 0)", [&](AnimatedFile& f) {
        f.add_channel(1, "scale", f.add_times({0}), f.add<float>("VEC3", 3, 5126, {1, nan, 0}));
    });
    refused("accessor 77", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1}), 77);
    });
    refused("input: got type",
            [&](AnimatedFile& f) { f.add_channel(1, "translation", places(f), places(f)); });
    refused("target node 12", [&](AnimatedFile& f) {
        f.add_channel(12, "translation", f.add_times({0, 1}), places(f));
    });
    refused("'WOBBLY'", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1}), places(f), "WOBBLY");
    });
    refused("sampler 0", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1}), places(f));
        f.samplers = "";
    });
    refused("a second channel", [&](AnimatedFile& f) {
        f.add_channel(1, "translation", f.add_times({0, 1}), places(f));
        f.add_channel(1, "translation", f.add_times({0, 1}), places(f));
    });
    refused("node 0 ('still'): got an animation of a node with a matrix", [&](AnimatedFile& f) {
        f.add_channel(0, "translation", f.add_times({0, 1}), places(f));
    });
    refused("integers of 8 or 16 bits", [&](AnimatedFile& f) {
        f.add_channel(1, "rotation", f.add_times({0}),
                      f.add<int8_t>("VEC4", 4, 5120, {0, 0, 0, 127}));
    });
}

TEST(BrokenGltf, compression_is_refused_by_name) {
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0}],
                       "extensionsRequired": ["KHR_draco_mesh_compression"])"),
                   "KHR_draco_mesh_compression");
    expect_refused(with_mesh(kTriangle, R"("nodes": [{"mesh": 0}],
                       "extensionsRequired": ["KHR_mesh_quantization"])"),
                   "KHR_mesh_quantization");
}

TEST(BrokenGltf, a_file_cut_off_anywhere_is_refused) {
    const ScratchFolder folder;
    write_gltf(quad_scene(), folder.path() / "whole.glb");
    write_gltf(quad_scene(), folder.path() / "whole.gltf");
    for (const char* extension : {".glb", ".gltf"}) {
        const std::string whole =
            test::read_file(folder.path() / ("whole" + std::string(extension)));
        // A final newline is not missed.
        const size_t needed = whole.find_last_not_of(" \n") + 1;
        for (size_t length = 0; length < needed; length += length < 40 ? 1 : 97) {
            const auto cut = folder.write("cut" + std::string(extension), whole.substr(0, length));
            const Error error = error_of([&] { load_scene_file(cut); });
            EXPECT_TRUE(test::is_clear(error)) << extension << " cut to " << length;
        }
    }
}

TEST(BrokenGltf, a_missing_or_short_buffer_file_is_refused) {
    const ScratchFolder folder;
    const std::filesystem::path path = folder.path() / "scene.gltf";
    write_gltf(quad_scene(), path);
    const std::string buffer = test::read_file(folder.path() / "scene.bin");
    folder.write("scene.bin", buffer.substr(0, buffer.size() / 2));
    EXPECT_TRUE(test::is_clear(error_of([&] { load_scene_file(path); })));
    std::filesystem::remove(folder.path() / "scene.bin");
    const Error error = error_of([&] { load_scene_file(path); });
    EXPECT_TRUE(contains(error.what(), "scene.bin"));
}

}  // namespace
}  // namespace onepass
