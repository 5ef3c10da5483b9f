// The build benchmarks. To add one, write a function and give it a line in kBenchmarks.
#include "compare/bench/build_benchmarks.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "compare/bench/bench_scenes.h"
#include "compare/bench/versus_embree.h"
#include "compare/peak_memory.h"
#include "core/grid/empty_space.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/two_level_buffers.h"
#include "gpu_glsl/pack/two_level_textures.h"

namespace onepass {
namespace {

/// Cells per triangle: the paper's kind of grid, and the ends of what the fast one is tuned among.
constexpr double kDensities[] = {5.0, 8.0, 16.0};

TwoLevelSizing sizing_of(double density) { return {.object = {.density = density}}; }

TwoLevelBuffers build_and_pack_buffers(const Scene& scene, double density) {
    // No device is asked: nothing is uploaded.
    constexpr TextureLimits kNoLimit{.max_buffer = uint64_t{1} << 40};
    return pack_two_level_buffers(
        scene, build_two_level_grid(scene, sizing_of(density), Duplicates::dropped), kNoLimit,
        BufferKind::texture, PlanesForm::floats);
}

void grid_build(benchmark::State& state, const Scene& scene, double density) {
    run_against_embree_commit(state, scene, [&] {
        return build_two_level_grid(scene, sizing_of(density), Duplicates::dropped);
    });
}

/// From a grid that is there.
void grid_empty_cubes(benchmark::State& state, const Scene& scene, double density) {
    const TwoLevelGrid grid = build_two_level_grid(scene, sizing_of(density), Duplicates::dropped);
    const UniformGrid& object = grid.objects.front();
    std::vector<uint32_t> codes(object.cell_count());
    run_against_embree_commit(state, scene, [&] {
        find_empty_cubes(object, codes.data());
        return codes.data();
    });
}

/// Packing for the paper's textures alone, from a grid that is there.
void grid_pack(benchmark::State& state, const Scene& scene, double density) {
    const TwoLevelGrid grid = build_two_level_grid(scene, sizing_of(density));
    run_against_embree_commit(state, scene,
                              [&] { return pack_two_level_textures(scene, grid, {}); });
}

/// What the paper's GPU tracers do before their first upload.
void grid_build_and_pack(benchmark::State& state, const Scene& scene, double density) {
    run_against_embree_commit(state, scene, [&] {
        return pack_two_level_textures(scene, build_two_level_grid(scene, sizing_of(density)), {});
    });
}

/// What the strategy `grid` does before its first upload.
void grid_build_and_pack_buffers(benchmark::State& state, const Scene& scene, double density) {
    run_against_embree_commit(state, scene, [&] { return build_and_pack_buffers(scene, density); });
}

double stat_value(const std::vector<Stat>& stats, const std::string& name) {
    for (const Stat& stat : stats) {
        if (stat.name == name) return stat.value;
    }
    return 0.0;
}

/// The time is that of building and packing, measurement of memory included.
void grid_memory(benchmark::State& state, const Scene& scene, double density) {
    std::vector<Stat> stats;
    std::optional<uint64_t> peak;
    for (auto _ : state) {
        const double ms = time_ms([&] {
            peak = peak_memory_of([&] { stats = build_and_pack_buffers(scene, density).stats; });
            return peak;
        });
        state.SetIterationTime(ms * 1e-3);
    }
    if (!peak) return state.SkipWithError("no peak of resident memory to be had");

    constexpr double kBytesATriangle = 64.0;
    constexpr double kBytesAReference = 16.0;
    constexpr double kBytesACell = 8.0;
    const double bytes = static_cast<double>(*peak);
    const double triangles = stat_value(stats, "triangles");
    const double references = stat_value(stats, "references");
    const double cells = stat_value(stats, "cells");
    const double budget =
        kBytesATriangle * triangles + kBytesAReference * references + kBytesACell * cells;
    state.counters["bytes"] = bytes;
    state.counters["triangles"] = triangles;
    state.counters["references"] = references;
    state.counters["cells"] = cells;
    state.counters["share_of_budget"] = bytes / budget;
}

using Run = void (*)(benchmark::State&, const Scene&, double density);

struct BuildBenchmark {
    const char* name;
    Run run;
    bool any_density;  ///< or the usual one only
};

constexpr BuildBenchmark kBenchmarks[] = {
    {"grid_build", grid_build, true},
    {"grid_empty_cubes", grid_empty_cubes, true},
    {"grid_pack", grid_pack, false},
    {"grid_build_and_pack", grid_build_and_pack, false},
    {"grid_build_and_pack_buffers", grid_build_and_pack_buffers, true},
    {"grid_memory", grid_memory, true},
};

/// `scene` is called when the benchmark runs.
template <class SceneOf>
void register_one(const BuildBenchmark& entry, const std::string& mesh, double density, int rounds,
                  const SceneOf& scene) {
    const std::string name = entry.any_density
                                 ? fmt::format("{}/density:{:g}/{}", entry.name, density, mesh)
                                 : fmt::format("{}/{}", entry.name, mesh);
    benchmark::RegisterBenchmark(
        name.c_str(), [=](benchmark::State& state) { entry.run(state, scene(), density); })
        ->Iterations(rounds)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_build_benchmarks() {
    const auto scenes = std::make_shared<const std::vector<BenchScene>>(make_bench_scenes());
    for (const BuildBenchmark& entry : kBenchmarks) {
        const bool is_memory = entry.run == grid_memory;
        const int rounds = is_memory ? 1 : kRounds;
        for (const double density : kDensities) {
            if (!entry.any_density && density != TwoLevelSizing{}.object.density) continue;
            for (const BenchScene& mesh : *scenes) {
                register_one(entry, mesh.name, density, rounds,
                             [scenes, &mesh]() -> const Scene& { return mesh.scene; });
            }
            // The large mesh is not kept: it would stand in every other benchmark's memory.
            constexpr int kRoundsOfLarge = 3;
            if (entry.any_density) {
                register_one(entry, "10M", density, is_memory ? 1 : kRoundsOfLarge,
                             make_large_bench_scene);
            }
        }
    }
}

}  // namespace onepass
