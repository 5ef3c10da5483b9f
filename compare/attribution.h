// Error attribution: which of a strategy's declared deviations each wrong ray comes from.
//
// Takes up where compare_hits() ends. Only the wrong rays are cast again, each time with one
// deviation switched off; the judge alone says whether the answer is then right. Guesses nothing: a
// ray that no single switch mends stays unattributed, and is shown.
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

/// A deviation, and the strategy's answers without it.
struct Suspect {
    std::string id;
    std::function<CastResult(std::span<const Ray>, Query)> cast_without;
};

/// One suspect for each deviation of the tracer that `params` leave on, in declared order. A tracer
/// is made for each call of cast_without, and not kept.
std::vector<Suspect> suspects_of(const CatalogueEntry& tracer, const ScenePtr& scene,
                                 const ParamValues& params);

struct Attribution {
    CheckRecord::Attribution record;
    std::vector<std::string> culprits;  ///< one a wrong ray: a suspect's id; empty: none of them
    std::optional<WorstRay> worst_unattributed;
};

/// Attributes each wrong ray to the first suspect without which its class is no error any more.
///
/// `wrong`: HitComparison::wrong, of any number of rays.
/// Cost: a cast and a judgement for each suspect and wrong ray that no earlier suspect explains.
Attribution attribute_errors(std::span<const WorstRay> wrong, Query query, const Judge& judge,
                             std::span<const Suspect> suspects);

}  // namespace onepass
