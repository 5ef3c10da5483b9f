// Timed frames: whole images, still or animated, all tracers interleaved as in timing.h.
#pragma once

#include <span>
#include <vector>

#include "compare/progress.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/affine.h"
#include "core/tracer.h"

namespace onepass {

/// The frames to render.
struct FrameRequest {
    Camera camera;
    RenderSettings settings;  ///< `aovs` is ignored: timed frames have none, compared ones have
    /// Frame by frame, the transforms of all instances; empty: one still image.
    std::vector<std::vector<Affine>> poses;
};

/// Renders with every tracer once a round, in an order drawn anew for each round.
///
/// First every frame once, uncounted: its pixels are compared with the oracle's (compare_images)
/// and its rays are counted. Then warm-up, then at least `options.repetitions` rounds, whole
/// passes over the animation: round r is frame r modulo the frames, and each tracer moves its
/// instances before it renders. Records come in the order of `tracers`; the ratio is to
/// `tracers[oracle]`, paired by round; the name of the scene is the caller's. Stopped early, the
/// records hold the whole rounds so far.
/// Throws: Error as time_casts; what the tracers throw.
std::vector<FrameTimingRecord> time_frames(std::span<Tracer* const> tracers, size_t oracle,
                                           const FrameRequest& request,
                                           const TimingOptions& options,
                                           const Progress& progress = {});

/// Fills a record's figures (median, rate, ratio) from its samples and the oracle's; without any of
/// the oracle's the ratio is NaN.
void summarise(FrameTimingRecord& record, uint64_t seed);

}  // namespace onepass
