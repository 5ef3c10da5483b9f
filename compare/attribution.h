// Error attribution: which of a strategy's declared deviations each wrong ray comes from.
//
// Takes up where compare_hits() ends. Only the wrong rays are cast again, each time with one
// deviation switched off, and what no single switch mends with two of them; the judge alone says
// whether the answer is then right. Guesses nothing: a ray that is still wrong stays unattributed,
// and is shown.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/hits.h"
#include "compare/results.h"
#include "core/catalogue.h"
#include "core/judge.h"

namespace onepass {

/// The deviations of one strategy that are on, and its answers without some of them.
struct Suspects {
    std::vector<Deviation> deviations;  ///< in the order in which they are accused

    /// Casts with the deviations at these places switched off, all else as it was.
    std::function<CastResult(std::span<const size_t> off, std::span<const Ray>, Query)>
        cast_without;
};

/// The deviations that `params` leave on, in declared order. A tracer is made for each call of
/// cast_without, and not kept.
Suspects suspects_of(const CatalogueEntry& tracer, const ScenePtr& scene,
                     const ParamValues& params);

/// What it takes to mend a ray: one deviation off, or two where two faults meet on one ray.
struct Culprit {
    std::vector<Deviation> off;  ///< empty: nothing that was tried mends it

    std::string id() const;  ///< "D11"; of two "D11+D10"

    bool operator==(const Culprit&) const = default;
};

struct Attribution {
    CheckRecord::Attribution record;  ///< every single deviation, then the pairs that mend a ray
    std::vector<Culprit> culprits;    ///< one a wrong ray
    std::optional<WorstRay> worst_unattributed;
};

/// Attributes each wrong ray to the first deviation without which its class is no error any more;
/// where none is enough alone, to the first two.
///
/// `wrong`: HitComparison::wrong, of any number of rays.
/// Cost: a cast and a judgement for each deviation, and then each pair, and each wrong ray that is
/// not explained before.
Attribution attribute_errors(std::span<const WorstRay> wrong, Query query, const Judge& judge,
                             const Suspects& suspects);

}  // namespace onepass
