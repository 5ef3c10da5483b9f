// Growth over fakes whose costs follow known laws: what is measured, kept, judged and fitted.
#include "compare/growth.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

constexpr uint64_t kMostTriangles = 50'000;  ///< of the growing fake

/// One triangle, said to be many: the fakes only look at the count.
ScenePtr scene_of(uint64_t triangles) {
    Scene scene;
    scene.name = "many-" + std::to_string(triangles);
    Object object;
    object.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    object.triangles.assign(triangles, uvec3(0, 1, 2));
    object.groups = {{"all", 0, static_cast<uint32_t>(triangles)}};
    scene.objects = {object};
    scene.instances = {{"one", 0, affine_identity(), {0}}};
    scene.materials = {Material{}};
    scene.cameras = {automatic_camera(scene_bounds(scene))};
    return std::make_shared<const Scene>(scene);
}

/// Builds in n ms / 1000, takes 10 n bytes, and traces in sqrt(n) ms, by its own timer in a tenth.
CatalogueEntry fake_entry(const std::string& name, bool on_device) {
    CatalogueEntry entry;
    entry.info.name = name;
    entry.make = [name, on_device](ScenePtr scene, const ParamValues&) {
        const double n = static_cast<double>(instanced_triangle_count(*scene));
        if (on_device && n > kMostTriangles) {
            throw Error({name, "too many triangles", "fewer", "Take fewer."});
        }
        auto tracer = std::make_unique<FakeTracer>(name);
        tracer->cast_ms = std::sqrt(n);
        tracer->abilities.device_timer = on_device;
        if (on_device) tracer->device_ms = [n] { return 0.1 * std::sqrt(n); };
        tracer->figures = {{"build_ms", 0.75e-3 * n, ""},
                           {"pack_ms", 0.25e-3 * n, ""},
                           {"device_bytes", 10.0 * n, ""},
                           {"cells", 5.0 * n, ""},
                           {"references", 3.0 * n, ""}};
        return tracer;
    };
    return entry;
}

struct Study {
    CatalogueEntry oracle = fake_entry("oracle", false);
    CatalogueEntry grid = fake_entry("grid", true);
    GrowthSetup setup;

    Study() {
        setup.contestants = {{&oracle, {}}, {&grid, {}}};
        setup.make_scene = scene_of;
        setup.make_judge = [](ScenePtr) -> std::unique_ptr<Judge> {
            return std::make_unique<FakeJudge>([](const Ray&, const Hit&) { return Verdict{}; });
        };
        setup.shape = "many";
        setup.kinds = {"primary", "random"};
        setup.judged = 10;
        setup.timing = {.repetitions = 9, .warm_up_rounds = 1, .warm_up_ms = 0.0, .seed = 1};
        setup.timing.steadiness.apart_ms = 0.0;
        setup.builds_ms = 1.0;
    }

    Results run(const std::vector<GrowthStep>& steps) const {
        Results all;
        for (const GrowthStep& step : steps) {
            const Results part = measure_growth(setup, step);
            const auto add = [](auto& to, const auto& from) {
                to.insert(to.end(), from.begin(), from.end());
            };
            add(all.growth_builds, part.growth_builds);
            add(all.growth_traces, part.growth_traces);
            add(all.paces, part.paces);
        }
        return all;
    }
};

TEST(GrowthSteps, grow_the_triangles_and_then_the_rays) {
    const std::vector<GrowthStep> steps = growth_steps({10, 20}, {100}, 64, 15);
    ASSERT_EQ(steps.size(), 3u);
    EXPECT_EQ(steps[1].id(), "triangles-20");
    EXPECT_EQ(steps[1].rays, 64u);
    EXPECT_EQ(steps[2].id(), "rays-100");
    EXPECT_EQ(steps[2].triangles, 15u);
    EXPECT_TRUE(steps[2].growing_rays);
}

