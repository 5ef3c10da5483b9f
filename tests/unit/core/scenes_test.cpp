// The built-in scenes and the shapes they are made of.
#include "scenes/scenes.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/io/import.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/meshes.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;
using test::is_closed;
using test::signed_volumes;

// ---- Shapes ----

const std::vector<vec2> kVase{{0, 0}, {0.5f, 0.1f}, {0.2f, 0.6f}, {0.4f, 1}, {0, 1.1f}};

/// A pointed tube whose outline goes from a diamond to nearly a square.
std::vector<Section> tube(size_t sections) {
    std::vector<Section> result;
    for (size_t i = 0; i < sections; ++i) {
        const auto s = static_cast<float>(i);
        result.push_back({s, 1.0f + 0.1f * s, -0.5f, 0.1f, 0.7f, 1.0f + s});
    }
    return result;
}

TEST(Shapes, have_the_counts_of_the_recipes) {
    EXPECT_EQ(make_sphere(40, 40).triangles.size(), 3120u);
    EXPECT_EQ(make_sphere(24, 13).triangles.size(), 2u * 24 * 12);
    EXPECT_EQ(make_lathe(kVase, 7).triangles.size(), 2u * 7 * 3);
    EXPECT_EQ(make_box(24, 24, 2).triangles.size(), 4u * (24 * 24 + 24 * 2 + 2 * 24));
    EXPECT_EQ(make_box(9, 4, 1).triangles.size(), 4u * (36 + 4 + 9));
    EXPECT_EQ(make_grid(11, 7).triangles.size(), 154u);
    EXPECT_EQ(make_loft(tube(34), 48).triangles.size(), 2u * 48 * 32);
    for (size_t segments : {1u, 4u, 66u}) {
        EXPECT_EQ(make_blade(tube(segments + 1)).triangles.size(), 8 * segments - 2);
    }
}

TEST(Shapes, all_but_grids_are_closed_and_face_outwards) {
    const Object shapes[] = {make_sphere(40, 40),    make_sphere(3, 2),   make_lathe(kVase, 9),
                             make_box(1, 1, 1),      make_box(4, 3, 2),   make_loft(tube(3), 3),
                             make_loft(tube(9), 32), make_blade(tube(2)), make_blade(tube(9))};
    for (const Object& shape : shapes) {
        SCOPED_TRACE(shape.name);
        EXPECT_TRUE(is_closed(shape));
        ASSERT_EQ(signed_volumes(shape).size(), 1u);
        EXPECT_GT(signed_volumes(shape)[0], 0.0);
        EXPECT_EQ(count_degenerate(shape), 0u);
    }
    EXPECT_NEAR(signed_volumes(make_box(4, 3, 2))[0], 1.0, 1e-6);  // float positions
    EXPECT_FALSE(is_closed(make_grid(2, 2)));
}

TEST(Shapes, a_grid_faces_up) {
    const Object grid = make_grid(3, 2);
    for (const uvec3& t : grid.triangles) {
        const vec3 normal = glm::cross(grid.positions[t.y] - grid.positions[t.x],
                                       grid.positions[t.z] - grid.positions[t.x]);
        EXPECT_GT(normal.y, 0.0f);
    }
}

TEST(Shapes, vertex_normals_agree_with_the_triangles) {
    for (const Object& shape : {make_sphere(20, 10), make_lathe(kVase, 16)}) {
        ASSERT_EQ(shape.normals.size(), shape.positions.size());
        for (const uvec3& t : shape.triangles) {
            const vec3 face = glm::cross(shape.positions[t.y] - shape.positions[t.x],
                                         shape.positions[t.z] - shape.positions[t.x]);
            const vec3 mean = shape.normals[t.x] + shape.normals[t.y] + shape.normals[t.z];
            EXPECT_GT(glm::dot(face, mean), 0.0f);
        }
    }
}

TEST(Shapes, the_triangles_of_convex_shapes_face_away_from_their_middle) {
    const std::vector<Section> taper = {
        {-1, 0.6f, -0.4f, 0, 0.4f}, {0, 1, -0.7f, 0.1f, 0.7f}, {1, 0, 0, 0, 0}};
    for (const Object& shape : {make_sphere(12, 7), make_box(2, 3, 4), make_blade(taper)}) {
        for (const uvec3& t : shape.triangles) {
            const vec3 v0 = shape.positions[t.x];
            const vec3 face = glm::cross(shape.positions[t.y] - v0, shape.positions[t.z] - v0);
            EXPECT_GT(glm::dot(face, v0 - vec3(0, 0.05f, 0)), 0.0f) << shape.name;
        }
    }
}

