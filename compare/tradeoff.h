// Speed against accuracy: the same rays by every setting, in the same rounds, and every answer
// judged.
//
// Stands beside timing.h, which takes the times, and core/judge.h, which counts the errors; the
// report draws what is left here. No point has a speed without its errors.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compare/results.h"
#include "compare/timing.h"
#include "core/judge.h"
#include "core/params.h"

namespace onepass {

/// One tracer with parameters of its own.
struct TradeoffSetting {
    std::string tracer;  ///< strategy/storage/entry; an entry "*" is the one under test
    ParamValues params{};
};

/// What `onepass bench --settings` compares; the first is what every ratio is to. Embree fast and
/// robust; the paper's tracer with its slack and without, with each and with all of its behaviours
/// that cost accuracy switched off, with narrow addresses and geometry; the watertight grid; the
/// twins in float and in double; brute force.
const std::vector<TradeoffSetting>& tradeoff_settings();

/// Triangle tests of one cast, rays times triangles, up to which brute force is worth its time: a
/// software renderer on two cores needs less than a second for as many.
inline constexpr uint64_t kMostBruteForceTests = uint64_t{1} << 25;

/// Casts the rays with every tracer, judges every answer, then times the casts.
///
/// One truth a ray, shared by all tracers. Points come in the order of `tracers`; the ratio is to
/// `tracers[oracle]`; scene and setting are the caller's. Empty if stopped before its first round.
/// Throws: as time_casts.
std::vector<TradeoffPoint> measure_tradeoff(std::span<Tracer* const> tracers, size_t oracle,
                                            const RaySet& rays, const Judge& judge,
                                            const TimingOptions& options,
                                            const Progress& progress = {});

/// Errors a ray. NaN without rays.
double error_rate(const TradeoffPoint& point);

/// Whether each point is on the Pareto front: no other is at least as fast and at least as accurate
/// and better in one of the two. Equal points are on it together. A point without a ratio or an
/// error rate is not on it, and keeps none off it.
/// Cost: quadratic.
std::vector<bool> on_front(std::span<const TradeoffPoint> points);

/// One point for each tracer and setting over several cases, a case being a scene with a ray kind:
/// the geometric mean of the ratios, errors, edges and rays added up.
///
/// A setting that did not take part in every case is left out: its mean would be over easier or
/// harder work than the others'. The interval: the cases are measured apart, so the logarithmic
/// distances to the ends add up in squares, over the number of cases. Samples are not pooled; scene
/// and rays are kept where all cases share them and "" else. In the order of first appearance.
std::vector<TradeoffPoint> pool(std::span<const TradeoffPoint> points);

}  // namespace onepass
