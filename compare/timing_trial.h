// The timing put on trial: how often does it call equals different, and does it find a strategy
// that was slowed on purpose? Over real casts, comparison after comparison.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "compare/progress.h"
#include "compare/rays.h"
#include "compare/timing.h"
#include "compare/verdict.h"
#include "core/catalogue.h"
#include "core/tracer.h"

namespace onepass {

/// A tracer that does a twentieth more: of the rays it is given it casts every twentieth twice, in
/// the same batch. Its answers are the tracer's own. It is slower by a twentieth only where rays
/// are all that a cast costs: on a small batch the launch hides them.
inline constexpr size_t kRepeatEvery = 20;
std::unique_ptr<Tracer> slowed(std::unique_ptr<Tracer> tracer);

struct TimingTrialOptions {
    uint32_t comparisons = 100;
    TimingOptions timing;  ///< of each comparison; the seed of the first
};

/// How often each verdict came, by SpeedVerdict.
struct TimingTrial {
    uint32_t comparisons = 0;  ///< whole ones; fewer if stopped
    std::array<uint32_t, 4> of_equals{};
    std::array<uint32_t, 4> of_slowed{};
    std::vector<double> noise;         ///< of each comparison
    std::vector<double> equals_ratio;  ///< speed of the equal, of the slowed one, relative
    std::vector<double> slowed_ratio;
    uint64_t errors = 0;  ///< of the strategy on these rays; the caller's to fill

    uint32_t called_different() const;  ///< equals
    uint32_t found_slower() const;      ///< the slowed one
};

/// The bound on called_different() of 100 comparisons, and the least found_slower(): nine in ten.
inline constexpr double kMostCalledDifferent = 0.10;
inline constexpr double kLeastFoundSlower = 0.90;
bool passed(const TimingTrial& trial);

/// Each comparison times four contestants anew, warm-up included: the strategy, its rival,
/// an equal and a slowed one, all built apart. The verdicts are those of
/// `onepass bench`: equal and slowed against the strategy, by compare_speeds.
TimingTrial try_timing(const CatalogueEntry& entry, const ScenePtr& scene,
                       const ParamValues& params, const RaySet& rays,
                       const TimingTrialOptions& options, const Progress& progress = {});

}  // namespace onepass
