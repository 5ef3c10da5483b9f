// onepass stress: ladders that are climbed until methods break, every answer judged exactly.
//
// Each ladder is a step, kept in DIR/parts as it finishes, so that the same command goes on where
// it was stopped. Failures are what this command is for: they never make it fail.
#include "compare/stress.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/parts.h"
#include "compare/report/report.h"
#include "core/error.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/ladders.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

/// Everything that `onepass stress` can run.
std::vector<StressExperiment> all_experiments() {
    std::vector<StressExperiment> all;
    for (const Ladder& ladder : ladders()) all.push_back(ladder_experiment(ladder));
    return all;
}

/// The robust grid and the paper's, each with its twins, which tell rounding from the algorithm;
/// both Embrees; and the paper's triangle test without any grid.
const std::vector<std::string> kDefaultStrategies = {
    "grid/buffer/fragment",           "grid/buffer/twin32",     "grid/buffer/twin64",
    "paper/texture2d/fragment",       "paper/texture2d/twin32", "paper/texture2d/twin64",
    "brute_force/texture2d/fragment", "embree/fast/threads",    "embree/robust/threads"};

/// By default the paper's tracer climbs once more without its slack of 0.4 % at one edge (D11),
/// which alone breaks it on the first rung of nearly every ladder.
constexpr char kStrictPaper[] = "paper/texture2d/fragment";
const ParamValues kStrictParams = {{"edge_tolerance", "1"}};
constexpr char kStrictSetting[] = "edge_tolerance=1";

/// A column of the summary: the first who climbed with such a name.
struct Column {
    const char* heading;
    const char* prefix;
    const char* setting;  ///< null: any
};
constexpr Column kColumns[] = {{"paper", "paper/", nullptr},
                               {"paper edge_tolerance=1", "paper/", kStrictSetting},
                               {"grid", "grid/", nullptr},
                               {"embree fast", "embree/fast/", nullptr},
                               {"embree robust", "embree/robust/", nullptr}};

struct StressCommand {
    std::vector<std::string> experiments;
    StrategyOptions strategy;
    uint32_t rays = 4096;
    std::string json;
    std::string output;
    bool fresh = false;
    bool list = false;
};

// ---- Tables

std::string knob_text(const RungRecord& rung) {
    return rung.label.empty() ? fmt::format("{:g}", rung.knob) : rung.label;
}

std::string climber_name(const RungRecord& rung) {
    return rung.setting.empty() ? rung.tracer : fmt::format("{} ({})", rung.tracer, rung.setting);
}

bool same_climber(const RungRecord& a, const RungRecord& b) {
    return a.tracer == b.tracer && a.setting == b.setting;
}

bool same_rung(const RungRecord& a, const RungRecord& b) {
    return a.knob == b.knob && a.label == b.label;
}

/// The first record of each that differs from all before it.
template <class Same>
std::vector<const RungRecord*> distinct(const LadderRecord& ladder, Same&& same) {
    std::vector<const RungRecord*> found;
    for (const RungRecord& rung : ladder.rungs) {
        const bool known = std::any_of(found.begin(), found.end(),
                                       [&](const RungRecord* other) { return same(rung, *other); });
        if (!known) found.push_back(&rung);
    }
    return found;
}

const RungRecord* find_rung(const LadderRecord& ladder, const RungRecord& climber,
                            const RungRecord& rung) {
    const auto found = std::find_if(
        ladder.rungs.begin(), ladder.rungs.end(),
        [&](const RungRecord& r) { return same_climber(r, climber) && same_rung(r, rung); });
    return found == ladder.rungs.end() ? nullptr : &*found;
}

std::string cell_text(const RungRecord* rung) {
    if (rung == nullptr) return "";
    if (rung->trials == 0) return "refused";
    return fmt::format("{}/{}", rung->failed(), rung->trials);
}

std::string vector_text(const vec3& v) {
    return fmt::format("({:.9g} {:.9g} {:.9g})", v.x, v.y, v.z);
}

std::string hit_text(double t, uint32_t prim_id, uint32_t inst_id) {
    if (inst_id == kNoId) return "a miss";
    return fmt::format("t {:.9g} triangle {} instance {}", t, prim_id, inst_id);
}

