// A swarm of moving instances: our update against Embree's.
#include "compare/bench/moving_benchmarks.h"

#include <string>
#include <utility>

#include "compare/bench/versus_embree.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/top_level_update.h"
#include "scenes/motions.h"

namespace onepass {
namespace {

/// A swarm, and where its instances are at each round of a benchmark.
struct Swarm {
    ScenePtr scene;
    std::vector<std::vector<Affine>> frames;
};

Swarm moving_swarm(uint32_t instances) {
    constexpr uint64_t kSeed = 1;
    Swarm swarm;
    swarm.scene = std::make_shared<const Scene>(make_swarm(instances, kSeed));
    const double step_s = double{swarm.scene->animation.duration()} / (kRounds + 1);
    for (int round = 0; round <= kRounds; ++round) {
        swarm.frames.push_back(instance_transforms(*swarm.scene, round * step_s));
    }
    return swarm;
}

MovingTopLevel packed_top_level(const ScenePtr& scene) {
    const TwoLevelSizing sizing;
    TwoLevelTexturesOptions options;
    options.moving = true;
    TwoLevelGrid grid = build_two_level_grid(*scene, sizing);
    TwoLevelTextures packed = pack_two_level_textures(*scene, grid, options);
    return MovingTopLevel(scene, std::move(grid), sizing.top, std::move(packed.places), options);
}

void top_level_rebuild(benchmark::State& state, uint32_t instances) {
    const Swarm swarm = moving_swarm(instances);
    MovingTopLevel moving = packed_top_level(swarm.scene);
    EmbreeRecommit embree(*swarm.scene);
    const auto update = [&](size_t round) {
        TopLevelMove move = moving.plan(swarm.frames[round]);
        moving.commit(move);
        return move;
    };
    run_by_turns(
        state, [&](size_t round) { return time_ms([&] { return update(round); }); },
        [&](size_t round) { return embree.recommit_ms(swarm.frames[round]); });
}

/// The same for the strategy `grid`, which keeps its top level in buffers.
void top_level_rebuild_buffers(benchmark::State& state, uint32_t instances) {
    const Swarm swarm = moving_swarm(instances);
    const TwoLevelSizing sizing;
    const MovingTopBuffers moving(
        swarm.scene, sizing.top,
        pack_two_level_buffers(*swarm.scene, build_two_level_grid(*swarm.scene, sizing), {},
                               BufferKind::texture, PlanesForm::floats),
        {});
    EmbreeRecommit embree(*swarm.scene);
    run_by_turns(
        state,
        [&](size_t round) { return time_ms([&] { return moving.plan(swarm.frames[round]); }); },
        [&](size_t round) { return embree.recommit_ms(swarm.frames[round]); });
}

void top_level_grid(benchmark::State& state, uint32_t instances) {
    const Swarm swarm = moving_swarm(instances);
    std::vector<std::vector<Bounds>> boxes;
    const Bounds object = object_bounds(swarm.scene->objects.front());
    for (const std::vector<Affine>& frame : swarm.frames) {
        std::vector<Bounds> of_frame;
        for (const Affine& m : frame) of_frame.push_back(transform_bounds(m, object));
        boxes.push_back(std::move(of_frame));
    }
    EmbreeRecommit embree(*swarm.scene);
    const GridSizing sizing = TwoLevelSizing{}.top;
    run_by_turns(
        state,
        [&](size_t round) { return time_ms([&] { return build_box_grid(boxes[round], sizing); }); },
        [&](size_t round) { return embree.recommit_ms(swarm.frames[round]); });
}

struct MovingBenchmark {
    const char* name;
    void (*run)(benchmark::State&, uint32_t instances);
};

constexpr MovingBenchmark kBenchmarks[] = {
    {"top_level_rebuild", top_level_rebuild},
    {"top_level_rebuild_buffers", top_level_rebuild_buffers},
    {"top_level_grid", top_level_grid},
};

}  // namespace

void register_moving_benchmarks() {
    for (const MovingBenchmark& entry : kBenchmarks) {
        for (const uint32_t instances : {10u, 100u, 1000u, 10000u}) {
            const auto run = [entry, instances](benchmark::State& state) {
                entry.run(state, instances);
            };
            const std::string name = std::string(entry.name) + "/" + std::to_string(instances);
            benchmark::RegisterBenchmark(name.c_str(), run)
                ->Iterations(kRounds)
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        }
    }
}

}  // namespace onepass
