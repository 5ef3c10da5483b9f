// onepass bench --ablate: what each step of a strategy is worth.
#pragma once

#include <string>
#include <vector>

#include "compare/cli/options.h"
#include "compare/cli/session.h"
#include "compare/cli/study_run.h"
#include "compare/timing.h"

namespace onepass::cli {

/// The work of an ablation unless the user states other kinds; "image" is the whole frame.
inline const std::vector<std::string> kAblationKinds = {"primary", "diffuse", "shadow", "image"};

struct BenchAblationCommand {
    std::vector<std::string> scenes;
    std::string strategy;  ///< strategy[/storage[/entry]]
    RayOptions rays;
    TimingOptions timing;
    StudyOptions study;
};

/// Times and judges the strategy as it is, twice, and without each of compare/ablation.h's steps.
void bench_ablation(Session& session, const BenchAblationCommand& options);

}  // namespace onepass::cli
