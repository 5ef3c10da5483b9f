// onepass tune: the grid-resolution study, each size with its errors; what it costs to be wrong
// about the size; and sizes for other commands to use.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/sizing.h"
#include "compare/cli/study_run.h"
#include "compare/cli/table.h"
#include "compare/manifest.h"
#include "compare/sizing_file.h"
#include "compare/statistics.h"
#include "compare/sweep.h"
#include "compare/tuning.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

struct TuneCommand {
    std::vector<std::string> scenes;
    StrategyOptions strategy;
    RayOptions rays{{"primary"}, "512x512", 0};
    std::vector<double> densities;
    std::vector<double> top_densities;
    std::vector<std::string> resolutions;
    SizingOptions sizing;
    TimingOptions timing;
    StudyOptions study;
    std::string sizing_out;
    std::vector<std::string> fit;

    bool lists_sizes() const {
        return !densities.empty() || !top_densities.empty() || !resolutions.empty();
    }
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

// ---- What the tables say ------------------------------------------------------------------------

std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

std::string regret_text(const Regret& regret) {
    const std::string interval =
        std::isnan(regret.low)
            ? std::string()
            : fmt::format(" (95 %: {:.1f}..{:.1f})", 100.0 * regret.low, 100.0 * regret.high);
    return percent(regret.share) + interval;
}

std::string band_text(const DensityBand& band) {
    return fmt::format("within {:.0f} %: density {}{:.3g} to {:.3g}{}", 100.0 * band.share,
                       band.low_open ? "(lowest) " : "", band.low, band.high,
                       band.high_open ? " (highest)" : "");
}

std::string mib(double bytes) { return fmt::format("{:.1f}", bytes / 1048576.0); }

/// What a sweep comes to.
std::string findings(std::span<const SweepPoint> points, const Tuning& tuning) {
    const SweepPoint& best = points[tuning.best];
    std::string text = fmt::format("  fastest: {}: {:.1f} ns a ray, {} errors\n",
                                   size_text(size_of(best)), tuning.ns[tuning.best], best.errors);
    if (tuning.model && tuning.predicted) {
        const CostModel& m = *tuning.model;
        text += fmt::format(
            "  model: {:.1f} ns + {:.2f} a cell + {:.2f} a test, off by {}; its best: {}: regret "
            "{}\n",
            m.ray, m.cell, m.test, percent(m.relative_error),
            size_text(size_of(points[*tuning.predicted])), regret_text(tuning.predicted_regret));
    }
    if (tuning.automatic) {
        text +=
            fmt::format("  auto: {}: regret {}\n", size_text(size_of(points[*tuning.automatic])),
                        regret_text(tuning.automatic_regret));
    }
    if (tuning.per_object) {
        const double gain = tuning.per_object_gain;
        text += fmt::format("  per object: {}: {} {} than the best single density\n",
                            size_text(size_of(points[*tuning.per_object])), percent(std::abs(gain)),
                            gain < 0.0 ? "slower" : "faster");
    }
    for (const DensityBand& band : tuning.bands) text += "  " + band_text(band) + "\n";
    const SweepPoint& smallest = points[tuning.smallest];
    return text + fmt::format("  no finer than needed: {}: {} MiB, {} MiB less than the fastest\n",
                              size_text(size_of(smallest)),
                              mib(static_cast<double>(smallest.bytes)), mib(tuning.saved_bytes));
}

std::string sweep_table(std::span<const SweepPoint> points) {
    const SweepPoint& first = points.front();
    std::string text = fmt::format("{}, {} rays, {}\n", first.scene, first.rays, first.tracer);
    std::vector<std::vector<std::string>> rows = {
        {"density", "top density", "chosen", "cells", "references", "MiB", "build ms", "cells/ray",
         "tests/ray", "median ms", "ns/ray", "predicted", "ratio", "95 % interval", "errors"}};
    std::string failures;
    const std::optional<Tuning> tuning = tuning_of(points);
    for (size_t i = 0; i < points.size(); ++i) {
        const SweepPoint& p = points[i];
        if (!p.failure.empty()) {
            failures += fmt::format("  {}: {}\n", size_text(size_of(p)), p.failure);
            continue;
        }
        std::string size = fmt::format("{:.4g}", p.object_density);
        if (!p.resolution.empty()) size = p.resolution;
        if (!p.sizes.empty()) size = "by object";
        rows.push_back(
            {size, fmt::format("{:.4g}", p.top_density), p.chosen, std::to_string(p.cells),
             std::to_string(p.references), mib(static_cast<double>(p.bytes)),
             fmt::format("{:.1f}", p.build_ms), fmt::format("{:.1f}", p.cells_per_ray),
             fmt::format("{:.1f}", p.tests_per_ray), fmt::format("{:.2f}", median(p.wall_ms)),
             fmt::format("{:.1f}", tuning->ns[i]),
             tuning->model ? fmt::format("{:.1f}", tuning->predicted_ns[i]) : "-",
             fmt::format("{:.3f}", p.ratio),
             fmt::format("{:.3f}..{:.3f}", p.ratio_low, p.ratio_high), std::to_string(p.errors)});
    }
    text += format_table(rows) + failures;
    return tuning ? text + findings(points, *tuning) : text;
}

/// The sweep points of one scene, ray kind and tracer each, in order of their first.
std::vector<std::vector<SweepPoint>> grouped(const std::vector<SweepPoint>& points) {
    std::vector<std::vector<SweepPoint>> groups;
    for (const SweepPoint& point : points) {
        const auto known = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
            const SweepPoint& first = group.front();
            return first.scene == point.scene && first.rays == point.rays &&
                   first.tracer == point.tracer;
        });
        if (known == groups.end()) {
            groups.push_back({point});
        } else {
            known->push_back(point);
        }
    }
    return groups;
}

