// `onepass_bench`: Google Benchmark with its usual flags (--help lists them).
//
// Two commits are compared by Google's compare.py (Debian's libbenchmark-tools): build both, run
// each with --benchmark_repetitions=9 --benchmark_out=FILE, then `compare.py benchmarks A B`. The
// times of two runs share no round: what it calls different is to be looked at with the counter
// ratio_to_embree_commit, which is of one run.
#include <cstdio>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "compare/bench/awkward_benchmarks.h"
#include "compare/bench/build_benchmarks.h"
#include "compare/bench/moving_benchmarks.h"
#include "compare/bench/versus_embree.h"
#include "core/error.h"
#include "cpu_ref/embree_tracer.h"

namespace {

/// What the numbers compare, printed above them and kept in JSON output.
void describe_comparison() {
    const int threads = tbb::this_task_arena::max_concurrency();
    benchmark::AddCustomContext(
        "compared",
        fmt::format("wall time of our build against rtcCommitScene at medium quality of the same "
                    "mesh (top_level_*: of our update of moving instances against rtcCommitScene "
                    "after moving the same); both on {} threads, by turns in the same run, {} "
                    "rounds; "
                    "ratio_to_embree_commit = ours / Embree's, of medians, with a 95 % bootstrap "
                    "interval; below 1 ours is faster",
                    threads, onepass::kRounds));
    benchmark::AddCustomContext(
        "awkward_rays",
        fmt::format("wall time of a batch of rays that are none against the same rays before they "
                    "were spoiled, by turns, {} rounds; times_a_normal_ray is to be {:g} or less",
                    onepass::kRounds, onepass::kMostTimesANormalRay));
    benchmark::AddCustomContext("embree", onepass::embree_description());
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    try {
        describe_comparison();
        onepass::register_build_benchmarks();
        onepass::register_moving_benchmarks();
        onepass::register_awkward_benchmarks();
        benchmark::RunSpecifiedBenchmarks();
    } catch (const onepass::Error& error) {
        std::fprintf(stderr, "onepass_bench: %s\n", error.what());
        return error.kind() == onepass::Error::Kind::device ? 3 : 2;
    }
    benchmark::Shutdown();
}