TEST(MeasureGrowth, records_what_was_built_and_how_it_traced) {
    const Study study;
    const Results results = study.run({{100, 64, false}});
    ASSERT_EQ(results.growth_builds.size(), 2u);
    const GrowthBuild& build = results.growth_builds[1];
    EXPECT_EQ(build.tracer, "grid");
    EXPECT_EQ(build.triangles, 100u);
    EXPECT_EQ(build.build_ms, std::vector<double>(9, 0.1)) << "packing included; 9 are enough";
    EXPECT_EQ(build.bytes, 1000u);
    EXPECT_EQ(build.cells, 500u);
    EXPECT_EQ(build.references, 300u);

    ASSERT_EQ(results.growth_traces.size(), 4u) << "two kinds by two tracers";
    const GrowthTrace& trace = results.growth_traces[3];
    EXPECT_EQ(trace.rays, "random");
    EXPECT_EQ(trace.ray_count, 64u);
    EXPECT_EQ(trace.wall_ms, std::vector<double>(9, 10.0));
    EXPECT_EQ(trace.device_ms, std::vector<double>(9, 1.0));
    EXPECT_TRUE(results.growth_traces[2].device_ms.empty());
    EXPECT_EQ(trace.judged, 10u);
    ASSERT_EQ(results.paces.size(), 2u) << "one a kind";
    EXPECT_EQ(results.paces[0].scene, "many-100");
    EXPECT_TRUE(results.paces[0].steady);
}

TEST(MeasureGrowth, repeats_builds_only_until_their_time_is_used_up) {
    Study study;
    study.setup.builds_ms = 0.25;
    const Results results = study.run({{100, 64, false}});
    EXPECT_EQ(results.growth_builds[1].build_ms.size(), 3u) << "0.1 ms each";
    EXPECT_TRUE(study.run({{100, 64, true}}).growth_builds.empty()) << "another step's";
}

TEST(MeasureGrowth, judges_a_sample_spread_over_all_rays) {
    Study study;
    study.setup.kinds = {"random"};
    size_t judged = 0;
    study.setup.make_judge = [&](ScenePtr) -> std::unique_ptr<Judge> {
        return std::make_unique<FakeJudge>([&](const Ray& ray, const Hit&) {
            ++judged;
            Verdict verdict;
            if (ray.org.x > 0.0f) verdict.hit_class = HitClass::false_miss;
            return verdict;
        });
    };
    study.setup.judged = 64;
    const Results results = study.run({{100, 4096, false}});
    const GrowthTrace& trace = results.growth_traces[1];
    EXPECT_GE(judged, 64u) << "agreement with the oracle is no verdict";
    EXPECT_EQ(trace.judged, 64u);
    // Half of the uniform points are above 0: binomial, 32 with a deviation of 4; five of them.
    EXPECT_NEAR(static_cast<double>(trace.errors), 32.0, 20.0);
}

TEST(MeasureGrowth, keeps_a_failure_to_build_and_goes_on_without_that_tracer) {
    const Study study;
    const Results results = study.run({{kMostTriangles + 1, 64, false}});
    ASSERT_EQ(results.growth_builds.size(), 2u);
    EXPECT_NE(results.growth_builds[1].failure.find("too many triangles"), std::string::npos);
    EXPECT_TRUE(results.growth_builds[1].build_ms.empty());
    for (const GrowthTrace& trace : results.growth_traces) EXPECT_EQ(trace.tracer, "oracle");
}

TEST(MeasureGrowth, leaves_nothing_of_a_step_that_was_stopped) {
    const Study study;
    int calls = 0;
    const Results results =
        measure_growth(study.setup, {100, 64, false}, [&](double) { return ++calls < 12; });
    EXPECT_TRUE(results.growth_builds.empty());
    EXPECT_TRUE(results.growth_traces.empty());
}

TEST(GrowthCurves, find_the_laws_that_the_fakes_follow) {
    using Cost = GrowthCurve::Cost;
    const Study study;
    const Results results = study.run(growth_steps({100, 1000, 10000}, {16, 64}, 64, 400));
    size_t seen = 0;
    for (const GrowthCurve& curve : growth_curves(results)) {
        const double expected = curve.cost == Cost::build_ms || curve.cost == Cost::bytes ? 1.0
                                : curve.over_rays                                         ? 0.0
                                                                                          : 0.5;
        constexpr double kRounding = 1e-9;  // sums of a few logarithms in double
        EXPECT_NEAR(curve.law.exponent, expected, kRounding) << cost_text(curve);
        EXPECT_EQ(curve.x.size(), curve.over_rays ? 2u : 3u);
        const bool timed = curve.cost == Cost::trace_ms && curve.tracer == "grid";
        EXPECT_EQ(curve.by_device, timed);
        ++seen;
    }
    // Two tracers: build and bytes, and two ray kinds over triangles and over rays.
    EXPECT_EQ(seen, 2u * (2u + 2u + 2u));
}

}  // namespace
}  // namespace onepass
