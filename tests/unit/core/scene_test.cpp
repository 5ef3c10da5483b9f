// What validate() promises, and the values derived from a scene.
#include "core/scene.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;
using test::quad_scene;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Defect {
    const char* name;
    std::function<void(Scene&)> make;
    const char* where;  ///< expected in Error::Parts::where
    const char* got;    ///< expected in Error::Parts::got
};

TEST(Validate, accepts_a_sound_scene) { EXPECT_NO_THROW(validate(quad_scene())); }

TEST(Validate, names_the_place_and_the_value_of_every_defect) {
    const Defect defects[] = {
        {"no triangles", [](Scene& s) { s.objects[0].triangles.clear(); }, "object 0 ('quad')",
         "no triangles"},
        {"NaN position", [](Scene& s) { s.objects[0].positions[2].y = kNan; },
         "object 0 ('quad'), vertex 2", "nan"},
        {"inf normal",
         [](Scene& s) {
             s.objects[0].normals.assign(4, vec3(0, 0, 1));
             s.objects[0].normals[3].x = kInfinity;
         },
         "object 0 ('quad'), normal 3", "inf"},
        {"normals of some vertices",
         [](Scene& s) { s.objects[0].normals.assign(3, vec3(0, 0, 1)); }, "object 0", "3 normals"},
        {"index out of range", [](Scene& s) { s.objects[0].triangles[1].y = 4; },
         "triangle 1 (triangle 0 of group 1 ('upper'))", "vertex index 4"},
        {"empty group",
         [](Scene& s) {
             s.objects[0].groups.push_back({"none", 2, 0});
         },
         "group 2 ('none')", "no triangles"},
        {"gap between groups", [](Scene& s) { s.objects[0].groups[1].first_triangle = 2; },
         "group 1 ('upper')", "first triangle 2"},
        {"triangle without a group", [](Scene& s) { s.objects[0].groups.pop_back(); }, "object 0",
         "groups of 1 triangles"},
        {"colour above 1", [](Scene& s) { s.materials[1].diffuse.y = 1.5f; },
         "material 1 ('second')", "diffuse 1.5"},
        {"NaN specular", [](Scene& s) { s.materials[0].specular.x = kNan; }, "material 0",
         "specular nan"},
        {"negative reflectivity", [](Scene& s) { s.materials[0].reflectivity = -0.5f; },
         "material 0", "reflectivity -0.5"},
        {"negative shininess", [](Scene& s) { s.materials[0].shininess = -1.0f; }, "material 0",
         "shininess -1"},
        {"no materials", [](Scene& s) { s.materials.clear(); }, "scene", "no materials"},
        {"no instances", [](Scene& s) { s.instances.clear(); }, "scene", "no instances"},
        {"unknown object", [](Scene& s) { s.instances[0].object = 1; }, "instance 0 ('only')",
         "object 1"},
        {"too few materials", [](Scene& s) { s.instances[0].materials.pop_back(); }, "instance 0",
         "1 materials"},
        {"unknown material", [](Scene& s) { s.instances[0].materials[1] = 2; }, "instance 0",
         "material 2"},
        {"flat transform", [](Scene& s) { s.instances[0].world_from_object[1] = vec3(0); },
         "instance 0", "flattens space"},
        {"NaN transform", [](Scene& s) { s.instances[0].world_from_object[3].z = kNan; },
         "instance 0", "NaN or inf"},
        {"box beyond float",
         [](Scene& s) {
             s.objects[0].positions[0].x = -3e38f;
             s.objects[0].positions[1].x = 3e38f;
         },
         "instance 0", "a box"},
        {"light at infinity", [](Scene& s) { s.lights[0].position.x = kInfinity; },
         "light 0 ('lamp')", "inf"},
        {"dark light", [](Scene& s) { s.lights[0].intensity.z = -1.0f; }, "light 0", "-1"},
        {"flat camera", [](Scene& s) { s.cameras[0].world_from_camera[0] = vec3(0); },
         "camera 0 ('front')", "flattens space"},
        {"no field of view", [](Scene& s) { s.cameras[0].vertical_fov = 0.0f; }, "camera 0",
         "field of view of 0"},
        {"half a turn of view", [](Scene& s) { s.cameras[0].vertical_fov = 3.2f; }, "camera 0",
         "field of view of 3.2"},
        {"NaN background", [](Scene& s) { s.background.x = kNan; }, "scene", "nan"},
        {"inf ambient", [](Scene& s) { s.ambient.x = kInfinity; }, "scene", "inf"},
    };
    for (const Defect& defect : defects) {
        SCOPED_TRACE(defect.name);
        Scene scene = quad_scene();
        defect.make(scene);
        const Error error = error_of([&] { validate(scene); });
        EXPECT_TRUE(contains(error.parts().where, defect.where));
        EXPECT_TRUE(contains(error.parts().got, defect.got));
        EXPECT_TRUE(test::is_clear(error));
    }
}

TEST(Scene, counts_triangles_once_an_instance) {
    Scene scene = quad_scene();
    scene.instances.push_back(scene.instances[0]);
    scene.instances.push_back(scene.instances[0]);
    EXPECT_EQ(instanced_triangle_count(scene), 6u);
}

TEST(Scene, object_bounds_ignore_vertices_without_a_triangle) {
    Scene scene = quad_scene();
    scene.objects[0].positions.push_back(vec3(100));
    EXPECT_EQ(object_bounds(scene.objects[0]), (Bounds{vec3(-1, -1, 0), vec3(1, 1, 0)}));
}

TEST(Scene, bounds_hold_every_instance) {
    Scene scene = quad_scene();
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object[3] = vec3(10, 0, 3);
    const std::vector<Bounds> boxes = instance_bounds(scene);
    ASSERT_EQ(boxes.size(), 2u);
    EXPECT_LE(boxes[1].lower.x, 9.0f);
    EXPECT_GE(boxes[1].upper.x, 11.0f);
    const Bounds all = scene_bounds(scene);
    EXPECT_LE(all.lower.x, -1.0f);
    EXPECT_GE(all.upper.x, 11.0f);
    EXPECT_LT(all.upper.x, 11.001f);
}

TEST(Scene, finds_the_group_of_every_triangle) {
    Object object;
    object.triangles.assign(10, uvec3(0));
    object.groups = {{"a", 0, 3}, {"b", 3, 1}, {"c", 4, 6}};
    for (uint32_t prim_id = 0; prim_id < 10; ++prim_id) {
        EXPECT_EQ(group_of_triangle(object, prim_id), prim_id < 3 ? 0u : prim_id < 4 ? 1u : 2u);
    }
}

}  // namespace
}  // namespace onepass
