#include "compare/cli/bench_tables.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "compare/cli/table.h"
#include "compare/manifest.h"
#include "compare/statistics.h"
#include "compare/time_to_image.h"
#include "compare/timing.h"
#include "compare/verdict.h"

namespace onepass::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;
using Records = std::vector<const TimingRecord*>;

constexpr uint64_t kBootstrapSeed = 0;  ///< every reader of the same samples gets the same figures

std::string interval_text(double low, double high) {
    return fmt::format("{:.3f}..{:.3f}", low, high);
}

std::string noise_text(double noise) {
    return std::isnan(noise) ? "not known: no rival" : fmt::format("{:.1f} %", 100.0 * noise);
}

std::string speed_table(const Records& records) {
    const TimingRecord& first = *records.front();
    const double noise = noise_of_case(records, false, kBootstrapSeed);
    std::string text =
        fmt::format("{}, {} rays: {} rays, {} rounds; ratio is speed relative to {}\n", first.scene,
                    first.rays, first.ray_count, first.wall_ms.size(), first.oracle);
    Rows rows = {{"tracer", "Mrays/s", "median ms", "quartiles ms", "ratio", "95 % interval",
                  "verdict", "device Mrays/s", "device ms", "device ratio", "95 % interval",
                  "rounds", "errors", "edge"}};
    for (const TimingRecord* record : records) {
        const DeviceSpeed device = device_speed(*record, kBootstrapSeed);
        const auto if_timed = [&](const std::string& figure) {
            return std::isnan(device.median_ms) ? "-" : figure;
        };
        const bool is_oracle = record->tracer == record->oracle;
        const SpeedComparison against = compare_with_oracle(*record, noise, kBootstrapSeed);
        rows.push_back({record->tracer, fmt::format("{:.3f}", record->mrays_per_s),
                        fmt::format("{:.2f}", record->median_ms),
                        fmt::format("{:.2f}..{:.2f}", quantile(record->wall_ms, 0.25),
                                    quantile(record->wall_ms, 0.75)),
                        fmt::format("{:.3f}", record->ratio),
                        interval_text(record->ratio_low, record->ratio_high),
                        is_oracle ? "-" : std::string(to_string(against.verdict)),
                        if_timed(fmt::format("{:.1f}", device.mrays_per_s)),
                        if_timed(fmt::format("{:.4f}", device.median_ms)),
                        if_timed(fmt::format("{:.3f}", device.ratio.ratio)),
                        if_timed(interval_text(device.ratio.low, device.ratio.high)),
                        std::to_string(record->wall_ms.size()), std::to_string(record->errors),
                        std::to_string(record->edges)});
    }
    return text + format_table(rows);
}

/// The tracers under test against the one that had a rival. Empty without a rival.
std::string pair_table(const Records& records) {
    const TimingRecord* baseline = baseline_of(records);
    if (!baseline) return "";
    const double wall_noise = noise_of_case(records, false, kBootstrapSeed);
    const double device_noise = noise_of_case(records, true, kBootstrapSeed);
    Rows rows = {
        {"against " + baseline->tracer, "speed", "95 % interval", "by", "verdict", "errors"}};
    for (const TimingRecord* record : records) {
        if (record == baseline) continue;
        SpeedComparison c = compare_speeds(*record, *baseline, wall_noise, kBootstrapSeed);
        if (c.by_device) c = compare_speeds(*record, *baseline, device_noise, kBootstrapSeed);
        rows.push_back({record->tracer, fmt::format("{:.3f}", c.speed.ratio),
                        interval_text(c.speed.low, c.speed.high), c.by_device ? "device" : "wall",
                        std::string(to_string(c.verdict)),
                        fmt::format("{} to {}", record->errors, baseline->errors)});
    }
    std::string noise = noise_text(wall_noise);
    if (!baseline->again_device_ms.empty()) {
        noise += fmt::format(" by wall time, {} by the device's", noise_text(device_noise));
    }
    return format_table(rows) +
           fmt::format(
               "  noise: {} ({} against an identical rival); verdicts are of the median of "
               "the rounds' ratios,\n  whose interval, widened by the noise, has to leave 1 "
               "out\n",
               noise, baseline->tracer);
}

std::string per_ray(uint64_t count, uint64_t rays) {
    return fmt::format("{:.2f}", static_cast<double>(count) / static_cast<double>(rays));
}

const TracerRecord* built(const Results& results, const TimingRecord& timing) {
    const auto found = std::find_if(
        results.tracers.begin(), results.tracers.end(), [&](const TracerRecord& tracer) {
            return tracer.scene == timing.scene && tracer.name == timing.tracer;
        });
    return found == results.tracers.end() ? nullptr : &*found;
}

