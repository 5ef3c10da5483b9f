// Timed casts: all tracers of one comparison interleaved in random order, round by round.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compare/progress.h"
#include "compare/rays.h"
#include "compare/results.h"
#include "core/tracer.h"

namespace onepass {

/// Below this, a bootstrap interval says little.
inline constexpr uint32_t kLeastRepetitions = 9;

struct TimingOptions {
    uint32_t repetitions = 11;    ///< counted rounds; at least kLeastRepetitions
    uint32_t warm_up_rounds = 2;  ///< uncounted rounds, at least
    double warm_up_ms = 500.0;    ///< and until this much time has passed: idle chips clock low
    uint64_t seed = 0;            ///< of the order and of the bootstrap
};

/// Throws: Error for fewer than kLeastRepetitions.
void check_repetitions(const TimingOptions& options);

/// Casts the rays with every tracer once a round, in an order drawn anew for each round.
///
/// Records come in the order of `tracers`; the ratio is to `tracers[oracle]`, paired by round.
/// Names of scene and errors are the caller's. Stopped early, the records hold the whole rounds so
/// far. Throws: Error for fewer than kLeastRepetitions; what the tracers' upload throws.
std::vector<TimingRecord> time_casts(std::span<Tracer* const> tracers, size_t oracle,
                                     const RaySet& rays, const TimingOptions& options,
                                     const Progress& progress = {});

/// Fills a record's figures (median, rate, ratio) from its samples and the oracle's.
void summarise(TimingRecord& record, uint64_t seed);

}  // namespace onepass
