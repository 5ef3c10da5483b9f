// Timed casts: all tracers of one comparison interleaved in random order, round by round.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/progress.h"
#include "compare/rays.h"
#include "compare/results.h"
#include "compare/statistics.h"
#include "core/tracer.h"

namespace onepass {

/// Below this, a bootstrap interval says little.
inline constexpr uint32_t kLeastRepetitions = 9;

/// When a device's pace counts as steady. An idle chip clocks low, and takes its time to rise.
struct Steadiness {
    uint32_t rounds = 5;       ///< a pace is the median over this many
    double change = 0.01;      ///< two paces may differ by this share, ...
    double apart_ms = 500.0;   ///< ... taken at least this long one after the other
    double at_most_ms = 20e3;  ///< after this long, what it is has to do
};

/// One that should be as fast as `tracers[of]`, to the last cast: the same strategy, built apart.
/// Its samples become that record's again_*. The same tracer cast twice would not do: each cast
/// finds in the caches what the other left there, and both get faster than all others.
struct Rival {
    size_t of = 0;
    Tracer* tracer = nullptr;
};

struct TimingOptions {
    uint32_t repetitions = 11;    ///< counted rounds; at least kLeastRepetitions
    uint32_t warm_up_rounds = 2;  ///< uncounted rounds, at least
    double warm_up_ms = 500.0;    ///< and until this much time has passed
    uint64_t seed = 0;            ///< of the order and of the bootstrap
    /// A tracer whose counted casts have taken this long has had enough with kLeastRepetitions; the
    /// oracle takes part in every round.
    double enough_ms = std::numeric_limits<double>::infinity();
    Steadiness steadiness{};  ///< asked of tracers with a device timer
    std::optional<Rival> rival{};
};

/// Throws: Error for fewer than kLeastRepetitions.
void check_repetitions(const TimingOptions& options);

/// What the uncounted rounds came to.
struct WarmUp {
    uint32_t rounds = 0;
    double ms = 0.0;
    double change = std::numeric_limits<double>::quiet_NaN();  ///< of the last two paces, a share
    bool steady = false;  ///< false as well where no tracer has a device timer
};

/// Casts the rays with every tracer once a round, in an order drawn anew for each round.
///
/// Warm-up: whole rounds first; then, where tracers have a device timer, rounds of those alone
/// until their pace is steady. There, each counted cast follows an uncounted one by the same
/// tracer, so that neither clock nor caches remember how long the CPU's tracers took before it.
/// `warmed` is called once, between the warm-up and the first counted cast.
/// Records come in the order of `tracers`; the ratio is to `tracers[oracle]`, paired by round.
/// The rival takes its turn like any other.
/// Names of scene and errors are the caller's. Stopped early, the records hold the whole rounds so
/// far. Throws: Error for fewer than kLeastRepetitions; what the tracers' upload throws.
std::vector<TimingRecord> time_casts(std::span<Tracer* const> tracers, size_t oracle,
                                     const RaySet& rays, const TimingOptions& options,
                                     const Progress& progress = {},
                                     const std::function<void(const WarmUp&)>& warmed = {});

/// Where a device's clocks can be read; empty functions and texts where they cannot.
struct DeviceClocks {
    std::string of;  ///< PaceRecord::clocks_of
    std::function<std::optional<ClockReading>()> read;
};

/// time_casts, and the device's pace, its clocks read just before and after the counted casts.
struct PacedTimings {
    std::vector<TimingRecord> timings;
    std::optional<PaceRecord> pace;  ///< absent where no tracer has a device timer; its scene is
                                     ///< the caller's
};
PacedTimings time_with_pace(std::span<Tracer* const> tracers, size_t oracle, const RaySet& rays,
                            const TimingOptions& options, const DeviceClocks& clocks,
                            const Progress& progress = {});

/// Fills a record's figures (median, rate, ratio) from its samples and the oracle's.
void summarise(TimingRecord& record, uint64_t seed);

/// The same by the device's own timer, launch and transfers left out; the oracle's time is wall
/// time as before. All NaN where the device has no timer, or the rounds do not pair.
struct DeviceSpeed {
    double median_ms = 0.0;
    double mrays_per_s = 0.0;
    RatioInterval ratio;
};
DeviceSpeed device_speed(const TimingRecord& record, uint64_t seed);

}  // namespace onepass
