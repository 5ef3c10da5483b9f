// `auto`: sizes of grids from counts alone. No ray is timed, so that the same scene gets the same
// sizes on a busy machine and on an idle one.
//
// A tracer that counts (the strategy's twin, on the CPU) is built at a ladder of densities and
// casts a small sample of rays; known costs (cost_model.h) turn cells and tests into time. Where a
// scene has several objects, each ray's walk says whose cells and tests they were: what one object
// costs at a density does not depend on the sizes of the others, so one ladder serves all objects
// at once, and each takes the rung that is best for it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/cost_model.h"
#include "compare/rays.h"
#include "compare/sweep.h"
#include "core/catalogue.h"

namespace onepass {

/// Rays of a sample, at most.
inline constexpr size_t kSampleRays = 4096;

/// Every n-th ray, so that no more than `most` are left, evenly from all of the set.
std::vector<Ray> sample_of(std::span<const Ray> rays, size_t most);

/// What a sample's rays did at one density.
struct CountedSize {
    double density = 0.0;
    double cells = 0.0;                  ///< a ray, both levels
    double tests = 0.0;                  ///< a ray
    std::vector<double> object_cells{};  ///< by object, a ray of the whole sample; empty for one
    std::vector<double> object_tests{};
    std::vector<size_t> object_rays{};  ///< rays that walked in the object's grids
};

struct AutoSizing {
    GridSize size;                     ///< `sizes` set where the objects differ
    double predicted_ns = 0.0;         ///< a ray
    double choice_ms = 0.0;            ///< wall time of choosing
    std::vector<CountedSize> counted;  ///< the ladder, coarse to fine
};

/// An object that fewer rays of the sample walked in takes the density that suits the whole scene.
inline constexpr size_t kLeastRaysOfObject = 64;

/// The ladder goes on to finer grids until the predicted time has risen by this much above the
/// least (or the grids would exceed kMostSearchedCells, or the strategy refuses).
inline constexpr double kRisenEnough = 0.25;

/// Chooses each object's density. The top level keeps the strategy's own, or that of `params`:
/// what a coarse one costs is rays taken into instances that they miss, and the costs are of cells
/// and tests alone (on palace, by cells and tests, the slowest of three top densities is the best).
///
/// Of several sizes, the coarsest within kWorthwhile of the least predicted time.
/// `counter`: makes tracers that count, and walk if the scene has several objects.
/// Cost: some ten builds of the structure, and a sample cast in each.
/// Throws: Error if the counter does not count, or refuses every size.
AutoSizing choose_sizes(const CatalogueEntry& counter, const ScenePtr& scene,
                        const ParamValues& params, std::span<const Ray> sample,
                        const CostModel& costs);

/// Who counts for a strategy: its twin of 32 bits in the same storage; null if it has none.
const CatalogueEntry* counter_of(const Catalogue& catalogue, const TracerInfo& info);

}  // namespace onepass
