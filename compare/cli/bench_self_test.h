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
inline constexpr char kSelfTestSize[] = "64x64";
inline constexpr uint32_t kSelfTestRounds = 101;

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
