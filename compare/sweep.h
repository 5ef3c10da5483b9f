// The grid-size study: one strategy at many densities, each checked, counted and timed.
#pragma once

#include <vector>

#include "compare/hits.h"
#include "compare/progress.h"
#include "compare/rays.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/catalogue.h"

namespace onepass {

/// The parameters by which a grid strategy takes its densities (cells per primitive).
inline constexpr char kObjectDensityParam[] = "density";
inline constexpr char kTopDensityParam[] = "top_density";

struct SweepOptions {
    std::vector<double> object_densities;  ///< cells a triangle
    std::vector<double> top_densities;     ///< cells an instance; empty: the strategy's default
    ParamValues params;                    ///< the strategy's other parameters
    HitCheckOptions check;
    TimingOptions timing;
};

/// True if the strategy takes a grid density.
bool has_grid_density(const TracerInfo& info);

/// One point a pair (top, object), top densities outermost.
///
/// Each point: build; one checked and counted cast (where the tracer counts); then timed rounds
/// against `oracle`. A size that the strategy refuses (texture limits) is a point with `failure`
/// set. Stopped early, the points so far.
/// Throws: Error if the strategy has no grid density.
std::vector<SweepPoint> sweep_grid_sizes(const CatalogueEntry& entry, const ScenePtr& scene,
                                         const RaySet& rays, Tracer& oracle, const Judge& judge,
                                         const SweepOptions& options,
                                         const Progress& progress = {});

/// The fastest point without a failure and with the fewest errors; null if there is none.
const SweepPoint* best_point(std::span<const SweepPoint> points);

}  // namespace onepass
