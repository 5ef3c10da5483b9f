// What a grid-size study says: fits, optima, bands and regrets of points whose answers are known.
#include "compare/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace onepass {
namespace {

/// Rounding of sums of a dozen products.
constexpr double kRounding = 1e-9;

/// Counts as grids have them: cells a ray rise and tests fall with the density.
SweepPoint point_at(double density, const CostModel& costs, double detail = 1.0,
                    const std::string& scene = "scene") {
    SweepPoint point;
    point.scene = scene;
    point.rays = "primary";
    point.tracer = "grid/x/y";
    point.top_density = 1.2;
    point.object_density = density;
    point.ray_count = 1000;
    point.bytes = static_cast<uint64_t>(1000.0 * density);
    point.cells_per_ray = 4.0 * std::cbrt(density);
    point.tests_per_ray = detail * 40.0 / std::cbrt(density * density);
    const double ms = 1e-6 * 1000.0 * costs.ns(point.cells_per_ray, point.tests_per_ray);
    point.wall_ms.assign(9, ms);
    point.oracle_wall_ms.assign(9, 2.0);
    point.ratio = 2.0 / ms;
    return point;
}

const std::vector<double> kDensities = {0.5, 1, 2, 4, 8, 16, 32, 64};

std::vector<SweepPoint> points_with(const CostModel& costs, double detail = 1.0,
                                    const std::string& scene = "scene") {
    std::vector<SweepPoint> points;
    for (const double density : kDensities) {
        points.push_back(point_at(density, costs, detail, scene));
    }
    return points;
}

TEST(FitCosts, finds_the_costs_that_the_samples_were_made_with) {
    const CostModel truth{.ray = 50.0, .cell = 10.0, .test = 3.0};
    std::vector<WorkSample> samples;
    for (const SweepPoint& p : points_with(truth)) {
        samples.push_back({p.cells_per_ray, p.tests_per_ray, 1e3 * p.wall_ms[0], 0});
    }
    const CostModel fit = fit_costs(samples).value();
    EXPECT_NEAR(fit.ray, truth.ray, 1e-6);  // the worst determined of the three
    EXPECT_NEAR(fit.cell, truth.cell, 1e-6);
    EXPECT_NEAR(fit.test, truth.test, 1e-6);
    EXPECT_LT(fit.relative_error, kRounding);
}

TEST(FitCosts, takes_no_negative_cost_where_that_would_fit_better) {
    // Time falls with the cells: the best costs that are not negative leave cells out.
    std::vector<WorkSample> samples;
    for (const double cells : {1.0, 2.0, 3.0, 4.0}) {
        samples.push_back({cells, 10.0 / cells, 100.0 - 5.0 * cells + 20.0 / cells, 0});
    }
    const CostModel fit = fit_costs(samples).value();
    EXPECT_EQ(fit.cell, 0.0);
    EXPECT_GE(fit.ray, 0.0);
    EXPECT_GT(fit.test, 0.0);
}

TEST(FitCosts, finds_the_ratio_of_costs_whatever_the_scale_of_each_scene) {
    const CostModel truth{.ray = 20.0, .cell = 10.0, .test = 4.0};
    std::vector<WorkSample> samples;
    size_t scene = 0;
    for (const double scale : {0.5, 1.0, 8.0}) {
        const double detail = 1.0 + static_cast<double>(scene);
        for (const SweepPoint& p : points_with(truth, detail)) {
            samples.push_back(
                {p.cells_per_ray, p.tests_per_ray, scale * 1e3 * p.wall_ms[0], scene});
        }
        ++scene;
    }
    const CostModel fit = fit_costs(samples).value();
    // Turn by turn it comes nearer: after kTurns a per mille is left.
    EXPECT_NEAR(fit.test / fit.cell, truth.test / truth.cell, 1e-3);
    EXPECT_NEAR(fit.ray / fit.cell, truth.ray / truth.cell, 5e-3);
    EXPECT_FALSE(fit_costs(std::span(samples).first(2)));
}

TEST(Tuning, finds_the_optimum_the_model_and_no_regret_where_the_model_is_the_truth) {
    // d/dl (10 * 4 l^(1/3) + 5 * 40 l^(-2/3)) = 0 at l = 2 * 5 * 40 / (10 * 4) = 10: 8 is nearest.
    const CostModel truth{.ray = 30.0, .cell = 10.0, .test = 5.0};
    const std::vector<SweepPoint> points = points_with(truth);
    const Tuning tuning = tuning_of(points).value();
    EXPECT_EQ(points[tuning.best].object_density, 8.0);
    EXPECT_EQ(tuning.predicted, tuning.best);
    EXPECT_EQ(tuning.predicted_regret.share, 0.0);
    EXPECT_NEAR(tuning.model->cell, truth.cell, 1e-6);
    EXPECT_NEAR(tuning.ns[tuning.best], tuning.predicted_ns[tuning.best], 1e-6);
}

TEST(Tuning, has_bands_whose_ends_lie_where_the_curve_crosses_their_share) {
    std::vector<SweepPoint> points;
    const double ms[] = {1.44, 1.2, 1.0, 1.1, 1.3};
    for (size_t i = 0; i < 5; ++i) {
        points.push_back(point_at(std::pow(2.0, static_cast<double>(i)), {}));
        points.back().wall_ms.assign(9, ms[i]);
    }
    const Tuning tuning = tuning_of(points).value();
    ASSERT_EQ(tuning.bands.size(), 2u);
    // From 4 down to 2 the time rises by 1.2, a factor of 2 in density: 1.05 is reached at
    // log 1.05 / log 1.2 of the way; likewise upwards to 8 with 1.1.
    EXPECT_NEAR(tuning.bands[0].low, 4.0 * std::pow(0.5, std::log(1.05) / std::log(1.2)),
                kRounding);
    EXPECT_NEAR(tuning.bands[0].high, 4.0 * std::pow(2.0, std::log(1.05) / std::log(1.1)),
                kRounding);
    EXPECT_NEAR(tuning.bands[1].low, 2.0, kRounding) << "just within 20 %";
    EXPECT_FALSE(tuning.bands[1].low_open);
    points.erase(points.begin(), points.begin() + 2);
    EXPECT_TRUE(tuning_of(points)->bands[0].low_open);

    SweepPoint alone = point_at(4.0, {});
    alone.top_density = 9.6;
    alone.wall_ms.assign(9, 0.5);
    points.push_back(alone);
    EXPECT_TRUE(tuning_of(points)->bands.empty()) << "one density is no curve";
}

TEST(Tuning, saves_memory_with_the_smallest_grid_within_its_share) {
    std::vector<SweepPoint> points;
    for (const double ms : {1.2, 1.04, 1.03, 1.0}) {
        points.push_back(point_at(std::pow(2.0, static_cast<double>(points.size())), {}));
        points.back().wall_ms.assign(9, ms);
    }
    const Tuning tuning = tuning_of(points).value();
    EXPECT_EQ(tuning.smallest, 1u);
    EXPECT_EQ(tuning.saved_bytes, 8000.0 - 2000.0);
}

TEST(Tuning, tells_the_regret_of_auto_and_the_gain_of_sizes_by_object) {
    std::vector<SweepPoint> points = points_with({.ray = 30.0, .cell = 10.0, .test = 5.0});
    const double best_ms = points[4].wall_ms[0];
    points[2].chosen = kAutoSize;
    points[2].wall_ms.assign(9, 1.5 * best_ms);
    SweepPoint own = points[4];
    own.sizes = "1,2";
    own.chosen = kPerObjectSize;
    own.wall_ms.assign(9, 0.8 * best_ms);
    points.push_back(own);
    const Tuning tuning = tuning_of(points).value();
    EXPECT_EQ(tuning.best, points.size() - 1);
    EXPECT_NEAR(tuning.automatic_regret.share, 1.5 / 0.8 - 1.0, kRounding);
    EXPECT_NEAR(tuning.automatic_regret.low, tuning.automatic_regret.share, kRounding)
        << "all rounds alike";
    EXPECT_NEAR(tuning.per_object_gain, 1.0 / 0.8 - 1.0, kRounding);
    EXPECT_TRUE(tuning.bands.empty()) << "the best lies on no curve of density";
}

TEST(Tuning, brings_points_of_other_rounds_to_one_pace) {
    std::vector<SweepPoint> points = points_with({.ray = 30.0, .cell = 10.0, .test = 5.0});
    const std::vector<double> calm = comparable_ns(points);
    // While the last was measured, the machine was three times slower, for the oracle as well.
    for (double& ms : points.back().wall_ms) ms *= 3.0;
    for (double& ms : points.back().oracle_wall_ms) ms *= 3.0;
    points.back().chosen = kAutoSize;
    EXPECT_NEAR(comparable_ns(points).back(), calm.back(), kRounding * calm.back());
    EXPECT_TRUE(std::isnan(tuning_of(points)->automatic_regret.low));
    // By the device's timer, the CPU's pace says nothing.
    for (SweepPoint& point : points) point.device_ms = point.wall_ms;
    EXPECT_NEAR(comparable_ns(points).back(), 3.0 * calm.back(), kRounding * calm.back());
}

TEST(Tuning, passes_over_refused_sizes) {
    std::vector<SweepPoint> points = points_with({.ray = 30.0, .cell = 10.0, .test = 5.0});
    points[4].failure = "too many cells";
    points[4].wall_ms.clear();
    points[4].oracle_wall_ms.clear();
    const Tuning tuning = tuning_of(points).value();
    EXPECT_TRUE(std::isnan(tuning.ns[4]));
    EXPECT_NE(tuning.best, 4u);
    for (SweepPoint& point : points) point.failure = "refused";
    EXPECT_FALSE(tuning_of(points));
}

TEST(LeaveOneOut, judges_each_scene_by_costs_of_the_others) {
    const CostModel usual{.ray = 0.0, .cell = 10.0, .test = 5.0};
    // Tests cost so much more in the odd scene that its best grid is finer.
    const CostModel odd{.ray = 0.0, .cell = 10.0, .test = 40.0};
    std::vector<SweepPoint> points;
    for (const auto& [scene, costs] : {std::pair("a", usual), {"b", usual}, {"odd", odd}}) {
        const auto own = points_with(costs, 1.0, scene);
        points.insert(points.end(), own.begin(), own.end());
    }
    const std::vector<LeftOut> left_out = leave_one_out(points);
    ASSERT_EQ(left_out.size(), 3u);
    EXPECT_EQ(left_out[2].scene, "odd");
    EXPECT_NEAR(left_out[2].costs.test / left_out[2].costs.cell, 0.5, 1e-3);
    EXPECT_EQ(left_out[2].best, 64.0);
    EXPECT_EQ(left_out[2].chosen, 8.0);
    EXPECT_GT(left_out[2].regret.share, 0.2);
    EXPECT_GT(left_out[0].costs.test / left_out[0].costs.cell, 0.5) << "the odd one has a say";
    EXPECT_GE(median_regret(left_out), 0.0);
    EXPECT_LT(median_regret(left_out), left_out[2].regret.share);
    EXPECT_TRUE(leave_one_out(std::span(points).first(8)).empty()) << "one scene";
}

TEST(CoarsestWorthwhile, takes_a_finer_grid_only_if_it_promises_enough) {
    const double within = 1.0 + 0.5 * kWorthwhile, beyond = 1.0 + 2.0 * kWorthwhile;
    EXPECT_EQ(coarsest_worthwhile(std::vector<double>{beyond, within, 1.0, 1.2}), 1u);
    EXPECT_EQ(coarsest_worthwhile(std::vector<double>{beyond, beyond, 1.0, 1.2}), 2u);
}

/// The table is written with as many digits as `tune --fit` prints.
constexpr double kPrintedShare = 1e-3;

TEST(KnownCosts, are_what_the_published_study_gives) {
    const Results study = read_results(ONEPASS_SOURCE_DIR "/results/tune/fitted-on.json");
    std::set<std::string> tracers;
    for (const SweepPoint& point : study.sweeps) tracers.insert(point.tracer);
    ASSERT_EQ(tracers.size(), 2u);
    for (const std::string& tracer : tracers) {
        std::vector<SweepPoint> own;
        std::copy_if(study.sweeps.begin(), study.sweeps.end(), std::back_inserter(own),
                     [&](const SweepPoint& point) { return point.tracer == tracer; });
        const std::optional<CostModel> fit = costs_of(own, tracer);
        const CostModel* known = known_costs_of(tracer);
        ASSERT_TRUE(fit && known) << tracer;
        EXPECT_NEAR(known->ray, fit->ray, kPrintedShare * fit->ray) << tracer;
        EXPECT_NEAR(known->cell, fit->cell, kPrintedShare * fit->cell) << tracer;
        EXPECT_NEAR(known->test, fit->test, kPrintedShare * fit->test) << tracer;
    }
}

}  // namespace
}  // namespace onepass
