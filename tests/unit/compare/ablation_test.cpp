// Ablations: which clock a ratio is by, and which tracer a step makes.
#include "compare/ablation.h"

#include <set>

#include <gtest/gtest.h>

#include "core/error.h"

namespace onepass {
namespace {

AblationRecord record_of(double wall_ms, double device_ms) {
    AblationRecord record;
    record.rays = 4000;
    record.wall_ms = std::vector<double>(9, wall_ms);
    if (device_ms > 0.0) record.device_ms = std::vector<double>(9, device_ms);
    return record;
}

TEST(Ablation, a_side_that_takes_twice_the_time_has_half_the_speed_of_the_first) {
    std::vector<AblationRecord> records = {record_of(2.0, 0.0), record_of(4.0, 0.0)};
    compare_ablations(records, 1);
    EXPECT_DOUBLE_EQ(records[0].ratio, 1.0);
    EXPECT_DOUBLE_EQ(records[1].ratio, 0.5);
    EXPECT_DOUBLE_EQ(records[1].ratio_low, 0.5);
    EXPECT_DOUBLE_EQ(records[1].ratio_high, 0.5);
    EXPECT_DOUBLE_EQ(mrays_per_s(records[1]), 1.0);
}

TEST(Ablation, a_devices_own_timer_counts_before_the_wall_clock) {
    std::vector<AblationRecord> records = {record_of(2.0, 0.5), record_of(2.5, 1.0)};
    compare_ablations(records, 1);
    EXPECT_DOUBLE_EQ(records[1].ratio, 0.5);
    EXPECT_DOUBLE_EQ(median_ms(records[1]), 1.0);
}

TEST(Ablation, a_side_that_could_not_be_made_has_no_ratio_and_the_others_have_theirs) {
    std::vector<AblationRecord> records = {record_of(2.0, 0.0), {}, record_of(1.0, 0.0)};
    records[1].failure = "too large";
    compare_ablations(records, 1);
    EXPECT_EQ(records[1].ratio, 0.0);
    EXPECT_DOUBLE_EQ(records[2].ratio, 2.0);
}

TEST(Ablation, a_step_that_is_a_storage_changes_the_middle_of_the_name) {
    EXPECT_EQ(tracer_without("grid/buffer/compute", {.without = "x", .storage = "ssbo"}),
              "grid/ssbo/compute");
    EXPECT_EQ(tracer_without("grid/buffer/compute", {.without = "x", .params = {{"a", "0"}}}),
              "grid/buffer/compute");
}

TEST(Ablation, each_step_is_named_once_and_changes_something) {
    for (const char* strategy : {"grid", "bvh"}) {
        std::set<std::string> names;
        for (const AblationStep& step : ablation_steps(strategy)) {
            EXPECT_TRUE(names.insert(step.without).second) << step.without;
            EXPECT_NE(step.storage.empty(), step.params.empty()) << step.without;
        }
        EXPECT_GE(names.size(), 2u) << strategy;
    }
    EXPECT_THROW(ablation_steps("embree"), Error);
}

}  // namespace
}  // namespace onepass
