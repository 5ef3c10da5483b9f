// How cost grows: one shape in ever more triangles, and ever more rays into one of them; building
// and tracing apart.
//
// Knows tracers by the catalogue only; scene, oracle and judge are the caller's. The exponents are
// fitted here, the report draws them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compare/results.h"
#include "compare/statistics.h"
#include "compare/stress.h"
#include "compare/timing.h"

namespace onepass {

/// What every step is made with.
struct GrowthSetup {
    /// The first is the oracle that the answers are compared with.
    std::vector<Contestant> contestants;
    /// The shape in about so many triangles.
    std::function<ScenePtr(uint64_t triangles)> make_scene;
    std::function<std::unique_ptr<Judge>(ScenePtr)> make_judge;
    std::string shape;               ///< its name in the results
    std::vector<std::string> kinds;  ///< ray kinds (compare/rays.h)
    size_t judged = 4096;            ///< rays whose answers are judged, spread over all of a kind
    TimingOptions timing;
    double builds_ms = 2000.0;  ///< builds are repeated until this is used up, ...
    uint32_t most_builds = 9;   ///< ... at most so often, and once at least
    DeviceClocks clocks;
};

/// One size.
struct GrowthStep {
    uint64_t triangles = 0;
    uint64_t rays = 0;          ///< a square image of about so many pixels
    bool growing_rays = false;  ///< the builds are another step's: they are not recorded

    /// A name for files: "triangles-10000", "rays-65536".
    std::string id() const;
};

/// The steps of both growths: each count of triangles with `fixed_rays`, each count of rays in
/// `fixed_triangles`.
std::vector<GrowthStep> growth_steps(const std::vector<uint64_t>& triangles,
                                     const std::vector<uint64_t>& ray_counts, uint64_t fixed_rays,
                                     uint64_t fixed_triangles);

/// Builds with every contestant, casts every kind of ray, judges every answer of a sample.
///
/// A contestant that throws Error (not of the device) for the scene has a failure and no traces; a
/// tracer's own chunks keep rays within what its device holds. Stopped by `progress`, the result is
/// empty.
/// Throws: Error if the oracle cannot be built, or for a ray kind that is not there.
Results measure_growth(const GrowthSetup& setup, const GrowthStep& step,
                       const Progress& progress = {});

/// One curve: how a cost of one tracer grows.
struct GrowthCurve {
    enum class Cost { build_ms, bytes, trace_ms } cost = Cost::build_ms;
    bool over_rays = false;  ///< x counts rays, not triangles
    std::string tracer;
    std::string setting;
    std::string rays;        ///< the kind, of trace_ms
    bool by_device = false;  ///< the device's own time
    std::vector<double> x;
    std::vector<double> y;
    PowerLaw law;
};

/// What grows over what: "build time over triangles", "time over rays, random".
std::string cost_text(const GrowthCurve& curve);

/// All curves of a run with at least two points, in the order of first appearance: build times,
/// bytes, traces over triangles, traces over rays. Trace times are the device's where every point
/// has them. What the rays' growth holds fixed is the same along a curve.
std::vector<GrowthCurve> growth_curves(const Results& results);

}  // namespace onepass
