// What `onepass reproduce` measures, step by step: one of the paper's scenes for its tables and
// figures, or one claim. Each fills Results and knows nothing of the other steps.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/cli/session.h"
#include "compare/experiments.h"
#include "compare/progress.h"

namespace onepass::cli {

/// How much work is spent on each step.
struct PaperEffort {
    TimingOptions timing{.repetitions = 21, .warm_up_rounds = 2, .warm_up_ms = 300.0, .seed = 0};
    uint32_t frames = 16;  ///< of an animation
    uint32_t grow = 1;     ///< multiplies the sides of the claims' images
    uint32_t shrink = 1;   ///< divides the sides of all images
};

/// For a quarter of an hour on two cores; a GPU gets images four times as wide, since it traces the
/// small ones in less time than a launch takes. `quick`: tiny images, to see that all steps run.
PaperEffort paper_effort(bool software_renderer, bool quick);

/// The tables' row and the figure of one scene: hits checked with their errors attributed, speed by
/// ray kind, frames, and pictures in `folder`/pictures (empty: none).
/// Returns false if `progress` asked for a stop. Throws: Error if the scene is not there.
bool measure_paper_scene(Session& session, const std::string& scene,
                         const std::vector<std::string>& entries, const PaperEffort& effort,
                         const std::filesystem::path& folder, const Progress& progress,
                         Results& results);

/// What claims are tested with. Besides SCENE as everywhere, "sphere-NxM" is a ball of N slices and
/// M stacks, 2 N (M - 1) triangles.
Workshop make_workshop(const Session& session, const PaperEffort& effort);

}  // namespace onepass::cli
