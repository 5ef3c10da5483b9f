// Timing and sweeps over fake tracers: interleaving, warm-up, samples, partial runs.
#include "compare/timing.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "compare/cast_counts.h"
#include "compare/sweep.h"
#include "compare/timing_trial.h"
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

TEST(TimeCasts, lets_a_rival_take_turns_and_keeps_its_samples_apart) {
    ThreeTracers tracers;
    FakeTracer rival("r");
    rival.log = &tracers.log;
    rival.cast_ms = 1.5;
    TimingOptions options = quick();
    options.rival = Rival{1, &rival};
    const auto records = time_casts(tracers.all, 0, some_rays(1), options);
    ASSERT_EQ(records.size(), 3u) << "the rival has no record of its own";
    EXPECT_EQ(records[1].again_wall_ms, std::vector<double>(9, 1.5));
    EXPECT_EQ(records[1].wall_ms, std::vector<double>(9, 1.0));
    EXPECT_TRUE(records[0].again_wall_ms.empty());
    EXPECT_EQ(std::count(tracers.log.begin(), tracers.log.end(), "r"), 2 + 9);
    EXPECT_EQ(tracers.log.size(), 4u * (2u + 9u));
}

TEST(CountCast, adds_up_all_rays_and_looks_for_repeated_tests_where_ways_are_told) {
    FakeTracer tracer("counting");
    EXPECT_FALSE(count_cast(tracer, some_rays(10))) << "it does not count";
    tracer.abilities.counters = true;
    const auto counts = count_cast(tracer, some_rays(10));
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->cells, 30u);
    EXPECT_EQ(counts->tests, 20u);
    EXPECT_EQ(counts->references, 40u);
    EXPECT_EQ(counts->walked_rays, 0u);

    tracer.abilities.walks = true;
    // Triangle 7 of instance 0 in two cells; of instance 1 it is another triangle.
    tracer.way =
        RayWalk{{{0, ivec3(0), {{7}, {8}}}, {0, ivec3(1), {{7}}}, {1, ivec3(0), {{7}}}}, {}};
    const auto walked = count_cast(tracer, some_rays(10));
    EXPECT_EQ(walked->walked_rays, 10u);
    EXPECT_EQ(walked->walked_tests, 40u);
    EXPECT_EQ(walked->repeated_tests, 10u);
}

// The timing on trial.

TEST(Slowed, casts_a_twentieth_of_the_rays_twice_and_answers_each_once) {
    auto inner = std::make_unique<FakeTracer>("fake");
    FakeTracer& fake = *inner;
    size_t casts = 0;
    fake.answer = [&](const Ray& ray) {
        ++casts;
        return Hit{ray.tmax, 0.0f, 0.0f, 0, 0};
    };
    const auto tracer = slowed(std::move(inner));
    RaySet rays = some_rays(50);
    for (size_t i = 0; i < 50; ++i) rays.rays[i].tmax = static_cast<float>(i);
    const CastResult cast = tracer->cast(tracer->upload(rays.rays), {});
    EXPECT_EQ(casts, 53u);
    ASSERT_EQ(cast.hits.size(), 50u);
    for (size_t i = 0; i < 50; ++i) EXPECT_EQ(cast.hits[i].t, static_cast<float>(i));
}

/// A strategy of which the n-th tracer made takes factor(n) ms a ray and cast.
CatalogueEntry paced_strategy(std::function<double(int)> factor) {
    CatalogueEntry entry;
    entry.info.name = "paced";
    entry.make = [factor, made = std::make_shared<int>(0)](ScenePtr, const ParamValues&) {
        auto tracer = std::make_unique<FakeTracer>("paced");
        FakeTracer* raw = tracer.get();
        const double ms = factor((*made)++);
        raw->cast_ms = 0.0;
        raw->answer = [raw, ms](const Ray&) {
            raw->cast_ms += ms;  // the time of a cast: read after its last ray
            return Hit{};
        };
        return tracer;
    };
    return entry;
}

