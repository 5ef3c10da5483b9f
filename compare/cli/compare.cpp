// onepass compare: two result files held against each other.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "compare/cli/commands.h"
#include "compare/cli/table.h"
#include "compare/run_comparison.h"

namespace onepass::cli {
namespace {

constexpr char kIfSlower[] = "slower";
constexpr char kIfMoreErrors[] = "more-errors";

struct CompareCommand {
    std::string before;
    std::string after;
    std::vector<std::string> fail_if;
};

std::string interval_text(const RatioInterval& r) {
    return fmt::format("{:.3f}..{:.3f}", r.low, r.high);
}

std::string noise_text(const SpeedChange& change) {
    if (std::isnan(change.noise)) return "not known";
    return fmt::format("{:.1f} %{}", 100.0 * change.noise, change.noise_known ? "" : ", of one");
}

std::string speed_table(const std::vector<SpeedChange>& speeds) {
    std::vector<std::vector<std::string>> rows = {{"case", "A", "B", "B / A", "95 % interval",
                                                   "noise", "by", "errors A", "errors B", "B is"}};
    for (const SpeedChange& c : speeds) {
        rows.push_back({fmt::format("{}, {}, {}{}", c.scene, c.rays, c.tracer,
                                    c.at.empty() ? "" : ", " + c.at),
                        fmt::format("{:.3f}", c.before.ratio), fmt::format("{:.3f}", c.after.ratio),
                        fmt::format("{:.3f}", c.change.ratio), interval_text(c.change),
                        noise_text(c), c.by_device ? "device" : "wall",
                        std::to_string(c.errors_before), std::to_string(c.errors_after),
                        std::string(to_string(c.verdict))});
    }
    return rows.size() > 1 ? "speed relative to the oracle in each run\n" + format_table(rows)
                           : "no speeds that both runs hold\n";
}

std::string count_table(const RunComparison& comparison) {
    std::string text = fmt::format("counts: {} equal, {} differ\n", comparison.equal_counts,
                                   comparison.counts.size());
    std::vector<std::vector<std::string>> rows = {{"count", "A", "B"}};
    for (const CountChange& c : comparison.counts) {
        rows.push_back({c.what, fmt::format("{}", c.before), fmt::format("{}", c.after)});
    }
    return rows.size() > 1 ? text + format_table(rows) : text;
}

std::string list(const std::string& title, const std::vector<std::string>& items) {
    if (items.empty()) return "";
    std::string text = title + "\n";
    for (const std::string& item : items) text += "  " + item + "\n";
    return text;
}

void run(Session& session, const CompareCommand& options) {
    const Results before = read_results(options.before);
    const Results after = read_results(options.after);
    const RunComparison comparison = compare_runs(before, after);
    const auto run_text = [](const std::string& name, const Results& run) {
        return fmt::format("{}: commit {}{}, {}", name, run.manifest.commit,
                           run.manifest.dirty ? " with uncommitted changes" : "",
                           run.manifest.time_utc);
    };
    fmt::print("A = {}\nB = {}\n", run_text(options.before, before),
               run_text(options.after, after));
    fmt::print("{}{}{}{}{}",
               list("WARNING: these runs differ in more than the code:", comparison.warnings),
               speed_table(comparison.speeds), count_table(comparison),
               list("only in A:", comparison.only_before),
               list("only in B:", comparison.only_after));

    const auto asked = [&](const char* what) {
        return std::find(options.fail_if.begin(), options.fail_if.end(), what) !=
               options.fail_if.end();
    };
    if ((asked(kIfSlower) && any_slower(comparison)) ||
        (asked(kIfMoreErrors) && any_more_errors(comparison))) {
        session.exit_code = kFailed;
    }
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "compare", "Holds two result files against each other: speeds, errors, counts");
    auto options = std::make_shared<CompareCommand>();
    command->add_option("before", options->before, "A: the file that changes are told from")
        ->required()
        ->type_name("A.json");
    command->add_option("after", options->after, "B: the file of the other run")
        ->required()
        ->type_name("B.json");
    command
        ->add_option("--fail-if", options->fail_if,
                     "Exit code 1 if some case of B is 'slower' (interval and noise leave no other "
                     "reading), or has 'more-errors'; may be repeated")
        ->allow_extra_args(false)
        ->check(CLI::IsMember({kIfSlower, kIfMoreErrors}));
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
