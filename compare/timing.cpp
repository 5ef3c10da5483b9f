#include "compare/timing.h"

#include <chrono>
#include <cmath>
#include <numeric>

#include "compare/statistics.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

struct Contestant {
    Tracer* tracer = nullptr;
    RayBatch batch;
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

}  // namespace

void check_repetitions(const TimingOptions& options) {
    if (options.repetitions >= kLeastRepetitions) return;
    throw Error({"--repetitions", std::to_string(options.repetitions),
                 "at least " + std::to_string(kLeastRepetitions),
                 "Fewer rounds give no interval to trust."});
}

std::vector<TimingRecord> time_casts(std::span<Tracer* const> tracers, size_t oracle,
                                     const RaySet& rays, const TimingOptions& options,
                                     const Progress& progress) {
    check_repetitions(options);
    ONEPASS_CHECK_LT(oracle, tracers.size());

    // Upload, once.
    std::vector<Contestant> contestants;
    for (Tracer* tracer : tracers)
        contestants.push_back({tracer, tracer->upload(rays.rays), {}, {}});
    const CastOptions cast_options{.query = rays.query, .counters = false};

    // Warm up.
    Random random(options.seed);
    const auto start = std::chrono::steady_clock::now();
    for (uint32_t round = 0;
         round < options.warm_up_rounds || milliseconds_since(start) < options.warm_up_ms;
         ++round) {
        play_round(contestants.size(), random, [&](size_t i) {
            contestants[i].tracer->cast(contestants[i].batch, cast_options);
        });
        if (!go_on(progress, 0.0)) break;
    }

    // Measure.
    for (uint32_t round = 0; round < options.repetitions; ++round) {
        if (!go_on(progress, double{1.0} * round / options.repetitions)) break;
        play_round(contestants.size(), random, [&](size_t i) {
            Contestant& contestant = contestants[i];
            const CastResult cast = contestant.tracer->cast(contestant.batch, cast_options);
            contestant.wall_ms.push_back(cast.wall_ms);
            if (!std::isnan(cast.device_ms)) contestant.device_ms.push_back(cast.device_ms);
        });
    }

    // Sum up.
    std::vector<TimingRecord> records;
    for (const Contestant& contestant : contestants) {
        TimingRecord& record = records.emplace_back();
        record.rays = rays.name;
        record.ray_count = rays.rays.size();
        record.tracer = contestant.tracer->name();
        record.oracle = tracers[oracle]->name();
        record.wall_ms = contestant.wall_ms;
        record.device_ms = contestant.device_ms;
        record.oracle_wall_ms = contestants[oracle].wall_ms;
        summarise(record, options.seed);
    }
    return records;
}

void summarise(TimingRecord& record, uint64_t seed) {
    record.median_ms = median(record.wall_ms);
    record.mrays_per_s = static_cast<double>(record.ray_count) / (1e3 * record.median_ms);
    const RatioInterval interval = ratio_of_medians(record.oracle_wall_ms, record.wall_ms, seed);
    record.ratio = interval.ratio;
    record.ratio_low = interval.low;
    record.ratio_high = interval.high;
}

}  // namespace onepass
