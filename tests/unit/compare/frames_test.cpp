// Frames: numbers, times, file names and what their record says.
#include "compare/frames.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/errors.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;

TEST(Frames, are_named_by_both_ends_or_alone) {
    EXPECT_EQ(parse_frames("0..47"), (FrameRange{0, 47}));
    EXPECT_EQ(parse_frames("0..47").count(), 48u);
    EXPECT_EQ(parse_frames("9"), (FrameRange{9, 9}));
    for (const char* text : {"", "..", "1..", "..1", "2..1", "-1..2", "1...2", "1-2", "1..2..3",
                             " 1..2", "1..4294967296", "0x1..2", "+1..2"}) {
        const Error error = error_of([&] { parse_frames(text); });
        EXPECT_TRUE(test::is_clear(error)) << text;
        EXPECT_TRUE(contains(error.what(), "A..B")) << text;
    }
}

TEST(Frames, start_the_loop_again_when_it_is_over) {
    EXPECT_EQ(frame_time(0, 24.0, 2.0), 0.0);
    EXPECT_EQ(frame_time(12, 24.0, 2.0), 0.5);
    EXPECT_EQ(frame_time(48, 24.0, 2.0), 0.0);
    EXPECT_EQ(frame_time(60, 24.0, 2.0), 0.5);
    EXPECT_EQ(frame_time(60, 24.0, 0.0), 2.5) << "nothing moves, so nothing loops";
}

TEST(FramePattern, puts_the_number_in_its_place) {
    EXPECT_EQ(FramePattern("frame.%04d.png").file(7), "frame.0007.png");
    EXPECT_EQ(FramePattern("frame.%04d.png").file(123456), "frame.123456.png");
    EXPECT_EQ(FramePattern("%d").file(30), "30");
    EXPECT_EQ(FramePattern("out/a%02d{}.exr").file(3), "out/a03{}.exr");
}

TEST(FramePattern, that_is_none_is_refused_with_an_example) {
    for (const char* text : {"a.png", "%", "%%", "%d%d", "%4d", "%0d", "%00d", "%010d", "%x", "%s",
                             "%.4d", "%04", "%d/a.png", "%04d.%%.png"}) {
        const Error error = error_of([&] { FramePattern pattern(text); });
        EXPECT_TRUE(test::is_clear(error)) << text;
        EXPECT_TRUE(contains(error.what(), "frame.%04d.png")) << text;
    }
}

Frame frame_of(double wall_ms, double device_ms, uint32_t rays_per_pixel) {
    Frame frame;
    frame.width = 4;
    frame.height = 2;
    frame.counters.resize(8, {.cells = 0, .tests = 0, .references = 0, .rays = rays_per_pixel});
    frame.wall_ms = wall_ms;
    frame.device_ms = device_ms;
    frame.costs = {{"passes", wall_ms, ""}};
    return frame;
}

TEST(TimedFrames, keep_every_sample_and_count_rays_by_the_frame) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    TimedFrames frames;
    TimedFrames oracle;
    frames.tracer = "ours";
    oracle.tracer = "truth";
    for (const double ms : {3.0, 1.0, 2.0}) {
        frames.add({.update_ms = 10 * ms, .upload_ms = 100 * ms}, frame_of(ms, 0.5, 3));
        oracle.add({.update_ms = ms, .upload_ms = 0.0}, frame_of(2 * ms, nan, 3));
    }
    const FrameTimingRecord record = timing_record(frames, oracle, 1);
    EXPECT_EQ(record.tracer, "ours");
    EXPECT_EQ(record.oracle, "truth");
    EXPECT_EQ(record.frames, 3u);
    EXPECT_EQ(record.primary_rays, 8u);
    EXPECT_EQ(record.secondary_rays, 16u);
    EXPECT_EQ(record.wall_ms, (std::vector<double>{3, 1, 2}));
    EXPECT_EQ(record.device_ms, (std::vector<double>{0.5, 0.5, 0.5}));
    EXPECT_EQ(record.update_ms, (std::vector<double>{30, 10, 20}));
    EXPECT_EQ(record.upload_ms, (std::vector<double>{300, 100, 200}));
    EXPECT_EQ(record.oracle_wall_ms, (std::vector<double>{6, 2, 4}));
    EXPECT_EQ(record.costs.at(0).value, 2.0) << "of the last frame";
    EXPECT_EQ(record.median_ms, 2.0);
    EXPECT_EQ(record.frames_per_s, 500.0);
    EXPECT_EQ(record.ratio, 2.0) << "as fast again as the oracle";
    EXPECT_EQ(record.ratio_low, 2.0) << "the ratio is that of every frame";
    EXPECT_TRUE(timing_record(oracle, oracle, 1).device_ms.empty());
    EXPECT_EQ(timing_record(oracle, oracle, 1).ratio, 1.0);
}

TEST(TimedFrames, without_an_oracle_or_counts_say_so) {
    TimedFrames frames;
    frames.add({}, frame_of(1.0, 1.0, 0));
    const FrameTimingRecord record = timing_record(frames, {}, 1);
    EXPECT_TRUE(std::isnan(record.ratio));
    EXPECT_EQ(record.oracle, "");
    EXPECT_EQ(record.secondary_rays, 0u);
}

}  // namespace
}  // namespace onepass
