#include "compare/time_to_image.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>

#include "compare/manifest.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Coefficients of two lines, in ms and ms a ray.
double crossing_at(double earlier_build, double earlier_slope, double later_build,
                   double later_slope) {
    const double head_start = later_build - earlier_build;
    const double gain = earlier_slope - later_slope;
    if (head_start <= 0.0) return gain >= 0.0 ? 0.0 : kNever;
    return gain > 0.0 ? head_start / gain : kNever;
}

double slope(double cast_ms, const ImageLine& line) {
    return cast_ms / static_cast<double>(line.timing->ray_count);
}

/// The median of as many draws with replacement as there are samples.
double resampled_median(const std::vector<double>& samples, Random& random) {
    std::vector<double> drawn(samples.size());
    for (double& sample : drawn) sample = samples[random.below(samples.size())];
    return median(drawn);
}

}  // namespace

BuiltTracer build_repeatedly(const CatalogueEntry& entry, const ScenePtr& scene,
                             const ParamValues& params) {
    const auto start = std::chrono::steady_clock::now();
    const auto spent_ms = [&] {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count();
    };
    BuiltTracer built;
    do {
        built.tracer.reset();  // one at a time has to fit
        built.tracer = entry.make(scene, params);
        const std::vector<Stat> stats = built.tracer->stats();
        built.build_ms.push_back(stat_value(stats, "build_ms") + stat_value(stats, "pack_ms"));
    } while (built.build_ms.size() < kMostBuilds && spent_ms() < kBuildsMs);
    return built;
}

double build_ms(const ImageLine& line) { return median(line.build->build_ms); }

double ms_per_mray(const ImageLine& line) {
    return 1e6 * slope(median(line.timing->wall_ms), line);
}

Crossing crossing(const ImageLine& earlier, const ImageLine& later, uint64_t seed) {
    const std::vector<double>& early_ms = earlier.timing->wall_ms;
    const std::vector<double>& late_ms = later.timing->wall_ms;
    const size_t rounds = std::min(early_ms.size(), late_ms.size());
    ONEPASS_CHECK_LT(size_t{0}, rounds);

    Random random(seed);
    std::vector<double> resampled(kBootstrapResamples);
    std::vector<double> early_drawn(rounds), late_drawn(rounds);
    for (double& rays : resampled) {
        for (size_t i = 0; i < rounds; ++i) {
            const size_t round = random.below(rounds);
            early_drawn[i] = early_ms[round];
            late_drawn[i] = late_ms[round];
        }
        const double early_build = resampled_median(earlier.build->build_ms, random);
        const double late_build = resampled_median(later.build->build_ms, random);
        rays = crossing_at(early_build, slope(median(early_drawn), earlier), late_build,
                           slope(median(late_drawn), later));
    }
    // Order statistics, not interpolated: between a number and infinity lies no number.
    std::sort(resampled.begin(), resampled.end());
    const auto at = [&](double share) {
        return resampled[static_cast<size_t>(share * (kBootstrapResamples - 1))];
    };
    return {crossing_at(build_ms(earlier), 1e-6 * ms_per_mray(earlier), build_ms(later),
                        1e-6 * ms_per_mray(later)),
            at(0.025), at(0.975)};
}

std::vector<FirstWithImage> first_with_image(std::span<const ImageLine> lines, uint64_t seed) {
    std::vector<FirstWithImage> firsts;
    if (lines.empty()) return firsts;
    const auto start = std::min_element(
        lines.begin(), lines.end(),
        [](const ImageLine& a, const ImageLine& b) { return build_ms(a) < build_ms(b); });
    firsts.push_back({static_cast<size_t>(start - lines.begin()), {}});
    for (;;) {
        FirstWithImage next{lines.size(), {kNever, kNever, kNever}};
        const ImageLine& leader = lines[firsts.back().line];
        for (size_t i = 0; i < lines.size(); ++i) {
            if (ms_per_mray(lines[i]) >= ms_per_mray(leader)) continue;
            const Crossing from = crossing(leader, lines[i], seed);
            if (from.rays < next.from.rays) next = {i, from};
        }
        if (next.line == lines.size()) return firsts;
        firsts.push_back(next);
    }
}

std::vector<ImageLine> image_lines(std::span<const TimingRecord* const> timings,
                                   std::span<const BuildRecord> builds) {
    std::vector<ImageLine> lines;
    for (const TimingRecord* timing : timings) {
        const auto build = std::find_if(builds.begin(), builds.end(), [&](const BuildRecord& b) {
            return b.scene == timing->scene && b.tracer == timing->tracer && !b.build_ms.empty();
        });
        if (build != builds.end() && !timing->wall_ms.empty()) lines.push_back({timing, &*build});
    }
    return lines;
}

}  // namespace onepass
