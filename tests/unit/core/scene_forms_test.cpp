// flattened() and unshared(): the same surfaces in other forms.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/scene.h"
#include "core/shading.h"
#include "scenes/scenes.h"
#include "tests/support/errors.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

/// A mirrored and sheared copy of the quad beside the first one, and something that moves.
Scene moving_quads() {
    Scene scene = test::quad_scene();
    Instance second = scene.instances[0];
    second.name = "second";
    second.world_from_object =
        Affine(vec3(-1, 0.2f, 0), vec3(0, 3, 0), vec3(0, 0, 2), vec3(4, 0, 1));
    second.materials = {1, 0};
    scene.instances.push_back(second);
    scene.animation.nodes.resize(1);
    scene.animation.carried = {{1, 0, affine_identity()}};
    return scene;
}

/// Calls visit(inst_id, prim_id, flat prim_id) for every triangle of every instance.
template <class Visit>
void for_each_triangle(const Scene& scene, Visit&& visit) {
    uint32_t flat = 0;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const size_t count = scene.objects[scene.instances[i].object].triangles.size();
        for (uint32_t t = 0; t < count; ++t) visit(i, t, flat++);
    }
}

TEST(Flattened, is_one_object_in_one_instance_that_does_not_move) {
    const Scene flat = flattened(moving_quads());
    EXPECT_NO_THROW(validate(flat));
    ASSERT_EQ(flat.objects.size(), 1u);
    ASSERT_EQ(flat.instances.size(), 1u);
    EXPECT_EQ(flat.instances[0].world_from_object, affine_identity());
    EXPECT_TRUE(flat.animation.empty());
    EXPECT_TRUE(flat.objects[0].normals.empty());
    EXPECT_EQ(flat.objects[0].groups, (std::vector<TriangleGroup>{{"only/lower", 0, 1},
                                                                  {"only/upper", 1, 1},
                                                                  {"second/lower", 2, 1},
                                                                  {"second/upper", 3, 1}}));
    EXPECT_EQ(flat.instances[0].materials, (std::vector<uint32_t>{0, 1, 1, 0}));
}

TEST(Flattened, rounds_each_position_once) {
    const Scene scene = make_instances();
    const Scene flat = flattened(scene);
    const Object& all = flat.objects[0];
    ASSERT_EQ(all.triangles.size(), instanced_triangle_count(scene));
    for_each_triangle(scene, [&](uint32_t inst_id, uint32_t prim_id, uint32_t flat_id) {
        const Affine& m = scene.instances[inst_id].world_from_object;
        const Object& object = scene.objects[scene.instances[inst_id].object];
        for (int corner = 0; corner < 3; ++corner) {
            const vec3 p = object.positions[object.triangles[prim_id][corner]];
            const vec3 world = all.positions[all.triangles[flat_id][corner]];
            for (int axis = 0; axis < 3; ++axis) {
                const long double terms[] = {static_cast<long double>(m[0][axis]) * p.x,
                                             static_cast<long double>(m[1][axis]) * p.y,
                                             static_cast<long double>(m[2][axis]) * p.z,
                                             m[3][axis]};
                long double exact = 0, magnitude = 0;
                for (long double term : terms) {
                    exact += term;
                    magnitude += std::abs(term);
                }
                // Half an ulp for the one rounding to float; three sums in double before it.
                const float ulp =
                    std::nextafter(std::abs(world[axis]), kInfinity) - std::abs(world[axis]);
                const long double allowed = 0.5L * ulp + 3 * 0x1p-53L * magnitude;
                ASSERT_LE(std::abs(world[axis] - exact), allowed)
                    << scene.instances[inst_id].name << ", triangle " << prim_id;
            }
        }
    });
}

TEST(Flattened, shades_like_the_instances_it_came_from) {
    const Scene scene = make_instances();  // with and without normals; mirrored, sheared, stretched
    const Scene flat = flattened(scene);
    const ShadingScene shading(scene), flat_shading(flat);
    // Positions err by 2^-24 of at most 8; the shortest edges are 0.01 long: 5e-5, and as much
    // again for float sums.
    constexpr float kNormalError = 1e-4f;
    float worst = 0.0f;
    for_each_triangle(scene, [&](uint32_t inst_id, uint32_t prim_id, uint32_t flat_id) {
        const Ray ray{.org = vec3(9, 7, 11), .dir = vec3(-0.6f, -0.5f, -0.7f)};
        const Hit hit{1.0f, 0.2f, 0.5f, prim_id, inst_id};
        const Hit flat_hit{1.0f, 0.2f, 0.5f, flat_id, 0};
        const SurfacePoint a = surface_point(shading, ray, hit);
        const SurfacePoint b = surface_point(flat_shading, ray, flat_hit);
        ASSERT_EQ(*a.material, *b.material) << scene.instances[inst_id].name;
        // A triangle seen edge-on may be turned to either side.
        if (std::abs(glm::dot(a.geometric_normal, glm::normalize(ray.dir))) < kNormalError) return;
        worst = std::max({worst, glm::length(a.geometric_normal - b.geometric_normal),
                          glm::length(a.shading_normal - b.shading_normal)});
    });
    EXPECT_LT(worst, kNormalError);
}

TEST(Flattened, refuses_more_triangles_than_an_object_can_number) {
    Scene scene = make_big_small();
    scene.instances.resize(80000, scene.instances[0]);
    const Error error = test::error_of([&] { flattened(scene); });
    EXPECT_TRUE(test::contains(error.parts().got, "1600480000"));
    EXPECT_TRUE(test::is_clear(error));
}

TEST(Unshared, gives_each_instance_an_object_of_its_own) {
    const Scene scene = make_balls_1();
    const Scene copies = unshared(scene);
    EXPECT_NO_THROW(validate(copies));
    ASSERT_EQ(copies.objects.size(), scene.instances.size());
    for (uint32_t i = 0; i < copies.instances.size(); ++i) {
        EXPECT_EQ(copies.instances[i].object, i);
        EXPECT_EQ(copies.objects[i], scene.objects[scene.instances[i].object]);
        EXPECT_EQ(copies.instances[i].world_from_object, scene.instances[i].world_from_object);
    }
}

TEST(Unshared, still_moves_and_flattens_to_the_same) {
    const Scene scene = moving_quads();
    EXPECT_EQ(unshared(scene).animation, scene.animation);
    EXPECT_TRUE(test::same_bits(flattened(unshared(scene)), flattened(scene)));
}

}  // namespace
}  // namespace onepass
