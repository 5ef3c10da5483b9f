#include "compare/auto_sizing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "compare/tuning.h"
#include "core/error.h"

namespace onepass {
namespace {

/// From a quarter of a cell a triangle on, twofold.
constexpr double kCoarsestDensity = 0.25;
constexpr double kLadderStep = 2.0;

/// Adds one ray's walk to its objects.
void add_walk(const Scene& scene, const RayWalk& walk, CountedSize& counted) {
    std::vector<bool> seen(scene.objects.size(), false);
    for (const WalkStep& step : walk.steps) {
        if (step.inst_id == kNoId) continue;
        const uint32_t object = scene.instances[step.inst_id].object;
        counted.object_cells[object] += 1.0;
        counted.object_tests[object] += static_cast<double>(step.tests.size());
        seen[object] = true;
    }
    for (size_t k = 0; k < seen.size(); ++k) counted.object_rays[k] += seen[k] ? 1 : 0;
}

CountedSize count_sample(const CatalogueEntry& counter, const ScenePtr& scene,
                         const ParamValues& params, const GridSize& size,
                         std::span<const Ray> sample, bool by_object) {
    const std::unique_ptr<Tracer> tracer =
        counter.make(scene, sized_params(counter.info, params, size));
    const Capabilities capabilities = tracer->capabilities();
    if (!capabilities.counters || (by_object && !capabilities.walks)) {
        throw Error({"auto sizes with " + counter.info.name,
                     capabilities.counters ? "a tracer that does not tell its walks"
                                           : "a tracer that does not count",
                     "a twin", "Give the sizes yourself, or a sizing file."});
    }
    CountedSize counted{.density = size.object_density};
    const double share = 1.0 / static_cast<double>(sample.size());
    const CastResult cast = tracer->cast(tracer->upload(sample), {.counters = true});
    for (const RayCounters& counters : cast.counters) {
        counted.cells += share * counters.cells;
        counted.tests += share * counters.tests;
    }
    if (!by_object) return counted;
    const size_t objects = scene->objects.size();
    counted.object_cells.resize(objects);
    counted.object_tests.resize(objects);
    counted.object_rays.resize(objects);
    for (const Ray& ray : sample) add_walk(*scene, tracer->walk(ray).value(), counted);
    for (double& cells : counted.object_cells) cells *= share;
    for (double& tests : counted.object_tests) tests *= share;
    return counted;
}

/// The same for a size that the strategy may refuse.
std::optional<CountedSize> try_sample(const CatalogueEntry& counter, const ScenePtr& scene,
                                      const ParamValues& params, const GridSize& size,
                                      std::span<const Ray> sample, bool by_object,
                                      std::string& refusal) {
    try {
        return count_sample(counter, scene, params, size, sample, by_object);
    } catch (const Error& error) {
        refusal = error.what();
        return std::nullopt;
    }
}

/// Counts at one density after the other, coarse to fine.
std::vector<CountedSize> climb(const CatalogueEntry& counter, const ScenePtr& scene,
                               const ParamValues& params, double top_density,
                               std::span<const Ray> sample, const CostModel& costs) {
    const bool by_object = scene->objects.size() > 1;
    std::vector<CountedSize> ladder;
    std::string refusal;
    double least_ns = std::numeric_limits<double>::infinity();
    const double highest = std::min(DensitySearch{}.highest, highest_density(*scene));
    for (double density = kCoarsestDensity; density <= highest; density *= kLadderStep) {
        const std::optional<CountedSize> counted = try_sample(
            counter, scene, params, {.top_density = top_density, .object_density = density}, sample,
            by_object, refusal);
        // Lists that are too long end with a finer grid; cells that are too many do not.
        if (!counted && !ladder.empty()) break;
        if (!counted) continue;
        ladder.push_back(*counted);
        const double ns = costs.ns(counted->cells, counted->tests);
        least_ns = std::min(least_ns, ns);
        if (ns > least_ns * (1.0 + kRisenEnough)) break;
    }
    if (ladder.empty()) {
        throw Error({"auto sizes with " + counter.info.name,
                     refusal.empty() ? "a scene of too many triangles" : refusal,
                     "a density that can be built", "Give the sizes yourself."});
    }
    return ladder;
}

/// The rung that a cost says is coarse enough and good.
template <class Cost>
const CountedSize& best_rung(const std::vector<CountedSize>& ladder, const Cost& cost) {
    std::vector<double> predicted;
    for (const CountedSize& rung : ladder) predicted.push_back(cost(rung));
    return ladder[coarsest_worthwhile(predicted)];
}

/// "8,2,8": each object its rung; empty if all have the same.
std::string own_sizes(const std::vector<CountedSize>& ladder, double shared_density,
                      const CostModel& costs) {
    std::string text;
    bool differ = false;
    for (size_t k = 0; k < ladder.front().object_cells.size(); ++k) {
        const bool known = std::any_of(ladder.begin(), ladder.end(), [&](const CountedSize& rung) {
            return rung.object_rays[k] >= kLeastRaysOfObject;
        });
        double density = shared_density;
        if (known) {
            density = best_rung(ladder, [&](const CountedSize& rung) {
                          return costs.ns(rung.object_cells[k], rung.object_tests[k]) - costs.ray;
                      }).density;
        }
        differ = differ || density != shared_density;
        text += fmt::format("{}{}", k == 0 ? "" : ",", density);
    }
    return differ ? text : std::string();
}

}  // namespace

std::vector<Ray> sample_of(std::span<const Ray> rays, size_t most) {
    std::vector<Ray> sample;
    const size_t step = std::max<size_t>(1, (rays.size() + most - 1) / most);
    for (size_t i = 0; i < rays.size(); i += step) sample.push_back(rays[i]);
    return sample;
}

AutoSizing choose_sizes(const CatalogueEntry& counter, const ScenePtr& scene,
                        const ParamValues& params, std::span<const Ray> sample,
                        const CostModel& costs) {
    const auto start = std::chrono::steady_clock::now();
    const GridSize usual = default_size(counter.info, params);
    AutoSizing chosen;
    chosen.size = usual;
    chosen.size.chosen = kAutoSize;

    // The objects: all of them climb one ladder, and each stays on its own rung.
    chosen.counted = climb(counter, scene, params, usual.top_density, sample, costs);
    const CountedSize& shared = best_rung(
        chosen.counted, [&](const CountedSize& rung) { return costs.ns(rung.cells, rung.tests); });
    chosen.size.object_density = shared.density;
    chosen.predicted_ns = costs.ns(shared.cells, shared.tests);
    chosen.size.sizes = own_sizes(chosen.counted, shared.density, costs);

    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    chosen.choice_ms = elapsed.count();
    return chosen;
}

const CatalogueEntry* counter_of(const Catalogue& catalogue, const TracerInfo& info) {
    const std::string storage = info.name.substr(0, info.name.rfind('/'));
    for (const CatalogueEntry& entry : catalogue.entries()) {
        if (entry.info.name == storage + "/twin32") return &entry;
    }
    return nullptr;
}

}  // namespace onepass
