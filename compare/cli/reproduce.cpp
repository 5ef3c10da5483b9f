// onepass reproduce: the paper's tables, figures and claims, measured anew and put on one page.
//
// The work is a list of steps, each kept in DIR/parts as it finishes. Stopped by Ctrl-C, or by a
// power cut, the same command takes up with the first step that is not there.
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/claims.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/paper_steps.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/paper_figures.h"
#include "compare/parts.h"
#include "compare/report/report.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct ReproduceCommand {
    std::string output;
    std::vector<std::string> claims;
    std::vector<std::string> scenes;
    std::string entry = "fragment";
    bool quick = false;
    bool fresh = false;
    bool list = false;
};

/// A step leaves its results, or returns false if it was stopped.
struct Step {
    std::string name;                    ///< also of its part: "scene-balls-1", "claim-single-pass"
    double weight = 1.0;                 ///< its share of the work, relative to the others
    std::vector<std::string> arguments;  ///< the command that remakes it alone
    std::function<bool(const Progress&, Results&)> work;
};

/// One run of the command.
struct ReproduceRun {
    Session& session;
    const ReproduceCommand& options;
    const PaperEffort effort =
        paper_effort(session.gl_context().description().software, options.quick);
    const std::vector<std::string> entries = options.entry == "both"
                                                 ? std::vector<std::string>{"fragment", "compute"}
                                                 : std::vector<std::string>{options.entry};
    const fs::path folder = options.output;
    const bool whole = options.claims.empty() && options.scenes.empty();
    const Workshop workshop = make_workshop(session, effort);
    std::vector<Results> done = {};  ///< by step; those not reached are missing

    // ---- The steps.

    std::vector<std::string> arguments_of(const std::string& option,
                                          const std::string& value) const {
        std::vector<std::string> arguments = {"onepass", "reproduce", option,
                                              value,     "--entry",   options.entry};
        if (options.quick) arguments.push_back("--quick");
        return arguments;
    }

    Step scene_step(const std::string& scene) {
        constexpr double kWeight = 8.0;
        return {"scene-" + file_name_part(scene), kWeight * static_cast<double>(entries.size()),
                arguments_of("--scene", scene),
                [this, scene](const Progress& progress, Results& results) {
                    return measure_paper_scene(session, scene, entries, effort, folder, progress,
                                               results);
                }};
    }

    Step claim_step(const Claim& claim) {
        double contestants = 0.0;
        for (const Experiment& e : claim.experiments) {
            contestants += 2.0 + static_cast<double>(e.variants.size());
        }
        const double weight = contestants * static_cast<double>(entries.size()) / 4.0;
        return {"claim-" + claim.id, weight, arguments_of("--claim", claim.id),
                [this, &claim](const Progress& progress, Results& results) {
                    const double share = 1.0 / static_cast<double>(entries.size());
                    double begin = 0.0;
                    for (const std::string& entry : entries) {
                        const Progress part = [&](double d) {
                            return go_on(progress, begin + share * d);
                        };
                        if (!run_claim(claim, entry, workshop, part, results)) return false;
                        begin += share;
                    }
                    return true;
                }};
    }

    std::vector<Step> steps() {
        std::vector<Step> all;
        for (const std::string& scene : options.scenes) all.push_back(scene_step(scene));
        for (const std::string& id : options.claims) all.push_back(claim_step(find_claim(id)));
        if (!whole) return all;
        for (const PaperScene& scene : kPaperScenes)
            all.push_back(scene_step(std::string(scene.name)));
        for (const Claim& claim : paper_claims()) all.push_back(claim_step(claim));
        return all;
    }

    // ---- Doing them.

    Manifest manifest_of(const Step& step) const {
        Manifest manifest = session.manifest();
        manifest.arguments = step.arguments;
        return manifest;
    }

