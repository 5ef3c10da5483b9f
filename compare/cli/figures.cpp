#include "compare/cli/figures.h"

#include <cstdlib>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/report/figures.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGnuplot = "gnuplot";

/// In single quotes; a quote within leaves them, stands escaped, and enters them again.
std::string shell_quoted(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

bool succeeds(const std::string& command) { return std::system(command.c_str()) == 0; }

}  // namespace

void write_figures(const std::vector<Results>& runs, const std::vector<fs::path>& folders,
                   const fs::path& folder) {
    // The texts.
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) {
        throw Error({folder.string(), failure.message(), "a folder for figures",
                     "Choose another with --figures."});
    }
    const std::vector<report::TextFile> files = report::figure_files(runs, folders);
    size_t drawings = 0;
    for (const report::TextFile& file : files) {
        write_bytes_atomically(folder / file.name, file.text);
        drawings += file.name.ends_with(report::kScriptSuffix) ? 1 : 0;
    }

    // The drawings.
    const bool drawn = succeeds(fmt::format("command -v {} >/dev/null", kGnuplot));
    for (const report::TextFile& file : files) {
        if (!drawn || !file.name.ends_with(report::kScriptSuffix)) continue;
        const std::string command = fmt::format("cd -- {} && {} {}", shell_quoted(folder.string()),
                                                kGnuplot, shell_quoted(file.name));
        if (!succeeds(command)) {
            throw Error({(folder / file.name).string(), "an error of gnuplot", "an SVG",
                         "The message above names the line; the CSV files are whole."});
        }
    }
    fmt::print(stderr, "onepass: wrote {} CSV files and {} figures to {}\n",
               files.size() - drawings, drawn ? drawings : 0, folder.string());
    if (!drawn && drawings > 0) {
        fmt::print(stderr,
                   "onepass: no gnuplot here, so no SVG; Debian's package is gnuplot-nox. Then: "
                   "cd {} && gnuplot *{}\n",
                   folder.string(), report::kScriptSuffix);
    }
}

}  // namespace onepass::cli
