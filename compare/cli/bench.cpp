// onepass bench: speed beside Embree's in the same rounds, and never without its error counts.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/bench_ablation.h"
#include "compare/cli/bench_settings.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/sizing.h"
#include "compare/cli/study_run.h"
#include "compare/cli/table.h"
#include "compare/manifest.h"
#include "compare/statistics.h"
#include "compare/timing.h"

namespace onepass::cli {
namespace {

struct BenchCommand {
    std::vector<std::string> scenes;
    StrategyOptions strategy;
    SizingOptions sizing;
    RayOptions rays{{"primary", "random"}, "512x512", 0};
    std::vector<std::string> references = {"embree/*/threads", "embree/*/1thread"};
    TimingOptions timing;
    double enough_s = 5.0;
    bool settings = false;
    std::string entry = "fragment";
    std::string ablate;
    StudyOptions study;
};

/// The references first, the oracle in front of them, then what was asked for.
std::vector<SelectedStrategy> contestants(const Session& session, const BenchCommand& options) {
    std::vector<SelectedStrategy> all = {{&session.catalogue.at(kOracleName), {}}};
    std::vector<SelectedStrategy> others;
    for (const std::string& reference : options.references) {
        for (const CatalogueEntry* entry : session.catalogue.select(reference)) {
            others.push_back({entry, {}});
        }
    }
    for (SelectedStrategy& strategy : select_strategies(session.catalogue, options.strategy)) {
        others.push_back(std::move(strategy));
    }
    for (SelectedStrategy& strategy : others) {
        const bool known = std::any_of(all.begin(), all.end(), [&](const SelectedStrategy& s) {
            return s.entry == strategy.entry;
        });
        if (!known) all.push_back(std::move(strategy));
    }
    return all;
}

std::string timing_table(const std::vector<TimingRecord>& records) {
    const TimingRecord& first = records.front();
    std::string text =
        fmt::format("{}, {} rays: {} rays, {} rounds; ratio is speed relative to {}\n", first.scene,
                    first.rays, first.ray_count, first.wall_ms.size(), first.oracle);
    std::vector<std::vector<std::string>> rows = {{"tracer", "Mrays/s", "median ms", "quartiles ms",
                                                   "ratio", "95 % interval", "device Mrays/s",
                                                   "device ms", "device ratio", "95 % interval",
                                                   "rounds", "errors", "edge"}};
    for (const TimingRecord& record : records) {
        const DeviceSpeed device = device_speed(record, 0);
        const auto if_timed = [&](const std::string& figure) {
            return std::isnan(device.median_ms) ? "-" : figure;
        };
        rows.push_back(
            {record.tracer, fmt::format("{:.3f}", record.mrays_per_s),
             fmt::format("{:.2f}", record.median_ms),
             fmt::format("{:.2f}..{:.2f}", quantile(record.wall_ms, 0.25),
                         quantile(record.wall_ms, 0.75)),
             fmt::format("{:.3f}", record.ratio),
             fmt::format("{:.3f}..{:.3f}", record.ratio_low, record.ratio_high),
             if_timed(fmt::format("{:.1f}", device.mrays_per_s)),
             if_timed(fmt::format("{:.4f}", device.median_ms)),
             if_timed(fmt::format("{:.3f}", device.ratio.ratio)),
             if_timed(fmt::format("{:.3f}..{:.3f}", device.ratio.low, device.ratio.high)),
             std::to_string(record.wall_ms.size()), std::to_string(record.errors),
             std::to_string(record.edges)});
    }
    return text + format_table(rows);
}

std::string clock_text(const std::optional<ClockReading>& clocks) {
    return clocks ? fmt::format("SM {:.0f} MHz, memory {:.0f} MHz, {:.0f} C", clocks->sm_mhz,
                                clocks->memory_mhz, clocks->temperature_c)
                  : "-";
}

/// Whether the device held its pace, and at which clocks.
std::string pace_text(const PaceRecord& pace) {
    std::string text = fmt::format(
        "  warm-up: {} rounds, {:.1f} s, until the pace of the device changed by {:.2f} %{}\n",
        pace.warm_up_rounds, 1e-3 * pace.warm_up_ms, 100.0 * pace.change,
        pace.steady ? "" : ": NOT STEADY");
    return text + fmt::format("  clocks ({}): before {}; after {}\n", pace.clocks_of,
                              clock_text(pace.before), clock_text(pace.after));
}

/// Checks, then times, all contestants on one ray set. False if it was stopped on the way.
bool bench_case(Session& session, const Court& court, const Case& subject,
                const std::vector<Tracer*>& tracers, const TimingOptions& timing,
                const Progress& progress, Results& results) {
    std::vector<CastResult> answers;
    std::vector<std::string> names;
    for (Tracer* tracer : tracers) {
        answers.push_back(answers_of(subject, *tracer));
        names.emplace_back(tracer->name());
    }
    std::vector<CheckRecord> checks;
    for (HitComparison& comparison :
         check_answers(court, subject, answers, names, {.seed = timing.seed})) {
        checks.push_back(std::move(comparison.record));
        checks.back().reference = checks.back().tracer.starts_with("embree/");
    }
    PacedTimings paced =
        time_with_pace(tracers, 0, subject.rays, timing, session.device_clocks(), progress);
    if (stop_requested()) return false;
    std::vector<TimingRecord>& timings = paced.timings;
    for (size_t i = 0; i < timings.size(); ++i) {
        timings[i].scene = court.open.name;
        timings[i].errors = checks[i].errors();
        timings[i].edges = checks[i].classes[static_cast<size_t>(HitClass::edge)].count;
    }
    results.checks.insert(results.checks.end(), checks.begin(), checks.end());
    results.timings.insert(results.timings.end(), timings.begin(), timings.end());
    if (!paced.pace) return true;
    paced.pace->scene = court.open.name;
    results.paces.push_back(std::move(*paced.pace));
    return true;
}

/// The scene's points that the study needs.
void bench_scene(Session& session, const BenchCommand& options, const std::string& name,
                 const std::vector<SelectedStrategy>& selected, ProgressBar& bar, Study& study) {
    std::vector<std::string> kinds = options.rays.kinds;
    std::erase_if(kinds, [&](const auto& kind) { return !study.needs(case_key(name, kind)); });
    if (kinds.empty()) return;
    const ImageSize size = parse_size(options.rays.size);
    const RayRequest request{size.width, size.height, options.rays.camera, session.globals.seed};

    // What the points share.
    Court court = open_court(session, name);
    study.check_scene(court.open.record);
    Results shared;
    shared.manifest.judge = court.judge->name();
    shared.scenes.push_back(court.open.record);
    std::vector<std::unique_ptr<Tracer>> owned;
    std::vector<Tracer*> tracers;
    for (const auto& [entry, params] : sized(session, court.open, selected, options.sizing,
                                             options.rays.kinds, options.rays.camera)) {
        owned.push_back(entry->make(court.open.scene, params));
        tracers.push_back(owned.back().get());
        shared.tracers.push_back(make_tracer_record(name, *tracers.back(), entry->info, params));
        shared.tracers.back().sizing = sizing_name(entry->info, options.sizing);
    }

    for (const std::string& kind : kinds) {
        if (stop_requested()) return;
        const Case subject = open_case(court, kind, request);
        Results point = shared;
        if (!bench_case(session, court, subject, tracers, options.timing, next_point(bar, study),
                        point)) {
            return;
        }
        study.add(case_key(name, kind), std::move(point));
    }
}

void print(const Results& results, std::FILE* out) {
    for (size_t begin = 0; begin < results.timings.size();) {
        const TimingRecord& first = results.timings[begin];
        std::vector<TimingRecord> group;
        for (; begin < results.timings.size(); ++begin) {
            const TimingRecord& record = results.timings[begin];
            if (record.scene != first.scene || record.rays != first.rays) break;
            group.push_back(record);
        }
        fmt::print(out, "{}", timing_table(group));
        for (const PaceRecord& pace : results.paces) {
            if (pace.scene != first.scene || pace.rays != first.rays) continue;
            fmt::print(out, "{}", pace_text(pace));
        }
    }
    fmt::print(out, "judge of the errors: {}\n", results.manifest.judge);
}

void run(Session& session, BenchCommand& options) {
    check_scene_names(options.scenes);
    parse_size(options.rays.size);
    options.timing.seed = session.globals.seed;
    options.timing.enough_ms = 1e3 * options.enough_s;
    check_repetitions(options.timing);
    const std::vector<SelectedStrategy> selected = contestants(session, options);
    std::vector<const CatalogueEntry*> entries;
    for (const SelectedStrategy& strategy : selected) entries.push_back(strategy.entry);
    std::vector<std::string> keys;
    for (const std::string& scene : options.scenes) {
        for (const std::string& kind : options.rays.kinds) keys.push_back(case_key(scene, kind));
    }

    Study study = open_study(session, options.study, std::move(keys), entries);
    {
        ProgressBar bar("bench");
        for (const std::string& scene : options.scenes) {
            if (stop_requested()) break;
            bench_scene(session, options, scene, selected, bar, study);
        }
    }
    Results results = study.results();
    print(results, table_stream(options.study.json));
    finish_study(session, study, results, options.study);
}

}  // namespace

void add_bench(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "bench", "Times strategies beside Embree, with the errors of the same rays");
    auto options = std::make_shared<BenchCommand>();
    command->add_option("scenes", options->scenes, "Scene names or files")->required();
    add_strategy_options(*command, options->strategy);
    add_sizing_options(*command, options->sizing);
    add_ray_options(*command, options->rays);
    command
        ->add_flag("--settings", options->settings,
                   fmt::format("Speed against accuracy: a built-in list of strategies and "
                               "parameters, every answer judged; unless given, rays {} and size {}",
                               fmt::join(kSettingsKinds, ","), kSettingsSize))
        ->excludes("--strategy")
        ->excludes("--param");
    command
        ->add_option("--ablate", options->ablate,
                     fmt::format("What each step of this strategy is worth: as it is, and with one "
                                 "step taken out at a time; unless given, rays {}",
                                 fmt::join(kAblationKinds, ",")))
        ->type_name("NAME")
        ->excludes("--strategy")
        ->excludes("--param")
        ->excludes("--settings");
    command->get_option("--sizing")->excludes("--settings")->excludes("--ablate");
    command->add_option("--entry", options->entry, "Of --settings: fragment or compute")
        ->check(CLI::IsMember({"fragment", "compute"}))
        ->needs("--settings")
        ->capture_default_str();
    command
        ->add_option("--repetitions", options->timing.repetitions,
                     fmt::format("Counted rounds, at least {}", kLeastRepetitions))
        ->capture_default_str();
    command
        ->add_option("--enough", options->enough_s,
                     fmt::format("Seconds of counted casts after which a tracer other than {} has "
                                 "had enough, if it has {} rounds",
                                 kOracleName, kLeastRepetitions))
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        ->add_option("--reference", options->references,
                     fmt::format("Tracers timed beside those of -s: NAME or a pattern with '*'; "
                                 "may be repeated. {} always is",
                                 kOracleName))
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->excludes("--settings")
        ->excludes("--ablate")
        ->capture_default_str();
    command
        ->add_option("--warm-up", options->timing.warm_up_ms,
                     "Least time of uncounted rounds before, in ms; where a device has a timer, "
                     "they go on until its pace is steady")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_study_options(*command, options->study);
    command->callback([&session, options, command] {
        if (!options->ablate.empty()) {
            if (command->count("--rays") == 0) options->rays.kinds = kAblationKinds;
            return bench_ablation(session, {options->scenes, options->ablate, options->rays,
                                            options->timing, options->study});
        }
        if (!options->settings) return run(session, *options);
        if (command->count("--rays") == 0) options->rays.kinds = kSettingsKinds;
        if (command->count("--size") == 0) options->rays.size = kSettingsSize;
        bench_settings(session, {options->scenes, options->rays, options->timing, options->entry,
                                 options->study});
    });
}

}  // namespace onepass::cli
