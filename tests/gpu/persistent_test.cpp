// Invocations that take given rays from a queue answer as those do that are given one each.
#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/shading.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/scenes.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kTracers[] = {"grid/buffer/compute", "grid/ssbo/compute",
                                    "bvh/buffer/compute", "bvh/ssbo/compute"};

class Persistent : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const std::string& persistent) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, {{"persistent", persistent}});
    }

    std::optional<Catalogue> catalogue;
};

TEST_F(Persistent, invocations_answer_as_those_do_that_are_given_one_ray_each) {
    for (const Scene& made : {make_balls_1(), make_knife(), make_big_small()}) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = awkward_rays(*scene);
        for (const char* kind : {"primary", "vertex", "edge", "random"}) {
            const std::vector<Ray> some = rays_of_kind(kind, *scene, 16);
            rays.insert(rays.end(), some.begin(), some.end());
        }
        for (const char* name : kTracers) {
            const auto given = make(name, scene, "off");
            const auto taken = make(name, scene, "on");
            for (const Query query : {Query::closest, Query::any}) {
                const CastResult expected = cast(*given, rays, {.query = query});
                const CastResult result = cast(*taken, rays, {.query = query});
                const std::string what = fmt::format("{}, {}", name, scene->name);
                expect_same_bits(result.hits, expected.hits, what);
                EXPECT_EQ(result.flags, expected.flags) << what;
            }
        }
    }
}

// A queue that was not left empty would begin the next cast behind its first ray.
TEST_F(Persistent, any_number_of_rays_is_cast_again_and_again) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> all = random_rays(scene_bounds(*scene), 5000, 3);
    const auto taken = make("grid/buffer/compute", scene, "on");
    const std::vector<Hit> expected = cast(*make("grid/buffer/compute", scene, "off"), all).hits;
    for (const size_t count : {1, 31, 1023, 1024, 1025, 5000, 2048, 5000}) {
        const std::vector<Ray> rays(all.begin(), all.begin() + static_cast<ptrdiff_t>(count));
        const RayBatch batch = taken->upload(rays);
        for (const bool counters : {false, true, false}) {
            const CastResult result = taken->cast(batch, {.counters = counters});
            expect_same_bits(result.hits,
                             {expected.begin(), expected.begin() + static_cast<ptrdiff_t>(count)},
                             fmt::format("{} rays", count));
            EXPECT_EQ(result.counters.size(), counters ? count : 0);
        }
    }
}

// One that ends loops counts the turns of all rays that an invocation casts. (There are more rays
// than invocations where no driver does.)
TEST_F(Persistent, no_driver_ends_the_loops_of_an_invocation_that_casts_many_rays) {
    const ScenePtr scene = share(make_lumpy_ball(20000));
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 3 << 17, 3);
    for (const char* name : {"grid/ssbo/compute", "bvh/ssbo/compute"}) {
        const CastResult expected = cast(*make(name, scene, "off"), rays);
        const CastResult result = cast(*make(name, scene, "on"), rays);
        expect_same_bits(result.hits, expected.hits, name);
        EXPECT_EQ(result.flags, expected.flags) << name;
    }
}

CastForm form_on(const std::string& strategy, const ScenePtr& scene, const Device& device,
                 const ParamValues& params = {}, size_t rays = kManyRays) {
    const std::vector<gl::StrategyInfo> all = gl::ShaderLibrary::embedded().strategies();
    const auto info = std::ranges::find(all, strategy, &gl::StrategyInfo::name);
    return prepare_strategy(*info, "ssbo", scene, params, device).compute_form(rays);
}

TEST(PersistentThreads, are_for_gpus_that_gain_by_them_or_where_asked_for) {
    using enum CastForm;
    const Device gpu = {.limits = {}, .has_ballots = true};
    const ScenePtr one = ball_at(vec3(0.0f), 1.0f);
    const ScenePtr several = share(make_instances());
    EXPECT_EQ(form_on("grid", one, gpu), persistent);
    EXPECT_EQ(form_on("grid", one, gpu, {{"persistent", "off"}}), single);
    EXPECT_EQ(form_on("grid", several, gpu), single);
    EXPECT_EQ(form_on("grid", one, gpu, {{"specialise", "0"}}), single);
    EXPECT_EQ(form_on("grid", several, gpu, {{"persistent", "on"}}), persistent);
    EXPECT_EQ(form_on("bvh", several, gpu), persistent);
    EXPECT_EQ(form_on("flat_grid", one, gpu), single);
    Scene turned = *one;
    turned.instances.front().world_from_object = Affine({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {});
    EXPECT_EQ(form_on("grid", share(turned), gpu), single);
    EXPECT_EQ(form_on("grid", one, {}), single) << "no ballots";
    const Device cpu = {.limits = {}, .is_software = true, .has_ballots = true};
    EXPECT_EQ(form_on("grid", one, cpu), single);
    EXPECT_EQ(form_on("grid", one, cpu, {{"persistent", "on"}}), persistent);
}

TEST(PersistentThreads, are_for_more_rays_than_a_gpu_casts_at_once) {
    using enum CastForm;
    const ScenePtr one = ball_at(vec3(0.0f), 1.0f);
    const Device gpu = {.limits = {}, .has_ballots = true, .processors = 132};
    EXPECT_EQ(form_on("grid", one, gpu, {}, 132 * 1024), single);
    EXPECT_EQ(form_on("grid", one, gpu, {}, 132 * 1024 + 1), persistent);
    EXPECT_EQ(form_on("grid", one, gpu, {{"persistent", "on"}}, 1), persistent);
}

TEST(PersistentThreads, take_rays_by_ballots_where_a_device_has_them) {
    const ScenePtr one = ball_at(vec3(0.0f), 1.0f);
    const auto has = [&](const ParamValues& params, const char* words) {
        const std::string text = compose_tracer_shader(gl::ShaderLibrary::embedded(),
                                                       "grid/ssbo/compute", one, params, nullptr)
                                     .text;
        return text.find(words) != std::string::npos;
    };
    for (const char* words : {"#extension GL_KHR_shader_subgroup_ballot : require",
                              "layout(local_size_x = 1024) in;", "subgroupBallot(true)"}) {
        EXPECT_TRUE(has({}, words)) << words;
        EXPECT_FALSE(has({{"persistent", "off"}}, words)) << words;
    }
    EXPECT_FALSE(has({}, "atomicAdd(rays_taken, 1u)"));
}

}  // namespace
}  // namespace onepass::test