    /// False if it was stopped. A scene that is not there leaves nothing.
    bool work(const Step& step, ProgressBar& bar, const Progress& progress, Results& results) {
        const auto start = std::chrono::steady_clock::now();
        try {
            if (!step.work(progress, results)) return false;
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::device) throw;
            bar.say(fmt::format("{}: not measured: {}", step.name, error.what()));
            results = {};
            return true;
        }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        bar.say(fmt::format("{}: {:.1f} s", step.name, taken.count()));
        const std::string judge = results.manifest.judge;
        results.manifest = manifest_of(step);
        results.manifest.judge = judge;
        return true;
    }

    /// Fills `done` up to the first step that was stopped.
    void run(const std::vector<Step>& all) {
        std::unique_ptr<PartStore> store;
        if (!folder.empty()) store = std::make_unique<PartStore>(folder / "parts");

        // What is there already.
        std::vector<FoundPart> found(all.size());
        double total = 0.0;
        for (size_t i = 0; i < all.size(); ++i) {
            if (store && !options.fresh) found[i] = store->find(all[i].name, manifest_of(all[i]));
            if (!found[i].results) total += all[i].weight;
        }

        // What is not.
        ProgressBar bar("reproduce");
        double begin = 0.0;
        for (size_t i = 0; i < all.size() && !stop_requested(); ++i) {
            const Step& step = all[i];
            if (found[i].results) {
                bar.say(fmt::format("{}: kept from an earlier run", step.name));
                done.push_back(std::move(*found[i].results));
                continue;
            }
            if (!found[i].why_not.empty()) {
                bar.say(fmt::format("{}: made again: {}", step.name, found[i].why_not));
            }
            Results results;
            const double end = begin + step.weight;
            if (!work(step, bar, bar.part(begin / total, end / total), results)) return;
            begin = end;
            if (store && !results.manifest.commit.empty()) store->save(step.name, results);
            done.push_back(std::move(results));
        }
    }

    // ---- What they come to.

    Results gathered() const {
        Results results;
        for (const Results& part : done) append_results(results, part);
        const std::string judge = results.manifest.judge;
        results.manifest = session.manifest();
        results.manifest.judge = judge;
        return results;
    }

    void write(const Results& results) const {
        const std::string stem = whole ? "paper" : "partial";
        const fs::path json = folder / (stem + ".json");
        const fs::path page = folder / (stem + ".html");
        write_results(results, json);
        write_bytes_atomically(page, render_report({results}, {folder}));
        fmt::print(stderr, "onepass: wrote {} and {}\n", json.string(), page.string());
    }
};

void print_claims(const Results& results) {
    if (results.claims.empty()) return;
    std::vector<std::vector<std::string>> rows = {{"verdict", "entry", "claim", "found"}};
    for (const ClaimRecord& claim : results.claims) {
        rows.push_back({std::string(to_string(claim.verdict)), claim.entry, claim.id, claim.now});
    }
    fmt::print("{}", format_list(rows, ""));
}

void list_claims() {
    for (const Claim& claim : paper_claims()) {
        fmt::print("{}\n  {}\n  then: {}; {}\n  rule: {}\n", claim.id, claim.claim, claim.then,
                   claim.source, claim.rule);
    }
    fmt::print("\nEvery measurement: {}\n", kVerdictRule);
}

void run(Session& session, const ReproduceCommand& options) {
    if (options.list) return list_claims();
    if (options.output.empty() && options.claims.empty() && options.scenes.empty()) {
        throw Error({"onepass reproduce", "no folder", "-o DIR for the results and the page",
                     "For example -o results/local/paper; --claim alone needs none."});
    }
    for (const std::string& id : options.claims) find_claim(id);  // before any work
    ReproduceRun reproduce{session, options};                     // throws without a GL device
    const std::vector<Step> steps = reproduce.steps();
    if (!options.output.empty()) {
        std::error_code ignored;
        fs::create_directories(reproduce.folder / "pictures", ignored);  // PartStore says why not
    }

    reproduce.run(steps);
    const Results results = reproduce.gathered();
    print_claims(results);
    if (reproduce.done.size() < steps.size()) {
        session.exit_code = kStopped;
        fmt::print(stderr, "onepass: stopped after {} of {} steps{}\n", reproduce.done.size(),
                   steps.size(),
                   options.output.empty() ? ""
                                          : "; the same command goes on from there (--fresh does "
                                            "not)");
        return;
    }
    if (!options.output.empty()) reproduce.write(results);
}

}  // namespace

void add_reproduce(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "reproduce", "Measures the paper's tables, figures and claims anew: one page");
    auto options = std::make_shared<ReproduceCommand>();
    command
        ->add_option("-o,--output", options->output,
                     "Folder for paper.json, paper.html, pictures and parts; made if needed")
        ->type_name("DIR");
    command
        ->add_option("--claim", options->claims,
                     "Only this claim; may be repeated. Writes partial.json and partial.html with "
                     "-o, and nothing without")
        ->type_name("ID")
        ->allow_extra_args(false);
    command
        ->add_option("--scene", options->scenes,
                     "Only this scene's row of the tables and its figure; may be repeated; as "
                     "--claim")
        ->type_name("SCENE")
        ->allow_extra_args(false);
    command
        ->add_option(
            "-s,--entry", options->entry,
            "How GLSL tracers run: fragment (the paper's), compute or both, which the page "
            "shows apart")
        ->check(CLI::IsMember({"fragment", "compute", "both"}))
        ->capture_default_str();
    command->add_flag("--list", options->list, "Lists the claims and the rules of their verdicts");
    command->add_flag("--fresh", options->fresh,
                      "Measures every step again. Default: steps that the same build finished on "
                      "the same device with the same options are kept");
    command->add_flag("--quick", options->quick,
                      "Tiny images and few rounds, to see that all steps run: no figure to quote");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
