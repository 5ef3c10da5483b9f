// onepass grow: how build time, memory and trace time grow with triangles and with rays.
//
// Each size is a point of a study. With -o it is also kept by itself in DIR/parts, where another
// list of sizes finds it again.
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/study_run.h"
#include "compare/cli/table.h"
#include "compare/growth.h"
#include "compare/parts.h"
#include "compare/report/report.h"
#include "core/error.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/scenes.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kShape[] = "lumpy-ball";
const std::vector<std::string> kDefaultStrategies = {kFastEmbreeName, "grid/buffer/compute"};

struct GrowCommand {
    StrategyOptions strategy;
    std::vector<double> triangles = {1e4, 1e5, 1e6, 1e7};
    std::vector<double> ray_counts = {65536, 262144, 1048576, 4194304, 16777216, 67108864};
    double fixed_rays = 1048576;
    double fixed_triangles = 1e6;
    std::vector<std::string> kinds = {"primary", "diffuse", "random"};
    size_t judged = 4096;
    TimingOptions timing;
    double enough_s = 5.0;
    StudyOptions study;
    std::string output;
    bool fresh = false;
};

/// Counts may be given as 1e6: CLI11 reads no such whole number.
std::vector<uint64_t> whole_counts(const std::string& option, const std::vector<double>& numbers) {
    constexpr double kMost = 1e10;
    std::vector<uint64_t> counts;
    for (const double number : numbers) {
        if (!(number >= 1.0 && number <= kMost) || number != std::floor(number)) {
            throw Error({option, fmt::format("{}", number),
                         fmt::format("whole numbers from 1 to {:g}", kMost), "Mend the number."});
        }
        counts.push_back(static_cast<uint64_t>(number));
    }
    return counts;
}

GrowthSetup setup_of(Session& session, const GrowCommand& options) {
    GrowthSetup setup;
    setup.contestants.push_back({&session.catalogue.at(kOracleName), {}});
    StrategyOptions strategies = options.strategy;
    if (strategies.patterns.empty()) strategies.patterns = kDefaultStrategies;
    for (const SelectedStrategy& s : select_strategies(session.catalogue, strategies)) {
        if (s.entry->info.name != kOracleName) setup.contestants.push_back({s.entry, s.params});
    }
    setup.make_scene = [](uint64_t triangles) -> ScenePtr {
        return std::make_shared<const Scene>(make_lumpy_ball(triangles));
    };
    setup.make_judge = [](ScenePtr scene) { return make_exact_judge(std::move(scene)); };
    setup.shape = kShape;
    setup.kinds = options.kinds;
    setup.judged = options.judged;
    setup.timing = options.timing;
    setup.timing.seed = session.globals.seed;
    setup.timing.enough_ms = 1e3 * options.enough_s;
    return setup;
}

/// The manifest of a step: its arguments are those that its figures depend on, so that a longer
/// list of sizes finds the shorter one's parts.
Manifest manifest_of(const Session& session, const GrowCommand& options, const GrowthStep& step) {
    Manifest manifest = session.manifest();
    manifest.arguments = {"onepass",      "grow",
                          "--triangles",  std::to_string(step.triangles),
                          "--fixed-rays", std::to_string(step.rays)};
    const auto add = [&](const std::string& option, const std::string& value) {
        manifest.arguments.push_back(option);
        manifest.arguments.push_back(value);
    };
    for (const std::string& pattern : options.strategy.patterns) add("-s", pattern);
    for (const std::string& param : options.strategy.params) add("--param", param);
    for (const std::string& kind : options.kinds) add("--rays", kind);
    add("--judged", std::to_string(options.judged));
    add("--repetitions", std::to_string(options.timing.repetitions));
    add("--enough", fmt::format("{}", options.enough_s));
    return manifest;
}

// ---- Tables

std::string who(const std::string& tracer, const std::string& setting) {
    return setting.empty() ? tracer : fmt::format("{} ({})", tracer, setting);
}

