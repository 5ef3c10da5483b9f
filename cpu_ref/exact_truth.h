// What a ray hits, in exact real arithmetic on the numbers as given: the foundation of the judge.
//
// Inputs are dyadic (floats, or doubles of a moved ray), so every question here (is the point
// inside, which t is smaller) is the sign of a polynomial in them. Intervals of doubles answer
// nearly all; where they cannot, exact numbers do (dyadic.h). Nothing is ever decided by a
// tolerance. Sees candidates only; knows nothing of answers, classes or moved rays.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cpu_ref/candidates.h"
#include "cpu_ref/interval.h"
#include "cpu_ref/truth.h"

namespace onepass {

/// A triangle that a ray's line crosses, and where.
///
/// The rule for what counts as crossed. A triangle is closed: its edges and corners belong to it.
/// Both sides count. A line in the triangle's plane crosses it nowhere, and so nothing crosses a
/// triangle without area. Coincident triangles are all crossed, at equal t.
struct ExactHit {
    uint32_t inst_id = kNoId;
    uint32_t prim_id = kNoId;
    Interval t;                    ///< holds the real t
    double t_rounded = 0.0;        ///< the real t to within 2^-40 of itself
    bool at_interval_end = false;  ///< t is exactly tmin or tmax
};

/// A line and a triangle, all in exact numbers: for a reader, who has the time.
struct ExactDetail {
    bool crosses = false;
    bool on_edge = false;  ///< a barycentric coordinate is exactly 0
    bool close = false;    ///< intervals could not tell whether it crosses
    bool has_t = false;    ///< false: the line does not meet the plane in one point
    double t = 0.0;        ///< these three are rounded
    double u = 0.0;
    double v = 0.0;
    std::string t_digits;  ///< decimal, cut after kDetailDigits significant digits
};
inline constexpr int kDetailDigits = 30;

class ExactTruth {
  public:
    /// `candidates` must outlive this.
    explicit ExactTruth(const CandidateSearch& candidates) : candidates_(candidates) {}

    /// The truth about a traceable ray; its reach is not used. `optional` says that t is exactly
    /// tmin or tmax.
    /// Cost: some microseconds; about a millisecond where exact numbers have to decide.
    Truth find(const SpreadRay& ray) const;

    /// Every hit in [tmin, tmax], nearest first, those at equal t by ids.
    std::vector<ExactHit> find_all(const SpreadRay& ray) const;

    /// Where the ray's line crosses the triangle, whatever the interval.
    std::optional<ExactHit> crossing(const SpreadRay& ray, uint32_t inst_id,
                                     uint32_t prim_id) const;

    /// Cost: about a millisecond.
    ExactDetail detail(const SpreadRay& ray, uint32_t inst_id, uint32_t prim_id) const;

    /// The real t of b less that of a, rounded once.
    double distance(const SpreadRay& ray, const ExactHit& a, const ExactHit& b) const;

  private:
    const Scene& scene() const { return candidates_.scene(); }

    /// The hit if it lies in the ray's interval.
    std::optional<ExactHit> hit_in_interval(const SpreadRay& ray, uint32_t inst_id,
                                            uint32_t prim_id) const;

    /// -1, 0, 1 as the real t of a is less than, equal to or greater than that of b.
    int compare_t(const SpreadRay& ray, const ExactHit& a, const ExactHit& b) const;
    /// The same with a number.
    int compare_t(const SpreadRay& ray, const ExactHit& a, double b) const;

    const CandidateSearch& candidates_;
};

}  // namespace onepass
