// What a ray hits, in double precision: fast, and off by no more than some roundings of 2^-53.
//
// The judge asks it about moved rays, of which there are many; the truth about the given ray itself
// is exact (exact_truth.h). Sees candidates only; knows nothing of answers or classes.
#pragma once

#include <optional>

#include "cpu_ref/candidates.h"
#include "cpu_ref/truth.h"

namespace onepass {

/// Positions nearer than this many roundings (of 2^-53) of the largest coordinate involved are one:
/// three times the longest chain of operations from corners to a crossing. A thousand million times
/// finer than float, so that no float error passes for a tie.
inline constexpr double kTieRoundings = 64.0;

/// Intersects in double: Woop, Benthin and Wald's watertight test (2013), inclusive at edges, both
/// sides. Rounding moves corners in the ray's projection but each shared corner alike, and the sign
/// of an edge function is never wrong, so that a closed mesh has no cracks at edges or corners.
///
/// A degenerate triangle (no area) and one seen exactly edge-on are never hit.
class DoubleTruth {
  public:
    explicit DoubleTruth(ScenePtr scene) : candidates_(std::move(scene)) {}

    const CandidateSearch& candidates() const { return candidates_; }
    const Scene& scene() const { return candidates_.scene(); }

    /// The truth about a traceable ray; its reach is not used.
    Truth find(const SpreadRay& ray) const;

    /// Where the ray's line crosses the triangle, whatever the interval.
    std::optional<Crossing> crossing(const SpreadRay& ray, uint32_t inst_id,
                                     uint32_t prim_id) const;

    WorldTriangle triangle(uint32_t inst_id, uint32_t prim_id) const;

  private:
    /// kTieRoundings at this ray, in scene units.
    double position_tolerance(const SpreadRay& ray) const;
    bool is_degenerate(uint32_t inst_id, uint32_t prim_id) const;

    CandidateSearch candidates_;
};

}  // namespace onepass