TEST(Shapes, a_loft_follows_its_sections) {
    const Section sections[] = {{0, 0, 0, 0.5f, 0}, {1, 2, -1, 0.5f, 3, 4}, {2, 0, 0, 0.5f, 0}};
    const Object loft = make_loft(sections, 8);
    EXPECT_EQ(object_bounds(loft), (Bounds{vec3(-2, -1, 0), vec3(2, 3, 2)}));
    // The corner of a superellipse of exponent 4: at 45 degrees both terms are one half.
    const float corner = std::pow(0.5f, 0.25f);
    EXPECT_NEAR(loft.positions[2].x, 2 * corner, 1e-6f);
    EXPECT_NEAR(loft.positions[2].y, 0.5f + 2.5f * corner, 1e-6f);
}

TEST(Shapes, spanning_places_a_leg_between_two_points) {
    const vec3 foot(1, 2, 3), top(-2, 5, 4);
    const Affine m = spanning(foot, top);
    constexpr float kRounding = 1e-6f;  // a few ulps of coordinates up to 5
    EXPECT_LT(glm::length(transform_point(m, vec3(0)) - foot), kRounding);
    EXPECT_LT(glm::length(transform_point(m, vec3(0, 1, 0)) - top), kRounding);
    EXPECT_NEAR(glm::length(m[0]), 1.0f, kRounding);
    EXPECT_NEAR(glm::length(m[2]), 1.0f, kRounding);
    EXPECT_NEAR(glm::dot(m[0], m[1]), 0.0f, kRounding);
    EXPECT_GT(determinant(m), 0.0);
}

TEST(Shapes, appended_parts_become_groups) {
    Object object;
    append_shape(object, make_box(1, 1, 1), translation(vec3(5, 0, 0)), "first");
    append_shape(object, make_grid(1, 1), affine_identity(), "second");
    ASSERT_EQ(object.groups.size(), 2u);
    EXPECT_EQ(object.groups[1], (TriangleGroup{"second", 12, 2}));
    EXPECT_EQ(object_bounds(object), (Bounds{vec3(-0.5f), vec3(5.5f, 0.5f, 0.5f)}));

    // A part of the last group's name joins it; a part may bring groups of its own.
    append_shape(object, make_grid(1, 1), affine_identity(), "second");
    EXPECT_EQ(object.groups.back(), (TriangleGroup{"second", 12, 4}));
    append_shape(object, make_grid(1, 1), affine_identity());
    EXPECT_EQ(object.groups.back(), (TriangleGroup{"grid", 16, 2}));
}

// ---- Generated scenes ----

TEST(Balls1, has_two_mirrors_with_nothing_between_their_centres) {
    const Scene scene = make_balls_1();
    std::vector<vec3> mirrors;
    for (const Instance& instance : scene.instances) {
        if (scene.materials[instance.materials[0]].reflectivity > 0.0f) {
            mirrors.push_back(instance.world_from_object[3]);
        }
    }
    ASSERT_EQ(mirrors.size(), 2u);

    // The line between the centres passes every other ball at more than its radius.
    const vec3 along = mirrors[1] - mirrors[0];
    for (const Instance& instance : scene.instances) {
        const vec3 centre = instance.world_from_object[3];
        if (centre == mirrors[0] || centre == mirrors[1] || instance.name == "floor") continue;
        const float s = glm::dot(centre - mirrors[0], along) / glm::dot(along, along);
        const vec3 nearest = mirrors[0] + along * glm::clamp(s, 0.0f, 1.0f);
        EXPECT_GT(glm::length(centre - nearest), glm::length(instance.world_from_object[0]))
            << instance.name;
    }
}

TEST(Balls1, balls_rest_on_the_floor_without_touching_each_other) {
    const Scene scene = make_balls_1();
    for (size_t i = 1; i < scene.instances.size(); ++i) {
        const Affine& a = scene.instances[i].world_from_object;
        EXPECT_NEAR(a[3].y, glm::length(a[0]), 0.05f) << scene.instances[i].name;
        for (size_t k = 1; k < i; ++k) {
            const Affine& b = scene.instances[k].world_from_object;
            EXPECT_GT(glm::length(a[3] - b[3]), glm::length(a[0]) + glm::length(b[0]))
                << scene.instances[i].name << " and " << scene.instances[k].name;
        }
    }
}

