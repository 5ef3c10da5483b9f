// The trials of `onepass stress` on scenes of ours: this joins compare/trials.h and scenes/.
#pragma once

#include <vector>

#include "compare/stress.h"

namespace onepass::cli {

/// All trials, and the ladders of scenes/cases.h, in the order in which they are run.
std::vector<StressExperiment> stress_trials();

}  // namespace onepass::cli
