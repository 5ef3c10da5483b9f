// The build benchmarks. To add one, write a function and give it a line in kBenchmarks.
#include "compare/bench/build_benchmarks.h"

#include <memory>

#include "compare/bench/bench_scenes.h"
#include "compare/bench/versus_embree.h"
#include "core/grid/two_level_grid.h"

namespace onepass {
namespace {

void grid_build(benchmark::State& state, const Scene& scene) {
    run_against_embree_commit(state, scene,
                              [&] { return build_two_level_grid(scene, TwoLevelSizing{}); });
}

struct BuildBenchmark {
    const char* name;
    void (*run)(benchmark::State&, const Scene&);
};

constexpr BuildBenchmark kBenchmarks[] = {
    {"grid_build", grid_build},
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
