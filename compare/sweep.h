// The grid-size study: one strategy at many sizes, each checked, counted and timed.
//
// Sizes are either listed by the caller, each a point of its own, or searched for: in wide steps
// of density, then between the best and its neighbours, and at last measured all in the same
// rounds.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "compare/hits.h"
#include "compare/progress.h"
#include "compare/rays.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/catalogue.h"

namespace onepass {

/// The parameters by which a grid strategy takes its sizes.
inline constexpr char kObjectDensityParam[] = "density";   ///< cells a triangle
inline constexpr char kTopDensityParam[] = "top_density";  ///< cells an instance
inline constexpr char kResolutionParam[] = "resolution";   ///< of every object grid
inline constexpr char kTopResolutionParam[] = "top_resolution";
inline constexpr char kObjectSizesParam[] = "sizes";  ///< one an object

/// One size of a strategy's grids.
struct GridSize {
    double top_density = 0.0;
    double object_density = 0.0;
    std::string resolution{};  ///< as SweepPoint
    std::string sizes{};       ///< as SweepPoint
    std::string chosen{};      ///< as SweepPoint

    bool operator==(const GridSize&) const = default;
};

struct SweepOptions {
    std::vector<double> object_densities;  ///< cells a triangle; where neither they nor resolutions
                                           ///< are listed, the strategy's own
    std::vector<double> top_densities;     ///< cells an instance; empty: the strategy's own
    std::vector<std::string> resolutions;  ///< "64x32x32", beside the densities
    ParamValues params;                    ///< the strategy's other parameters
    HitCheckOptions check;
    TimingOptions timing;
};

/// True if the strategy takes a grid density.
bool has_grid_density(const TracerInfo& info);

/// True if the strategy has a parameter of this name.
bool has_param(const TracerInfo& info, const std::string& name);

/// `params` with those that ask for this size. Throws: Error if the strategy has none for it.
ParamValues sized_params(const TracerInfo& info, ParamValues params, const GridSize& size);

/// The size that a point was measured at.
GridSize size_of(const SweepPoint& point);

/// What a strategy has where nothing is said: its default densities, and those that `params` set.
GridSize default_size(const TracerInfo& info, const ParamValues& params);

/// The sizes that the options list: a pair (top, object) each, top densities outermost, and after
/// the densities the resolutions. Throws: Error if the strategy has no grid density, or no
/// resolution where one is asked for.
std::vector<GridSize> listed_sizes(const TracerInfo& info, const SweepOptions& options);

/// Everything that a size is measured on.
struct SweepCase {
    const CatalogueEntry& entry;
    const ScenePtr& scene;
    const RaySet& rays;
    Tracer& oracle;
    const Judge& judge;
    const CastResult& truth;  ///< the oracle's answers to the rays
};

/// One point a size, in their order: build; one checked and counted cast (where the tracer
/// counts); then timed rounds of all sizes and the oracle together, in random order.
///
/// A size that the strategy refuses (texture limits) is a point with `failure` set. Stopped before
/// the first round: no points. Cost: all sizes are in memory at once.
std::vector<SweepPoint> measure_together(const SweepCase& sweep, std::span<const GridSize> sizes,
                                         const SweepOptions& options,
                                         const Progress& progress = {});

/// The listed sizes, each measured by itself beside the oracle. `is_done`: sizes to leave out;
/// `finished` is called after each point. Stopped early, the points so far.
/// Throws: as listed_sizes.
struct SweepHooks {
    std::function<bool(const GridSize&)> is_done;
    std::function<void(const SweepPoint&)> finished;
};
std::vector<SweepPoint> sweep_grid_sizes(const CatalogueEntry& entry, const ScenePtr& scene,
                                         const RaySet& rays, Tracer& oracle, const Judge& judge,
                                         const SweepOptions& options, const Progress& progress = {},
                                         const SweepHooks& hooks = {});

// ---- The search ------------------------------------------------------------------------------

/// A density that was tried, and the time there; NaN: refused.
struct TriedDensity {
    double density = 0.0;
    double ns = 0.0;
};

/// Where a search begins, how far it goes, and when it is fine enough.
struct DensitySearch {
    std::vector<double> coarse = {0.5, 2.0, 8.0, 32.0, 128.0};
    double step = 4.0;    ///< beyond an end that was best
    double finest = 1.5;  ///< neighbours of the best nearer than this ratio: done
    double lowest = 1.0 / 64.0;
    double highest = 1024.0;
};

/// The densities to try next; empty: done. First the coarse ones; while the best is at an end, one
/// step beyond it; then the geometric means between the best and its neighbours.
std::vector<double> next_densities(std::span<const TriedDensity> tried,
                                   const DensitySearch& search);

/// A search builds no grids with more cells in all than this: their begins take 256 MiB.
inline constexpr double kMostSearchedCells = 0x1p26;

/// The highest density whose object grids together stay within kMostSearchedCells.
double highest_density(const Scene& scene);

/// Searches the density of the objects at the strategy's top density, then, where there are
/// several instances and a top density, that of the top level at the best object density.
///
/// The points rest on few rounds: they say where to look, and their sizes are to be measured again,
/// together. Each size stands once, in the order in which it was tried.
std::vector<SweepPoint> search_sizes(const SweepCase& sweep, const SweepOptions& options,
                                     const Progress& progress = {});

/// The fastest point without a failure and with the fewest errors; null if there is none.
const SweepPoint* best_point(std::span<const SweepPoint> points);

}  // namespace onepass
