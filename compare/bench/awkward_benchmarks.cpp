// A batch of spoiled rays against the same rays as they were, by turns in the same run.
#include "compare/bench/awkward_benchmarks.h"

#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "compare/bench/bench_scenes.h"
#include "compare/bench/versus_embree.h"
#include "compare/rays.h"
#include "compare/statistics.h"
#include "compare/trials.h"
#include "core/catalogue.h"
#include "core/error.h"
#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/glsl_tracers.h"

namespace onepass {
namespace {

constexpr const char* kTracers[] = {"grid/buffer/fragment", "grid/buffer/compute",
                                    "paper/texture2d/fragment", "paper/texture2d/compute"};
constexpr size_t kRays = size_t{1} << 15;

/// What all benchmarks share; made at the first of them, because a context takes its time and may
/// not be had.
struct Bench {
    std::unique_ptr<gl::GlContext> context = gl::make_context();
    ScenePtr scene = std::make_shared<const Scene>(make_bench_scenes().front().scene);
    std::vector<Ray> normal = random_rays(scene_bounds(*scene), kRays, 1);
    Catalogue catalogue;

    Bench() {
        for (CatalogueEntry& entry : glsl_tracers(
                 gl::ShaderLibrary::embedded(), [this]() -> gl::GlContext& { return *context; })) {
            catalogue.add(std::move(entry));
        }
    }
};

Bench& bench() {
    static Bench made;
    return made;
}

double cast_ms(Tracer& tracer, const RayBatch& batch) { return tracer.cast(batch, {}).wall_ms; }

void time_spoiled(benchmark::State& state, const std::string& name, const Spoiler& spoiler) {
    const auto tracer = bench().catalogue.at(name).make(bench().scene, {});
    std::vector<Ray> spoiled;
    for (const Ray& ray : bench().normal) spoiled.push_back(spoiler.spoil(ray, spoiled.size()));
    const RayBatch normal_batch = tracer->upload(bench().normal);
    const RayBatch spoiled_batch = tracer->upload(spoiled);

    // Warm up, then by turns who goes first.
    cast_ms(*tracer, normal_batch);
    cast_ms(*tracer, spoiled_batch);
    std::vector<double> normal_ms;
    std::vector<double> spoiled_ms;
    for (auto _ : state) {
        const bool spoiled_first = spoiled_ms.size() % 2 == 0;
        if (!spoiled_first) normal_ms.push_back(cast_ms(*tracer, normal_batch));
        spoiled_ms.push_back(cast_ms(*tracer, spoiled_batch));
        if (spoiled_first) normal_ms.push_back(cast_ms(*tracer, normal_batch));
        state.SetIterationTime(spoiled_ms.back() * 1e-3);
    }

    constexpr uint64_t kBootstrapSeed = 1;
    const RatioInterval ratio = ratio_of_medians(spoiled_ms, normal_ms, kBootstrapSeed);
    state.counters["times_a_normal_ray"] = ratio.ratio;
    state.counters["times_low"] = ratio.low;
    state.counters["times_high"] = ratio.high;
    state.counters["within_bound"] = ratio.ratio <= kMostTimesANormalRay ? 1.0 : 0.0;
    state.SetLabel(tracer->capabilities().device);
}

/// Without a device the benchmark says so and the others go on.
void awkward_rays(benchmark::State& state, const std::string& name, const Spoiler& spoiler) {
    try {
        time_spoiled(state, name, spoiler);
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
}

std::string joined_words(std::string text) {
    for (char& c : text) c = c == ' ' ? '_' : c;
    return text;
}

}  // namespace

void register_awkward_benchmarks() {
    for (const char* name : kTracers) {
        for (const Spoiler& spoiler : spoilers()) {
            const std::string full =
                "awkward_rays/" + std::string(name) + "/" + joined_words(spoiler.label);
            benchmark::RegisterBenchmark(
                full.c_str(),
                [name, spoiler](benchmark::State& state) { awkward_rays(state, name, spoiler); })
                ->Iterations(kRounds)
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        }
    }
}

}  // namespace onepass