TEST(Instances, are_mirrored_stretched_and_sheared) {
    const Scene scene = make_instances();
    EXPECT_NO_THROW(validate(scene));
    EXPECT_GE(scene.objects.size(), 3u);
    int mirrored = 0, stretched = 0, sheared = 0;
    for (const Instance& instance : scene.instances) {
        const Affine& m = instance.world_from_object;
        mirrored += determinant(m) < 0.0;
        const float lengths[] = {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
        stretched += std::abs(lengths[0] - lengths[1]) > 0.1f;
        sheared += std::abs(glm::dot(m[0], m[1])) > 0.1f * lengths[0] * lengths[1];
    }
    EXPECT_GE(mirrored, 3);
    EXPECT_GE(stretched, 3);
    EXPECT_GE(sheared, 2);
}

TEST(BigSmall, holds_six_large_triangles_and_many_small_ones_in_one_object) {
    const Scene scene = make_big_small();
    EXPECT_NO_THROW(validate(scene));
    ASSERT_EQ(scene.objects.size(), 1u);
    const Object& object = scene.objects[0];
    ASSERT_EQ(object.triangles.size(), 20006u);
    const auto longest_edge = [&](size_t prim_id) {
        const uvec3& t = object.triangles[prim_id];
        return std::max(glm::length(object.positions[t.x] - object.positions[t.y]),
                        glm::length(object.positions[t.x] - object.positions[t.z]));
    };
    for (size_t i = 0; i < 6; ++i) EXPECT_GT(longest_edge(i), 5.0f);
    for (size_t i = 6; i < object.triangles.size(); ++i) EXPECT_LT(longest_edge(i), 0.5f);
}

TEST(LumpyBall, is_closed_and_of_one_shape_at_every_size) {
    double coarser_volume = 0.0;
    for (const uint64_t asked : {8u, 200u, 10'000u, 40'000u}) {
        const Scene scene = make_lumpy_ball(asked);
        validate(scene);
        const Object& ball = scene.objects[0];
        EXPECT_TRUE(is_closed(ball)) << asked;
        EXPECT_EQ(ball.positions.size(), ball.triangles.size() / 2 + 2) << "Euler, of a sphere";
        // 8 m^2 triangles, m rounded: off by less than ((m + 1/2) / m)^2.
        const double m = std::sqrt(static_cast<double>(asked) / 8.0);
        EXPECT_NEAR(static_cast<double>(ball.triangles.size()) / static_cast<double>(asked), 1.0,
                    1.0 / m + 0.25 / (m * m));
        const double volume = signed_volumes(ball).at(0);
        EXPECT_GT(volume, 0.0) << "counter-clockwise from outside";
        if (asked > 10'000) {
            EXPECT_NEAR(volume / coarser_volume, 1.0, 0.01) << "chords cut corners";
        }
        coarser_volume = volume;
    }
    EXPECT_THROW(make_lumpy_ball(7), Error);
}

// ---- By name ----

TEST(LoadScene, knows_every_name_that_it_lists) {
    std::vector<std::string> names;
    for (const SceneInfo& info : builtin_scenes()) names.push_back(info.name);
    EXPECT_EQ(names, (std::vector<std::string>{"balls-1", "chair-wood", "palm-pc", "knife", "sr71a",
                                               "palace", "hind24", "hind24-flying", "instances",
                                               "big-small", "ball-on-ground", "bunny", "cornell",
                                               "motorbike", "buildings", "sr71a-real"}));
    for (const char* name : {"balls-1", "instances", "big-small"}) {
        EXPECT_EQ(load_scene(name).scene.name, name);
    }
}

TEST(LoadScene, lists_the_names_when_it_knows_neither_name_nor_file) {
    const Error error = error_of([] { load_scene("teapot"); });
    EXPECT_TRUE(contains(error.parts().where, "teapot"));
    EXPECT_TRUE(contains(error.parts().expected, "big-small, ball-on-ground, bunny"));
    EXPECT_TRUE(test::is_clear(error));
}

TEST(LoadScene, says_how_to_fetch_a_mesh_that_is_not_at_hand) {
    EXPECT_EQ(how_to_fetch("balls-1"), "");
    const std::filesystem::path installed =
        "/usr/share/games/flightgear/AI/Aircraft/SR-71/Blackbird-SR71A-lowpoly.ac";
    if (std::filesystem::exists(installed)) GTEST_SKIP() << installed << " is installed";

    // Neither this folder nor the one it names holds a mesh.
    const TemporaryFolder folder;
    const std::filesystem::path before = std::filesystem::current_path();
    const char* named = std::getenv("ONEPASS_SCENE_DIR");
    const std::string named_before = named != nullptr ? named : "";
    unsetenv("ONEPASS_SCENE_DIR");
    std::filesystem::current_path(folder.path());
    const std::string fetch = how_to_fetch("sr71a-real");
    const Error error = error_of([] { load_scene("sr71a-real"); });
    std::filesystem::current_path(before);
    if (named != nullptr) setenv("ONEPASS_SCENE_DIR", named_before.c_str(), 1);

    EXPECT_EQ(fetch, "./dev meshes sr71a");
    EXPECT_TRUE(contains(error.parts().remedy, fetch));
    EXPECT_TRUE(test::is_clear(error));
}

/// Loads a real mesh, or skips the test where no package has brought it.
void load_or_skip(const std::string& name, LoadedScene& loaded) {
    try {
        loaded = load_scene(name);
    } catch (const Error& e) {
        if (!contains(e.parts().got, "no such file in")) throw;
        GTEST_SKIP() << e.what();
    }
}

/// The view that published figures of a mesh are measured from, stated once more: 0.75 diagonals of
/// the box from its centre towards `direction`, looking at the centre, 45 degrees from top to
/// bottom.
void expect_published_view(const Scene& scene, const vec3& direction, const vec3& up) {
    constexpr float kRounding = 1e-5f;  // float sums, far below what a pixel of 1024 spans
    ASSERT_FALSE(scene.cameras.empty());
    const Camera& camera = scene.cameras[0];
    const Affine& axes = camera.world_from_camera;
    const Bounds box = scene_bounds(scene);
    const vec3 eye = (axes[3] - box.centre()) / box.diagonal();
    EXPECT_NEAR(glm::distance(eye, 0.75f * glm::normalize(direction)), 0.0f, kRounding);
    EXPECT_NEAR(glm::dot(-axes[2], -glm::normalize(eye)), 1.0f, kRounding) << "at the centre";
    EXPECT_NEAR(glm::dot(axes[0], up), 0.0f, kRounding) << "level";
    EXPECT_GT(glm::dot(axes[1], up), 0.0f);
    EXPECT_NEAR(camera.vertical_fov, 0.25f * 3.14159265f, kRounding);
}

/// What is exported runs where no importer of meshes is: the view has to go along.
void expect_the_same_view_from_glb(const Scene& scene) {
    const TemporaryFolder folder;
    write_gltf(scene, folder.path() / "scene.glb");
    EXPECT_EQ(load_scene((folder.path() / "scene.glb").string()).scene.cameras, scene.cameras);
}

TEST(LoadScene, bunny_has_its_triangles_and_the_published_view) {
    LoadedScene loaded;
    load_or_skip("bunny", loaded);
    if (IsSkipped()) return;
    EXPECT_EQ(instanced_triangle_count(loaded.scene), 69666u);
    EXPECT_TRUE(is_closed(loaded.scene.objects[0]));
    expect_published_view(loaded.scene, vec3(0.3f, 0.25f, 1.0f), vec3(0, 1, 0));
    expect_the_same_view_from_glb(loaded.scene);
}

TEST(LoadScene, cornell_has_its_triangles_and_colours) {
    LoadedScene loaded;
    load_or_skip("cornell", loaded);
    if (IsSkipped()) return;
    EXPECT_EQ(instanced_triangle_count(loaded.scene), 34u);
    EXPECT_EQ(loaded.scene.objects[0].groups.size(), 7u);
    int red = 0, green = 0;
    for (uint32_t material : loaded.scene.instances[0].materials) {
        red += loaded.scene.materials[material].diffuse == vec3(1, 0, 0);
        green += loaded.scene.materials[material].diffuse == vec3(0, 1, 0);
    }
    EXPECT_EQ(red, 1);
    EXPECT_EQ(green, 1);
}

TEST(LoadScene, motorbike_has_its_triangles_in_67_groups_and_the_published_view) {
    LoadedScene loaded;
    load_or_skip("motorbike", loaded);
    if (IsSkipped()) return;
    EXPECT_EQ(instanced_triangle_count(loaded.scene), 331653u);
    EXPECT_EQ(loaded.scene.objects[0].groups.size(), 67u);
    expect_published_view(loaded.scene, vec3(-0.5f, -1.0f, 0.35f), vec3(0, 0, 1));
    expect_the_same_view_from_glb(loaded.scene);
}

TEST(LoadScene, the_real_sr71a_has_148_parts_and_takes_its_stand_ins_place) {
    LoadedScene loaded;
    load_or_skip("sr71a-real", loaded);
    if (IsSkipped()) return;
    const Scene& scene = loaded.scene;
    EXPECT_EQ(instanced_triangle_count(scene), 23201u);
    EXPECT_EQ(scene.objects[0].groups.size(), 148u);

    const Scene stand_in = make_sr71a();
    EXPECT_EQ(scene.cameras, stand_in.cameras);
    EXPECT_EQ(scene.lights, stand_in.lights);
    const Bounds real = scene_bounds(scene), model = scene_bounds(stand_in);
    EXPECT_NEAR(real.centre().z, model.centre().z, 1e-3f);
    // Both aircraft are drawn to size: 32.7 m and 16.9 m.
    EXPECT_NEAR(real.extent().z / model.extent().z, 1.0f, 0.05f);
    EXPECT_NEAR(real.extent().x / model.extent().x, 1.0f, 0.06f);
}

}  // namespace
}  // namespace onepass
