// onepass report: one HTML page from the JSON files of any runs.
#include "compare/report/report.h"

#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct ReportCommand {
    std::vector<std::string> inputs;
    std::string output;
};

void run(const ReportCommand& options) {
    check_writable(options.output);
    std::vector<Results> runs;
    std::vector<fs::path> folders;
    for (const std::string& input : options.inputs) {
        runs.push_back(read_results(input));
        const fs::path folder = fs::path(input).parent_path();
        folders.push_back(folder.empty() ? fs::path(".") : folder);
    }
    const std::string page = render_report(runs, folders);
    write_bytes_atomically(options.output, page);
    fmt::print(stderr, "onepass: wrote {} ({:.1f} MiB)\n", options.output,
               static_cast<double>(page.size()) / 1048576.0);
}

}  // namespace

void add_report(CLI::App& app, Session&) {
    CLI::App* command = app.add_subcommand(
        "report", "Makes one HTML page (no network needed) from results of check, bench and tune");
    auto options = std::make_shared<ReportCommand>();
    command->add_option("results", options->inputs, "JSON files written with --json")
        ->required()
        ->type_name("RESULT.json");
    command->add_option("-o,--output", options->output, "The page")
        ->required()
        ->type_name("FILE.html");
    command->callback([options] { run(*options); });
}

}  // namespace onepass::cli