// ---- --fit: costs from results ------------------------------------------------------------------

std::string fit_text(const std::vector<SweepPoint>& points) {
    std::set<std::string> tracers;
    for (const SweepPoint& point : points) tracers.insert(point.tracer);
    std::string text;
    for (const std::string& tracer : tracers) {
        std::vector<SweepPoint> own;
        for (const SweepPoint& point : points) {
            if (point.tracer == tracer) own.push_back(point);
        }
        const std::optional<CostModel> costs = costs_of(own, tracer);
        if (!costs) continue;
        text +=
            fmt::format("{}: ray {:.2f} ns, cell {:.3f} ns, test {:.3f} ns; off by {}\n", tracer,
                        costs->ray, costs->cell, costs->test, percent(costs->relative_error));
        const std::vector<LeftOut> left_out = leave_one_out(own);
        if (left_out.empty()) continue;
        std::vector<std::vector<std::string>> rows = {
            {"left out", "rays", "ray ns", "cell ns", "test ns", "chosen", "best", "regret"}};
        for (const LeftOut& scene : left_out) {
            rows.push_back({scene.scene, scene.rays, fmt::format("{:.2f}", scene.costs.ray),
                            fmt::format("{:.3f}", scene.costs.cell),
                            fmt::format("{:.3f}", scene.costs.test),
                            fmt::format("{:.4g}", scene.chosen), fmt::format("{:.4g}", scene.best),
                            regret_text(scene.regret)});
        }
        text += format_table(rows);
        text += fmt::format("  median regret on scenes that were left out: {}\n",
                            percent(median_regret(left_out)));
    }
    return text;
}

void print_fit(const std::vector<std::string>& files) {
    std::vector<SweepPoint> points;
    for (const std::string& file : files) {
        const Results results = read_results(file);
        points.insert(points.end(), results.sweeps.begin(), results.sweeps.end());
    }
    const std::string text = fit_text(points);
    if (text.empty()) {
        throw Error({"--fit", "no sizes that were measured", "results of 'onepass tune'",
                     "Name files that it wrote with --json."});
    }
    fmt::print("{}", text);
}

// ---- The work -----------------------------------------------------------------------------------

/// What is measured at once and finished as a whole: one listed size; or a search, with what its
/// outcome is compared with; or the size that --sizing adds to a list.
struct TunePoint {
    enum class Kind { search, listed, sizing };
    std::string key;
    std::string scene;
    std::string rays;
    const SelectedStrategy* strategy = nullptr;
    Kind kind = Kind::search;
    GridSize size{};
};

