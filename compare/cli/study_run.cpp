#include "compare/cli/study_run.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "scenes/scenes.h"

namespace onepass::cli {

void add_study_options(CLI::App& command, StudyOptions& options) {
    command
        .add_option("--json", options.json,
                    "Writes the results, point by point; '-' is standard output. Stopped or "
                    "killed, the same command goes on from there")
        ->type_name("FILE");
    command
        .add_option("--shard", options.shard,
                    "Does the I-th of N shares of the work, for 'onepass merge' to unite")
        ->type_name("I/N")
        ->capture_default_str();
}

void check_scene_names(std::span<const std::string> names) {
    for (const std::string& name : names) {
        const auto& known = builtin_scenes();
        const bool builtin = std::any_of(
            known.begin(), known.end(), [&](const SceneInfo& scene) { return scene.name == name; });
        std::error_code ignored;
        const bool there =
            builtin ? how_to_fetch(name).empty() : std::filesystem::exists(name, ignored);
        if (!there) load_scene(name);  // which says what is missing
    }
}

Study open_study(Session& session, const StudyOptions& options, std::vector<std::string> keys,
                 std::span<const CatalogueEntry* const> tracers) {
    const bool has_file = !options.json.empty() && options.json != "-";
    if (has_file) check_writable(options.json);
    const Shard shard = parse_shard(options.shard);
    const bool has_gl = std::any_of(tracers.begin(), tracers.end(), [](const auto* entry) {
        return !entry->info.is_oracle && !entry->info.is_twin;
    });
    if (has_gl) session.gl_context();

    Study study({std::move(keys), shard, session.manifest(), options.json});
    if (study.kept() > 0) {
        fmt::print(stderr, "onepass: {}: {} of {} points are kept from an earlier run\n",
                   options.json, study.kept(), study.total());
    }
    return study;
}

std::string case_key(const std::string& scene, const std::string& kind) {
    return fmt::format("{}, {}", scene, kind);
}

Progress next_point(ProgressBar& bar, const Study& study) {
    const auto left = static_cast<double>(study.total() - study.kept());
    const auto begin = static_cast<double>(study.done() - study.kept());
    return bar.part(begin / left, (begin + 1.0) / left);
}

void finish_study(Session& session, const Study& study, Results& results,
                  const StudyOptions& options) {
    finish(session, results, options.json, !study.finished());
    if (study.finished()) return;
    const bool has_file = !options.json.empty() && options.json != "-";
    fmt::print(stderr, "onepass: {} of {} points are finished{}\n", study.done(), study.total(),
               has_file ? "; the same command goes on from there" : "");
}

}  // namespace onepass::cli
