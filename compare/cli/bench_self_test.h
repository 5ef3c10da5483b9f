// onepass bench --self-test: the timing itself on trial.
#pragma once

#include <string>
#include <vector>

#include "compare/cli/options.h"
#include "compare/cli/session.h"
#include "compare/timing.h"

namespace onepass::cli {

/// What a self-test casts unless the user states other rays or rounds: short casts
/// and many of them, because what disturbs a machine then meets all of a round or none.
/// Of the strategies one whose cast takes as long as its rays do: where a launch costs more than a
/// few rays, a twentieth more of them is less than a twentieth slower.
inline constexpr char kSelfTestStrategy[] = "embree/robust/1thread";
inline constexpr char kSelfTestSize[] = "16x16";
inline constexpr uint32_t kSelfTestRounds = 501;

struct BenchSelfTestCommand {
    std::vector<std::string> scenes;
    StrategyOptions strategy;
    RayOptions rays;
    TimingOptions timing;
    uint32_t comparisons = 100;
};

/// Compares equals, and a strategy with itself slowed by 5 %, scene by scene and kind by kind;
/// prints how often each verdict came. The exit code is kFailed if the timing did not pass.
void bench_self_test(Session& session, const BenchSelfTestCommand& options);

}  // namespace onepass::cli