/// One run of the command.
struct TuneRun {
    Session& session;
    const TuneCommand& options;
    const std::vector<SelectedStrategy> selected;
    const ImageSize size;

    // What the points of one scene share; opened when first needed.
    std::optional<Court> court = {};
    std::string opened = {};  ///< as it was asked for
    std::optional<Case> subject = {};
    std::map<std::string, TracerRecord> tracer_records = {};

    SweepOptions sweep_options(const SelectedStrategy& strategy) const {
        SweepOptions sweep{options.densities, options.top_densities,          options.resolutions,
                           strategy.params,   {.seed = session.globals.seed}, options.timing};
        sweep.timing.seed = session.globals.seed;
        return sweep;
    }

    std::vector<TunePoint> points() const {
        std::vector<TunePoint> all;
        for (const std::string& scene : options.scenes) {
            for (const std::string& rays : options.rays.kinds) {
                for (const SelectedStrategy& strategy : selected)
                    add_points(scene, rays, strategy, all);
            }
        }
        return all;
    }

    void add_points(const std::string& scene, const std::string& rays,
                    const SelectedStrategy& strategy, std::vector<TunePoint>& all) const {
        const TracerInfo& info = strategy.entry->info;
        const std::string key = fmt::format("tune {}, {} rays, {}", scene, rays, info.name);
        using enum TunePoint::Kind;
        if (!options.lists_sizes()) {
            all.push_back({key, scene, rays, &strategy, search});
            return;
        }
        for (const GridSize& listed_size : listed_sizes(info, sweep_options(strategy))) {
            all.push_back(
                {key + ", " + size_text(listed_size), scene, rays, &strategy, listed, listed_size});
        }
        if (options.sizing.sizing.empty()) return;
        all.push_back({fmt::format("{}, sizing {}", key, options.sizing.sizing), scene, rays,
                       &strategy, sizing});
    }

    /// Opens what the point is about, unless the last one was about it as well.
    void open(const TunePoint& point, const Study& study) {
        if (opened != point.scene) {
            subject.reset();
            tracer_records.clear();
            court.reset();
            court = open_court(session, point.scene);
            opened = point.scene;
            study.check_scene(court->open.record);
        }
        if (subject && subject->rays.name == point.rays) return;
        subject = open_case(*court, point.rays,
                            {size.width, size.height, options.rays.camera, session.globals.seed});
    }

