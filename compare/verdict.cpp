#include "compare/verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace onepass {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The rounds that both took part in: who left early was there before.
RatioInterval paired(std::span<const double> numerator, std::span<const double> denominator,
                     uint64_t seed) {
    const size_t rounds = std::min(numerator.size(), denominator.size());
    return median_of_ratios(numerator.first(rounds), denominator.first(rounds), seed);
}

SpeedComparison compared(const RatioInterval& speed, double noise, bool by_device) {
    return {speed, noise, speed_verdict(speed, noise), by_device};
}

}  // namespace

std::string_view to_string(SpeedVerdict verdict) {
    switch (verdict) {
        case SpeedVerdict::faster:
            return "faster";
        case SpeedVerdict::slower:
            return "slower";
        case SpeedVerdict::no_difference:
            return "no difference";
        case SpeedVerdict::unknown:
            break;
    }
    return "unknown";
}

double noise_of(const RatioInterval& of_equals) {
    if (std::isnan(of_equals.low) || std::isnan(of_equals.high)) return kUnknown;
    return std::max(std::abs(of_equals.low - 1.0), std::abs(of_equals.high - 1.0));
}

RatioInterval widened(const RatioInterval& interval, double noise) {
    const double factor = std::isnan(noise) ? 1.0 : 1.0 + noise;
    return {interval.ratio, interval.low / factor, interval.high * factor};
}

SpeedVerdict speed_verdict(const RatioInterval& speed, double noise) {
    const RatioInterval wide = widened(speed, noise);
    if (std::isnan(wide.low) || std::isnan(wide.high)) return SpeedVerdict::unknown;
    if (wide.low > 1.0) return SpeedVerdict::faster;
    if (wide.high < 1.0) return SpeedVerdict::slower;
    return SpeedVerdict::no_difference;
}

SpeedComparison compare_speeds(const TimingRecord& first, const TimingRecord& second, double noise,
                               uint64_t seed) {
    const bool by_device = !first.device_ms.empty() && !second.device_ms.empty();
    const auto& of_first = by_device ? first.device_ms : first.wall_ms;
    const auto& of_second = by_device ? second.device_ms : second.wall_ms;
    return compared(paired(of_second, of_first, seed), noise, by_device);
}

SpeedComparison compare_with_oracle(const TimingRecord& record, double noise, uint64_t seed) {
    return compared(paired(record.oracle_wall_ms, record.wall_ms, seed), noise, false);
}

double noise_of_case(std::span<const TimingRecord* const> records, bool by_device, uint64_t seed) {
    double noise = kUnknown;
    for (const TimingRecord* record : records) {
        if (record->again_wall_ms.empty()) continue;
        const bool device = by_device && !record->again_device_ms.empty();
        const RatioInterval again = device
                                        ? paired(record->again_device_ms, record->device_ms, seed)
                                        : paired(record->again_wall_ms, record->wall_ms, seed);
        noise = std::fmax(noise, noise_of(again));  // NaN gives way
    }
    return noise;
}

const TimingRecord* baseline_of(std::span<const TimingRecord* const> records) {
    const auto found = std::find_if(records.begin(), records.end(), [](const TimingRecord* record) {
        return !record->again_wall_ms.empty();
    });
    return found == records.end() ? nullptr : *found;
}

}  // namespace onepass
