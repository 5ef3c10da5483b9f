#include "compare/timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "compare/statistics.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

struct Contestant {
    Tracer* tracer = nullptr;
    RayBatch batch;
    bool on_device = false;  ///< has a timer of its own
    double counted_ms = 0.0;
    std::vector<double> wall_ms;
    std::vector<double> device_ms;
};

/// Calls cast(i) for each contestant once, in random order.
template <class Cast>
void play_round(size_t count, Random& random, Cast&& cast) {
    std::vector<size_t> order(count);
    std::iota(order.begin(), order.end(), size_t{0});
    random.shuffle(std::span(order));
    for (const size_t i : order) cast(i);
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

/// One uncounted cast by each tracer with a device timer; the sum of their times.
double device_round_ms(std::span<const Contestant> contestants, const CastOptions& cast_options) {
    double sum = 0.0;
    for (const Contestant& contestant : contestants) {
        if (!contestant.on_device) continue;
        sum += contestant.tracer->cast(contestant.batch, cast_options).device_ms;
    }
    return sum;
}

/// Casts on the device until two paces, `apart_ms` one after the other, are alike.
void steady(std::span<const Contestant> contestants, const CastOptions& cast_options,
            const Steadiness& wanted, const Progress& progress, WarmUp& warm_up) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<double> rounds;
    double last_pace = std::numeric_limits<double>::quiet_NaN();
    double last_ms = 0.0;
    while (!warm_up.steady && milliseconds_since(start) < wanted.at_most_ms) {
        if (!go_on(progress, 0.0)) return;
        rounds.push_back(device_round_ms(contestants, cast_options));
        ++warm_up.rounds;
        const double now_ms = milliseconds_since(start);
        if (rounds.size() < wanted.rounds || now_ms - last_ms < wanted.apart_ms) continue;
        const double pace = median(std::span(rounds).last(wanted.rounds));
        warm_up.change = std::abs(pace / last_pace - 1.0);
        warm_up.steady = warm_up.change <= wanted.change;  // not with the first pace: that is NaN
        last_pace = pace;
        last_ms = now_ms;
        rounds.clear();
    }
}

WarmUp warm(std::span<const Contestant> contestants, const CastOptions& cast_options,
            const TimingOptions& options, Random& random, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    WarmUp warm_up;
    bool goes_on = true;
    while (goes_on && (warm_up.rounds < options.warm_up_rounds ||
                       milliseconds_since(start) < options.warm_up_ms)) {
        play_round(contestants.size(), random, [&](size_t i) {
            contestants[i].tracer->cast(contestants[i].batch, cast_options);
        });
        ++warm_up.rounds;
        goes_on = go_on(progress, 0.0);
    }
    const bool on_device = std::any_of(contestants.begin(), contestants.end(),
                                       [](const Contestant& c) { return c.on_device; });
    if (goes_on && on_device) {
        steady(contestants, cast_options, options.steadiness, progress, warm_up);
    }
    warm_up.ms = milliseconds_since(start);
    return warm_up;
}

}  // namespace

void check_repetitions(const TimingOptions& options) {
    if (options.repetitions >= kLeastRepetitions) return;
    throw Error({"--repetitions", std::to_string(options.repetitions),
                 "at least " + std::to_string(kLeastRepetitions),
                 "Fewer rounds give no interval to trust."});
}

