// One of our builds against Embree's commit of the same mesh, by turns in the same run.
#pragma once

#include <chrono>
#include <memory>
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
/// rtcCommitGeometry for every instance, then rtcCommitScene of the top level at medium quality, as
/// for a new scene; with all threads. The objects' scenes are committed once and before.
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

/// Runs `build` and Embree's commit once a round, by turns who goes first; one round to warm up is
/// not counted. Wall time; freeing what `build` returns is not timed, as it is not for Embree.
template <class Build>
void run_against_embree_commit(benchmark::State& state, const Scene& scene, const Build& build) {
    std::vector<double> ours_ms;
    std::vector<double> embree_ms;
    EmbreeCommit embree(scene);
    const auto time_build = [&] {
        const auto start = std::chrono::steady_clock::now();
        auto result = build();
        benchmark::DoNotOptimize(result);
        const std::chrono::duration<double, std::milli> elapsed =
            std::chrono::steady_clock::now() - start;
        return elapsed.count();
    };

    time_build();
    embree.commit_ms();
    for (auto _ : state) {
        const bool ours_first = ours_ms.size() % 2 == 0;
        if (!ours_first) embree_ms.push_back(embree.commit_ms());
        ours_ms.push_back(time_build());
        if (ours_first) embree_ms.push_back(embree.commit_ms());
        state.SetIterationTime(ours_ms.back() * 1e-3);
    }
    report_ratio(state, ours_ms, embree_ms);
}

}  // namespace onepass
