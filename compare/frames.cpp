#include "compare/frames.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "compare/frame_timing.h"
#include "core/error.h"

namespace onepass {
namespace {

/// Decimal digits alone; false for anything else, and for what does not fit.
bool read_number(const std::string& text, uint32_t& number) {
    const char* end = text.data() + text.size();
    const auto [stopped, failure] = std::from_chars(text.data(), end, number);
    return failure == std::errc{} && stopped == end;
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
    const size_t dots = text.find("..");
    const std::string first = text.substr(0, dots);
    const std::string last = dots == std::string::npos ? first : text.substr(dots + 2);
    FrameRange range;
    if (read_number(first, range.first) && read_number(last, range.last) &&
        range.first <= range.last) {
        return range;
    }
    throw Error({"--frames", "'" + text + "'", "A..B, with 0 <= A <= B",
                 "Write, for instance, --frames 0..47."});
}

double frame_time(uint32_t frame, double frames_per_s, double duration_s) {
    const double time = frame / frames_per_s;
    return duration_s > 0.0 ? std::fmod(time, duration_s) : time;
}

std::string frame_name(const std::string& scene, uint32_t frame) {
    return fmt::format("{}, frame {}", scene, frame);
}

FramePattern::FramePattern(const std::string& text) {
    const auto refuse = [&](const std::string& got) {
        throw Error({"-o " + text, got, "one %d or %04d in the file's name",
                     "Write, for instance, -o frame.%04d.png."});
    };
    const size_t percent = text.find('%');
    if (percent == std::string::npos) refuse("no place for the frame's number");
    if (text.find('%', percent + 1) != std::string::npos) refuse("more than one %");
    if (text.find('/', percent) != std::string::npos) refuse("a frame's number in the folder");

    // %d, or %0Nd.
    const std::string rest = text.substr(percent + 1);
    const bool padded = rest.size() >= 3 && rest[0] == '0' && rest[1] >= '1' && rest[1] <= '9';
    const size_t letter = padded ? 2 : 0;
    if (letter >= rest.size() || rest[letter] != 'd') refuse("'%" + rest.substr(0, 3) + "'");
    before_ = text.substr(0, percent);
    after_ = rest.substr(letter + 1);
    digits_ = padded ? rest[1] - '0' : 0;
}

std::string FramePattern::file(uint32_t frame) const {
    return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

void TimedFrames::add(const UpdateTimes& times, const Frame& frame) {
    width = frame.width;
    height = frame.height;
    update_ms.push_back(times.update_ms);
    upload_ms.push_back(times.upload_ms);
    wall_ms.push_back(frame.wall_ms);
    if (!std::isnan(frame.device_ms)) device_ms.push_back(frame.device_ms);
    for (const RayCounters& counters : frame.counters) rays += counters.rays;
    costs = frame.costs;
}

FrameTimingRecord timing_record(const TimedFrames& frames, const TimedFrames& oracle,
                                uint64_t seed) {
    FrameTimingRecord record;
    record.tracer = frames.tracer;
    record.oracle = oracle.tracer;
    record.width = frames.width;
    record.height = frames.height;
    record.frames = static_cast<uint32_t>(frames.wall_ms.size());
    record.primary_rays = uint64_t{frames.width} * frames.height;
    if (record.frames > 0) {
        const uint64_t rays = frames.rays / record.frames;
        record.secondary_rays = rays > record.primary_rays ? rays - record.primary_rays : 0;
    }
    record.wall_ms = frames.wall_ms;
    record.device_ms = frames.device_ms;
    record.update_ms = frames.update_ms;
    record.upload_ms = frames.upload_ms;
    record.oracle_wall_ms = oracle.wall_ms;
    record.costs = frames.costs;

    summarise(record, seed);
    return record;
}

}  // namespace onepass