std::vector<TimingRecord> time_casts(std::span<Tracer* const> tracers, size_t oracle,
                                     const RaySet& rays, const TimingOptions& options,
                                     const Progress& progress,
                                     const std::function<void(const WarmUp&)>& warmed) {
    check_repetitions(options);
    ONEPASS_CHECK_LT(oracle, tracers.size());
    if (options.rival) ONEPASS_CHECK_LT(options.rival->of, tracers.size());

    // Upload, once. A rival comes last.
    std::vector<Tracer*> taking_part(tracers.begin(), tracers.end());
    if (options.rival) taking_part.push_back(options.rival->tracer);
    std::vector<Contestant> contestants;
    for (Tracer* tracer : taking_part) {
        contestants.push_back({.tracer = tracer,
                               .batch = tracer->upload(rays.rays),
                               .on_device = tracer->capabilities().device_timer,
                               .counted_ms = 0.0,
                               .wall_ms = {},
                               .device_ms = {}});
    }
    const CastOptions cast_options{.query = rays.query, .counters = false, .answers = false};

    // Warm up.
    Random random(options.seed);
    const WarmUp warm_up = warm(contestants, cast_options, options, random, progress);
    if (warmed) warmed(warm_up);

    // Measure.
    for (uint32_t round = 0; round < options.repetitions; ++round) {
        if (!go_on(progress, double{1.0} * round / options.repetitions)) break;
        play_round(contestants.size(), random, [&](size_t i) {
            Contestant& contestant = contestants[i];
            const bool enough =
                round >= kLeastRepetitions && contestant.counted_ms >= options.enough_ms;
            if (enough && i != oracle) return;
            if (contestant.on_device) contestant.tracer->cast(contestant.batch, cast_options);
            const CastResult cast = contestant.tracer->cast(contestant.batch, cast_options);
            contestant.counted_ms += cast.wall_ms;
            contestant.wall_ms.push_back(cast.wall_ms);
            if (!std::isnan(cast.device_ms)) contestant.device_ms.push_back(cast.device_ms);
        });
    }

    // Sum up.
    std::vector<TimingRecord> records;
    for (size_t i = 0; i < tracers.size(); ++i) {
        const Contestant& contestant = contestants[i];
        TimingRecord& record = records.emplace_back();
        record.rays = rays.name;
        record.ray_count = rays.rays.size();
        record.tracer = contestant.tracer->name();
        record.oracle = tracers[oracle]->name();
        record.wall_ms = contestant.wall_ms;
        record.device_ms = contestant.device_ms;
        record.oracle_wall_ms = contestants[oracle].wall_ms;
        record.oracle_wall_ms.resize(record.wall_ms.size());  // who leaves early was there before
        summarise(record, options.seed);
    }
    if (options.rival) {
        TimingRecord& record = records[options.rival->of];
        record.again_wall_ms = std::move(contestants.back().wall_ms);
        record.again_device_ms = std::move(contestants.back().device_ms);
    }
    return records;
}

PacedTimings time_with_pace(std::span<Tracer* const> tracers, size_t oracle, const RaySet& rays,
                            const TimingOptions& options, const DeviceClocks& clocks,
                            const Progress& progress) {
    const auto read_clocks = [&] {
        return clocks.read ? clocks.read() : std::optional<ClockReading>();
    };
    PaceRecord pace;
    pace.rays = rays.name;
    pace.ray_count = rays.rays.size();
    pace.clocks_of = clocks.of;
    PacedTimings paced;
    paced.timings =
        time_casts(tracers, oracle, rays, options, progress, [&](const WarmUp& warm_up) {
            pace.warm_up_rounds = warm_up.rounds;
            pace.warm_up_ms = warm_up.ms;
            pace.change = warm_up.change;
            pace.steady = warm_up.steady;
            pace.before = read_clocks();
        });
    pace.after = read_clocks();
    const bool on_device = std::any_of(tracers.begin(), tracers.end(), [](const Tracer* tracer) {
        return tracer->capabilities().device_timer;
    });
    if (on_device) paced.pace = std::move(pace);
    return paced;
}

void summarise(TimingRecord& record, uint64_t seed) {
    record.median_ms = median(record.wall_ms);
    record.mrays_per_s = static_cast<double>(record.ray_count) / (1e3 * record.median_ms);
    const RatioInterval interval = ratio_of_medians(record.oracle_wall_ms, record.wall_ms, seed);
    record.ratio = interval.ratio;
    record.ratio_low = interval.low;
    record.ratio_high = interval.high;
}

DeviceSpeed device_speed(const TimingRecord& record, uint64_t seed) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const size_t rounds = record.device_ms.size();
    if (rounds != record.wall_ms.size() || rounds != record.oracle_wall_ms.size()) {
        return {kNone, kNone, {kNone, kNone, kNone}};
    }
    const double median_ms = median(record.device_ms);
    return {median_ms, static_cast<double>(record.ray_count) / (1e3 * median_ms),
            ratio_of_medians(record.oracle_wall_ms, record.device_ms, seed)};
}

}  // namespace onepass