    /// The tracer with its own sizes: the sweep's are in its points.
    const TracerRecord& tracer_record(const SelectedStrategy& strategy) {
        const TracerInfo& info = strategy.entry->info;
        const auto known = tracer_records.find(info.name);
        if (known != tracer_records.end()) return known->second;
        TracerRecord record;
        try {
            const auto tracer = strategy.entry->make(court->open.scene, strategy.params);
            record = make_tracer_record(court->open.name, *tracer, info, strategy.params);
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::device) throw;
            record.scene = court->open.name;  // refused at its own sizes
            record.name = info.name;
        }
        return tracer_records[info.name] = record;
    }

    /// The size that --sizing asks for, or auto's where nothing is said; nothing, and why on
    /// stderr, where a search cannot have auto's.
    std::optional<GridSize> chosen_size(const SelectedStrategy& strategy, bool asked_for,
                                        ProgressBar& bar) {
        const TracerInfo& info = strategy.entry->info;
        const std::string& sizing = options.sizing.sizing;
        if (!sizing.empty() && sizing != "auto") {
            return size_from(read_sizing_file(sizing), sizing, info.name, *court->open.scene,
                             court->open.record.hash, options.rays.kinds);
        }
        try {
            const AutoSizing chosen = auto_size(session, court->open.scene, strategy,
                                                sample_of(subject->rays.rays, kSampleRays),
                                                costs_for(info.name, options.sizing));
            bar.say(fmt::format("{}: auto sizes of {}: {} (chosen in {:.0f} ms)", court->open.name,
                                info.name, size_text(chosen.size), chosen.choice_ms));
            return chosen.size;
        } catch (const Error& error) {
            if (asked_for) throw;
            bar.say(fmt::format("{}: no auto sizes of {}: {}", court->open.name, info.name,
                                error.what()));
            return std::nullopt;
        }
    }

    /// Each object its own density, by costs fitted to what the search saw of this very scene.
    std::optional<GridSize> per_object_size(const SelectedStrategy& strategy,
                                            std::span<const SweepPoint> seen) const {
        const std::optional<Tuning> tuning = tuning_of(seen);
        const CatalogueEntry* counter = counter_of(session.catalogue, strategy.entry->info);
        const bool able =
            tuning && tuning->model && counter != nullptr && court->open.scene->objects.size() > 1;
        if (!able) return std::nullopt;
        ParamValues params = strategy.params;
        if (has_param(strategy.entry->info, kTopDensityParam)) {
            params[kTopDensityParam] = fmt::format("{}", seen[tuning->best].top_density);
        }
        GridSize own = choose_sizes(*counter, court->open.scene, params,
                                    sample_of(subject->rays.rays, kSampleRays), *tuning->model)
                           .size;
        own.chosen = kPerObjectSize;
        return own.sizes.empty() ? std::nullopt : std::optional(own);
    }

    /// The search, then all of its sizes and what is compared with them in the same rounds.
    std::vector<SweepPoint> search(const SweepCase& sweep, const SelectedStrategy& strategy,
                                   const Progress& progress, ProgressBar& bar) {
        const SweepOptions sweep_with = sweep_options(strategy);
        const auto half = [&](double begin) {
            return
                [&progress, begin](double share) { return go_on(progress, begin + 0.5 * share); };
        };
        const std::vector<SweepPoint> seen = search_sizes(sweep, sweep_with, half(0.0));
        std::vector<GridSize> sizes;
        for (const SweepPoint& point : seen) sizes.push_back(size_of(point));
        const auto add = [&](const std::optional<GridSize>& extra) {
            if (!extra) return;
            const auto known = std::find_if(sizes.begin(), sizes.end(), [&](GridSize s) {
                s.chosen = extra->chosen;
                return s == *extra;
            });
            if (known == sizes.end()) {
                sizes.push_back(*extra);
            } else {
                known->chosen = extra->chosen;
            }
        };
        add(chosen_size(strategy, !options.sizing.sizing.empty(), bar));
        add(per_object_size(strategy, seen));
        return measure_together(sweep, sizes, sweep_with, half(0.5));
    }

    /// Measures a point; no sweeps if it was stopped.
    Results measure(const TunePoint& point, const Study& study, const Progress& progress,
                    ProgressBar& bar) {
        open(point, study);
        const SelectedStrategy& strategy = *point.strategy;
        const SweepCase sweep{*strategy.entry, court->open.scene, subject->rays,
                              *court->oracle,  *court->judge,     subject->truth};
        Results results;
        if (point.kind == TunePoint::Kind::search) {
            results.sweeps = search(sweep, strategy, progress, bar);
        } else {
            const GridSize one = point.kind == TunePoint::Kind::listed
                                     ? point.size
                                     : *chosen_size(strategy, true, bar);
            results.sweeps =
                measure_together(sweep, std::span(&one, 1), sweep_options(strategy), progress);
        }
        for (SweepPoint& measured : results.sweeps) measured.scene = court->open.name;
        results.manifest.judge = court->judge->name();
        results.scenes = {court->open.record};
        results.tracers = {tracer_record(strategy)};
        return results;
    }
};

/// The sizes with the fewest errors, and of those the fastest.
void write_sizes(const Results& results, const std::string& path) {
    SizingFile file;
    for (const std::vector<SweepPoint>& points : grouped(results.sweeps)) {
        const SweepPoint* best = best_point(points);
        if (best == nullptr) continue;
        const std::optional<Tuning> tuning = tuning_of(points);
        const OpenScene open = open_scene(best->scene);
        auto at = std::find_if(file.scenes.begin(), file.scenes.end(),
                               [&](const SceneSizing& s) { return s.hash == open.record.hash; });
        if (at == file.scenes.end()) {
            file.scenes.push_back({best->scene, open.record.hash, {}});
            at = std::prev(file.scenes.end());
        }
        const auto index = static_cast<size_t>(best - points.data());
        at->tracers.push_back(tracer_sizing(*best, *open.scene, tuning->ns[index],
                                            tuning->model ? tuning->predicted_ns[index] : NAN));
    }
    write_sizing_file(file, path);
    fmt::print(stderr, "onepass: wrote {}\n", path);
}