TEST(TryTiming, counts_verdicts_on_equals_and_on_the_slowed_one) {
    // cast_ms adds up over casts, so every tracer's pace is the number of its casts so far: in a
    // round all have as many, and the slowed one a twentieth more.
    const TimingTrialOptions options{3, quick()};
    const TimingTrial trial =
        try_timing(paced_strategy([](int) { return 1.0; }), nullptr, {}, some_rays(200), options);
    EXPECT_EQ(trial.comparisons, 3u);
    EXPECT_EQ(trial.called_different(), 0u);
    EXPECT_EQ(trial.found_slower(), 3u);
    EXPECT_TRUE(passed(trial));
    for (const double ratio : trial.slowed_ratio) EXPECT_NEAR(ratio, 1.0 / 1.05, 1e-9);
}

TEST(TryTiming, fails_a_timing_that_calls_equals_different_or_misses_the_slowed_one) {
    // The equal (made third) is 3 % slow, and nothing in the rival tells that places differ.
    const TimingTrialOptions options{3, quick()};
    const TimingTrial fooled = try_timing(paced_strategy([](int n) { return n == 2 ? 1.03 : 1.0; }),
                                          nullptr, {}, some_rays(200), options);
    EXPECT_EQ(fooled.called_different(), 3u);
    EXPECT_FALSE(passed(fooled));
    // The rival (made second) says that equals differ by 10 %: then 5 % cannot be found.
    const TimingTrial blind = try_timing(paced_strategy([](int n) { return n == 1 ? 1.1 : 1.0; }),
                                         nullptr, {}, some_rays(200), options);
    EXPECT_EQ(blind.found_slower(), 0u);
    EXPECT_FALSE(passed(blind));
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

/// A tracer with a timer, whose n-th cast takes pace(n) ms by it.
struct TimedTracers : ThreeTracers {
    int casts = 0;

    explicit TimedTracers(std::function<double(int)> pace) {
        b.abilities.device_timer = true;
        b.device_ms = [this, pace = std::move(pace)] { return pace(casts++); };
    }
};

TimingOptions quick_and_steady() {
    TimingOptions options = quick();
    options.steadiness.apart_ms = 0.0;
    return options;
}

TEST(TimeCasts, keeps_a_device_at_work_until_its_pace_is_steady) {
    // A chip that wakes: twice as slow at first, within 1 % of its best after some 60 casts.
    TimedTracers tracers([](int n) { return 1.0 + std::exp(-n / 13.0); });
    WarmUp seen;
    const auto records = time_casts(tracers.all, 0, some_rays(1), quick_and_steady(), {},
                                    [&](const WarmUp& warm_up) { seen = warm_up; });
    EXPECT_TRUE(seen.steady);
    EXPECT_LE(seen.change, 0.01);
    EXPECT_GT(seen.rounds, 40u);
    // Paces 5 casts apart differ by less than 1 %: the rest to come is at most 1 / (1 - e^(-5/13))
    // of that.
    for (const double ms : records[1].device_ms) EXPECT_LT(ms, 1.035);
    EXPECT_EQ(tracers.log.size() - static_cast<size_t>(tracers.casts), 2u * (2u + 9u))
        << "the others are not kept at work";
}

TEST(TimeCasts, gives_up_on_a_device_that_does_not_hold_its_pace) {
    TimedTracers tracers([](int n) { return 1.0 + n; });
    TimingOptions options = quick_and_steady();
    options.steadiness.change = 0.0;
    options.steadiness.at_most_ms = 5.0;
    WarmUp seen;
    seen.steady = true;
    time_casts(tracers.all, 0, some_rays(1), options, {},
               [&](const WarmUp& warm_up) { seen = warm_up; });
    EXPECT_FALSE(seen.steady);
    EXPECT_GE(seen.ms, 5.0);
}

TEST(TimeCasts, wakes_a_device_before_each_counted_cast) {
    // Of the casts after the warm-up every second counts.
    TimedTracers tracers([](int) { return 1.0; });
    int warmed_at = 0;
    time_casts(tracers.all, 0, some_rays(1), quick_and_steady(), {},
               [&](const WarmUp&) { warmed_at = tracers.casts; });
    EXPECT_EQ(tracers.casts - warmed_at, 2 * 9);
}

TEST(TimeCasts, lets_slow_tracers_go_when_they_have_had_enough) {
    ThreeTracers tracers;
    tracers.a.cast_ms = 100.0;
    tracers.c.cast_ms = 100.0;
    TimingOptions options = quick(30);
    options.enough_ms = 1500.0;
    const auto records = time_casts(tracers.all, 0, some_rays(1), options);
    EXPECT_EQ(records[0].wall_ms.size(), 30u) << "the oracle stays: every ratio needs it";
    EXPECT_EQ(records[1].wall_ms.size(), 30u) << "fast";
    EXPECT_EQ(records[2].wall_ms.size(), 15u) << "1500 ms";
    EXPECT_EQ(records[2].oracle_wall_ms.size(), 15u) << "of the rounds it took part in";
    options.enough_ms = 200.0;
    EXPECT_EQ(time_casts(tracers.all, 0, some_rays(1), options)[2].wall_ms.size(),
              kLeastRepetitions);
}

TEST(DeviceSpeed, is_of_the_devices_own_time_and_absent_without_a_timer) {
    TimedTracers tracers([](int) { return 0.5; });
    tracers.a.cast_ms = 4.0;
    const auto records = time_casts(tracers.all, 0, some_rays(1000), quick_and_steady());
    const DeviceSpeed speed = device_speed(records[1], 0);
    EXPECT_EQ(speed.median_ms, 0.5);
    EXPECT_EQ(speed.mrays_per_s, 2.0);
    EXPECT_EQ(speed.ratio.ratio, 8.0);
    EXPECT_TRUE(std::isnan(device_speed(records[0], 0).mrays_per_s));
    TimingRecord edited = records[0];
    edited.wall_ms.clear();
    EXPECT_TRUE(std::isnan(device_speed(edited, 0).ratio.ratio)) << "no pairs, and no abort";
}

TEST(TimeWithPace, reads_the_clocks_around_the_counted_casts) {
    TimedTracers tracers([](int) { return 1.0; });
    std::vector<int> read_at;
    const DeviceClocks clocks{"a GPU", [&] {
                                  read_at.push_back(tracers.casts);
                                  return ClockReading{1000.0 + tracers.casts, 2000.0, 40.0};
                              }};
    const PacedTimings paced =
        time_with_pace(tracers.all, 0, some_rays(7), quick_and_steady(), clocks);
    ASSERT_TRUE(paced.pace);
    EXPECT_EQ(paced.pace->clocks_of, "a GPU");
    EXPECT_EQ(paced.pace->ray_count, 7u);
    ASSERT_EQ(read_at.size(), 2u);
    EXPECT_EQ(read_at[1] - read_at[0], 2 * 9) << "nothing but the counted casts and their wakers";
    EXPECT_EQ(paced.pace->after->sm_mhz, 1000.0 + read_at[1]);
    ThreeTracers no_timer;
    EXPECT_FALSE(time_with_pace(no_timer.all, 0, some_rays(1), quick(), {}).pace);
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
    SweepOptions options{{1.0, 4.0, 16.0, 64.0}, {}, {}, {}, {}, quick()};
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
    // The first point asks once before it, once before its build, twice in its warm-up and once a
    // round; the second gets as far as its own warm-up.
    const Progress stop = [&](double) { return ++calls <= 1 + 1 + 2 + 9 + 2; };
    const auto points = sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(1), setup.oracle,
                                         setup.judge, setup.options, stop);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].wall_ms.size(), 9u);
}

