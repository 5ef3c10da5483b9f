#include "compare/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace onepass {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool all_on_device(std::span<const SweepPoint> points) {
    return std::all_of(points.begin(), points.end(), [](const SweepPoint& p) {
        return p.wall_ms.empty() || p.device_ms.size() == p.wall_ms.size();
    });
}

std::span<const double> samples_of(const SweepPoint& point, bool on_device) {
    return on_device ? point.device_ms : point.wall_ms;
}

/// `choice` against `best`, at these times.
Regret regret_of(std::span<const SweepPoint> points, const std::vector<double>& ns, size_t choice,
                 size_t best) {
    Regret regret{ns[choice] / ns[best] - 1.0, kNan, kNan};
    const SweepPoint& a = points[choice];
    const SweepPoint& b = points[best];
    const bool same_rounds = a.wall_ms.size() == b.wall_ms.size() && !a.oracle_wall_ms.empty() &&
                             a.oracle_wall_ms == b.oracle_wall_ms;
    if (!same_rounds) return regret;
    const bool on_device = all_on_device(points);
    constexpr uint64_t kSeed = 0;
    const RatioInterval interval =
        ratio_of_medians(samples_of(a, on_device), samples_of(b, on_device), kSeed);
    regret.low = interval.low - 1.0;
    regret.high = interval.high - 1.0;
    return regret;
}

/// Indices of the sizes by density with the best's top density, from coarse to fine.
std::vector<size_t> curve_through(std::span<const SweepPoint> points, const std::vector<double>& ns,
                                  size_t best) {
    std::vector<size_t> curve;
    for (size_t i = 0; i < points.size(); ++i) {
        const bool on_curve = is_by_density(points[i]) && !std::isnan(ns[i]) &&
                              points[i].top_density == points[best].top_density;
        if (on_curve) curve.push_back(i);
    }
    std::sort(curve.begin(), curve.end(), [&](size_t a, size_t b) {
        return points[a].object_density < points[b].object_density;
    });
    return curve;
}

/// Where the line between two points of the curve reaches `limit`, on logarithms.
double crossing(double density_in, double ns_in, double density_out, double ns_out, double limit) {
    const double share = std::log(limit / ns_in) / std::log(ns_out / ns_in);
    return density_in * std::pow(density_out / density_in, share);
}

DensityBand band_about(std::span<const SweepPoint> points, const std::vector<double>& ns,
                       const std::vector<size_t>& curve, size_t best, double share) {
    const double limit = ns[best] * (1.0 + share);
    const auto middle =
        static_cast<size_t>(std::find(curve.begin(), curve.end(), best) - curve.begin());
    const auto density = [&](size_t at) { return points[curve[at]].object_density; };
    const auto edge = [&](size_t in, size_t out) {
        return crossing(density(in), ns[curve[in]], density(out), ns[curve[out]], limit);
    };
    DensityBand band{share, 0.0, 0.0, false, false};
    size_t first = middle;
    while (first > 0 && ns[curve[first - 1]] <= limit) --first;
    band.low_open = first == 0;
    band.low = band.low_open ? density(0) : edge(first, first - 1);
    size_t last = middle;
    while (last + 1 < curve.size() && ns[curve[last + 1]] <= limit) ++last;
    band.high_open = last + 1 == curve.size();
    band.high = band.high_open ? density(last) : edge(last, last + 1);
    return band;
}

size_t least(std::span<const size_t> among, const std::vector<double>& values) {
    return *std::min_element(among.begin(), among.end(),
                             [&](size_t a, size_t b) { return values[a] < values[b]; });
}

std::optional<size_t> last_chosen(std::span<const SweepPoint> points, const std::vector<double>& ns,
                                  const char* how) {
    std::optional<size_t> found;
    for (size_t i = 0; i < points.size(); ++i) {
        if (points[i].chosen == how && !std::isnan(ns[i])) found = i;
    }
    return found;
}

/// The points of each scene, ray kind and top density that the costs may choose among.
using Series = std::map<std::tuple<std::string, std::string, double>, std::vector<SweepPoint>>;

Series series_of(std::span<const SweepPoint> points) {
    Series series;
    for (const SweepPoint& point : points) {
        if (!is_by_density(point) || !point.failure.empty()) continue;
        series[{point.scene, point.rays, point.top_density}].push_back(point);
    }
    for (auto& [key, own] : series) {
        std::sort(own.begin(), own.end(), [](const SweepPoint& a, const SweepPoint& b) {
            return a.object_density < b.object_density;
        });
    }
    return series;
}

/// Samples of all series but those of one scene. A series is brought to one pace by itself, and has
/// a scale of its own.
std::vector<WorkSample> samples_without(const Series& series, const std::string& scene) {
    std::vector<WorkSample> samples;
    size_t scale = 0;
    for (const auto& [key, own] : series) {
        if (std::get<0>(key) == scene) continue;
        const std::vector<double> ns = comparable_ns(own);
        for (size_t i = 0; i < own.size(); ++i) {
            samples.push_back({own[i].cells_per_ray, own[i].tests_per_ray, ns[i], scale});
        }
        ++scale;
    }
    return samples;
}

}  // namespace

bool is_by_density(const SweepPoint& point) {
    return point.resolution.empty() && point.sizes.empty();
}

