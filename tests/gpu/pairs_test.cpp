// Two given rays a fragment answer as one does, bit by bit.
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/shading.h"
#include "scenes/shapes.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kTracers[] = {"grid/buffer/fragment", "grid/ssbo/fragment",
                                    "flat_grid/buffer/fragment", "irregular_grid/buffer/fragment"};

class Pairs : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const std::string& pairs, ParamValues params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        params["pairs"] = pairs;
        return catalogue->at(name).make(scene, params);
    }

    void expect_same(const std::string& name, const ScenePtr& scene, const std::vector<Ray>& rays,
                     const ParamValues& params = {}) {
        const auto one = make(name, scene, "off", params);
        const auto two = make(name, scene, "on", params);
        for (const Query query : {Query::closest, Query::any}) {
            const CastResult alone = cast(*one, rays, {.query = query});
            const CastResult paired = cast(*two, rays, {.query = query});
            const std::string what =
                fmt::format("{}, {}, query {}", name, scene->name, static_cast<int>(query));
            expect_same_bits(paired.hits, alone.hits, what);
            EXPECT_EQ(paired.flags, alone.flags) << what;
        }
    }

    std::optional<Catalogue> catalogue;
};

/// Rays of all kinds, so mixed that those of a pair have nothing in common.
std::vector<Ray> mixed_rays(const ScenePtr& scene) {
    std::vector<Ray> rays;
    for (const char* kind : {"primary", "vertex", "edge", "random", "shadow"}) {
        const std::vector<Ray> some = rays_of_kind(kind, *scene, 24);
        rays.insert(rays.end(), some.begin(), some.end());
    }
    const std::vector<Ray> awkward = awkward_rays(*scene);
    rays.insert(rays.end(), awkward.begin(), awkward.end());
    std::vector<Ray> mixed(rays.size());
    size_t at = 0;
    for (size_t start = 0; start < 13; ++start) {
        for (size_t i = start; i < rays.size(); i += 13) mixed[at++] = rays[i];
    }
    return mixed;
}

TEST_F(Pairs, are_answered_as_each_ray_is_alone) {
    for (const Scene& made : {make_balls_1(), make_instances(), make_big_small(), make_knife()}) {
        const ScenePtr scene = share(made);
        const std::vector<Ray> rays = mixed_rays(scene);
        for (const char* name : kTracers) expect_same(name, scene, rays);
        for (const ParamValues& params :
             {ParamValues{{"decide", "floats"}}, ParamValues{{"test_boxes", "0"}},
              ParamValues{{"skip_empty", "0"}}, ParamValues{{"specialise", "0"}},
              ParamValues{{"records", "floats"}}, ParamValues{{"records", "fixed"}}}) {
            expect_same(kTracers[0], scene, rays, params);
        }
    }
}

TEST_F(Pairs, rays_of_which_floats_leave_too_much_open_are_cast_once_more_alone) {
    // A ball in a hall 1e5 times its size, in one mesh: many of its triangles are open at once.
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& mesh = scene.objects.front();
    mesh = make_sphere(20, 16);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    const Object hall = make_box(8, 8, 8);
    for (const vec3& p : hall.positions) mesh.positions.push_back(1e5f * (p + vec3(0.2f)));
    for (const uvec3& t : hall.triangles) mesh.triangles.push_back(t + uvec3(first));
    mesh.normals.clear();
    mesh.groups = {{"all", 0, uint32_t(mesh.triangles.size())}};
    validate(scene);
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < first; ++i) {
        const vec3& target = mesh.positions[i];
        const vec3 from = (i % 2 ? 3.0f : 2e4f) * mesh.positions[(i * 7) % first];
        rays.push_back({from, 0.0f, target - from, kInfinity});
    }
    const ScenePtr shared = share(scene);
    for (const char* name : kTracers) {
        expect_same(name, shared, rays);
        expect_no_error(*make(name, shared, "on"), shared, rays, name);
    }
}

TEST_F(Pairs, any_number_of_rays_finds_each_ray_its_own_answer) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> all = random_rays(scene_bounds(*scene), 16400, 3);
    const auto one = make(kTracers[0], scene, "off");
    const auto two = make(kTracers[0], scene, "on");
    const std::vector<Hit> expected = cast(*one, all).hits;
    for (const size_t count :
         {1, 7, 8, 9, 15, 16, 17, 24, 4095, 4097, 15871, 15872, 15873, 16400}) {
        const std::vector<Ray> rays(all.begin(), all.begin() + count);
        expect_same_bits(cast(*two, rays).hits, {expected.begin(), expected.begin() + count},
                         fmt::format("{} rays", count));
    }
}

TEST_F(Pairs, work_is_counted_ray_by_ray_from_the_same_batch) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = mixed_rays(scene);
    const auto one = make(kTracers[0], scene, "off");
    const auto two = make(kTracers[0], scene, "on");
    const CastResult expected = cast(*one, rays, {.counters = true});
    const RayBatch batch = two->upload(rays);
    const CastResult quick = two->cast(batch, {});
    const CastResult counted = two->cast(batch, {.counters = true});
    expect_same_bits(quick.hits, expected.hits, "not counted");
    expect_same_bits(counted.hits, expected.hits, "counted");
    ASSERT_EQ(counted.counters.size(), rays.size());
    EXPECT_TRUE(counted.counters == expected.counters);
}

TEST_F(Pairs, of_a_loop_that_the_driver_ends_both_rays_say_so) {
    if (!context->description().software || context->description().jumps) {
        GTEST_SKIP() << "ends no loop";
    }
    const ScenePtr scene = ball_at(vec3(0.0f), 1.0f);
    Scene fine = *scene;
    fine.objects.front() = make_sphere(200, 201);  // 80,000 triangles in one cell
    validate(fine);
    const ScenePtr shared = share(fine);
    const std::vector<Ray> rays = random_rays(scene_bounds(fine), 64, 3);
    const ParamValues params = {{"resolution", "1x1x1"}};
    const std::vector<Hit> expected =
        cast(*catalogue_of(context).at("grid/buffer/twin32").make(shared, params), rays).hits;
    const CastResult result = cast(*make(kTracers[0], shared, "on", params), rays);
    size_t flagged = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if ((result.flags[i] & kFlagExhausted) != 0) {
            ++flagged;
        } else {
            EXPECT_EQ(result.hits[i].t, expected[i].t) << "ray " << i;
        }
    }
    EXPECT_GT(flagged, 0u);
}

TEST(JumpingRenderers, are_those_of_mesa_from_25_on) {
    const std::string cpu = "llvmpipe (LLVM 15.0.6, 256 bits)";
    EXPECT_TRUE(gl::is_jumping_renderer(cpu, "4.5 (Core Profile) Mesa 25.0.7-2~bpo12+1"));
    EXPECT_TRUE(gl::is_jumping_renderer(cpu, "4.5 (Core Profile) Mesa 26.1.0"));
    EXPECT_FALSE(gl::is_jumping_renderer(cpu, "4.5 (Core Profile) Mesa 22.3.6"));
    EXPECT_FALSE(gl::is_jumping_renderer(cpu, "4.5 (Core Profile)"));
    EXPECT_FALSE(gl::is_jumping_renderer("softpipe", "3.3 (Core Profile) Mesa 25.0.7"));
    EXPECT_FALSE(gl::is_jumping_renderer("Mesa Intel(R) Graphics", "4.6 Mesa 25.0.7"));
    EXPECT_FALSE(gl::is_jumping_renderer("NVIDIA H100 80GB HBM3", "4.6.0 NVIDIA 580.95.05"));
}

}  // namespace
}  // namespace onepass::test
