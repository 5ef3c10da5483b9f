// What each step of a strategy is worth: the strategy as it is beside itself with one step taken
// out, in the same rounds.
//
// A step is a parameter or another storage; nothing here knows more of a tracer than names. The
// errors come from the caller, who has a judge.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/params.h"

namespace onepass {

/// A way to take one step out.
struct AblationStep {
    std::string without;    ///< the step, in words
    std::string storage{};  ///< another one; empty: the same
    ParamValues params{};
};

/// The steps of a strategy ("grid"), the one that should matter most first.
/// Throws: Error naming the strategies that have some for one that has none.
const std::vector<AblationStep>& ablation_steps(const std::string& strategy);

/// "grid/buffer/compute" by a step's storage: "grid/ssbo/compute".
std::string tracer_without(const std::string& tracer, const AblationStep& step);

/// Fills the records' ratios from their samples: `records` are of one scene and work, and the first
/// is the strategy as it is. By the device's timer if all that were timed have one. Those that
/// could not be made have no samples and stay as they are.
void compare_ablations(std::span<AblationRecord> records, uint64_t seed);

/// Its time a run, and millions of rays (pixels) a second: by the device's timer where there is
/// one. NaN without samples.
double median_ms(const AblationRecord& record);
double mrays_per_s(const AblationRecord& record);

}  // namespace onepass
