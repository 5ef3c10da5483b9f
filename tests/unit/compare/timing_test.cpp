// Timing and sweeps over fake tracers: interleaving, warm-up, samples, partial runs.
#include "compare/timing.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "compare/sweep.h"
#include "core/error.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

RaySet some_rays(size_t count) {
    RaySet rays;
    rays.name = "test";
    rays.rays.resize(count);
    return rays;
}

TimingOptions quick(uint32_t repetitions = 9, uint32_t warm_up_rounds = 2) {
    return {
        .repetitions = repetitions, .warm_up_rounds = warm_up_rounds, .warm_up_ms = 0.0, .seed = 1};
}

struct ThreeTracers {
    std::vector<std::string> log;
    FakeTracer a{"a"}, b{"b"}, c{"c"};
    std::vector<Tracer*> all{&a, &b, &c};

    ThreeTracers() {
        for (FakeTracer* tracer : {&a, &b, &c}) tracer->log = &log;
    }
};

TEST(TimeCasts, casts_every_tracer_once_a_round_in_changing_order) {
    ThreeTracers tracers;
    time_casts(tracers.all, 0, some_rays(1), quick(58, 2));
    ASSERT_EQ(tracers.log.size(), 3u * 60u);
    std::set<std::string> orders;
    for (size_t round = 0; round < 60; ++round) {
        std::string order;
        for (size_t i = 0; i < 3; ++i) order += tracers.log[3 * round + i];
        orders.insert(order);
        std::sort(order.begin(), order.end());
        EXPECT_EQ(order, "abc") << "round " << round;
    }
    EXPECT_EQ(orders.size(), 6u) << "all orders of three come up in 60 rounds";
}

TEST(TimeCasts, keeps_all_samples_but_not_those_of_the_warm_up) {
    ThreeTracers tracers;
    int casts = 0;
    tracers.a.answer = [&](const Ray&) {
        tracers.a.cast_ms = ++casts;  // the n-th cast takes n ms
        return Hit{};
    };
    const auto records = time_casts(tracers.all, 1, some_rays(1), quick(9, 3));
    EXPECT_EQ(records[0].wall_ms, (std::vector<double>{4, 5, 6, 7, 8, 9, 10, 11, 12}));
    EXPECT_EQ(records[0].median_ms, 8.0);
    EXPECT_EQ(records[0].oracle, "b");
    EXPECT_TRUE(records[0].device_ms.empty()) << "NaN means no timer";
}

TEST(TimeCasts, gives_speed_relative_to_the_oracle_and_rates) {
    ThreeTracers tracers;
    tracers.a.cast_ms = 2.0;
    tracers.b.cast_ms = 4.0;
    tracers.c.cast_ms = 8.0;
    const auto records = time_casts(tracers.all, 1, some_rays(1000), quick());
    EXPECT_EQ(records[0].ratio, 2.0) << "twice as fast as b";
    EXPECT_EQ(records[1].ratio, 1.0);
    EXPECT_EQ(records[2].ratio, 0.5);
    EXPECT_EQ(records[2].ratio_low, 0.5);
    EXPECT_EQ(records[2].ratio_high, 0.5);
    EXPECT_EQ(records[0].mrays_per_s, 0.5) << "1000 rays in 2 ms";
}

TEST(TimeCasts, warms_up_for_the_stated_time) {
    ThreeTracers tracers;
    TimingOptions options = quick(9, 1);
    options.warm_up_ms = 5.0;
    time_casts(tracers.all, 0, some_rays(1), options);
    EXPECT_GT(tracers.log.size(), 3u * 10u) << "fakes take far less than 5 ms a round";
}

TEST(TimeCasts, refuses_too_few_repetitions) {
    ThreeTracers tracers;
    EXPECT_THROW(time_casts(tracers.all, 0, some_rays(1), quick(8)), Error);
}

TEST(TimeCasts, returns_whole_rounds_when_stopped) {
    ThreeTracers tracers;
    const Progress stop = [](double done) { return done < 0.5; };
    const auto records = time_casts(tracers.all, 0, some_rays(1), quick(10), stop);
    for (const TimingRecord& record : records) EXPECT_EQ(record.wall_ms.size(), 5u);
}

// Sweeps.

