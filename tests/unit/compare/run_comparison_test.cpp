// Two runs against each other: what changed, what did not, and what makes them hard to compare.
#include "compare/run_comparison.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace onepass {
namespace {

/// A tracer `times` as fast as an oracle whose pace changes from round to round.
TimingRecord timing(double times, double machine_ms = 10.0) {
    TimingRecord record;
    record.scene = "bunny";
    record.rays = "primary";
    record.tracer = "grid/x/y";
    record.oracle = "embree";
    record.ray_count = 1000;
    for (int round = 0; round < 21; ++round) {
        const double oracle_ms = machine_ms * (1.0 + 0.1 * (round % 5));
        const double scatter = 1.0 + 0.01 * (round % 3 - 1);
        record.oracle_wall_ms.push_back(oracle_ms);
        record.wall_ms.push_back(oracle_ms / times * scatter);
        record.again_wall_ms.push_back(record.wall_ms.back() * (1.0 + 0.01 * (round % 2)));
    }
    record.counts = CastCounts{.cells = 5000, .tests = 700, .references = 800};
    return record;
}

Results run_of(std::vector<TimingRecord> timings) {
    Results run;
    run.manifest.cpu = "a CPU";
    run.scenes = {{"bunny", 1, 1, 1, 1, "hash", {}}};
    CheckRecord check;
    check.scene = "bunny";
    check.rays = "primary";
    check.tracer = "grid/x/y";
    check.ray_hash = "rays";
    run.checks = {check};
    run.timings = std::move(timings);
    return run;
}

bool any_contains(const std::vector<std::string>& all, const std::string& part) {
    return std::any_of(all.begin(), all.end(),
                       [&](const auto& one) { return one.find(part) != std::string::npos; });
}

TEST(CompareRuns, cancels_what_made_a_whole_run_slower) {
    const auto comparison = compare_runs(run_of({timing(0.5)}), run_of({timing(0.5, 30.0)}));
    ASSERT_EQ(comparison.speeds.size(), 1u);
    EXPECT_NEAR(comparison.speeds[0].change.ratio, 1.0, 1e-12);
    EXPECT_EQ(comparison.speeds[0].verdict, SpeedVerdict::no_difference);
    EXPECT_TRUE(comparison.warnings.empty());
    EXPECT_TRUE(comparison.counts.empty());
    EXPECT_GT(comparison.equal_counts, 6u);
    EXPECT_FALSE(any_slower(comparison));
}

TEST(CompareRuns, finds_what_became_slower_and_says_by_how_much) {
    const auto comparison = compare_runs(run_of({timing(0.5)}), run_of({timing(0.45, 5.0)}));
    const SpeedChange& change = comparison.speeds.at(0);
    EXPECT_NEAR(change.change.ratio, 0.9, 1e-12);
    EXPECT_LT(change.change.low, 0.9);
    EXPECT_GT(change.change.high, 0.9);
    EXPECT_LT(change.change.high, 0.93) << "one per cent of scatter in each run";
    EXPECT_EQ(change.verdict, SpeedVerdict::slower);
    EXPECT_TRUE(any_slower(comparison));
    const auto back = compare_runs(run_of({timing(0.45)}), run_of({timing(0.5)}));
    EXPECT_EQ(back.speeds.at(0).verdict, SpeedVerdict::faster);
}

TEST(CompareRuns, adds_the_noise_of_both_up) {
    TimingRecord noisy = timing(0.45);
    for (double& ms : noisy.again_wall_ms) ms *= 1.2;
    const auto comparison = compare_runs(run_of({timing(0.5)}), run_of({noisy}));
    EXPECT_EQ(comparison.speeds.at(0).verdict, SpeedVerdict::no_difference);
    EXPECT_GT(comparison.speeds.at(0).noise, 0.2);
    TimingRecord without = timing(0.45);
    without.again_wall_ms.clear();
    const auto half_known = compare_runs(run_of({timing(0.5)}), run_of({without}));
    EXPECT_FALSE(half_known.speeds.at(0).noise_known);
    EXPECT_FALSE(std::isnan(half_known.speeds.at(0).noise));
}

TEST(CompareRuns, compares_counts_exactly) {
    TimingRecord other = timing(0.5);
    other.counts->tests += 1;
    other.errors = 2;
    const auto comparison = compare_runs(run_of({timing(0.5)}), run_of({other}));
    ASSERT_EQ(comparison.counts.size(), 2u);
    EXPECT_EQ(comparison.counts[0].what, "bunny, primary, grid/x/y: errors");
    EXPECT_EQ(comparison.counts[0].after, 2.0);
    EXPECT_EQ(comparison.counts[1].what, "bunny, primary, grid/x/y: tests");
    EXPECT_EQ(comparison.counts[1].before, 700.0);
    EXPECT_EQ(comparison.counts[1].after, 701.0);
    EXPECT_TRUE(any_more_errors(comparison));
}

TEST(CompareRuns, finds_more_errors_in_a_check_without_speeds) {
    Results before = run_of({}), after = run_of({});
    EXPECT_FALSE(any_more_errors(compare_runs(before, after)));
    after.checks[0].classes[static_cast<size_t>(HitClass::false_miss)].count = 1;
    EXPECT_TRUE(any_more_errors(compare_runs(before, after)));
    EXPECT_FALSE(any_more_errors(compare_runs(after, before)));
}

TEST(CompareRuns, warns_of_another_machine_scene_and_rays) {
    Results other = run_of({timing(0.5)});
    other.manifest.cpu = "another CPU";
    other.scenes[0].hash = "other hash";
    other.checks[0].ray_hash = "other rays";
    const auto comparison = compare_runs(run_of({timing(0.5)}), other);
    EXPECT_EQ(comparison.warnings.size(), 3u);
    EXPECT_TRUE(any_contains(comparison.warnings, "another CPU"));
    EXPECT_TRUE(any_contains(comparison.warnings, "other hash"));
    EXPECT_TRUE(any_contains(comparison.warnings, "other rays"));
}

TEST(CompareRuns, lists_what_only_one_of_them_holds) {
    TimingRecord shadow = timing(0.5);
    shadow.rays = "shadow";
    const auto comparison = compare_runs(run_of({timing(0.5), shadow}), run_of({timing(0.5)}));
    EXPECT_TRUE(any_contains(comparison.only_before, "timing of bunny, shadow"));
    EXPECT_TRUE(comparison.only_after.empty());
    EXPECT_EQ(comparison.speeds.size(), 1u);
}

SweepPoint grid_size(double ratio, uint64_t cells) {
    SweepPoint point;
    point.scene = "bunny";
    point.rays = "primary";
    point.tracer = "grid/x/y";
    point.object_density = 8.0;
    point.cells = cells;
    point.ratio = ratio;
    point.ratio_low = ratio / 1.01;
    point.ratio_high = ratio * 1.01;
    return point;
}

TEST(CompareRuns, compares_grid_sizes_by_their_intervals_and_their_cells_exactly) {
    Results a, b;
    a.sweeps = {grid_size(0.5, 100)};
    b.sweeps = {grid_size(0.55, 101)};
    const auto comparison = compare_runs(a, b);
    const SpeedChange& change = comparison.speeds.at(0);
    EXPECT_NEAR(change.change.ratio, 1.1, 1e-12);
    EXPECT_NEAR(std::log(change.change.high / 1.1), std::sqrt(2.0) * std::log(1.01), 1e-12);
    EXPECT_NEAR(std::log(change.change.low / 1.1), -std::sqrt(2.0) * std::log(1.01), 1e-12);
    EXPECT_EQ(change.verdict, SpeedVerdict::faster);
    EXPECT_TRUE(std::isnan(change.noise));
    ASSERT_EQ(comparison.counts.size(), 1u);
    EXPECT_EQ(comparison.counts[0].after, 101.0);
}

TEST(CompareRuns, tells_sizes_apart_that_have_the_same_density) {
    SweepPoint by_cells = grid_size(0.5, 100), by_object = grid_size(0.5, 100);
    by_cells.resolution = "8x8x8";
    by_object.sizes = "1,2";
    Results a, b;
    a.sweeps = {grid_size(0.5, 100), by_cells};
    b.sweeps = {by_object, by_cells};
    const auto comparison = compare_runs(a, b);
    ASSERT_EQ(comparison.speeds.size(), 1u);
    EXPECT_NE(comparison.speeds[0].at.find("8x8x8"), std::string::npos);
    EXPECT_TRUE(any_contains(comparison.only_before, "density 8"));
    EXPECT_TRUE(any_contains(comparison.only_after, "1,2"));
}

}  // namespace
}  // namespace onepass