void check_options(const TuneCommand& options) {
    if (options.scenes.empty()) {
        throw Error({"onepass tune", "no scene", "at least one, or --fit RESULT.json",
                     "'onepass list scenes' shows the names."});
    }
    check_repetitions(options.timing);
    if (!options.sizing_out.empty()) check_writable(options.sizing_out);
}

void run(Session& session, const TuneCommand& options) {
    if (!options.fit.empty()) return print_fit(options.fit);
    check_options(options);
    TuneRun tune{session, options, grid_strategies(session, options.strategy),
                 parse_size(options.rays.size)};
    const std::vector<TunePoint> points = tune.points();
    std::vector<std::string> keys;
    for (const TunePoint& point : points) keys.push_back(point.key);
    std::vector<const CatalogueEntry*> entries;
    for (const SelectedStrategy& strategy : tune.selected) entries.push_back(strategy.entry);
    Study study = open_study(session, options.study, keys, entries);
    {
        ProgressBar bar("tune");
        for (const TunePoint& point : points) {
            if (stop_requested()) break;
            if (!study.needs(point.key)) continue;
            Results measured = tune.measure(point, study, next_point(bar, study), bar);
            if (measured.sweeps.empty()) break;  // stopped
            study.add(point.key, std::move(measured));
        }
    }
    Results results = study.results();
    const std::vector<std::vector<SweepPoint>> sweeps = grouped(results.sweeps);
    std::FILE* out = table_stream(options.study.json);
    for (const std::vector<SweepPoint>& sweep : sweeps) fmt::print(out, "{}", sweep_table(sweep));
    if (!options.sizing_out.empty() && study.finished()) write_sizes(results, options.sizing_out);
    finish_study(session, study, results, options.study);
}

CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<double>& list,
                      const std::string& help) {
    return command.add_option(name, list, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::PositiveNumber);
}

}  // namespace

void add_tune(CLI::App& app, Session& session) {
    CLI::App* command =
        app.add_subcommand("tune", "Searches the grid sizes of strategies, or measures a list");
    auto options = std::make_shared<TuneCommand>();
    command->add_option("scenes", options->scenes, "Scene names or files");
    add_strategy_options(*command, options->strategy);
    add_ray_options(*command, options->rays);
    add_list(*command, "--densities", options->densities,
             "Densities of the object grids, in cells a triangle, by commas. Without any list of "
             "sizes they are searched: in wide steps, then between the best and its neighbours");
    add_list(*command, "--top-densities", options->top_densities,
             "Densities of the top-level grid, in cells an instance, by commas. Default: the "
             "strategy's own");
    command
        ->add_option("--resolutions", options->resolutions,
                     "Cells of every object grid, XxYxZ, by commas: measured beside the densities")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        ->add_option("--sizing", options->sizing.sizing,
                     "Measures these sizes as well: 'auto', or a sizing file. A search always "
                     "measures auto where it can")
        ->type_name("auto|FILE");
    add_costs_option(*command, options->sizing);
    command
        ->add_option("--repetitions", options->timing.repetitions,
                     fmt::format("Counted rounds a size, at least {}", kLeastRepetitions))
        ->capture_default_str();
    command
        ->add_option("--warm-up", options->timing.warm_up_ms,
                     "Least time of uncounted rounds before each size, in ms")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_study_options(*command, options->study);
    command
        ->add_option("--sizing-out", options->sizing_out,
                     "Writes the best sizes, by errors and then by speed, for --sizing FILE")
        ->type_name("FILE");
    command
        ->add_option("--fit", options->fit,
                     "Fits the costs of a cell and a test to these results and measures nothing: "
                     "what auto's choice costs on each scene when it is left out of the fit")
        ->type_name("RESULT.json")
        ->excludes("scenes");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
