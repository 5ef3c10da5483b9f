// onepass tune: the grid-resolution study, each size with its errors.
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/manifest.h"
#include "compare/statistics.h"
#include "compare/sweep.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

struct TuneCommand {
    std::vector<std::string> scenes;
    StrategyOptions strategy;
    RayOptions rays{{"primary"}, "512x512", 0};
    std::vector<double> densities = {0.5, 1, 2, 4, 8, 16, 32};
    std::vector<double> top_densities;
    TimingOptions timing;
    std::string json;
};

/// The strategies asked for; of the defaults, those that have grids.
std::vector<SelectedStrategy> grid_strategies(const Session& session,
                                              const StrategyOptions& options) {
    std::vector<SelectedStrategy> selected = select_strategies(session.catalogue, options);
    if (options.patterns.empty()) {
        std::erase_if(selected, [](const auto& s) { return !has_grid_density(s.entry->info); });
    }
    for (const SelectedStrategy& strategy : selected) {
        if (has_grid_density(strategy.entry->info)) continue;
        throw Error({strategy.entry->info.name, "no parameter 'density'", "a strategy over grids",
                     "Name one with -s."});
    }
    if (selected.empty()) {
        throw Error({"onepass tune", "no strategy over grids", "at least one",
                     "Name one with -s ('onepass list strategies')."});
    }
    return selected;
}

std::string sweep_table(std::span<const SweepPoint> points) {
    const SweepPoint& first = points.front();
    std::string text = fmt::format("{}, {} rays, {}\n", first.scene, first.rays, first.tracer);
    std::vector<std::vector<std::string>> rows = {
        {"density", "top density", "cells", "references", "MiB", "build ms", "cells/ray",
         "tests/ray", "median ms", "ratio", "95 % interval", "errors"}};
    std::string failures;
    for (const SweepPoint& p : points) {
        if (!p.failure.empty()) {
            failures += fmt::format("  density {}, top density {}: {}\n", p.object_density,
                                    p.top_density, p.failure);
            continue;
        }
        rows.push_back({fmt::format("{}", p.object_density), fmt::format("{}", p.top_density),
                        std::to_string(p.cells), std::to_string(p.references),
                        fmt::format("{:.1f}", static_cast<double>(p.bytes) / 1048576.0),
                        fmt::format("{:.1f}", p.build_ms), fmt::format("{:.1f}", p.cells_per_ray),
                        fmt::format("{:.1f}", p.tests_per_ray),
                        fmt::format("{:.2f}", median(p.wall_ms)), fmt::format("{:.3f}", p.ratio),
                        fmt::format("{:.3f}..{:.3f}", p.ratio_low, p.ratio_high),
                        std::to_string(p.errors)});
    }
    text += format_table(rows) + failures;
    if (const SweepPoint* best = best_point(points)) {
        text += fmt::format("  best: density {}, top density {}: {:.3f} of {}, {} errors\n",
                            best->object_density, best->top_density, best->ratio, kOracleName,
                            best->errors);
    }
    return text;
}

/// One run of the command.
struct TuneRun {
    Session& session;
    const TuneCommand& options;
    const std::vector<SelectedStrategy> selected;
    const ImageSize size;
    Results results;
    std::string tables;

    /// The tracer's record describes it at its best size.
    void record_tracer(const Court& court, const SelectedStrategy& strategy,
                       std::span<const SweepPoint> points) {
        const SweepPoint* best = best_point(points);
        if (!best) return;
        const TracerInfo& info = strategy.entry->info;
        ParamValues params = strategy.params;
        params[kObjectDensityParam] = fmt::format("{}", best->object_density);
        for (const ParamInfo& param : info.params) {
            if (param.name == kTopDensityParam) {
                params[param.name] = fmt::format("{}", best->top_density);
            }
        }
        const std::unique_ptr<Tracer> tracer = strategy.entry->make(court.open.scene, params);
        results.tracers.push_back(make_tracer_record(court.open.name, *tracer, info, params));
    }

    void sweep(Court& court, const Case& subject, const SelectedStrategy& strategy,
               const Progress& progress) {
        SweepOptions sweep_options{options.densities,
                                   options.top_densities,
                                   strategy.params,
                                   {.seed = session.globals.seed},
                                   options.timing};
        sweep_options.timing.seed = session.globals.seed;
        std::vector<SweepPoint> points =
            sweep_grid_sizes(*strategy.entry, court.open.scene, subject.rays, *court.oracle,
                             *court.judge, sweep_options, progress);
        for (SweepPoint& point : points) point.scene = court.open.name;
        if (points.empty()) return;
        tables += sweep_table(points);
        record_tracer(court, strategy, points);
        results.sweeps.insert(results.sweeps.end(), points.begin(), points.end());
    }

    void tune_scene(const std::string& name, const Progress& progress) {
        Court court = open_court(session, name);
        results.manifest.judge = court.judge->name();
        results.scenes.push_back(court.open.record);
        const RayRequest request{size.width, size.height, options.rays.camera,
                                 session.globals.seed};
        const double total = static_cast<double>(options.rays.kinds.size() * selected.size());
        double done = 0.0;
        for (const std::string& kind : options.rays.kinds) {
            const Case subject = open_case(court, kind, request);
            for (const SelectedStrategy& strategy : selected) {
                if (stop_requested()) return;
                sweep(court, subject, strategy,
                      [&](double share) { return go_on(progress, (done + share) / total); });
                done += 1.0;
            }
        }
    }
};

void run(Session& session, const TuneCommand& options) {
    if (!options.json.empty() && options.json != "-") check_writable(options.json);
    TuneRun tune{
        session, options, grid_strategies(session, options.strategy), parse_size(options.rays.size),
        {},      {}};
    {
        ProgressBar bar("tune");
        const double scenes = static_cast<double>(options.scenes.size());
        for (size_t i = 0; i < options.scenes.size() && !stop_requested(); ++i) {
            const double begin = static_cast<double>(i) / scenes;
            tune.tune_scene(options.scenes[i], bar.part(begin, begin + 1.0 / scenes));
        }
    }
    fmt::print(table_stream(options.json), "{}", tune.tables);
    finish(session, tune.results, options.json, stop_requested());
}

}  // namespace

void add_tune(CLI::App& app, Session& session) {
    CLI::App* command =
        app.add_subcommand("tune", "Sweeps the grid resolution of strategies and picks the best");
    auto options = std::make_shared<TuneCommand>();
    command->add_option("scenes", options->scenes, "Scene names or files")->required();
    add_strategy_options(*command, options->strategy);
    add_ray_options(*command, options->rays);
    command
        ->add_option("--densities", options->densities,
                     "Densities of the object grids, in cells a triangle, by commas")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option("--top-densities", options->top_densities,
                     "Densities of the top-level grid, in cells an instance, by commas. "
                     "Default: the strategy's own")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::PositiveNumber);
    command
        ->add_option("--repetitions", options->timing.repetitions,
                     fmt::format("Counted rounds a size, at least {}", kLeastRepetitions))
        ->capture_default_str();
    command
        ->add_option("--warm-up", options->timing.warm_up_ms,
                     "Least time of uncounted rounds before each size, in ms")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command->add_option("--json", options->json, "Writes the results; '-' is standard output")
        ->type_name("FILE");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
