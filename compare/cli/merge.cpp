// onepass merge: one result file from the shards of a study.
#include "compare/merge.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/commands.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

struct MergeCommand {
    std::vector<std::string> inputs;
    std::string output;
    bool partial = false;
};

/// A shard as its run wrote it: the united file gets a digest of its own, and no edit may hide
/// behind that.
Results read_unedited(const std::string& input) {
    Results results = read_results(input);
    std::ifstream file(input, std::ios::binary);
    const Seal seal = seal_of({std::istreambuf_iterator<char>(file), {}}, input);
    if (!seal.stored.empty() && !seal.intact()) {
        throw Error({input, "a digest that is not that of the content: it was edited",
                     "a file as its run wrote it", "Make the shard again."});
    }
    return results;
}

void run(const MergeCommand& options) {
    check_writable(options.output);
    std::vector<ShardFile> files;
    for (const std::string& input : options.inputs) {
        files.push_back({input, read_unedited(input)});
        move_pictures(files.back().results, fs::path(input).parent_path(),
                      fs::path(options.output).parent_path());
    }
    const Results all = merge_shards(files, options.partial);
    write_results(all, options.output);
    fmt::print(stderr, "onepass: wrote {}: {} of {} points from {} files\n", options.output,
               all.study->points.size(), all.study->keys.size(), files.size());
    const std::vector<StudyPart>& parts = all.study->parts;
    const bool alike = std::all_of(parts.begin(), parts.end(), [&](const StudyPart& part) {
        return like_machines(part.manifest, parts.front().manifest);
    });
    if (!alike) {
        fmt::print(stderr,
                   "onepass: the shards were measured on unlike machines: their counts compare, "
                   "their times do not\n");
    }
}

}  // namespace

void add_merge(CLI::App& app, Session&) {
    CLI::App* command = app.add_subcommand(
        "merge", "Unites the shards of a study (--shard of bench, check, tune, grow)");
    auto options = std::make_shared<MergeCommand>();
    command->add_option("shards", options->inputs, "Result files, in any order")
        ->required()
        ->type_name("SHARD.json");
    command->add_option("-o,--output", options->output, "The united file")
        ->required()
        ->type_name("FILE");
    command->add_flag("--partial", options->partial,
                      "Allows points to be missing; the file then says that it is not complete");
    command->callback([options] { run(*options); });
}

}  // namespace onepass::cli
