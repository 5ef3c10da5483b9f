// onepass bench: speed beside Embree's in the same rounds, and never without its error counts.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cast_counts.h"
#include "compare/cli/bench_ablation.h"
#include "compare/cli/bench_self_test.h"
#include "compare/cli/bench_settings.h"
#include "compare/cli/bench_tables.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/sizing.h"
#include "compare/cli/study_run.h"
#include "compare/manifest.h"
#include "compare/time_to_image.h"
#include "compare/timing.h"
#include "core/error.h"

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
    std::string versus;
    bool self_test = false;
    uint32_t comparisons = 100;
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

/// Which contestant gets a rival, and is what the others are held against in pairs: --versus, else
/// the first that -s asks for.
size_t baseline_among(const std::vector<SelectedStrategy>& selected, const Session& session,
                      const BenchCommand& options) {
    const CatalogueEntry* wanted =
        options.versus.empty()
            ? select_strategies(session.catalogue, options.strategy).front().entry
            : session.catalogue.select(options.versus).front();
    const auto found = std::find_if(selected.begin(), selected.end(),
                                    [&](const auto& s) { return s.entry == wanted; });
    if (found != selected.end()) return static_cast<size_t>(found - selected.begin());
    throw Error({"--versus", "'" + options.versus + "'", "a tracer that is timed",
                 "Name it with -s or --reference as well."});
}

/// Checks, counts, then times, all contestants on one ray set. False if it was stopped on the way.
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
    std::vector<std::optional<CastCounts>> counts;
    for (Tracer* tracer : tracers) counts.push_back(count_cast(*tracer, subject.rays));
    PacedTimings paced =
        time_with_pace(tracers, 0, subject.rays, timing, session.device_clocks(), progress);
    if (stop_requested()) return false;
    std::vector<TimingRecord>& timings = paced.timings;
    for (size_t i = 0; i < timings.size(); ++i) {
        timings[i].scene = court.open.name;
        timings[i].errors = checks[i].errors();
        timings[i].edges = checks[i].classes[static_cast<size_t>(HitClass::edge)].count;
        timings[i].counts = counts[i];
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
    const std::vector<SelectedStrategy> scene_sized = sized(
        session, court.open, selected, options.sizing, options.rays.kinds, options.rays.camera);
    for (const auto& [entry, params] : scene_sized) {
        BuiltTracer built = build_repeatedly(*entry, court.open.scene, params);
        shared.builds.push_back({name, entry->info.name, std::move(built.build_ms)});
        owned.push_back(std::move(built.tracer));
        tracers.push_back(owned.back().get());
        shared.tracers.push_back(make_tracer_record(name, *tracers.back(), entry->info, params));
        shared.tracers.back().sizing = sizing_name(entry->info, options.sizing);
    }

    const size_t baseline = baseline_among(scene_sized, session, options);
    const std::unique_ptr<Tracer> rival =
        scene_sized[baseline].entry->make(court.open.scene, scene_sized[baseline].params);
    TimingOptions timing = options.timing;
    timing.rival = Rival{baseline, rival.get()};

    for (const std::string& kind : kinds) {
        if (stop_requested()) return;
        const Case subject = open_case(court, kind, request);
        Results point = shared;
        if (!bench_case(session, court, subject, tracers, timing, next_point(bar, study), point)) {
            return;
        }
        study.add(case_key(name, kind), std::move(point));
    }
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
    print_bench(results, table_stream(options.study.json));
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
    command
        ->add_option("--versus", options->versus,
                     "The tracer that the others are held against in pairs, and that is cast a "
                     "second time a round to measure the noise. Default: the first of -s")
        ->type_name("NAME")
        ->excludes("--settings")
        ->excludes("--ablate");
    command
        ->add_flag("--self-test", options->self_test,
                   fmt::format("Puts the timing itself on trial with the first of -s: how often "
                               "equals are called different, and the strategy slowed by a "
                               "twentieth is found; unless given, {}, size {}, {} rounds",
                               kSelfTestStrategy, kSelfTestSize, kSelfTestRounds))
        ->excludes("--sizing")
        ->excludes("--settings")
        ->excludes("--ablate");
    command->add_option("--comparisons", options->comparisons, "Of --self-test")
        ->check(CLI::PositiveNumber)
        ->needs("--self-test")
        ->capture_default_str();
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
    command->get_option("--self-test")->excludes("--json")->excludes("--shard");
    command->callback([&session, options, command] {
        if (!options->ablate.empty()) {
            if (command->count("--rays") == 0) options->rays.kinds = kAblationKinds;
            return bench_ablation(session, {options->scenes, options->ablate, options->rays,
                                            options->timing, options->study});
        }
        if (options->self_test) {
            if (command->count("--rays") == 0) options->rays.kinds = {"primary"};
            if (command->count("--size") == 0) options->rays.size = kSelfTestSize;
            if (options->strategy.patterns.empty()) {
                options->strategy.patterns = {kSelfTestStrategy};
            }
            if (command->count("--repetitions") == 0) {
                options->timing.repetitions = kSelfTestRounds;
            }
            return bench_self_test(session, {options->scenes, options->strategy, options->rays,
                                             options->timing, options->comparisons});
        }
        if (!options->settings) return run(session, *options);
        if (command->count("--rays") == 0) options->rays.kinds = kSettingsKinds;
        if (command->count("--size") == 0) options->rays.size = kSettingsSize;
        bench_settings(session, {options->scenes, options->rays, options->timing, options->entry,
                                 options->study});
    });
}

}  // namespace onepass::cli