std::string build_table(const Results& results) {
    std::vector<std::vector<std::string>> rows = {{"tracer", "triangles", "build ms", "builds",
                                                   "MiB", "bytes/triangle", "cells", "references"}};
    std::string failures;
    for (const GrowthBuild& b : results.growth_builds) {
        if (!b.failure.empty()) {
            failures += fmt::format("  {}, {} triangles: {}\n", who(b.tracer, b.setting),
                                    b.triangles, b.failure);
            continue;
        }
        const double bytes = static_cast<double>(b.bytes);
        rows.push_back({who(b.tracer, b.setting), std::to_string(b.triangles),
                        fmt::format("{:.1f}", median(b.build_ms)),
                        std::to_string(b.build_ms.size()), fmt::format("{:.1f}", bytes / 1048576.0),
                        fmt::format("{:.1f}", bytes / static_cast<double>(b.triangles)),
                        std::to_string(b.cells), std::to_string(b.references)});
    }
    return "builds\n" + format_table(rows) + failures;
}

std::string trace_table(const Results& results) {
    std::vector<std::vector<std::string>> rows = {
        {"tracer", "triangles", "rays", "of kind", "Mrays/s", "median ms", "device Mrays/s",
         "device ms", "rounds", "errors", "edge", "of judged"}};
    for (const GrowthTrace& t : results.growth_traces) {
        const double rays = static_cast<double>(t.ray_count);
        const double wall_ms = median(t.wall_ms), device_ms = median(t.device_ms);
        const bool timed = !t.device_ms.empty();
        rows.push_back(
            {who(t.tracer, t.setting), std::to_string(t.triangles), std::to_string(t.ray_count),
             t.rays, fmt::format("{:.3f}", rays / (1e3 * wall_ms)), fmt::format("{:.3f}", wall_ms),
             timed ? fmt::format("{:.1f}", rays / (1e3 * device_ms)) : "-",
             timed ? fmt::format("{:.4f}", device_ms) : "-", std::to_string(t.wall_ms.size()),
             std::to_string(t.errors), std::to_string(t.edges), std::to_string(t.judged)});
    }
    return "casts\n" + format_table(rows);
}

std::string exponent_table(const Results& results) {
    std::vector<std::vector<std::string>> rows = {{"cost", "exponent", "standard error", "points"}};
    for (const GrowthCurve& curve : growth_curves(results)) {
        rows.push_back({fmt::format("{}, {}{}", cost_text(curve), who(curve.tracer, curve.setting),
                                    curve.by_device ? " (device)" : ""),
                        fmt::format("{:.3f}", curve.law.exponent),
                        std::isnan(curve.law.standard_error)
                            ? "-"
                            : fmt::format("{:.3f}", curve.law.standard_error),
                        std::to_string(curve.x.size())});
    }
    return "exponents\n" + format_table(rows);
}

// ---- Running

/// The step's results, from an earlier run's parts or measured now; none if stopped on the way.
std::optional<Results> step_results(const Session& session, const GrowthSetup& setup,
                                    const GrowthStep& step, const GrowCommand& options,
                                    const PartStore* store, ProgressBar& bar,
                                    const Progress& progress) {
    const std::string id = step.id();
    if (store && !options.fresh) {
        FoundPart found = store->find(id, manifest_of(session, options, step));
        if (found.results) {
            bar.say(fmt::format("{}: kept from an earlier run", id));
            return std::move(found.results);
        }
        if (!found.why_not.empty()) bar.say(fmt::format("{}: made again: {}", id, found.why_not));
    }
    Results results = measure_growth(setup, step, progress);
    if (stop_requested()) return std::nullopt;
    const std::string judge = results.manifest.judge;
    results.manifest = manifest_of(session, options, step);
    results.manifest.judge = judge;
    bar.say(fmt::format("{}: done", id));
    if (store) store->save(id, results);
    return results;
}