/// A strategy whose speed is best at density 4, and which refuses densities above 16.
CatalogueEntry grid_strategy() {
    CatalogueEntry entry;
    entry.info.name = "grid";
    entry.info.params = {{"density", ParamInfo::Type::real, "5", "cells a triangle", {}},
                         {"top_density", ParamInfo::Type::real, "1.2", "cells an instance", {}}};
    entry.make = [](ScenePtr, const ParamValues& params) {
        const double density = std::stod(params.at("density"));
        if (density > 16.0) {
            throw Error({"grid texture", "too many cells", "at most 4096", "Lower the density."});
        }
        auto tracer = std::make_unique<FakeTracer>("grid");
        tracer->cast_ms = 1.0 + std::abs(density - 4.0);
        tracer->abilities.counters = true;
        tracer->figures = {{"cells", 100.0 * density, ""},
                           {"references", 7.0, ""},
                           {"device_bytes", 1024.0, ""},
                           {"build_ms", 3.5, ""}};
        return tracer;
    };
    return entry;
}

struct SweepSetup {
    ScenePtr scene = std::make_shared<const Scene>();
    FakeTracer oracle{"oracle"};
    FakeJudge judge{[](const Ray&, const Hit&) { return Verdict{}; }};
    SweepOptions options{{1.0, 4.0, 16.0, 64.0}, {}, {}, {}, quick()};
};

TEST(SweepGridSizes, measures_each_density_and_reports_what_was_refused) {
    SweepSetup setup;
    const auto points = sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(10), setup.oracle,
                                         setup.judge, setup.options);
    ASSERT_EQ(points.size(), 4u);
    EXPECT_EQ(points[0].top_density, 1.2) << "the strategy's default";
    EXPECT_EQ(points[1].object_density, 4.0);
    EXPECT_EQ(points[1].cells, 400u);
    EXPECT_EQ(points[1].references, 7u);
    EXPECT_EQ(points[1].bytes, 1024u);
    EXPECT_EQ(points[1].build_ms, 3.5);
    EXPECT_EQ(points[1].cells_per_ray, 3.0);
    EXPECT_EQ(points[1].tests_per_ray, 2.0);
    EXPECT_EQ(points[1].ratio, 1.0);
    EXPECT_EQ(points[0].ratio, 0.25);
    EXPECT_EQ(points[0].wall_ms.size(), 9u);
    EXPECT_NE(points[3].failure.find("too many cells"), std::string::npos);
    EXPECT_TRUE(points[3].wall_ms.empty());
    EXPECT_EQ(best_point(points), &points[1]);
}

TEST(SweepGridSizes, counts_errors_beside_every_size) {
    SweepSetup setup;
    setup.oracle.answer = [](const Ray&) { return Hit{1.0f, 0.0f, 0.0f, 0, 0}; };
    const FakeJudge judge([](const Ray&, const Hit& answer) {
        Verdict verdict;
        if (!answer.is_hit()) verdict.hit_class = HitClass::false_miss;
        return verdict;
    });
    setup.options.object_densities = {4.0};
    const auto points = sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(10), setup.oracle,
                                         judge, setup.options);
    EXPECT_EQ(points[0].errors, 10u);
}

TEST(SweepGridSizes, takes_the_product_of_both_levels) {
    SweepSetup setup;
    setup.options.object_densities = {1.0, 2.0};
    setup.options.top_densities = {0.5, 1.0, 2.0};
    const auto points = sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(1), setup.oracle,
                                         setup.judge, setup.options);
    ASSERT_EQ(points.size(), 6u);
    EXPECT_EQ(points[2].top_density, 1.0);
    EXPECT_EQ(points[2].object_density, 1.0);
}

TEST(SweepGridSizes, drops_a_point_that_was_stopped_before_its_first_round) {
    SweepSetup setup;
    int calls = 0;
    // The first point asks once before it, twice in its warm-up and once a round; the second gets
    // as far as its own warm-up.
    const Progress stop = [&](double) { return ++calls <= 1 + 2 + 9 + 1; };
    const auto points = sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(1), setup.oracle,
                                         setup.judge, setup.options, stop);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].wall_ms.size(), 9u);
}

TEST(SweepGridSizes, refuses_a_strategy_without_a_density) {
    SweepSetup setup;
    CatalogueEntry entry = grid_strategy();
    entry.info.params.clear();
    EXPECT_THROW(sweep_grid_sizes(entry, setup.scene, some_rays(1), setup.oracle, setup.judge,
                                  setup.options),
                 Error);
}

TEST(BestPoint, prefers_fewer_errors_to_speed) {
    std::vector<SweepPoint> points(3);
    points[0].ratio = 2.0;
    points[1].ratio = 3.0;
    points[2].ratio = 9.0;
    points[2].errors = 1;
    EXPECT_EQ(best_point(points), &points[1]);
    EXPECT_EQ(best_point({}), nullptr);
}

}  // namespace
}  // namespace onepass
