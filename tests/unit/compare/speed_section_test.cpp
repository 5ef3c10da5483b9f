// The page's section on speed: verdicts, pairs, counters, time to image, errors beside each.
#include <gtest/gtest.h>

#include "compare/report/sections.h"

namespace onepass::report {
namespace {

TimingRecord timing(const std::string& tracer, double ms) {
    TimingRecord record;
    record.scene = "bunny";
    record.rays = "primary";
    record.tracer = tracer;
    record.oracle = "embree";
    record.ray_count = 1000;
    record.wall_ms.assign(9, ms);
    record.oracle_wall_ms.assign(9, 1.0);
    record.errors = 308;
    return record;
}

Results a_run() {
    Results run;
    run.timings = {timing("embree", 1.0), timing("grid", 4.0), timing("bvh", 2.0)};
    run.timings[1].again_wall_ms.assign(9, 4.0);
    run.timings[1].counts = CastCounts{7000, 3000, 4000, 10, 40, 30};
    run.builds = {{"bunny", "grid", {1.0}}, {"bunny", "bvh", {3.0}}};
    return run;
}

std::string section_of(const Results& run) {
    const std::vector<Results> runs = {run};
    return speed_section(gather(runs, {"."}));
}

bool contains(const std::string& html, const std::string& part) {
    return html.find(part) != std::string::npos;
}

TEST(SpeedSection, gives_a_verdict_on_each_tracer_and_on_each_pair) {
    const std::string html = section_of(a_run());
    EXPECT_TRUE(contains(html, ">slower</td>")) << "grid and bvh, against the oracle";
    EXPECT_TRUE(contains(html, "Pair by pair on bunny"));
    EXPECT_TRUE(contains(html, ">faster</td>")) << "bvh, against grid";
    EXPECT_TRUE(contains(html, "<td>2.00 ×<small>2.00 – 2.00</small></td>")) << html;
}

TEST(SpeedSection, shows_counters_and_where_the_curves_cross) {
    const std::string html = section_of(a_run());
    EXPECT_TRUE(contains(html, "What a ray costs on bunny"));
    EXPECT_TRUE(contains(html, "<td>7.00</td><td>3.00</td><td>75.0\u00a0%</td><td>4.00</td>"));
    EXPECT_TRUE(contains(html, "Time to image on bunny"));
    // bvh builds 2 ms longer and casts a ray in 2 microseconds less.
    EXPECT_TRUE(contains(html, "<td>1,000<small>1,000 – 1,000</small></td>")) << html;
}

TEST(SpeedSection, leaves_out_what_an_older_run_does_not_hold) {
    Results old = a_run();
    old.builds.clear();
    for (TimingRecord& record : old.timings) {
        record.again_wall_ms.clear();
        record.counts.reset();
    }
    const std::string html = section_of(old);
    EXPECT_FALSE(contains(html, "Pair by pair"));
    EXPECT_FALSE(contains(html, "What a ray costs"));
    EXPECT_FALSE(contains(html, "Time to image"));
    EXPECT_TRUE(contains(html, ">slower</td>")) << "by the interval alone";
}

}  // namespace
}  // namespace onepass::report