TEST(SweepGridSizes, leaves_out_what_is_done_and_tells_of_each_point) {
    SweepSetup setup;
    std::vector<double> finished;
    const SweepHooks hooks{[](const GridSize& size) { return size.object_density == 4.0; },
                           [&](const SweepPoint& p) { finished.push_back(p.object_density); }};
    sweep_grid_sizes(grid_strategy(), setup.scene, some_rays(1), setup.oracle, setup.judge,
                     setup.options, {}, hooks);
    EXPECT_EQ(finished, (std::vector<double>{1.0, 16.0, 64.0}));
}

TEST(SweepGridSizes, measures_all_sizes_of_a_search_in_the_same_rounds) {
    SweepSetup setup;
    const RaySet rays = some_rays(4);
    const CatalogueEntry entry = grid_strategy();
    const CastResult truth = setup.oracle.cast(setup.oracle.upload(rays.rays), {});
    const SweepCase sweep{entry, setup.scene, rays, setup.oracle, setup.judge, truth};
    const std::vector<GridSize> sizes = {{1.2, 1.0}, {1.2, 64.0}, {1.2, 4.0}};
    const auto points = measure_together(sweep, sizes, setup.options);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_FALSE(points[1].failure.empty()) << "a refused size keeps its place";
    EXPECT_EQ(points[0].oracle_wall_ms, points[2].oracle_wall_ms);
    EXPECT_EQ(points[0].ray_count, 4u);
    EXPECT_EQ(points[2].wall_ms.size(), 9u);
    EXPECT_EQ(points[2].object_density, 4.0);
}

