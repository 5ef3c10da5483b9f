// The small scene of one ray: the same bits, the right neighbours, the same reach; and what is said
// of it.
#include "compare/reproduction.h"

#include <cmath>

#include <gtest/gtest.h>

#include "compare/npy.h"
#include "core/io/load.h"
#include "scenes/shapes.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

/// Two balls, the second placed by a matrix that rounds, and a far one that spans the scene.
Scene three_balls() {
    Scene scene;
    scene.name = "three";
    Object ball = make_sphere(24, 16);
    const auto half = static_cast<uint32_t>(ball.triangles.size() / 2);
    ball.groups = {{"north", 0, half},
                   {"south", half, static_cast<uint32_t>(ball.triangles.size()) - half}};
    scene.objects = {make_sphere(8, 6), ball};
    scene.materials.resize(4);
    for (size_t i = 0; i < 4; ++i) scene.materials[i].shininess = static_cast<float>(10 + i);
    scene.instances.push_back({.name = "far", .object = 0, .materials = {0}});
    scene.instances[0].world_from_object[3] = vec3(900, 0, 0);
    scene.instances.push_back({.name = "first", .object = 1, .materials = {1, 2}});
    scene.instances.push_back({.name = "second", .object = 1, .materials = {2, 3}});
    scene.instances[2].world_from_object =
        Affine(vec3(0.3f, 0.1f, 0), vec3(-0.1f, 0.3f, 0), vec3(0, 0, 0.7f), vec3(0.1f, 4, 0.3f));
    scene.lights = {{"lamp", vec3(0, 0, 4), vec3(1)}};
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    validate(scene);
    return scene;
}

Explanation explanation_of(std::vector<std::pair<uint32_t, uint32_t>> met) {
    Explanation e;
    e.ray = {.org = {0, -5, 0.1f}, .tmin = 0.0f, .dir = {0, 1, 0.01f}, .tmax = kInfinity};
    for (const auto& [inst_id, prim_id] : met) {
        Meeting m;
        m.inst_id = inst_id;
        m.prim_id = prim_id;
        e.truth.hits.push_back(m);
    }
    return e;
}

/// The three corners in the world's numbers as they are stored: object space and matrix.
struct Placed {
    std::array<vec3, 3> corners;
    Affine matrix;
    float shininess;
    bool operator==(const Placed&) const = default;
};
Placed placed(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
    const Instance& instance = scene.instances[inst_id];
    const Object& object = scene.objects[instance.object];
    const uvec3 t = object.triangles[prim_id];
    const uint32_t material = instance.materials[group_of_triangle(object, prim_id)];
    return {{object.positions[t.x], object.positions[t.y], object.positions[t.z]},
            instance.world_from_object,
            scene.materials[material].shininess};
}

TEST(Reproduction, holds_the_triangles_with_their_neighbours_in_the_same_bits) {
    const Scene scene = three_balls();
    const auto last = static_cast<uint32_t>(scene.objects[1].triangles.size() - 1);
    const Reproduction small = make_reproduction(scene, explanation_of({{1, 200}, {2, last}}));
    uint64_t seen = 0;
    for (uint32_t i = 0; i < small.scene.instances.size(); ++i) {
        const Object& object = small.scene.objects[small.scene.instances[i].object];
        for (uint32_t k = 0; k < object.triangles.size(); ++k) {
            const Hit there = small.in_large({1.0f, 0, 0, k, i});
            EXPECT_EQ(placed(small.scene, i, k), placed(scene, there.inst_id, there.prim_id));
            ++seen;
        }
    }
    EXPECT_EQ(seen, instanced_triangle_count(small.scene));

    // Every triangle that shares a corner with triangle 200 is there, and the pole's whole fan.
    const Object& large = scene.objects[1];
    const auto kept = [&](uint32_t prim_id) {
        const auto& ids = small.prim_ids.back();
        return std::find(ids.begin(), ids.end(), prim_id) != ids.end();
    };
    size_t neighbours = 0;
    for (uint32_t k = 0; k < large.triangles.size(); ++k) {
        bool shares = false;
        for (const uint32_t of : {200u, last}) {
            for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    shares |= large.positions[large.triangles[k][a]] ==
                              large.positions[large.triangles[of][b]];
                }
            }
        }
        EXPECT_EQ(kept(k), shares) << k;
        neighbours += shares ? 1 : 0;
    }
    EXPECT_GT(neighbours, 30u);
    EXPECT_LT(neighbours, large.triangles.size() / 4);
}

