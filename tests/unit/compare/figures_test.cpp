// Figures for a paper, from invented results.
#include "compare/report/figures.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "compare/timing.h"

namespace onepass {
namespace {

using report::TextFile;

TimingRecord sample_timing(const std::string& tracer, double ms, uint64_t errors) {
    TimingRecord timing;
    timing.scene = "a \"bunny\", or two";
    timing.rays = "primary";
    timing.ray_count = 1000;
    timing.tracer = tracer;
    timing.oracle = "embree/robust/threads";
    timing.wall_ms = std::vector<double>(9, ms);
    timing.wall_ms.front() = ms + 0.5;
    timing.oracle_wall_ms = std::vector<double>(9, 10.0);
    timing.errors = errors;
    summarise(timing, 0);
    return timing;
}

std::vector<TextFile> sample_files() {
    Results run;
    run.timings = {sample_timing("embree/robust/threads", 10.0, 0),
                   sample_timing("grid/buffer/compute", 5.0, 0),
                   sample_timing("paper/texture2d/compute", 4.0, 3),
                   sample_timing("slow/but/right", 20.0, 0)};
    CheckRecord check;
    check.classes[5] = {3, WorstRay{}};
    run.checks.push_back(check);
    return report::figure_files({run}, {"."});
}

std::string text_of(const std::vector<TextFile>& files, const std::string& start,
                    const std::string& end) {
    for (const TextFile& file : files) {
        if (file.name.starts_with(start) && file.name.ends_with(end)) return file.text;
    }
    ADD_FAILURE() << "no file " << start << "..." << end;
    return "";
}

TEST(Figures, have_a_table_of_every_list_of_records) {
    const std::vector<TextFile> files = sample_files();
    const std::string timings = text_of(files, "timings", ".csv");
    std::istringstream lines(timings);
    std::string heading, first;
    std::getline(lines, heading);
    std::getline(lines, first);
    EXPECT_TRUE(heading.starts_with("run,scene,rays,ray_count,tracer,oracle,wall_ms,"));
    EXPECT_TRUE(first.starts_with("1,\"a \"\"bunny\"\", or two\",primary,1000,")) << first;
    EXPECT_NE(first.find(",10.5 10.0 10.0 "), std::string::npos) << "samples are one field";
    EXPECT_NE(text_of(files, "checks", ".csv").find("classes.wrong_surface.count"),
              std::string::npos);
}

TEST(Figures, mark_the_pareto_front) {
    const std::string csv = text_of(sample_files(), "chart-tradeoff-", ".csv");
    std::istringstream lines(csv);
    std::string front;
    for (std::string line; std::getline(lines, line);) {
        if (line.ends_with(",1")) front += line.substr(0, line.find(',')) + " ";
    }
    EXPECT_EQ(front, "grid/buffer/compute paper/texture2d/compute ");
}

TEST(Figures, have_a_script_for_every_chart_and_no_name_twice) {
    const std::vector<TextFile> files = sample_files();
    std::vector<std::string> names;
    for (const TextFile& file : files) names.push_back(file.name);
    for (const std::string& name : names) {
        EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
        if (!name.ends_with(report::kScriptSuffix)) continue;
        const std::string base = name.substr(0, name.size() - report::kScriptSuffix.size());
        EXPECT_NE(std::find(names.begin(), names.end(), base + ".csv"), names.end()) << name;
        EXPECT_NE(text_of(files, name, "").find("set output '" + base + ".svg'"),
                  std::string::npos);
    }
}

}  // namespace
}  // namespace onepass