std::vector<double> comparable_ns(std::span<const SweepPoint> points) {
    std::vector<double> all_rounds;
    for (const SweepPoint& point : points) {
        all_rounds.insert(all_rounds.end(), point.oracle_wall_ms.begin(),
                          point.oracle_wall_ms.end());
    }
    const double pace = median(all_rounds);
    const bool on_device = all_on_device(points);

    std::vector<double> ns;
    for (const SweepPoint& point : points) {
        const double ms = median(samples_of(point, on_device));
        // A device's timer does not know how busy the CPU was; files of older versions do not hold
        // the oracle's rounds.
        const bool paired = !on_device && !point.oracle_wall_ms.empty();
        const double scale = paired ? pace / median(point.oracle_wall_ms) : 1.0;
        const double rays = static_cast<double>(std::max<uint64_t>(1, point.ray_count));
        ns.push_back(point.failure.empty() ? 1e6 * ms * scale / rays : kNan);
    }
    return ns;
}

std::optional<Tuning> tuning_of(std::span<const SweepPoint> points) {
    Tuning tuning;
    tuning.ns = comparable_ns(points);
    const std::vector<double>& ns = tuning.ns;
    std::vector<size_t> measured, by_density;
    for (size_t i = 0; i < points.size(); ++i) {
        if (std::isnan(ns[i])) continue;
        measured.push_back(i);
        if (is_by_density(points[i])) by_density.push_back(i);
    }
    if (measured.empty()) return std::nullopt;
    tuning.best = least(measured, ns);

    // The model and its choice.
    std::vector<WorkSample> samples;
    for (const size_t i : measured) {
        samples.push_back({points[i].cells_per_ray, points[i].tests_per_ray, ns[i], 0});
    }
    tuning.model = fit_costs(samples);
    if (tuning.model) {
        for (const SweepPoint& point : points) {
            tuning.predicted_ns.push_back(
                point.failure.empty() ? tuning.model->ns(point.cells_per_ray, point.tests_per_ray)
                                      : kNan);
        }
        if (!by_density.empty()) {
            tuning.predicted = least(by_density, tuning.predicted_ns);
            tuning.predicted_regret = regret_of(points, ns, *tuning.predicted, tuning.best);
        }
    }

    // How much the density matters.
    if (is_by_density(points[tuning.best])) {
        const std::vector<size_t> curve = curve_through(points, ns, tuning.best);
        for (const double share : kBandShares) {
            if (curve.size() < 2) break;  // one density is no curve
            tuning.bands.push_back(band_about(points, ns, curve, tuning.best, share));
        }
    }

    // No finer than the scene needs.
    tuning.smallest = tuning.best;
    for (const size_t i : measured) {
        const bool fast = ns[i] <= ns[tuning.best] * (1.0 + kNoFinerShare);
        if (fast && points[i].bytes < points[tuning.smallest].bytes) tuning.smallest = i;
    }
    tuning.saved_bytes = static_cast<double>(points[tuning.best].bytes) -
                         static_cast<double>(points[tuning.smallest].bytes);

    // What others chose.
    tuning.automatic = last_chosen(points, ns, kAutoSize);
    if (tuning.automatic) {
        tuning.automatic_regret = regret_of(points, ns, *tuning.automatic, tuning.best);
    }
    tuning.per_object = last_chosen(points, ns, kPerObjectSize);
    if (tuning.per_object && !by_density.empty()) {
        tuning.per_object_gain = ns[least(by_density, ns)] / ns[*tuning.per_object] - 1.0;
    }
    return tuning;
}

std::vector<LeftOut> leave_one_out(std::span<const SweepPoint> points) {
    const Series series = series_of(points);
    std::vector<LeftOut> left_out;
    for (const auto& [key, own] : series) {
        if (own.size() < 2) continue;
        const std::optional<CostModel> costs = fit_costs(samples_without(series, std::get<0>(key)));
        if (!costs) continue;
        std::vector<double> predicted;
        for (const SweepPoint& point : own) {
            predicted.push_back(costs->ns(point.cells_per_ray, point.tests_per_ray));
        }
        const std::vector<double> ns = comparable_ns(own);
        const size_t chosen = coarsest_worthwhile(predicted);
        const auto best = static_cast<size_t>(std::min_element(ns.begin(), ns.end()) - ns.begin());
        left_out.push_back({std::get<0>(key), std::get<1>(key), *costs, own.size(),
                            own[chosen].object_density, own[best].object_density,
                            regret_of(own, ns, chosen, best)});
    }
    return left_out;
}

double median_regret(std::span<const LeftOut> left_out) {
    std::vector<double> shares;
    for (const LeftOut& scene : left_out) shares.push_back(scene.regret.share);
    return median(shares);
}

std::optional<CostModel> costs_of(std::span<const SweepPoint> points, const std::string& tracer) {
    std::vector<SweepPoint> own;
    for (const SweepPoint& point : points) {
        if (point.tracer == tracer) own.push_back(point);
    }
    return fit_costs(samples_without(series_of(own), ""));
}

size_t coarsest_worthwhile(std::span<const double> predicted_ns) {
    const double least_ns = *std::min_element(predicted_ns.begin(), predicted_ns.end());
    const auto found = std::find_if(predicted_ns.begin(), predicted_ns.end(), [&](double ns) {
        return ns <= least_ns * (1.0 + kWorthwhile);
    });
    return static_cast<size_t>(found - predicted_ns.begin());
}

}  // namespace onepass
