// Where one tracer's build and rays overtake another's.
#include "compare/time_to_image.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

/// A tracer that takes build_ms and then ns_per_ray, without any scatter unless given.
struct Contestant {
    TimingRecord timing;
    BuildRecord build;

    Contestant(const std::string& name, double build_ms, double ns_per_ray) {
        timing.scene = build.scene = "scene";
        timing.tracer = build.tracer = name;
        timing.ray_count = 1000;
        timing.wall_ms.assign(9, 1e-3 * ns_per_ray);
        build.build_ms = {build_ms};
    }
    ImageLine line() const { return {&timing, &build}; }
};

TEST(Crossing, is_where_the_longer_build_has_paid_for_itself) {
    const Contestant quick_to_build("a", 1.0, 100.0), quick_to_cast("b", 5.0, 20.0);
    const Crossing from = crossing(quick_to_build.line(), quick_to_cast.line(), 0);
    EXPECT_NEAR(from.rays, 50000.0, 1e-6) << "4 ms at 80 ns a ray";
    EXPECT_NEAR(from.low, from.rays, 1e-6) << "without scatter there is no doubt";
    EXPECT_NEAR(from.high, from.rays, 1e-6);
}

TEST(Crossing, never_comes_where_the_rays_are_no_faster) {
    const Contestant a("a", 1.0, 20.0), b("b", 5.0, 20.0);
    EXPECT_TRUE(std::isinf(crossing(a.line(), b.line(), 0).rays));
    EXPECT_EQ(crossing(b.line(), a.line(), 0).rays, 0.0) << "a is there from the start";
}

TEST(Crossing, reaches_to_infinity_where_the_rounds_leave_open_who_is_faster) {
    Contestant a("a", 1.0, 20.0), b("b", 5.0, 19.0);
    for (size_t i = 0; i < 9; ++i) b.timing.wall_ms[i] *= i % 2 ? 1.2 : 0.9;
    const Crossing from = crossing(a.line(), b.line(), 0);
    EXPECT_TRUE(std::isfinite(from.low));
    EXPECT_TRUE(std::isinf(from.high));
}

TEST(Crossing, counts_the_scatter_of_the_builds) {
    Contestant a("a", 1.0, 100.0), b("b", 5.0, 20.0);
    b.build.build_ms = {4.0, 5.0, 6.0};
    const Crossing from = crossing(a.line(), b.line(), 0);
    EXPECT_NEAR(from.low, 37500.0, 1e-6);
    EXPECT_NEAR(from.high, 62500.0, 1e-6);
}

TEST(FirstWithImage, names_the_leaders_in_order_and_none_who_never_leads) {
    const Contestant none("no structure", 0.0, 1000.0), mid("middle", 2.0, 100.0);
    const Contestant late("late", 10.0, 10.0), never("never", 9.0, 99.0);
    const ImageLine lines[] = {never.line(), late.line(), mid.line(), none.line()};
    const auto firsts = first_with_image(lines, 0);
    ASSERT_EQ(firsts.size(), 3u);
    EXPECT_EQ(firsts[0].line, 3u);
    EXPECT_EQ(firsts[0].from.rays, 0.0);
    EXPECT_EQ(firsts[1].line, 2u);
    EXPECT_NEAR(firsts[1].from.rays, 2e6 / 900.0, 1e-6);
    EXPECT_EQ(firsts[2].line, 1u);
    EXPECT_NEAR(firsts[2].from.rays, 8e6 / 90.0, 1e-6);
    EXPECT_TRUE(first_with_image({}, 0).empty());
}

TEST(ImageLines, join_timings_with_builds_of_the_same_scene_and_tracer) {
    const Contestant a("a", 1.0, 1.0), b("b", 2.0, 1.0);
    const TimingRecord* const timings[] = {&a.timing, &b.timing};
    std::vector<BuildRecord> builds = {b.build};
    builds.push_back(a.build);
    builds.back().scene = "another";
    const auto lines = image_lines(timings, builds);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0].timing, &b.timing);
    EXPECT_EQ(build_ms(lines[0]), 2.0);
    EXPECT_DOUBLE_EQ(ms_per_mray(lines[0]), 1.0);
}

TEST(BuildRepeatedly, keeps_every_builds_time_packing_included) {
    int made = 0;
    CatalogueEntry entry;
    entry.make = [&](ScenePtr, const ParamValues&) {
        auto tracer = std::make_unique<FakeTracer>("fake");
        tracer->figures = {{"build_ms", 1.0 + made++, ""}, {"pack_ms", 0.5, ""}};
        return tracer;
    };
    const BuiltTracer built = build_repeatedly(entry, std::make_shared<const Scene>(), {});
    EXPECT_EQ(built.build_ms, (std::vector<double>{1.5, 2.5, 3.5, 4.5, 5.5}));
    EXPECT_TRUE(built.tracer);
}

}  // namespace
}  // namespace onepass
