// onepass report: one HTML page, and figures for a paper, from the JSON files of any runs; with
// --check, whether such files say what their samples say.
#include "compare/report/report.h"

#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/audit.h"
#include "compare/cli/commands.h"
#include "compare/cli/figures.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
    std::vector<std::string> inputs;
    std::string output;
    std::string figures;
    bool check = false;
};

fs::path folder_of(const std::string& file) {
    const fs::path folder = fs::path(file).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

/// What a file without samples and without a digest says cannot be held against anything.
const char* outcome_text(const Audit& found) {
    if (!found.passed()) return "FAILED";
    return found.derived == 0 && !found.sealed ? "NOTHING TO CHECK" : "passed";
}

/// What the digest says, in words.
std::string seal_text(const Audit& found) {
    if (!found.sealed) return "no digest stored";
    return found.intact ? "the digest is right"
                        : "THE DIGEST IS NOT THAT OF THE CONTENT: it was edited";
}

/// Derives every headline number again; false if a file does not say what its samples say.
bool check_files(const std::vector<std::string>& inputs) {
    bool passed = true;
    for (const std::string& input : inputs) {
        std::ifstream file(input, std::ios::binary);
        if (!file) read_results(input);  // says what is wrong with it
        const Audit found =
            audit({std::istreambuf_iterator<char>(file), {}}, input, folder_of(input));
        fmt::print("{}: {}: {} figures derived again, {} differ; {}\n", input, outcome_text(found),
                   found.derived, found.discrepancies.size(), seal_text(found));
        if (found.underived > 0) {
            fmt::print("  {} figures rest on samples that the file does not hold\n",
                       found.underived);
        }
        for (const Discrepancy& d : found.discrepancies) {
            fmt::print("  {}: stored {}, derived {}\n", d.place, d.stored, d.derived);
        }
        passed &= found.passed();
    }
    return passed;
}

void run(Session& session, const ReportCommand& options) {
    if (options.output.empty() && options.figures.empty() && !options.check) {
        throw Error({"onepass report", "no word of what to make", "-o, --figures or --check",
                     "For a page: -o report.html"});
    }
    if (!options.output.empty()) check_writable(options.output);
    if (options.check && !check_files(options.inputs)) session.exit_code = kFailed;
    if (options.output.empty() && options.figures.empty()) return;

    std::vector<Results> runs;
    std::vector<fs::path> folders;
    for (const std::string& input : options.inputs) {
        runs.push_back(read_results(input));
        folders.push_back(folder_of(input));
    }
    if (!options.output.empty()) {
        const std::string page = render_report(runs, folders);
        write_bytes_atomically(options.output, page);
        fmt::print(stderr, "onepass: wrote {} ({:.1f} MiB)\n", options.output,
                   static_cast<double>(page.size()) / 1048576.0);
    }
    if (!options.figures.empty()) write_figures(runs, folders, options.figures);
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "report", "Makes one HTML page (no network needed) from the results of any commands");
    auto options = std::make_shared<ReportCommand>();
    command->add_option("results", options->inputs, "JSON files written with --json")
        ->required()
        ->type_name("RESULT.json");
    command->add_option("-o,--output", options->output, "The page")->type_name("FILE.html");
    command
        ->add_option("--figures", options->figures,
                     "Writes every record list and every chart as CSV, and the charts as SVG with "
                     "the gnuplot scripts that draw them")
        ->type_name("DIR");
    command->add_flag("--check", options->check,
                      "Derives every headline number again from the samples and counts of each "
                      "file, and its digest; exit code 1 if one differs");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