/// What a climber did wrong where it first did, and what it refused.
std::string remarks(const LadderRecord& ladder, const RungRecord& climber) {
    std::string text;
    if (const RungRecord* broken = breaks_at(ladder, climber.tracer, climber.setting)) {
        std::string kinds;
        for (const FailureCount& failure : broken->failures) {
            kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", failure.kind, failure.count);
        }
        text += fmt::format("  {} at {}: {}", climber_name(climber), knob_text(*broken), kinds);
        if (const auto& worst = broken->worst) {
            text +=
                fmt::format("; ray {}, from {} along {}: {}; truth: {}", worst->index,
                            vector_text(worst->ray.org), vector_text(worst->ray.dir),
                            hit_text(worst->answer.t, worst->answer.prim_id, worst->answer.inst_id),
                            hit_text(worst->verdict.true_t, worst->verdict.true_prim_id,
                                     worst->verdict.true_inst_id));
        }
        text += "\n";
    }
    for (const RungRecord& rung : ladder.rungs) {
        if (!same_climber(rung, climber) || rung.refusal.empty()) continue;
        text +=
            fmt::format("  {} at {}: {}\n", climber_name(climber), knob_text(rung), rung.refusal);
    }
    return text;
}

std::string ladder_table(const LadderRecord& ladder) {
    const auto rungs = distinct(ladder, same_rung);
    std::vector<std::vector<std::string>> rows = {{"failures of trials"}};
    for (const RungRecord* rung : rungs) rows[0].push_back(knob_text(*rung));
    rows[0].push_back("breaks at");
    std::string notes;
    for (const RungRecord* climber : distinct(ladder, same_climber)) {
        std::vector<std::string> row = {climber_name(*climber)};
        for (const RungRecord* rung : rungs) {
            row.push_back(cell_text(find_rung(ladder, *climber, *rung)));
        }
        const RungRecord* broken = breaks_at(ladder, climber->tracer, climber->setting);
        row.push_back(broken ? knob_text(*broken) : "never");
        rows.push_back(std::move(row));
        notes += remarks(ladder, *climber);
    }
    return fmt::format("{}: {}; {}{}{}\n", ladder.id, ladder.title, ladder.knob,
                       ladder.unit.empty() ? "" : ", in ", ladder.unit) +
           format_table(rows) + notes + "\n";
}

const RungRecord* find_climber(const LadderRecord& ladder, const Column& column) {
    const auto found =
        std::find_if(ladder.rungs.begin(), ladder.rungs.end(), [&](const RungRecord& rung) {
            return rung.tracer.starts_with(column.prefix) &&
                   (column.setting == nullptr || rung.setting == column.setting);
        });
    return found == ladder.rungs.end() ? nullptr : &*found;
}

std::string fate_of(const LadderRecord& ladder, const Column& column) {
    const RungRecord* climber = find_climber(ladder, column);
    if (climber == nullptr) return "-";
    const RungRecord* broken = breaks_at(ladder, climber->tracer, climber->setting);
    return broken ? knob_text(*broken) : "never";
}

/// Who goes on where grid has failed, but for its own twins and others'; empty if nobody does.
std::string beyond_grid(const LadderRecord& ladder) {
    const RungRecord* grid = find_climber(ladder, {"grid", "grid/", nullptr});
    if (grid == nullptr) return "";
    std::string names;
    for (const RungRecord* other : outlasting(ladder, grid->tracer, grid->setting)) {
        const bool twin = other->tracer.find("/twin") != std::string::npos;
        if (twin || other->tracer.starts_with("grid/")) continue;
        names += (names.empty() ? "" : ", ") + climber_name(*other);
    }
    if (names.empty()) return "";
    return fmt::format("  {}: {} fails before {}\n", ladder.id, grid->tracer, names);
}

std::string summary_table(const std::vector<LadderRecord>& ladders) {
    std::vector<std::vector<std::string>> rows = {{"breaks at"}};
    for (const Column& column : kColumns) rows[0].push_back(column.heading);
    std::string notes;
    for (const LadderRecord& ladder : ladders) {
        rows.push_back({ladder.id});
        for (const Column& column : kColumns) rows.back().push_back(fate_of(ladder, column));
        notes += beyond_grid(ladder);
    }
    return "who breaks first\n" + format_table(rows) + notes;
}

// ---- Running