std::string stat_text(const TracerRecord* tracer, const char* name) {
    if (!tracer) return "-";
    const double value = stat_value(tracer->stats, name);
    return value > 0.0 ? fmt::format("{:.0f}", value) : "-";
}

/// Counters of a cast and of the structure. Empty where no tracer counts.
std::string counter_table(const Results& results, const Records& records) {
    Rows rows = {{"counted in a pass of its own", "cells/ray", "tests/ray", "repeated tests",
                  "references/ray", "structure: cells", "references", "MiB"}};
    for (const TimingRecord* record : records) {
        if (!record->counts) continue;
        const CastCounts& c = *record->counts;
        const TracerRecord* tracer = built(results, *record);
        const double bytes = tracer ? stat_value(tracer->stats, "device_bytes") : 0.0;
        rows.push_back(
            {record->tracer, per_ray(c.cells, record->ray_count),
             per_ray(c.tests, record->ray_count),
             c.walked_tests == 0
                 ? "-"
                 : fmt::format("{:.1f} %", 100.0 * static_cast<double>(c.repeated_tests) /
                                               static_cast<double>(c.walked_tests)),
             per_ray(c.references, record->ray_count), stat_text(tracer, "cells"),
             stat_text(tracer, "references"), fmt::format("{:.1f}", bytes / 1048576.0)});
    }
    return rows.size() > 1 ? format_table(rows) : "";
}

std::string rays_text(double rays) {
    return std::isinf(rays) ? "never" : fmt::format("{:.3g}", rays);
}

std::string crossing_text(const Crossing& from) {
    return fmt::format("{} ({}..{})", rays_text(from.rays), rays_text(from.low),
                       rays_text(from.high));
}

/// Build and rays: who has the first image first. Empty where no builds are known.
std::string image_table(const Results& results, const Records& records) {
    const std::vector<ImageLine> lines = image_lines(records, results.builds);
    if (lines.empty()) return "";
    const std::vector<FirstWithImage> firsts = first_with_image(lines, kBootstrapSeed);
    Rows rows = {{"first with its image", "from, rays (95 % interval)", "build ms", "builds",
                  "ms/Mray", "errors"}};
    for (const FirstWithImage& first : firsts) {
        const ImageLine& line = lines[first.line];
        rows.push_back(
            {line.timing->tracer, first.from.rays == 0.0 ? "0" : crossing_text(first.from),
             fmt::format("{:.2f}", build_ms(line)), std::to_string(line.build->build_ms.size()),
             fmt::format("{:.1f}", ms_per_mray(line)), std::to_string(line.timing->errors)});
    }
    return format_table(rows);
}

std::string clock_text(const std::optional<ClockReading>& clocks) {
    return clocks ? fmt::format("SM {:.0f} MHz, memory {:.0f} MHz, {:.0f} C", clocks->sm_mhz,
                                clocks->memory_mhz, clocks->temperature_c)
                  : "-";
}

/// Whether the device held its pace, and at which clocks.
std::string pace_text(const PaceRecord& pace) {
    std::string text = fmt::format(
        "  warm-up: {} rounds, {:.1f} s, until the pace of the device changed by {:.2f} %{}\n",
        pace.warm_up_rounds, 1e-3 * pace.warm_up_ms, 100.0 * pace.change,
        pace.steady ? "" : ": NOT STEADY");
    return text + fmt::format("  clocks ({}): before {}; after {}\n", pace.clocks_of,
                              clock_text(pace.before), clock_text(pace.after));
}

}  // namespace

void print_bench(const Results& results, std::FILE* out) {
    for (size_t begin = 0; begin < results.timings.size();) {
        const TimingRecord& first = results.timings[begin];
        Records group;
        for (; begin < results.timings.size(); ++begin) {
            const TimingRecord& record = results.timings[begin];
            if (record.scene != first.scene || record.rays != first.rays) break;
            group.push_back(&record);
        }
        fmt::print(out, "{}{}{}{}", speed_table(group), pair_table(group),
                   counter_table(results, group), image_table(results, group));
        for (const PaceRecord& pace : results.paces) {
            if (pace.scene != first.scene || pace.rays != first.rays) continue;
            fmt::print(out, "{}", pace_text(pace));
        }
    }
    if (results.manifest.judge.empty()) return;  // a shard without a point
    fmt::print(out, "judge of the errors: {}\n", results.manifest.judge);
}

}  // namespace onepass::cli