TEST(SearchSizes, finds_the_best_density_of_a_strategy_that_refuses_fine_grids) {
    SweepSetup setup;
    const RaySet rays = some_rays(1);
    const CatalogueEntry entry = grid_strategy();  // best at 4; refuses above 16
    const CastResult truth = setup.oracle.cast(setup.oracle.upload(rays.rays), {});
    const SweepCase sweep{entry, setup.scene, rays, setup.oracle, setup.judge, truth};
    const auto points = search_sizes(sweep, setup.options);
    const SweepPoint* best = best_point(points);
    ASSERT_NE(best, nullptr);
    EXPECT_LT(best->object_density, 4.0 * DensitySearch{}.finest);
    EXPECT_GT(best->object_density, 4.0 / DensitySearch{}.finest);
    std::vector<double> densities;
    for (const SweepPoint& p : points) densities.push_back(p.object_density);
    std::sort(densities.begin(), densities.end());
    EXPECT_EQ(std::adjacent_find(densities.begin(), densities.end()), densities.end())
        << "no density twice";
}

TEST(NextDensities, goes_beyond_an_end_while_that_is_best) {
    const DensitySearch search;
    const std::vector<TriedDensity> falling = {{0.5, 9}, {2, 8}, {8, 7}, {32, 6}, {128, 5}};
    EXPECT_EQ(next_densities(falling, search), std::vector<double>{512.0});
    const std::vector<TriedDensity> rising = {{0.5, 5}, {2, 6}, {8, 7}};
    EXPECT_EQ(next_densities(rising, search), std::vector<double>{0.125});
}

TEST(NextDensities, halves_the_gaps_about_the_best_until_they_are_small) {
    const DensitySearch search;
    std::vector<TriedDensity> tried = {{2, 6}, {8, 5}, {32, 7}};
    EXPECT_EQ(next_densities(tried, search), (std::vector<double>{4.0, 16.0}));
    tried = {{7, 6}, {8, 5}, {9, 7}};
    EXPECT_TRUE(next_densities(tried, search).empty());
}

TEST(NextDensities, takes_a_refused_size_for_the_slowest) {
    const double refused = std::numeric_limits<double>::quiet_NaN();
    const std::vector<TriedDensity> tried = {{2, 6}, {8, 5}, {32, refused}};
    EXPECT_EQ(next_densities(tried, DensitySearch{}), (std::vector<double>{4.0, 16.0}));
    const std::vector<TriedDensity> refused_first = {{2, refused}, {8, 5}, {32, 7}};
    EXPECT_EQ(next_densities(refused_first, DensitySearch{}), (std::vector<double>{4.0, 16.0}));
    const std::vector<TriedDensity> none = {{2, refused}, {8, refused}};
    EXPECT_TRUE(next_densities(none, DensitySearch{}).empty());
}

TEST(ListedSizes, has_resolutions_behind_the_densities) {
    CatalogueEntry entry = grid_strategy();
    SweepOptions options;
    options.object_densities = {2.0};
    options.resolutions = {"8x4x2"};
    EXPECT_THROW(listed_sizes(entry.info, options), Error) << "it has no parameter for it";
    entry.info.params.push_back({"resolution", ParamInfo::Type::text, "auto", "cells", {}});
    const auto sizes = listed_sizes(entry.info, options);
    ASSERT_EQ(sizes.size(), 2u);
    EXPECT_EQ(sizes[1].resolution, "8x4x2");
    EXPECT_EQ(sized_params(entry.info, {}, sizes[1]).at("resolution"), "8x4x2");
    options.resolutions = {"8x4"};
    EXPECT_THROW(listed_sizes(entry.info, options), Error);
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