/// One run of the command.
struct StressRun {
    Session& session;
    const StressCommand& options;
    const std::vector<StressExperiment> experiments;
    const std::vector<Contestant> contestants;
    const bool whole = options.experiments.empty();
    std::vector<Results> done = {};  ///< by experiment; those not reached are missing

    StressSetup setup() const {
        StressSetup setup;
        setup.contestants = contestants;
        setup.make_judge = [](ScenePtr scene) { return make_exact_judge(std::move(scene)); };
        setup.make_oracle = [this](ScenePtr scene) {
            return session.catalogue.at(kOracleName).make(std::move(scene), {});
        };
        setup.rays = options.rays;
        setup.seed = session.globals.seed;
        return setup;
    }

    /// The command that climbs this ladder alone.
    std::vector<std::string> arguments_of(const StressExperiment& experiment) const {
        std::vector<std::string> arguments = {"onepass", "stress", experiment.id};
        const auto add = [&](const std::string& option, const std::string& value) {
            arguments.push_back(option);
            arguments.push_back(value);
        };
        for (const std::string& pattern : options.strategy.patterns) add("-s", pattern);
        for (const std::string& param : options.strategy.params) add("--param", param);
        add("--rays", std::to_string(options.rays));
        add("--seed", std::to_string(session.globals.seed));
        return arguments;
    }

    Manifest manifest_of(const StressExperiment& experiment) const {
        Manifest manifest = session.manifest();
        manifest.arguments = arguments_of(experiment);
        return manifest;
    }

    /// False if it was stopped.
    bool run(const StressExperiment& experiment, ProgressBar& bar, const Progress& progress,
             Results& results) const {
        const auto start = std::chrono::steady_clock::now();
        LadderRecord ladder = experiment.run(setup(), progress);
        if (stop_requested()) return false;
        for (const std::string& word : arguments_of(experiment)) {
            ladder.command += (ladder.command.empty() ? "" : " ") + word;
        }
        results.manifest = manifest_of(experiment);
        results.manifest.judge = ladder.judge;
        results.ladders.push_back(std::move(ladder));
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        bar.say(fmt::format("{}: {:.1f} s", experiment.id, taken.count()));
        return true;
    }

    /// Fills `done` up to the first experiment that was stopped.
    void run_all() {
        std::unique_ptr<PartStore> store;
        if (!options.output.empty()) {
            store = std::make_unique<PartStore>(fs::path(options.output) / "parts");
        }
        ProgressBar bar("stress");
        const double total = static_cast<double>(experiments.size());
        for (size_t i = 0; i < experiments.size() && !stop_requested(); ++i) {
            const StressExperiment& experiment = experiments[i];
            if (store && !options.fresh) {
                FoundPart found = store->find(experiment.id, manifest_of(experiment));
                if (found.results) {
                    bar.say(fmt::format("{}: kept from an earlier run", experiment.id));
                    done.push_back(std::move(*found.results));
                    continue;
                }
                if (!found.why_not.empty()) {
                    bar.say(fmt::format("{}: made again: {}", experiment.id, found.why_not));
                }
            }
            Results results;
            const double begin = static_cast<double>(i);
            if (!run(experiment, bar, bar.part(begin / total, (begin + 1.0) / total), results)) {
                return;
            }
            if (store) store->save(experiment.id, results);
            done.push_back(std::move(results));
        }
    }

    Results gathered() const {
        Results results;
        for (const Results& part : done) append_results(results, part);
        return results;
    }

    /// The results as they are written, with the page beside them.
    void write_folder(Results results) const {
        const std::string judge = results.manifest.judge;
        results.manifest = session.manifest();
        results.manifest.judge = judge;
        const fs::path folder = options.output;
        const std::string stem = whole ? "stress" : "partial";
        write_results(results, folder / (stem + ".json"));
        write_bytes_atomically(folder / (stem + ".html"), render_report({results}, {folder}));
        fmt::print(stderr, "onepass: wrote {} and {}\n", (folder / (stem + ".json")).string(),
                   (folder / (stem + ".html")).string());
    }
};

