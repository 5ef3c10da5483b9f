// Speed against accuracy: the front, points pooled over cases, and every answer judged once.
#include "compare/tradeoff.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/ladder_results.h"

namespace onepass {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TradeoffPoint point(double ratio, uint64_t errors, uint64_t rays = 1000) {
    TradeoffPoint p;
    p.ratio = p.ratio_low = p.ratio_high = ratio;
    p.errors = errors;
    p.ray_count = rays;
    return p;
}

std::vector<bool> front(std::vector<TradeoffPoint> points) { return on_front(points); }

TEST(OnFront, keeps_what_is_faster_or_more_often_right_than_each_other) {
    EXPECT_EQ(front({point(4, 30), point(2, 10), point(1, 0)}),
              (std::vector<bool>{true, true, true}));
    EXPECT_EQ(front({point(4, 30), point(2, 31), point(1, 0), point(0.5, 0)}),
              (std::vector<bool>{true, false, true, false}));
}

TEST(OnFront, drops_what_is_as_fast_with_more_errors_and_as_right_but_slower) {
    EXPECT_EQ(front({point(2, 5), point(2, 6)}), (std::vector<bool>{true, false}));
    EXPECT_EQ(front({point(2, 5), point(1.9, 5)}), (std::vector<bool>{true, false}));
}

TEST(OnFront, keeps_equal_points_together) {
    EXPECT_EQ(front({point(2, 5), point(2, 5), point(1, 9)}),
              (std::vector<bool>{true, true, false}));
}

TEST(OnFront, goes_by_the_share_of_errors_and_not_by_their_count) {
    EXPECT_EQ(front({point(2, 5, 1000), point(1, 8, 10000)}), (std::vector<bool>{true, true}));
    EXPECT_EQ(front({point(2, 5, 10000), point(1, 4, 1000)}), (std::vector<bool>{true, false}));
}

TEST(OnFront, leaves_out_what_has_no_figures_and_lets_it_beat_nothing) {
    EXPECT_EQ(front({point(kNaN, 0), point(9, 0, 0), point(1, 3)}),
              (std::vector<bool>{false, false, true}));
    EXPECT_TRUE(front({}).empty());
}

TEST(Pool, takes_the_geometric_mean_of_ratios_and_adds_up_errors_and_rays) {
    const std::vector<TradeoffPoint> points = {invented_point("a", "primary", "t", "k=1", 0.5, 3),
                                               invented_point("a", "random", "t", "k=1", 2.0, 4),
                                               invented_point("b", "primary", "t", "k=1", 8.0, 0)};
    const std::vector<TradeoffPoint> pooled = pool(points);
    ASSERT_EQ(pooled.size(), 1u);
    EXPECT_NEAR(pooled[0].ratio, 2.0, 1e-12) << "the cube root of 0.5 * 2 * 8";
    EXPECT_EQ(pooled[0].errors, 7u);
    EXPECT_EQ(pooled[0].edges, 2u);
    EXPECT_EQ(pooled[0].ray_count, 3u * 16384u);
    EXPECT_EQ(pooled[0].tracer, "t");
    EXPECT_EQ(pooled[0].setting, "k=1");
    EXPECT_EQ(pooled[0].scene, "") << "not of one scene";
    EXPECT_EQ(pooled[0].oracle, "embree/robust/threads");
    // Three independent cases with equal intervals: a third of the root of three of each.
    EXPECT_NEAR(pooled[0].ratio_low, 2.0 * std::pow(0.93, 1.0 / std::sqrt(3.0)), 1e-12);
    EXPECT_NEAR(pooled[0].ratio_high, 2.0 * std::pow(1.05, 1.0 / std::sqrt(3.0)), 1e-12);
}

TEST(Pool, gives_back_a_single_case) {
    const TradeoffPoint one = invented_point("a", "primary", "t", "", 0.25, 3);
    const std::vector<TradeoffPoint> pooled = pool(std::vector{one});
    ASSERT_EQ(pooled.size(), 1u);
    EXPECT_DOUBLE_EQ(pooled[0].ratio_low, one.ratio_low);
    EXPECT_DOUBLE_EQ(pooled[0].ratio_high, one.ratio_high);
    EXPECT_EQ(pooled[0].scene, "a");
    EXPECT_EQ(pooled[0].rays, "primary");
}

TEST(Pool, leaves_out_a_setting_that_lacks_a_case) {
    const std::vector<TradeoffPoint> points = {invented_point("a", "primary", "t", "", 1, 0),
                                               invented_point("a", "primary", "t", "k=1", 1, 0),
                                               invented_point("b", "primary", "t", "", 1, 0)};
    const std::vector<TradeoffPoint> pooled = pool(points);
    ASSERT_EQ(pooled.size(), 1u);
    EXPECT_EQ(pooled[0].setting, "");
}

/// Answers each ray with the triangle `id`, in `cast_ms`.
FakeTracer answering(const std::string& name, uint32_t id, double cast_ms) {
    FakeTracer tracer(name);
    tracer.answer = [id](const Ray&) { return Hit{1.0f, 0.0f, 0.0f, id, 0}; };
    tracer.cast_ms = cast_ms;
    return tracer;
}

TEST(MeasureTradeoff, judges_every_answer_with_one_truth_a_ray) {
    FakeTracer right = answering("right", 1, 4.0);
    FakeTracer wrong = answering("wrong", 2, 1.0);
    FakeTracer close = answering("close", 3, 2.0);
    std::vector<Tracer*> tracers{&right, &wrong, &close};

    class CountingJudge final : public Judge {
      public:
        mutable std::atomic<size_t> rays{0};
        std::string_view name() const override { return "counts"; }
        std::vector<Verdict> judge(const Ray&, Query, std::span<const Hit> hits) const override {
            ++rays;
            std::vector<Verdict> verdicts(hits.size());
            for (size_t i = 0; i < hits.size(); ++i) {
                verdicts[i].hit_class = hits[i].prim_id == 2   ? HitClass::wrong_surface
                                        : hits[i].prim_id == 3 ? HitClass::edge
                                                               : HitClass::agree;
            }
            return verdicts;
        }
        RayTruth explain(const Ray&, std::span<const Hit>) const override { return {}; }
    } judge;

    RaySet rays;
    rays.name = "some";
    rays.rays.resize(100);
    const std::vector<TradeoffPoint> points =
        measure_tradeoff(tracers, 0, rays, judge,
                         {.repetitions = 9, .warm_up_rounds = 0, .warm_up_ms = 0.0, .seed = 1});
    EXPECT_EQ(judge.rays, 100u);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points[0].errors, 0u);
    EXPECT_EQ(points[1].errors, 100u);
    EXPECT_EQ(points[2].errors, 0u);
    EXPECT_EQ(points[2].edges, 100u);
    EXPECT_EQ(points[1].tracer, "wrong");
    EXPECT_EQ(points[1].rays, "some");
    EXPECT_EQ(points[1].oracle, "right");
    EXPECT_EQ(points[1].ray_count, 100u);
    EXPECT_EQ(points[1].ratio, 4.0) << "four times as fast as the first";
    EXPECT_EQ(points[1].wall_ms.size(), 9u);
    EXPECT_EQ(points[1].oracle_wall_ms, std::vector<double>(9, 4.0));
}

TEST(MeasureTradeoff, leaves_nothing_if_stopped_before_its_first_round) {
    FakeTracer tracer = answering("t", 1, 1.0);
    std::vector<Tracer*> tracers{&tracer};
    RaySet rays;
    rays.rays.resize(1);
    const FakeJudge judge([](const Ray&, const Hit&) { return Verdict{}; });
    EXPECT_TRUE(measure_tradeoff(tracers, 0, rays, judge, {.warm_up_ms = 0.0}, [](double) {
                    return false;
                }).empty());
}

TEST(TradeoffSettings, name_each_setting_once_and_the_oracle_first) {
    std::set<std::pair<std::string, ParamValues>> seen;
    for (const TradeoffSetting& setting : tradeoff_settings()) {
        EXPECT_TRUE(seen.insert({setting.tracer, setting.params}).second) << setting.tracer;
    }
    EXPECT_EQ(tradeoff_settings().front().tracer, "embree/robust/threads");
}

}  // namespace
}  // namespace onepass
