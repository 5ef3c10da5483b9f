// Two runs held against each other: of two commits, two machines, two settings.
//
// Times of two runs share no round, so they are never compared as such. What is compared is each
// tracer's speed relative to the oracle in its own run: what made the whole of one run slower is in
// both numbers and goes out. Counts are compared exactly.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "compare/results.h"
#include "compare/statistics.h"
#include "compare/verdict.h"

namespace onepass {

/// How one tracer's speed on one case changed from A to B.
struct SpeedChange {
    std::string scene;
    std::string rays;
    std::string tracer;
    std::string at{};         ///< of a sweep: the grid size; else empty
    RatioInterval before{};   ///< speed relative to the oracle in A
    RatioInterval after{};    ///< ... in B
    RatioInterval change{};   ///< after / before; above 1: B is faster
    double noise = 0.0;       ///< of both runs together; NaN where neither had a rival
    bool noise_known = true;  ///< both runs had one
    SpeedVerdict verdict = SpeedVerdict::unknown;  ///< of B, by speed_verdict
    uint64_t errors_before = 0;
    uint64_t errors_after = 0;
    bool by_device = false;  ///< the tracer's time is its device's own, in both runs
};

/// A count that should be the same in both runs and is not.
struct CountChange {
    std::string what;  ///< "bunny, primary, grid/buffer/compute: tests"
    double before = 0.0;
    double after = 0.0;
};

struct RunComparison {
    /// What makes the runs hard to compare: another machine, scene, set of rays, parameter.
    std::vector<std::string> warnings;
    std::vector<SpeedChange> speeds;
    std::vector<CountChange> counts;  ///< those that differ
    size_t equal_counts = 0;
    bool checks_have_more_errors = false;  ///< some check of B, than the same check of A
    std::vector<std::string> only_before;  ///< cases that one run alone holds
    std::vector<std::string> only_after;
};

/// Interval of the change: of a bench, 2000 times over, the rounds of A and, apart from them, those
/// of B are drawn with replacement, and the two medians of paired ratios divided. Of a sweep,
/// whose older records keep no samples of the oracle, from the two stored intervals: their half
/// widths as logarithms add as squares. The noise of both runs adds up: (1 + a) (1 + b) - 1.
/// Records of one scene, rays and tracer that a run holds more than once are compared in order.
RunComparison compare_runs(const Results& before, const Results& after, uint64_t seed = 0);

bool any_slower(const RunComparison& comparison);
/// Of what both runs hold: speeds and checks.
bool any_more_errors(const RunComparison& comparison);

}  // namespace onepass
