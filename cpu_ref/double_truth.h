// What a ray hits, in double precision: the arithmetic under the double judge.
//
// Sees candidates only; knows nothing of answers, classes or moved rays.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "cpu_ref/candidates.h"

namespace onepass {

/// A triangle's corners in the world. Equal corners of neighbours are equal in every bit.
using WorldTriangle = std::array<dvec3, 3>;

/// Where a ray's line crosses a triangle, as far as double can tell.
struct Crossing {
    double t = 0.0;
    double t_tolerance = 0.0;  ///< bound of the rounding in t; grows as the triangle turns edge-on
    bool touch = false;        ///< outside, but by less than rounding: may count or not
};

/// A triangle hit by a ray.
struct Surface {
    uint32_t inst_id = kNoId;
    uint32_t prim_id = kNoId;
    Crossing crossing;
    bool optional = false;  ///< a touch, or t equals tmin or tmax: may count or not
};

/// All that is right to answer to one ray.
struct Truth {
    /// Nearest at an inclusive interval, touches left out; of equal distances the lowest inst_id,
    /// then prim_id.
    std::optional<Surface> nearest;
    /// Every surface whose answer is right: `nearest`, those as near as it, and optional ones.
    std::vector<Surface> right;
    /// No surface lies inside the interval beyond doubt.
    bool miss_is_right = true;

    const Surface* find(uint32_t inst_id, uint32_t prim_id) const;
};

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
