// onepass bench's rivals and self-test, onepass compare, and the JSON of Google Benchmark's binary,
// as a user meets them.
#include <cstdio>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "compare/results.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

struct Said {
    int exit_code = -1;
    std::string text;  ///< stdout and stderr
};

/// Runs a command line in the folder.
Said said(const TemporaryFolder& folder, const std::string& command) {
    Said result;
    const std::string line = "cd '" + folder.path().string() + "' && " + command + " 2>&1";
    std::FILE* pipe = popen(line.c_str(), "r");
    char buffer[4096];
    for (size_t read; (read = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
        result.text.append(buffer, read);
    }
    const int status = pclose(pipe);
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    return result;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

const std::string kBench =
    std::string(ONEPASS_BINARY) +
    " bench balls-1 -s grid/buffer/twin32 -s embree/fast/threads --reference embree/fast/threads "
    "--size 32x32 --warm-up 0 --repetitions 9 ";

TEST(Bench, gives_the_first_strategy_a_rival_and_counts_apart_from_the_timing) {
    const TemporaryFolder folder;
    const Said bench = said(folder, kBench +
                                        "--rays primary --rays shadow --rays reflection "
                                        "--rays diffuse --rays random --json run.json");
    EXPECT_EQ(bench.exit_code, 0) << bench.text;
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_EQ(results.timings.size(), 5u * 3u);
    for (const TimingRecord& timing : results.timings) {
        const bool is_first = timing.tracer == "grid/buffer/twin32";
        EXPECT_EQ(timing.again_wall_ms.size(), is_first ? 9u : 0u) << timing.tracer;
        EXPECT_EQ(timing.counts.has_value(), is_first) << "Embree does not count";
        if (!is_first) continue;
        EXPECT_GT(timing.counts->cells, 0u);
        EXPECT_GE(timing.counts->references, timing.counts->tests);
        if (timing.rays == "shadow") continue;  // any-hit ways are not told
        EXPECT_GT(timing.counts->walked_tests, timing.counts->repeated_tests);
    }
    EXPECT_EQ(results.builds.size(), 3u);
    for (const char* words : {"verdict", "against grid/buffer/twin32", "noise: ", "repeated tests",
                              "first with its image"}) {
        EXPECT_TRUE(contains(bench.text, words)) << words << "\n" << bench.text;
    }
}

TEST(Bench, refuses_to_hold_others_against_a_tracer_that_is_not_timed) {
    const TemporaryFolder folder;
    const Said bench = said(folder, kBench + "--rays primary --versus embree/robust/1thread");
    EXPECT_EQ(bench.exit_code, 2);
    EXPECT_TRUE(contains(bench.text, "--versus")) << bench.text;
}

TEST(BenchSelfTest, prints_how_often_each_verdict_came) {
    const TemporaryFolder folder;
    const Said trial = said(folder, std::string(ONEPASS_BINARY) +
                                        " bench balls-1 -s embree/robust/1thread --self-test "
                                        "--comparisons 2 --repetitions 9 --size 16x16 --warm-up 0");
    EXPECT_TRUE(trial.exit_code == 0 || trial.exit_code == 1) << trial.text;
    EXPECT_TRUE(contains(trial.text, "256 rays, 2 comparisons")) << trial.text;
    EXPECT_EQ(trial.exit_code == 0, contains(trial.text, "  passed:")) << trial.text;
    EXPECT_EQ(trial.exit_code == 1, contains(trial.text, "  FAILED:")) << trial.text;
}

/// A run of one tracer with chosen speed, written to a file.
void write_run(const TemporaryFolder& folder, const std::string& name, double tracer_ms,
               const std::string& cpu) {
    Results run;
    run.manifest.cpu = cpu;
    TimingRecord record;
    record.scene = "bunny";
    record.rays = "primary";
    record.tracer = "grid/x/y";
    record.oracle = "embree";
    record.ray_count = 1000;
    record.wall_ms.assign(9, tracer_ms);
    record.again_wall_ms = record.wall_ms;
    record.oracle_wall_ms.assign(9, 1.0);
    run.timings = {record};
    write_results(run, folder.path() / name);
}

TEST(Compare, prints_the_change_and_fails_only_when_asked_to) {
    const TemporaryFolder folder;
    write_run(folder, "a.json", 2.0, "a CPU");
    write_run(folder, "b.json", 2.5, "another CPU");
    const std::string compare = std::string(ONEPASS_BINARY) + " compare ";
    const Said slower = said(folder, compare + "a.json b.json");
    EXPECT_EQ(slower.exit_code, 0) << slower.text;
    for (const char* words : {"WARNING", "another CPU", "0.800", "slower", "counts: 3 equal"}) {
        EXPECT_TRUE(contains(slower.text, words)) << words << "\n" << slower.text;
    }
    EXPECT_EQ(said(folder, compare + "a.json b.json --fail-if slower").exit_code, 1);
    EXPECT_EQ(said(folder, compare + "b.json a.json --fail-if slower").exit_code, 0);
    EXPECT_EQ(said(folder, compare + "a.json a.json --fail-if slower").exit_code, 0);
    EXPECT_EQ(said(folder, compare + "a.json b.json --fail-if more-errors").exit_code, 0);
    EXPECT_EQ(said(folder, compare + "a.json nowhere.json").exit_code, 2);
}

TEST(BenchBinary, takes_googles_flags_and_writes_googles_json) {
    const TemporaryFolder folder;
    const Said bench = said(folder, std::string(ONEPASS_BENCH_BINARY) +
                                        " --benchmark_filter=top_level_grid/10/ "
                                        "--benchmark_repetitions=3 --benchmark_out=run.json "
                                        "--benchmark_out_format=json");
    ASSERT_EQ(bench.exit_code, 0) << bench.text;
    const auto json = nlohmann::json::parse(read_bytes(folder.path() / "run.json"));
    EXPECT_TRUE(json.at("context").contains("embree"));
    // What compare.py pairs two files by, and what it compares.
    size_t runs = 0;
    bool has_median = false;
    for (const auto& run : json.at("benchmarks")) {
        EXPECT_EQ(run.at("run_name").get<std::string>().rfind("top_level_grid/10/", 0), 0u);
        EXPECT_GT(run.at("real_time").get<double>(), 0.0);
        EXPECT_EQ(run.at("time_unit"), "ms");
        runs += run.at("run_type") == "iteration" ? 1 : 0;
        has_median = has_median || run.value("aggregate_name", "") == "median";
        if (run.at("run_type") == "iteration") {
            EXPECT_GT(run.at("ratio_to_embree_commit").get<double>(), 0.0);
        }
    }
    EXPECT_EQ(runs, 3u);
    EXPECT_TRUE(has_median);
    EXPECT_EQ(said(folder, std::string(ONEPASS_BENCH_BINARY) + " --no_such_flag").exit_code, 2);
}

}  // namespace
}  // namespace onepass
