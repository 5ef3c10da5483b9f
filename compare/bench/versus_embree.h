// One of our builds or updates against Embree's commit of the same, by turns in the same run.
#pragma once

#include <chrono>
#include <memory>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/scene.h"

namespace onepass {

/// Times rtcCommitScene at medium quality (Embree's default) for the scene's only object, with all
/// threads. Each commit is a new RTCScene; buffers are filled once and before, and releasing a
/// scene is not timed.
class EmbreeCommit {
  public:
    explicit EmbreeCommit(const Scene& scene);
    ~EmbreeCommit();
    EmbreeCommit(const EmbreeCommit&) = delete;
    EmbreeCommit& operator=(const EmbreeCommit&) = delete;

    double commit_ms();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Times what Embree does when the instances of a scene move: rtcSetGeometryTransform and
/// rtcCommitGeometry for every instance, shared out over all threads, then rtcCommitScene of the
/// top level, with all threads. The objects' scenes are committed once and before.
///
/// Medium quality, Embree's default, is also its fastest here: low quality, meant for scenes that
/// change, took 1.4 to 2.3 times as long for 10 to 10,000 instances, with the flag `dynamic` and
/// without.
class EmbreeRecommit {
  public:
    explicit EmbreeRecommit(const Scene& scene);
    ~EmbreeRecommit();
    EmbreeRecommit(const EmbreeRecommit&) = delete;
    EmbreeRecommit& operator=(const EmbreeRecommit&) = delete;

    double recommit_ms(std::span<const Affine> world_from_object);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Sets the counters: medians of both, in ms, and ratio_to_embree_commit (below 1: ours is faster)
/// with the ends of its 95 % bootstrap interval.
void report_ratio(benchmark::State& state, const std::vector<double>& ours_ms,
                  const std::vector<double>& embree_ms);

/// The rounds of a benchmark: more than the 9 repetitions that every comparison of speed needs.
inline constexpr int kRounds = 31;

/// Milliseconds of wall time that `work` takes. Freeing what it returns is not counted.
template <class Work>
double time_ms(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    auto result = work();
    benchmark::DoNotOptimize(result);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    return elapsed.count();
}

/// Calls `ours_ms(round)` and `embree_ms(round)`, which time themselves, once a round, by turns who
/// goes first; round 0 is to warm up and not counted. Ends with report_ratio().
template <class Ours, class Embree>
void run_by_turns(benchmark::State& state, const Ours& ours_ms, const Embree& embree_ms) {
    std::vector<double> ours;
    std::vector<double> embree;
    ours_ms(0);
    embree_ms(0);
    for (auto _ : state) {
        const size_t round = ours.size() + 1;
        const bool ours_first = round % 2 == 1;
        if (!ours_first) embree.push_back(embree_ms(round));
        ours.push_back(ours_ms(round));
        if (ours_first) embree.push_back(embree_ms(round));
        state.SetIterationTime(ours.back() * 1e-3);
    }
    report_ratio(state, ours, embree);
}

/// `build` against Embree's commit of the scene's only object. As for Embree, freeing is not timed.
template <class Build>
void run_against_embree_commit(benchmark::State& state, const Scene& scene, const Build& build) {
    EmbreeCommit embree(scene);
    run_by_turns(
        state, [&](size_t) { return time_ms(build); }, [&](size_t) { return embree.commit_ms(); });
}

}  // namespace onepass
