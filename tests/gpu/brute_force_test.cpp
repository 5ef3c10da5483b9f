// Brute force: the same answers as the paper's tracer without its grid, in chunks of any size.
#include <gtest/gtest.h>

#include "compare/hits.h"
#include "core/error.h"
#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kTracers[] = {"brute_force/texture2d/fragment",
                                    "brute_force/texture2d/compute"};

class BruteForce : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (!IsSkipped() && !HasFatalFailure()) catalogue = catalogue_of(context);
    }

    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        return catalogue.at(name).make(scene, params);
    }

    Catalogue catalogue;  ///< its shader library must outlive the tracers
};

TEST_F(BruteForce, finds_what_the_paper_finds_without_its_slack_and_its_cells) {
    for (Scene& made : std::vector<Scene>{make_balls_1(), make_instances(), make_big_small()}) {
        const ScenePtr scene = share(std::move(made));
        std::vector<Ray> rays = primary_rays(*scene, 24, 24);
        for (const Ray& ray : random_rays(scene_bounds(*scene), 500, 5)) rays.push_back(ray);
        const CastResult truth = cast(*embree_tracers().front().make(scene, {}), rays);
        const auto judge = make_exact_judge(scene);
        const auto classes_of = [&](const std::string& name, const ParamValues& params) {
            const CastResult answers = cast(*make(name, scene, params), rays);
            return compare_hits(rays, Query::closest, answers, truth, *judge,
                                {.agreement_sample = 1.0});
        };
        const HitComparison paper = classes_of("paper/texture2d/fragment",
                                               {{"edge_tolerance", "1"}, {"clip_to_cell", "0"}});
        EXPECT_GT(paper.record.hit_count, 300u);
        for (const char* name : kTracers) {
            const HitComparison brute = classes_of(name, {{"edge_tolerance", "1"}});
            EXPECT_EQ(brute.record.errors(), 0u) << name << ", " << scene->name;
            EXPECT_EQ(brute.classes, paper.classes) << name << ", " << scene->name;
        }
    }
}

TEST_F(BruteForce, answers_the_same_for_any_chunk_and_counts_every_test) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 200, 8);
    const uint64_t tests = instanced_triangle_count(*scene);
    for (const char* name : kTracers) {
        const CastResult whole = cast(*make(name, scene), rays, {.counters = true});
        EXPECT_GT(hit_count(whole.hits), 20u);
        for (const RayCounters& c : whole.counters) {
            EXPECT_EQ(c, (RayCounters{0, static_cast<uint32_t>(tests), 0, 1}));
        }
        for (const uint64_t chunk : {tests / 3, uint64_t{997}}) {
            const auto tracer = make(name, scene, {{"chunk", std::to_string(chunk)}});
            const CastResult parts = cast(*tracer, rays, {.counters = true});
            expect_same_bits(whole.hits, parts.hits, name);
            EXPECT_EQ(whole.counters, parts.counters) << name;
            ASSERT_EQ(parts.costs.size(), 1u);
            EXPECT_EQ(parts.costs[0].value, static_cast<double>((tests + chunk - 1) / chunk));
        }
    }
}

TEST_F(BruteForce, flags_the_rays_of_a_chunk_that_the_driver_cuts_short) {
    if (!context->description().software || context->description().jumps) {
        GTEST_SKIP() << "GPUs have no limit of loop turns, nor has Mesa 25";
    }
    Scene sphere;
    sphere.objects.push_back(make_sphere(200, 176));  // 70,000 triangles
    sphere.instances.push_back({.name = "only", .object = 0, .materials = {0}});
    sphere.materials.push_back({});
    sphere.cameras.push_back(automatic_camera(scene_bounds(sphere)));
    const ScenePtr scene = share(std::move(sphere));
    const std::vector<Ray> rays = primary_rays(*scene, 8, 8);
    for (const char* name : kTracers) {
        for (const uint32_t flag : cast(*make(name, scene), rays).flags) {
            EXPECT_EQ(flag & kFlagExhausted, 0u) << name;
        }
        const auto cut = make(name, scene, {{"chunk", "100000"}});
        for (const uint32_t flag : cast(*cut, rays).flags) {
            EXPECT_EQ(flag & kFlagExhausted, kFlagExhausted) << name;
        }
    }
}

TEST_F(BruteForce, casts_only_and_is_taken_only_by_name) {
    const ScenePtr scene = share(make_instances());
    for (const char* name : kTracers) {
        EXPECT_FALSE(catalogue.at(name).info.by_default);
        const auto tracer = catalogue.at(name).make(scene, {});
        EXPECT_FALSE(tracer->capabilities().render);
        EXPECT_TRUE(is_clear(error_of([&] { tracer->render(scene->cameras.front(), {}); })));
        EXPECT_TRUE(cast(*tracer, {}).hits.empty());
        for (const char* chunk : {"0", "-1", "9999999999"}) {
            EXPECT_TRUE(is_clear(error_of([&] { make(name, scene, {{"chunk", chunk}}); })));
        }
    }
}

}  // namespace
}  // namespace onepass::test
