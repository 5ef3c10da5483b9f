// Time to image: a tracer's first image costs its build and then k rays, a straight line in k.
// Where two lines cross, the one that builds longer has caught up.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compare/results.h"
#include "compare/statistics.h"
#include "core/catalogue.h"
#include "core/tracer.h"

namespace onepass {

/// Builds are repeated until this much time has gone (setting up the tracer included) or this many
/// are done, at least one.
inline constexpr double kBuildsMs = 1000.0;
inline constexpr uint32_t kMostBuilds = 5;

/// The last of several builds, and how long each took: structure and packing, wall time.
struct BuiltTracer {
    std::unique_ptr<Tracer> tracer;
    std::vector<double> build_ms;
};
/// Throws: Error as the entry's make.
BuiltTracer build_repeatedly(const CatalogueEntry& entry, const ScenePtr& scene,
                             const ParamValues& params);

/// One tracer's line: median build + k * median cast / rays. By wall time: that is what is waited.
struct ImageLine {
    const TimingRecord* timing = nullptr;
    const BuildRecord* build = nullptr;
};

/// Its two coefficients.
double build_ms(const ImageLine& line);
double ms_per_mray(const ImageLine& line);

/// From how many rays on `later`, whose build takes longer, has its image first.
///
/// 0: from the start (its build is no longer); infinity: never (its rays are no faster).
struct Crossing {
    double rays = 0.0;
    double low = 0.0;   ///< 95 % bootstrap interval: rounds drawn for both tracers alike, builds of
    double high = 0.0;  ///< each for themselves; it may reach infinity
};
Crossing crossing(const ImageLine& earlier, const ImageLine& later, uint64_t seed);

/// Who has the image first: the lower envelope of all lines, from the one with the least build on.
/// Each begins where it overtakes the one before; the first at 0.
struct FirstWithImage {
    size_t line = 0;  ///< into `lines`
    Crossing from;
};
std::vector<FirstWithImage> first_with_image(std::span<const ImageLine> lines, uint64_t seed);

/// The lines of one case: its timings with the builds of the same scene and tracer. A timing
/// without a build is left out.
std::vector<ImageLine> image_lines(std::span<const TimingRecord* const> timings,
                                   std::span<const BuildRecord> builds);

}  // namespace onepass
