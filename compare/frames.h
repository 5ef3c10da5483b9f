// Frames of an animation: when each one is, what its file is called, and how long it took.
//
// Knows tracers by what they return; the loop over frames is the command line's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/tracer.h"

namespace onepass {

/// Frames `first` to `last`, both included.
struct FrameRange {
    uint32_t first = 0;
    uint32_t last = 0;

    uint64_t count() const { return uint64_t{last} - first + 1; }
    bool operator==(const FrameRange&) const = default;
};

/// "0..47", or "7" for one frame. Throws: Error for another form, or a range that runs backwards.
FrameRange parse_frames(const std::string& text);

/// When frame k is, s: k / frames_per_s, modulo the duration where that is over 0. The frame that
/// falls on the end of the loop is the one at its start.
double frame_time(uint32_t frame, double frames_per_s, double duration_s);

/// "balls-1, frame 7": the name under which a frame's records stand, since it is another scene.
std::string frame_name(const std::string& scene, uint32_t frame);

/// A file name with a place for the frame's number: "picture.%04d.png".
///
/// Takes %d, and %0Nd with N from 1 to 9, once, in the name itself and not in its folder.
/// Throws: Error for another pattern.
class FramePattern {
  public:
    explicit FramePattern(const std::string& text);
    std::string file(uint32_t frame) const;

  private:
    std::string before_;
    std::string after_;
    int digits_ = 0;  ///< at least; 0: as many as the number has
};

/// The times of one tracer's frames, in the order in which they were rendered.
struct TimedFrames {
    std::string tracer;
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> update_ms;
    std::vector<double> upload_ms;
    std::vector<double> wall_ms;
    std::vector<double> device_ms;  ///< of the frames whose device had a timer
    uint64_t rays = 0;              ///< of all frames, by the tracer's own count; 0: not counted
    std::vector<Stat> costs;        ///< of the last frame

    void add(const UpdateTimes& times, const Frame& frame);
};

/// The record of a tracer's frames; the ratio is to `oracle`, paired frame by frame, and NaN
/// without one (no frames). Scene and pixel counts are the caller's.
FrameTimingRecord timing_record(const TimedFrames& frames, const TimedFrames& oracle,
                                uint64_t seed);

}  // namespace onepass