void run(Session& session, const GrowCommand& options) {
    check_repetitions(options.timing);
    GrowthSetup setup = setup_of(session, options);
    const std::vector<GrowthStep> steps =
        growth_steps(whole_counts("--triangles", options.triangles),
                     whole_counts("--ray-counts", options.ray_counts),
                     whole_counts("--fixed-rays", {options.fixed_rays})[0],
                     whole_counts("--fixed-triangles", {options.fixed_triangles})[0]);
    std::vector<const CatalogueEntry*> entries;
    for (const Contestant& contestant : setup.contestants) entries.push_back(contestant.entry);
    std::vector<std::string> keys;
    for (const GrowthStep& step : steps) keys.push_back(step.id());
    Study study = open_study(session, options.study, std::move(keys), entries);
    setup.clocks = session.device_clocks();
    std::unique_ptr<PartStore> store;
    if (!options.output.empty()) {
        store = std::make_unique<PartStore>(fs::path(options.output) / "parts");
    }

    // The sizes.
    {
        ProgressBar bar("grow");
        for (const GrowthStep& step : steps) {
            if (stop_requested()) break;
            if (!study.needs(step.id())) continue;
            auto results = step_results(session, setup, step, options, store.get(), bar,
                                        next_point(bar, study));
            if (results) study.add(step.id(), std::move(*results));
        }
    }

    // What they come to.
    Results results = study.results();
    std::FILE* out = table_stream(options.study.json);
    fmt::print(out, "{}{}{}", build_table(results), trace_table(results), exponent_table(results));
    fmt::print(out, "judge of the errors: {}\n", results.manifest.judge);
    finish_study(session, study, results, options.study);
    if (options.output.empty()) return;
    const fs::path folder = options.output;
    write_results(results, folder / "growth.json");
    write_bytes_atomically(folder / "growth.html", render_report({results}, {folder}));
    fmt::print(stderr, "onepass: wrote {} and {}\n", (folder / "growth.json").string(),
               (folder / "growth.html").string());
    if (!study.finished()) {
        fmt::print(stderr, "onepass: {} of {} sizes are kept; the same command goes on there\n",
                   study.done(), study.total());
    }
}

}  // namespace

void add_grow(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "grow",
        "How cost grows: one closed shape in ever more triangles, then ever more rays; build and "
        "trace apart, exponents fitted, a sample of every answer judged");
    auto options = std::make_shared<GrowCommand>();
    add_strategy_options(*command, options->strategy);
    command->get_option("--strategy")
        ->description(
            "Strategy: NAME[/STORAGE[/ENTRY]] or a pattern with '*'; may be repeated. "
            "Default: " +
            fmt::format("{}", fmt::join(kDefaultStrategies, ", ")) +
            fmt::format(". {} always is there", kOracleName));
    const auto add_counts = [&](const char* name, std::vector<double>& counts, const char* help) {
        command->add_option(name, counts, help)
            ->delimiter(',')
            ->allow_extra_args(false)
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
    };
    add_counts("--triangles", options->triangles, "Sizes of the shape, by commas");
    add_counts("--ray-counts", options->ray_counts,
               "Pixels of the images whose rays are cast into one size, by commas");
    command
        ->add_option("--fixed-rays", options->fixed_rays,
                     "Pixels of the image while the triangles grow")
        ->capture_default_str();
    command
        ->add_option("--fixed-triangles", options->fixed_triangles,
                     "Size of the shape while the rays grow")
        ->capture_default_str();
    command
        ->add_option("--rays", options->kinds,
                     "Rays, by kind; may be repeated. Secondary kinds are fewer than pixels")
        ->type_name("KIND")
        ->allow_extra_args(false)
        ->capture_default_str();
    command
        ->add_option("--judged", options->judged,
                     "Rays of each kind and size whose answers are judged, spread evenly")
        ->check(CLI::Range(1u, 1u << 24))
        ->capture_default_str();
    command
        ->add_option("--repetitions", options->timing.repetitions,
                     fmt::format("Counted rounds a size, at least {}", kLeastRepetitions))
        ->capture_default_str();
    command
        ->add_option("--enough", options->enough_s,
                     fmt::format("Seconds of counted casts after which a tracer other than {} has "
                                 "had enough, if it has {} rounds",
                                 kOracleName, kLeastRepetitions))
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_study_options(*command, options->study);
    command
        ->add_option("-o,--output", options->output,
                     "Folder for growth.json, growth.html and parts; made if needed. Ctrl-C "
                     "stops; the same command goes on from there")
        ->type_name("DIR");
    command->add_flag("--fresh", options->fresh,
                      "Measures every size again. Default: sizes that the same build finished on "
                      "the same device with the same options are kept");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