TEST(Reproduction, keeps_the_reach_of_the_rays_that_count_as_equal) {
    // Alone, the ball's coordinates reach 5 with the ray's origin; the scene's reach 901.
    const Scene scene = three_balls();
    const Reproduction small = make_reproduction(scene, explanation_of({{1, 200}}));
    EXPECT_EQ(std::ilogb(scene_bounds(small.scene).magnitude()),
              std::ilogb(scene_bounds(scene).magnitude()));
    EXPECT_EQ(small.instances, (std::vector<uint32_t>{0, 1}));
    EXPECT_LE(small.prim_ids[0].size(), 6u);

    // From an origin so far away, nothing has to be added.
    Explanation far = explanation_of({{1, 200}});
    far.ray.org.x = 1000.0f;
    EXPECT_EQ(make_reproduction(scene, far).instances, (std::vector<uint32_t>{1}));
}

TEST(Reproduction, of_a_ray_that_meets_nothing_is_still_a_scene) {
    EXPECT_GT(instanced_triangle_count(make_reproduction(three_balls(), explanation_of({})).scene),
              0u);
}

TEST(Reproduction, reloads_bit_by_bit) {
    const TemporaryFolder folder;
    const Reproduction small =
        make_reproduction(three_balls(), explanation_of({{1, 200}, {2, 17}}));
    write_reproduction(small, folder.path());
    EXPECT_TRUE(test::same_bits(load_scene_file(folder.path() / "scene.glb").scene, small.scene));
    const std::vector<Ray> rays = read_rays_npy(folder.path() / "ray.npy");
    ASSERT_EQ(rays.size(), 1u);
    EXPECT_EQ(ray_text(rays[0]), ray_text(small.ray));
}

Statement statement_of(const std::string& tracer, HitClass hit_class, const Hit& hit) {
    Statement s;
    s.tracer = tracer;
    s.verdict.hit_class = hit_class;
    s.hit = hit;
    return s;
}

TEST(Recurrence, asks_for_the_same_class_and_the_same_triangle) {
    Explanation large = explanation_of({{1, 200}, {1, 201}});
    const Reproduction reproduction = make_reproduction(three_balls(), large);
    const auto& ids = reproduction.prim_ids.back();
    const auto here = [&](uint32_t prim_id) {
        return static_cast<uint32_t>(std::find(ids.begin(), ids.end(), prim_id) - ids.begin());
    };
    Explanation small = large;
    // Instance 1 of the small scene is instance 1 of the large one, after the far ball.
    large.statements = {statement_of("a", HitClass::tie, {1, 0, 0, 201, 1}),
                        statement_of("b", HitClass::tie, {1, 0, 0, 201, 1}),
                        statement_of("c", HitClass::false_miss, {}),
                        statement_of("d", HitClass::false_miss, {})};
    small.statements = {statement_of("a", HitClass::tie, {1, 0, 0, here(201), 1}),
                        statement_of("b", HitClass::tie, {1, 0, 0, here(200), 1}),
                        statement_of("c", HitClass::agree, {1, 0, 0, here(200), 1}),
                        statement_of("d", HitClass::false_miss, {})};
    const std::vector<Recurrence> r = compare_statements(reproduction, large, small);
    EXPECT_TRUE(r[0].holds());
    EXPECT_FALSE(r[1].holds());
    EXPECT_FALSE(r[2].holds());
    EXPECT_TRUE(r[3].holds());
    const std::string text = recurrence_text(r);
    EXPECT_NE(text.find("a  reproduces: yes, tie\n"), std::string::npos) << text;
    EXPECT_NE(text.find("b  reproduces: no, tie, by another triangle\n"), std::string::npos);
    EXPECT_NE(text.find("c  reproduces: no, agree instead of false_miss\n"), std::string::npos);

    const std::string readme =
        reproduction_readme(reproduction, small, r, {"Found there.", " -s 'a'", "onepass 1"});
    EXPECT_NE(readme.find("onepass explain scene.glb --ray ray.npy -s 'a'\n"), std::string::npos);
    EXPECT_NE(readme.find("| c | t 1 instance 1 triangle"), std::string::npos) << readme;
    EXPECT_NE(readme.find("| agree | false_miss | no |"), std::string::npos) << readme;
    EXPECT_NE(readme.find("| " + std::to_string(here(201)) + " | 201 |"), std::string::npos)
        << readme;
}

}  // namespace
}  // namespace onepass
