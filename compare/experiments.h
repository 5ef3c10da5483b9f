// Runs the experiments of a claim: makes both sides, checks their answers, times them in the same
// rounds, and reads the verdict.
//
// Knows tracers by the catalogue only. Where scenes, their oracle and judge, and their movements
// come from is the caller's business (Workshop), so that fakes can stand in for all of them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compare/claims.h"
#include "compare/progress.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/catalogue.h"
#include "core/judge.h"

namespace onepass {

/// Those who know the truth about a scene.
struct Referees {
    std::unique_ptr<Tracer> oracle;
    std::unique_ptr<Judge> judge;
};

/// What experiments are made with.
struct Workshop {
    const Catalogue* catalogue = nullptr;
    /// Throws: Error if there is no such scene.
    std::function<ScenePtr(const std::string& name, SceneForm form)> scene;
    std::function<Referees(const ScenePtr& scene)> referees;
    /// One list of transforms a frame, evenly through the animation.
    /// Throws: Error if nothing moves.
    std::function<std::vector<std::vector<Affine>>(const Scene& scene, uint32_t frames)> poses;
    TimingOptions timing;
    uint32_t frames = 16;  ///< of an animation
    uint32_t grow = 1;     ///< multiplies the sides of images that are not fixed
    uint32_t shrink = 1;   ///< divides the sides of all images, down to kLeastSide
};

inline constexpr uint32_t kLeastSide = 16;

/// Pixels a side of the experiment's image in this workshop.
uint32_t image_side(const Workshop& workshop, const Experiment& experiment);

/// The setting as the page names it: "paper_claims/texture2d (top_loop=nested)".
std::string label_of(const Setting& setting);

/// The parameters that were given, as text: "address=half, density=2".
std::string params_text(const ParamValues& params);

/// Runs all experiments of a claim for one entry ("fragment", "compute"), and appends the claim's
/// record; timed animations, and frames that report costs, go to frame_timings as well.
///
/// What is missing (a scene, a tracer, a parameter) leaves its measurements `not_measured` with the
/// reason. Baseline, baseline again and all variants of an experiment take turns in random order.
/// Returns false, appending nothing, if `progress` asked for a stop.
bool run_claim(const Claim& claim, const std::string& entry, const Workshop& workshop,
               const Progress& progress, Results& results);

}  // namespace onepass
