// Auto sizes over a tracer whose counts follow from its density: the best is known beforehand.
#include "compare/auto_sizing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "compare/tuning.h"
#include "core/error.h"
#include "core/grid/sizing.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

/// Counts of a grid: 1,000 l cells... a ray visits `cells` l and tests `tests` / l, so that with
/// equal costs the best density is sqrt(tests / cells).
struct Work {
    uint32_t cells_at(double density) const { return static_cast<uint32_t>(16.0 * density); }
    uint32_t tests_at(double density) const { return static_cast<uint32_t>(tests / density); }
    double tests = 0.0;
};

constexpr CostModel kEqualCosts{.ray = 0.0, .cell = 1.0, .test = 1.0};

/// Objects 0, 1, ... with one instance each; every ray walks through all of them.
CatalogueEntry counting(std::vector<Work> objects, double refused_from = 1e9) {
    CatalogueEntry entry;
    entry.info.name = "grid/x/twin32";
    entry.info.params = {{"density", ParamInfo::Type::real, "5", "", {}},
                         {"top_density", ParamInfo::Type::real, "1", "", {}},
                         {"sizes", ParamInfo::Type::text, "same", "", {}}};
    entry.make = [=](ScenePtr, const ParamValues& params) {
        const double density = std::stod(params.at("density"));
        if (density >= refused_from) throw Error({"cells", "too many", "fewer", "Less."});
        auto tracer = std::make_unique<FakeTracer>("grid/x/twin32");
        tracer->abilities.counters = tracer->abilities.walks = true;
        tracer->cost = {};
        RayWalk way;
        for (uint32_t k = 0; k < objects.size(); ++k) {
            const uint32_t cells = objects[k].cells_at(density);
            const uint32_t tests = objects[k].tests_at(density);
            tracer->cost.cells += cells;
            tracer->cost.tests += tests;
            for (uint32_t c = 0; c < cells; ++c) way.steps.push_back({k, ivec3(0), {}});
            if (cells > 0) way.steps.back().tests.resize(tests);
        }
        tracer->way = way;
        return tracer;
    };
    return entry;
}

ScenePtr scene_of(size_t objects) {
    Scene scene;
    scene.objects.resize(objects);
    for (uint32_t k = 0; k < objects; ++k) {
        scene.objects[k].triangles.resize(1000);
        scene.instances.push_back({.name = "", .object = k, .materials = {}});
    }
    return std::make_shared<const Scene>(std::move(scene));
}

const std::vector<Ray> kSample(kLeastRaysOfObject);

TEST(AutoSizing, takes_the_density_of_the_least_predicted_time) {
    const AutoSizing chosen =
        choose_sizes(counting({{.tests = 16.0 * 64.0}}), scene_of(1), {}, kSample, kEqualCosts);
    EXPECT_EQ(chosen.size.object_density, 8.0) << "16 l + 1024 / l is least at 8";
    EXPECT_EQ(chosen.size.sizes, "");
    EXPECT_EQ(chosen.size.chosen, kAutoSize);
}

TEST(AutoSizing, follows_the_costs) {
    const CostModel dear_cells{.ray = 0.0, .cell = 16.0, .test = 1.0};
    EXPECT_EQ(choose_sizes(counting({{.tests = 16.0 * 64.0}}), scene_of(1), {}, kSample, dear_cells)
                  .size.object_density,
              2.0);
}

TEST(AutoSizing, gives_a_dense_and_a_coarse_object_a_density_of_their_own) {
    const AutoSizing chosen =
        choose_sizes(counting({{.tests = 16.0 * 256.0}, {.tests = 16.0 * 4.0}}), scene_of(2), {},
                     kSample, kEqualCosts);
    EXPECT_EQ(chosen.size.sizes, "16,2");
    EXPECT_EQ(chosen.size.top_density, 1.0) << "the strategy's own";
}

TEST(AutoSizing, leaves_objects_that_few_rays_met_at_the_density_of_the_scene) {
    std::vector<Ray> few(kLeastRaysOfObject - 1);
    const AutoSizing chosen =
        choose_sizes(counting({{.tests = 16.0 * 256.0}, {.tests = 16.0 * 4.0}}), scene_of(2), {},
                     few, kEqualCosts);
    EXPECT_EQ(chosen.size.sizes, "");
}

TEST(AutoSizing, stops_where_the_strategy_refuses_and_says_so_if_that_is_everywhere) {
    const CatalogueEntry limited = counting({{.tests = 16.0 * 64.0}}, 4.0);
    EXPECT_EQ(choose_sizes(limited, scene_of(1), {}, kSample, kEqualCosts).size.object_density,
              2.0);
    EXPECT_THROW(
        choose_sizes(counting({{.tests = 1.0}}, 0.0), scene_of(1), {}, kSample, kEqualCosts),
        Error);
}

TEST(AutoSizing, samples_a_whole_set_evenly) {
    std::vector<Ray> rays(10);
    for (size_t i = 0; i < rays.size(); ++i) rays[i].tmax = static_cast<float>(i);
    const std::vector<Ray> sample = sample_of(rays, 4);
    ASSERT_EQ(sample.size(), 4u);
    EXPECT_EQ(sample[3].tmax, 9.0f);
    EXPECT_EQ(sample_of(rays, 100).size(), 10u);
}

TEST(AutoSizing, is_counted_by_the_twin_of_the_same_storage) {
    Catalogue catalogue;
    catalogue.add(counting({}));
    TracerInfo info;
    info.name = "grid/x/compute";
    ASSERT_NE(counter_of(catalogue, info), nullptr);
    EXPECT_EQ(counter_of(catalogue, info)->info.name, "grid/x/twin32");
    info.name = "grid/y/compute";
    EXPECT_EQ(counter_of(catalogue, info), nullptr);
}

}  // namespace
}  // namespace onepass
