// How commands run as studies (compare/study.h): options, taking up, progress, and the last word.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "compare/cli/progress_bar.h"
#include "compare/cli/session.h"
#include "compare/study.h"
#include "core/catalogue.h"

namespace onepass::cli {

/// --json and --shard.
struct StudyOptions {
    std::string json;
    std::string shard = "1/1";
};
void add_study_options(CLI::App& command, StudyOptions& options);

/// Throws: Error for a name that is no scene's, before hours are spent on those before it.
void check_scene_names(std::span<const std::string> names);

/// Begins the study or takes it up, which it says. Makes the GL context if one of the tracers
/// needs it: the manifest names the device, which an unfinished file is compared by.
/// Throws: Error as Study, for a shard that is none, or a file that cannot be written.
Study open_study(Session& session, const StudyOptions& options, std::vector<std::string> keys,
                 std::span<const CatalogueEntry* const> tracers);

/// The key of one kind of rays, or of another work, in one scene.
std::string case_key(const std::string& scene, const std::string& kind);

/// The bar's part for the next point: those that are left have equal shares, so that the time left
/// is guessed from those done in this run.
Progress next_point(ProgressBar& bar, const Study& study);

/// Writes the study's results as they are at the end, as finish() does; they are `results`, with
/// what the command may have derived from all points.
void finish_study(Session& session, const Study& study, Results& results,
                  const StudyOptions& options);

}  // namespace onepass::cli
