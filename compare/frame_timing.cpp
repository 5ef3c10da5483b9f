#include "compare/frame_timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "compare/images.h"
#include "compare/statistics.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

uint64_t ray_count(const Frame& frame) {
    return std::accumulate(frame.counters.begin(), frame.counters.end(), uint64_t{0},
                           [](uint64_t sum, const RayCounters& c) { return sum + c.rays; });
}

/// Counts the rays of `frame`, the record's next one, and the pixels that differ from `truth`.
void look_at_frame(const Frame& frame, const Frame& truth, FrameTimingRecord& record) {
    const uint64_t pixels = uint64_t{frame.width} * frame.height;
    const uint64_t rays = ray_count(frame);
    record.primary_rays += pixels;
    record.secondary_rays += rays > pixels ? rays - pixels : 0;
    record.differing_pixels += compare_images(frame, truth).differing_pixels;
    record.compared_pixels += pixels;
}

/// All that one call of time_frames needs.
struct FrameRace {
    std::span<Tracer* const> tracers;
    const FrameRequest& request;
    std::vector<FrameTimingRecord> records;

    size_t frames() const { return std::max<size_t>(1, request.poses.size()); }

    UpdateTimes move(size_t tracer, size_t frame) const {
        if (request.poses.empty()) return {};
        return tracers[tracer]->update(request.poses[frame % frames()]);
    }

    Frame render(size_t tracer, bool aovs) const {
        RenderSettings settings = request.settings;
        settings.aovs = aovs;
        return tracers[tracer]->render(request.camera, settings);
    }

    void compare_frame(size_t oracle, size_t frame) {
        move(oracle, frame);
        const Frame truth = render(oracle, true);
        for (size_t i = 0; i < tracers.size(); ++i) {
            if (i != oracle) move(i, frame);
            look_at_frame(i == oracle ? truth : render(i, true), truth, records[i]);
        }
    }

    void play_round(size_t frame, Random& random, bool counted) {
        std::vector<size_t> order(tracers.size());
        std::iota(order.begin(), order.end(), size_t{0});
        random.shuffle(std::span(order));
        for (const size_t i : order) {
            const UpdateTimes times = move(i, frame);
            const Frame image = render(i, false);
            if (!counted) continue;
            FrameTimingRecord& record = records[i];
            record.wall_ms.push_back(image.wall_ms);
            if (!std::isnan(image.device_ms)) record.device_ms.push_back(image.device_ms);
            if (!request.poses.empty()) {
                record.update_ms.push_back(times.update_ms);
                record.upload_ms.push_back(times.upload_ms);
            }
            record.costs = image.costs;
        }
    }
};

}  // namespace

std::vector<FrameTimingRecord> time_frames(std::span<Tracer* const> tracers, size_t oracle,
                                           const FrameRequest& request,
                                           const TimingOptions& options, const Progress& progress) {
    check_repetitions(options);
    ONEPASS_CHECK_LT(oracle, tracers.size());
    FrameRace race{tracers, request, std::vector<FrameTimingRecord>(tracers.size())};
    const size_t frames = race.frames();
    const size_t rounds = (options.repetitions + frames - 1) / frames * frames;

    // Compare and count.
    for (size_t frame = 0; frame < frames; ++frame) {
        if (!go_on(progress, 0.0)) return race.records;
        race.compare_frame(oracle, frame);
    }

    // Warm up.
    Random random(options.seed);
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed_ms = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count();
    };
    for (uint32_t round = 0; round < options.warm_up_rounds || elapsed_ms() < options.warm_up_ms;
         ++round) {
        if (!go_on(progress, 0.0)) return race.records;
        race.play_round(round, random, false);
    }

    // Measure.
    for (size_t round = 0; round < rounds; ++round) {
        if (!go_on(progress, static_cast<double>(round) / static_cast<double>(rounds))) break;
        race.play_round(round, random, true);
    }

    // Sum up.
    for (size_t i = 0; i < tracers.size(); ++i) {
        FrameTimingRecord& record = race.records[i];
        record.tracer = tracers[i]->name();
        record.oracle = tracers[oracle]->name();
        record.width = request.settings.width;
        record.height = request.settings.height;
        record.frames = static_cast<uint32_t>(frames);
        record.primary_rays /= frames;
        record.secondary_rays /= frames;
        record.oracle_wall_ms = race.records[oracle].wall_ms;
        summarise(record, options.seed);
    }
    return race.records;
}

void summarise(FrameTimingRecord& record, uint64_t seed) {
    record.median_ms = median(record.wall_ms);
    record.frames_per_s = 1e3 / record.median_ms;
    const RatioInterval interval =
        record.oracle_wall_ms.empty()
            ? RatioInterval{std::nan(""), std::nan(""), std::nan("")}
            : ratio_of_medians(record.oracle_wall_ms, record.wall_ms, seed);
    record.ratio = interval.ratio;
    record.ratio_low = interval.low;
    record.ratio_high = interval.high;
}

}  // namespace onepass
