// The build benchmarks. To add one, write a function and give it a line in kBenchmarks.
#include "compare/bench/build_benchmarks.h"

#include <memory>

#include "compare/bench/bench_scenes.h"
#include "compare/bench/versus_embree.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/two_level_textures.h"

namespace onepass {
namespace {

void grid_build(benchmark::State& state, const Scene& scene) {
    run_against_embree_commit(state, scene,
                              [&] { return build_two_level_grid(scene, TwoLevelSizing{}); });
}

/// Packing alone, from a grid that is there.
void grid_pack(benchmark::State& state, const Scene& scene) {
    const TwoLevelGrid grid = build_two_level_grid(scene, TwoLevelSizing{});
    run_against_embree_commit(state, scene,
                              [&] { return pack_two_level_textures(scene, grid, {}); });
}

/// What a GPU tracer does before its first upload.
void grid_build_and_pack(benchmark::State& state, const Scene& scene) {
    run_against_embree_commit(state, scene, [&] {
        return pack_two_level_textures(scene, build_two_level_grid(scene, TwoLevelSizing{}), {});
    });
}

struct BuildBenchmark {
    const char* name;
    void (*run)(benchmark::State&, const Scene&);
};

constexpr BuildBenchmark kBenchmarks[] = {
    {"grid_build", grid_build},
    {"grid_pack", grid_pack},
    {"grid_build_and_pack", grid_build_and_pack},
};

}  // namespace

void register_build_benchmarks() {
    const auto scenes = std::make_shared<const std::vector<BenchScene>>(make_bench_scenes());
    for (const BuildBenchmark& entry : kBenchmarks) {
        for (const BenchScene& mesh : *scenes) {
            const auto run = [scenes, &mesh, entry](benchmark::State& state) {
                entry.run(state, mesh.scene);
            };
            const std::string name = std::string(entry.name) + "/" + mesh.name;
            benchmark::RegisterBenchmark(name.c_str(), run)
                ->Iterations(kRounds)
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        }
    }
}

}  // namespace onepass
