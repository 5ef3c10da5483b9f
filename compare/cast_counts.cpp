#include "compare/cast_counts.h"

#include <algorithm>
#include <set>
#include <utility>

namespace onepass {
namespace {

void follow_some(Tracer& tracer, const RaySet& rays, CastCounts& counts) {
    if (!tracer.capabilities().walks || rays.query != Query::closest) return;
    const size_t followed = std::min(kWalkedRays, rays.rays.size());
    for (size_t i = 0; i < followed; ++i) {
        const auto walk = tracer.walk(rays.rays[i * rays.rays.size() / followed]);
        if (!walk) continue;
        ++counts.walked_rays;
        for (const WalkStep& step : walk->steps) counts.walked_tests += step.tests.size();
        counts.repeated_tests += repeated_tests(*walk);
    }
}

}  // namespace

uint64_t repeated_tests(const RayWalk& walk) {
    std::set<std::pair<uint32_t, uint32_t>> seen;
    uint64_t repeated = 0;
    for (const WalkStep& step : walk.steps) {
        for (const WalkTest& test : step.tests) {
            repeated += seen.emplace(step.inst_id, test.prim_id).second ? 0 : 1;
        }
    }
    return repeated;
}

std::optional<CastCounts> count_cast(Tracer& tracer, const RaySet& rays) {
    if (!tracer.capabilities().counters) return std::nullopt;
    const CastResult cast =
        tracer.cast(tracer.upload(rays.rays), {.query = rays.query, .counters = true});
    CastCounts counts;
    for (const RayCounters& ray : cast.counters) {
        counts.cells += ray.cells;
        counts.tests += ray.tests;
        counts.references += ray.references;
    }
    follow_some(tracer, rays, counts);
    return counts;
}

}  // namespace onepass
