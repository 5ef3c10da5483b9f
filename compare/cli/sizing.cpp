#include "compare/cli/sizing.h"

#include <algorithm>

#include <fmt/format.h>

#include "compare/sizing_file.h"
#include "compare/tuning.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

constexpr char kAuto[] = "auto";

void refuse_two_sizes(const SelectedStrategy& strategy) {
    for (const char* name : {kObjectDensityParam, kTopDensityParam, kResolutionParam,
                             kTopResolutionParam, kObjectSizesParam}) {
        if (!strategy.params.contains(name)) continue;
        throw Error({"--sizing", fmt::format("--param {} as well", name), "one of the two",
                     "Leave the other out."});
    }
}

/// A sample of each ray kind, all together.
std::vector<Ray> sample_of_kinds(const Session& session, const OpenScene& open,
                                 const std::vector<std::string>& ray_kinds, uint32_t camera) {
    constexpr uint32_t kSampleSide = 64;
    const std::unique_ptr<Tracer> oracle = session.catalogue.at(kOracleName).make(open.scene, {});
    std::vector<Ray> sample;
    for (const std::string& kind : ray_kinds) {
        const RaySet rays = make_ray_set(kind, *open.scene, *oracle,
                                         {kSampleSide, kSampleSide, camera, session.globals.seed});
        const std::vector<Ray> some = sample_of(rays.rays, kSampleRays);
        sample.insert(sample.end(), some.begin(), some.end());
    }
    return sample;
}

}  // namespace

void add_costs_option(CLI::App& command, SizingOptions& options) {
    command
        .add_option("--costs", options.costs,
                    "For auto sizes: takes the costs of a cell and a test from these results of "
                    "'onepass tune', made on this machine; may be repeated. Default: those that "
                    "come with the program")
        ->type_name("RESULT.json")
        ->allow_extra_args(false);
}

void add_sizing_options(CLI::App& command, SizingOptions& options) {
    command
        .add_option("--sizing", options.sizing,
                    "Sizes of the grids: 'auto' chooses them by counting, with no ray timed; a "
                    "file of 'onepass tune --sizing-out' has those that were measured. Default: "
                    "the strategies' parameters")
        ->type_name("auto|FILE");
    add_costs_option(command, options);
}

CostModel costs_for(const std::string& tracer, const SizingOptions& options) {
    std::vector<SweepPoint> points;
    for (const std::string& file : options.costs) {
        const Results results = read_results(file);
        points.insert(points.end(), results.sweeps.begin(), results.sweeps.end());
    }
    if (const std::optional<CostModel> fitted = costs_of(points, tracer)) return *fitted;
    if (const CostModel* known = known_costs_of(tracer)) return *known;
    throw Error({"auto sizes with " + tracer, "no costs of its cells and tests",
                 "a result of 'onepass tune' with this strategy", "Name one with --costs."});
}

AutoSizing auto_size(const Session& session, const ScenePtr& scene,
                     const SelectedStrategy& strategy, std::span<const Ray> sample,
                     const CostModel& costs) {
    const TracerInfo& info = strategy.entry->info;
    const CatalogueEntry* counter = counter_of(session.catalogue, info);
    if (counter == nullptr) {
        throw Error({"auto sizes with " + info.name, "a strategy without a twin",
                     "one that can be counted on the CPU",
                     "Give the sizes yourself, or a sizing file."});
    }
    return choose_sizes(*counter, scene, strategy.params, sample, costs);
}

std::string size_text(const GridSize& size) {
    const std::string top = fmt::format(", top density {}", size.top_density);
    if (!size.sizes.empty()) return "own sizes " + size.sizes + top;
    if (!size.resolution.empty()) return size.resolution + " cells" + top;
    return fmt::format("density {}", size.object_density) + top;
}

std::vector<SelectedStrategy> sized(const Session& session, const OpenScene& open,
                                    std::vector<SelectedStrategy> strategies,
                                    const SizingOptions& options,
                                    const std::vector<std::string>& ray_kinds, uint32_t camera) {
    std::vector<Ray> sample;  // one for all
    for (SelectedStrategy& strategy : strategies) {
        const TracerInfo& info = strategy.entry->info;
        if (sizing_name(info, options).empty()) continue;
        refuse_two_sizes(strategy);
        GridSize size;
        if (options.sizing == kAuto) {
            if (sample.empty()) sample = sample_of_kinds(session, open, ray_kinds, camera);
            const AutoSizing chosen =
                auto_size(session, open.scene, strategy, sample, costs_for(info.name, options));
            fmt::print(stderr, "onepass: {}: auto sizes of {}: {} (chosen in {:.0f} ms)\n",
                       open.name, info.name, size_text(chosen.size), chosen.choice_ms);
            size = chosen.size;
        } else {
            size = size_from(read_sizing_file(options.sizing), options.sizing, info.name,
                             *open.scene, open.record.hash, ray_kinds);
        }
        strategy.params = sized_params(info, strategy.params, size);
    }
    return strategies;
}

std::string sizing_name(const TracerInfo& info, const SizingOptions& options) {
    return has_grid_density(info) ? options.sizing : std::string();
}

}  // namespace onepass::cli
