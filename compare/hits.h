// Hit comparison: one tracer's answers against the oracle's, ray by ray, by class.
//
// Stands between the casts and the results. Knows tracers only by their answers, and leaves every
// doubtful ray to the judge; decides nothing about geometry itself.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/judge.h"
#include "core/tracer.h"

namespace onepass {

/// The share of all rays that may be of class `edge`: 1 in 1000, at least one ray.
///
/// Reason: a ray is within E_ray of an edge when it passes it closer than about 2^-21 of the
/// scene's size (4 ulp in origin and direction each). N triangles spread evenly over the view have
/// edges of total length 2.3 sqrt(N) times its width, so about 4.4e-6 sqrt(N) of the rays are that
/// close: 1.2e-3 for the 70,000 triangles of the bunny, of which a sound tracer gets only a part
/// wrong. A tracer that spends more has a fault that E_ray happens to cover: one that computes t in
/// absolute coordinates, for instance, loses digits on every ray that starts close to what it hits.
inline constexpr double kEdgeShare = 1e-3;
uint64_t edge_budget(uint64_t ray_count);

struct HitCheckOptions {
    /// Bounds that replace the defaults: 0 for the error classes, edge_budget() for `edge`, none
    /// for `agree` and `tie`.
    std::map<HitClass, uint64_t> allowed{};

    /// The share of rays on which tracer and oracle agree that is judged nevertheless, drawn at
    /// random: the two could be wrong together.
    double agreement_sample = 0.01;
    uint64_t seed = 0;
};

struct HitComparison {
    CheckRecord record;  ///< all but the names of scene, rays, tracer and oracle
    std::vector<std::optional<HitClass>> classes;  ///< one a ray; none where the oracle is invalid
    std::vector<WorstRay> wrong;  ///< every ray of an error class, in the order of the rays
};

/// Whether the first verdict is the worse one: by backward error, then by t error; NaN, "no such
/// t", comes last.
bool is_worse(const Verdict& a, const Verdict& b);

/// Sorts every ray of every tracer into one class; one comparison for each of `answers`.
///
/// A ray that the oracle flags kFlagOracleInvalid is counted and falls into no class. Tracer and
/// oracle agree without a judge if both miss, or if both name the same triangle and their t differ
/// by at most kTUlps ulps of the oracle's. Rays on which any tracer disagrees, and a sample of the
/// others, go to the judge, which finds the truth once and classes all answers to the ray by it. So
/// two that are off alike count as `agree`, apart from the sample; the oracle's own classes show
/// how often that may be. The oracle's answers may be among `answers`: that is its own row. Cost:
/// parallel; a judgement a ray that is judged. The result does not depend on thread count.
std::vector<HitComparison> compare_hits(std::span<const Ray> rays, Query query,
                                        std::span<const CastResult> answers,
                                        const CastResult& oracle, const Judge& judge,
                                        const HitCheckOptions& options = {});

/// The same for one tracer.
HitComparison compare_hits(std::span<const Ray> rays, Query query, const CastResult& answers,
                           const CastResult& oracle, const Judge& judge,
                           const HitCheckOptions& options = {});

/// The judge's verdicts on several answers to one ray, in their order. Answers equal in every bit
/// are judged once: tracers mostly agree, and a search for a witness is dear.
std::vector<Verdict> judge_distinct(const Judge& judge, const Ray& ray, Query query,
                                    std::span<const Hit> answers);

/// Reads "CLASS=N", an argument of --allow. Throws: Error for another form or an unknown class.
std::pair<HitClass, uint64_t> parse_allowance(const std::string& text);

}  // namespace onepass
