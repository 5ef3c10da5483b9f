// Timed frames over fake tracers: what is compared, counted and timed, still and animated.
#include "compare/frame_timing.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

TimingOptions quick(uint32_t repetitions = 9) {
    return {.repetitions = repetitions, .warm_up_rounds = 2, .warm_up_ms = 0.0, .seed = 1};
}

FrameRequest still(uint32_t side = 4) { return {{}, {.width = side, .height = side}, {}}; }

/// Frame f puts its one instance at x = f.
FrameRequest animated(size_t frames) {
    FrameRequest request = still();
    for (size_t f = 0; f < frames; ++f) {
        Affine pose = affine_identity();
        pose[3].x = static_cast<float>(f);
        request.poses.push_back({pose});
    }
    return request;
}

struct TwoTracers {
    std::vector<std::string> log;
    FakeTracer ours{"ours"}, oracle{"oracle"};
    std::vector<Tracer*> all{&ours, &oracle};

    TwoTracers() {
        ours.frame_ms = 8.0;
        oracle.frame_ms = 2.0;
        for (FakeTracer* tracer : {&ours, &oracle}) tracer->log = &log;
    }
};

TEST(TimeFrames, gives_rates_and_speed_relative_to_the_oracle) {
    TwoTracers tracers;
    tracers.ours.frame_costs = {{"passes", 7.0, ""}};
    const auto records = time_frames(tracers.all, 1, still(), quick());
    ASSERT_EQ(records.size(), 2u);
    EXPECT_EQ(records[0].tracer, "ours");
    EXPECT_EQ(records[0].oracle, "oracle");
    EXPECT_EQ(records[0].wall_ms, std::vector<double>(9, 8.0)) << "the warm-up does not count";
    EXPECT_EQ(records[0].frames_per_s, 125.0);
    EXPECT_EQ(records[0].ratio, 0.25);
    EXPECT_EQ(records[1].ratio, 1.0);
    EXPECT_EQ(records[0].costs, tracers.ours.frame_costs);
    EXPECT_TRUE(records[0].device_ms.empty()) << "NaN means no timer";
    EXPECT_TRUE(records[0].update_ms.empty()) << "nothing moves";
    EXPECT_EQ(records[0].frames, 1u);
}

TEST(TimeFrames, counts_rays_and_compares_pixels_with_the_oracle) {
    TwoTracers tracers;
    tracers.ours.cost.rays = 3;
    tracers.ours.color = vec3(0.5f);
    const auto records = time_frames(tracers.all, 1, still(4), quick());
    EXPECT_EQ(records[0].primary_rays, 16u);
    EXPECT_EQ(records[0].secondary_rays, 32u);
    EXPECT_EQ(records[0].differing_pixels, 16u);
    EXPECT_EQ(records[0].compared_pixels, 16u);
    EXPECT_EQ(records[1].differing_pixels, 0u) << "the oracle differs from nobody";
}

TEST(TimeFrames, renders_every_tracer_once_a_round_in_changing_order) {
    TwoTracers tracers;
    time_frames(tracers.all, 0, still(), quick(40));
    ASSERT_EQ(tracers.log.size(), 2u * (1 + 2 + 40)) << "compared, warmed up, measured";
    int first = 0;
    for (size_t round = 0; round < 43; ++round) {
        EXPECT_NE(tracers.log[2 * round], tracers.log[2 * round + 1]);
        first += tracers.log[2 * round] == "ours" ? 1 : 0;
    }
    EXPECT_GT(first, 5);
    EXPECT_LT(first, 38);
}

TEST(TimeFrames, moves_the_instances_before_every_frame_and_keeps_what_that_took) {
    TwoTracers tracers;
    tracers.ours.update_times = {3.0, 0.5};
    const auto records = time_frames(tracers.all, 1, animated(4), quick(9));
    EXPECT_EQ(records[0].frames, 4u);
    EXPECT_EQ(records[0].wall_ms.size(), 12u) << "whole passes over the animation";
    EXPECT_EQ(records[0].update_ms, std::vector<double>(12, 3.0));
    EXPECT_EQ(records[0].upload_ms, std::vector<double>(12, 0.5));
    EXPECT_EQ(records[0].compared_pixels, 4u * 16u) << "every frame is compared";
    EXPECT_EQ(records[0].primary_rays, 16u) << "of one frame";
    for (FakeTracer* tracer : {&tracers.ours, &tracers.oracle}) {
        ASSERT_EQ(tracer->moved.size(), 1u);
        EXPECT_EQ(tracer->moved[0][3].x, 3.0f) << "it ends at the last frame";
    }
}

TEST(TimeFrames, stopped_early_keeps_whole_rounds) {
    TwoTracers tracers;
    int calls = 0;
    const auto records =
        time_frames(tracers.all, 1, still(), quick(50), [&](double) { return ++calls < 10; });
    EXPECT_LT(records[0].wall_ms.size(), 10u);
    EXPECT_EQ(records[0].wall_ms.size(), records[1].wall_ms.size());
}

TEST(TimeFrames, refuses_too_few_rounds) {
    TwoTracers tracers;
    EXPECT_THROW(time_frames(tracers.all, 0, still(), quick(8)), Error);
}

}  // namespace
}  // namespace onepass