std::vector<StressExperiment> select_experiments(const std::vector<std::string>& ids) {
    const std::vector<StressExperiment> all = all_experiments();
    if (ids.empty()) return all;
    std::vector<StressExperiment> selected;
    for (const std::string& id : ids) {
        const auto found = std::find_if(
            all.begin(), all.end(), [&](const auto& experiment) { return experiment.id == id; });
        if (found == all.end()) {
            std::string known;
            for (const StressExperiment& e : all) known += (known.empty() ? "" : ", ") + e.id;
            throw Error({"onepass stress", fmt::format("'{}'", id), "one of " + known,
                         "'onepass stress --list' says what each is."});
        }
        selected.push_back(*found);
    }
    return selected;
}

std::vector<Contestant> select_contestants(const Session& session, StrategyOptions options) {
    const bool defaults = options.patterns.empty();
    if (defaults) options.patterns = kDefaultStrategies;
    std::vector<Contestant> contestants;
    for (const SelectedStrategy& s : select_strategies(session.catalogue, options)) {
        contestants.push_back({s.entry, s.params});
        if (!defaults || s.entry->info.name != kStrictPaper) continue;
        ParamValues strict = s.params;
        strict.insert(kStrictParams.begin(), kStrictParams.end());
        if (strict != s.params) contestants.push_back({s.entry, strict});
    }
    return contestants;
}

void list_experiments() {
    std::vector<std::vector<std::string>> rows = {{"ladder", "what it is"}};
    for (const StressExperiment& e : all_experiments()) rows.push_back({e.id, e.title});
    fmt::print("{}", format_list(rows, ""));
    for (const Ladder& ladder : ladders()) {
        fmt::print("\n{}: {}\n  {}\n", ladder.id, ladder.title, ladder.question);
    }
}

void run(Session& session, const StressCommand& options) {
    if (options.list) return list_experiments();
    if (!options.json.empty() && options.json != "-") check_writable(options.json);
    StressRun stress{session, options, select_experiments(options.experiments),
                     select_contestants(session, options.strategy)};

    // The manifest names the GL device, which an earlier run is compared by: have it from the
    // start.
    const bool has_gl = std::any_of(
        stress.contestants.begin(), stress.contestants.end(),
        [](const auto& c) { return !c.entry->info.is_oracle && !c.entry->info.is_twin; });
    if (has_gl) session.gl_context();

    stress.run_all();
    Results results = stress.gathered();
    std::FILE* out = table_stream(options.json);
    for (const LadderRecord& ladder : results.ladders) fmt::print(out, "{}", ladder_table(ladder));
    if (!results.ladders.empty()) fmt::print(out, "{}", summary_table(results.ladders));
    const bool stopped = stress.done.size() < stress.experiments.size();
    if (!options.output.empty() && !stopped) stress.write_folder(results);
    finish(session, results, options.json, stopped);
    if (stopped && !options.output.empty()) {
        fmt::print(stderr, "onepass: {} of {} ladders are kept; the same command goes on there\n",
                   stress.done.size(), stress.experiments.size());
    }
}

}  // namespace

void add_stress(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "stress",
        "Climbs ladders of ever harder scenes and rays, and says where each method fails. Every "
        "answer is judged exactly. Failures are data: the exit code is 0 whatever fails");
    auto options = std::make_shared<StressCommand>();
    command->add_option("ladders", options->experiments, "Ladders to climb; default: all")
        ->type_name("LADDER");
    add_strategy_options(*command, options->strategy);
    command->get_option("--strategy")
        ->description(
            "Strategy: NAME[/STORAGE[/ENTRY]] or a pattern with '*'; may be repeated. Default: " +
            fmt::format("{}", fmt::join(kDefaultStrategies, ", ")) +
            fmt::format("; and {} with {}", kStrictPaper, kStrictSetting));
    command->add_option("--rays", options->rays, "Rays of every rung")
        ->check(CLI::Range(1u, 1u << 24))
        ->capture_default_str();
    command->add_option("--json", options->json, "Writes the results; '-' is standard output")
        ->type_name("FILE");
    command
        ->add_option(
            "-o,--output", options->output,
            "Folder for stress.json and stress.html (of all ladders; of some: partial.json "
            "and partial.html) and parts; made if needed. Ctrl-C stops; the same command "
            "goes on from there")
        ->type_name("DIR");
    command->add_flag("--list", options->list, "Lists the ladders and what each of them asks");
    command->add_flag("--fresh", options->fresh,
                      "Climbs every ladder again. Default: ladders that the same build finished on "
                      "the same device with the same options are kept");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
