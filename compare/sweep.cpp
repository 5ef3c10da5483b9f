#include "compare/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "compare/manifest.h"
#include "compare/tuning.h"
#include "core/error.h"
#include "core/grid/sizing.h"

namespace onepass {
namespace {

const ParamInfo* find_param(const TracerInfo& info, const std::string& name) {
    const auto found = std::find_if(info.params.begin(), info.params.end(),
                                    [&](const ParamInfo& param) { return param.name == name; });
    return found == info.params.end() ? nullptr : &*found;
}

void check_has_density(const TracerInfo& info) {
    if (has_grid_density(info)) return;
    throw Error(
        {info.name, "no parameter 'density'", "a strategy over grids", "Name one with -s."});
}

double default_of(const TracerInfo& info, const ParamValues& params, const std::string& name) {
    const auto given = params.find(name);
    if (given != params.end()) return std::stod(given->second);
    const ParamInfo* param = find_param(info, name);
    return param ? std::stod(param->default_value) : 0.0;
}

void count(SweepPoint& point, const CastResult& cast) {
    double cells = 0.0;
    double tests = 0.0;
    for (const RayCounters& counters : cast.counters) {
        cells += counters.cells;
        tests += counters.tests;
    }
    const double rays = static_cast<double>(cast.counters.size());
    point.cells_per_ray = rays > 0 ? cells / rays : 0.0;
    point.tests_per_ray = rays > 0 ? tests / rays : 0.0;
}

/// All of a point but its times.
void inspect(SweepPoint& point, Tracer& tracer, const SweepCase& sweep,
             const SweepOptions& options) {
    const std::vector<Stat> stats = tracer.stats();
    point.cells = static_cast<uint64_t>(stat_value(stats, "cells"));
    point.references = static_cast<uint64_t>(stat_value(stats, "references"));
    point.bytes = static_cast<uint64_t>(stat_value(stats, "device_bytes"));
    point.build_ms = stat_value(stats, "build_ms");

    // Correctness and counters, apart from the timing.
    const RaySet& rays = sweep.rays;
    const CastOptions counted{.query = rays.query, .counters = tracer.capabilities().counters};
    const CastResult cast = tracer.cast(tracer.upload(rays.rays), counted);
    count(point, cast);
    point.errors =
        compare_hits(rays.rays, rays.query, cast, sweep.truth, sweep.judge, options.check)
            .record.errors();
}

void take_times(SweepPoint& point, const TimingRecord& timing) {
    point.wall_ms = timing.wall_ms;
    point.device_ms = timing.device_ms;
    point.oracle_wall_ms = timing.oracle_wall_ms;
    point.ratio = timing.ratio;
    point.ratio_low = timing.ratio_low;
    point.ratio_high = timing.ratio_high;
}

SweepPoint point_at(const SweepCase& sweep, const GridSize& size) {
    SweepPoint point;
    point.rays = sweep.rays.name;
    point.tracer = sweep.entry.info.name;
    point.top_density = size.top_density;
    point.object_density = size.object_density;
    point.resolution = size.resolution;
    point.sizes = size.sizes;
    point.chosen = size.chosen;
    point.ray_count = sweep.rays.rays.size();
    return point;
}

/// Quick timings: they choose where to look, and are thrown away.
TimingOptions quick(TimingOptions timing) {
    timing.repetitions = kLeastRepetitions;
    return timing;
}

/// One axis of a search; what it measured joins `all`. Returns the fastest.
template <class SizeAt>
std::optional<GridSize> search_axis(const SweepCase& sweep, const SweepOptions& options,
                                    const DensitySearch& search, const SizeAt& size_at,
                                    std::vector<SweepPoint>& all, const Progress& progress) {
    std::vector<TriedDensity> tried;
    std::vector<SweepPoint> points;
    while (true) {
        std::vector<GridSize> next;
        for (const double density : next_densities(tried, search)) {
            next.push_back(size_at(density));
            next.back().chosen = tried.empty() ? kCoarseSize : kRefinedSize;
        }
        if (next.empty()) break;
        const std::vector<SweepPoint> measured = measure_together(sweep, next, options, progress);
        if (measured.empty()) break;  // stopped
        points.insert(points.end(), measured.begin(), measured.end());
        const std::vector<double> ns = comparable_ns(points);
        tried.clear();
        for (size_t i = 0; i < points.size(); ++i) tried.push_back({size_at.of(points[i]), ns[i]});
    }
    all.insert(all.end(), points.begin(), points.end());
    const std::optional<Tuning> tuning = tuning_of(points);
    return tuning ? std::optional(size_of(points[tuning->best])) : std::nullopt;
}

/// The axes of a search: the one density moves, the other stays.
struct ObjectAxis {
    double top_density;
    GridSize operator()(double density) const { return {top_density, density, {}, {}, {}}; }
    static double of(const SweepPoint& point) { return point.object_density; }
};
struct TopAxis {
    double object_density;
    GridSize operator()(double density) const { return {density, object_density, {}, {}, {}}; }
    static double of(const SweepPoint& point) { return point.top_density; }
};

}  // namespace

bool has_grid_density(const TracerInfo& info) { return has_param(info, kObjectDensityParam); }

bool has_param(const TracerInfo& info, const std::string& name) {
    return find_param(info, name) != nullptr;
}

ParamValues sized_params(const TracerInfo& info, ParamValues params, const GridSize& size) {
    const auto set = [&](const char* name, const std::string& value) {
        if (has_param(info, name)) {
            params[name] = value;
            return;
        }
        throw Error({info.name, fmt::format("no parameter '{}'", name),
                     "a strategy over grids that has it", "Name one with -s."});
    };
    set(kObjectDensityParam, fmt::format("{}", size.object_density));
    if (has_param(info, kTopDensityParam)) {
        set(kTopDensityParam, fmt::format("{}", size.top_density));
    }
    if (!size.resolution.empty()) set(kResolutionParam, size.resolution);
    if (!size.sizes.empty()) set(kObjectSizesParam, size.sizes);
    return params;
}

GridSize size_of(const SweepPoint& point) {
    return {point.top_density, point.object_density, point.resolution, point.sizes, point.chosen};
}

GridSize default_size(const TracerInfo& info, const ParamValues& params) {
    check_has_density(info);
    return {.top_density = default_of(info, params, kTopDensityParam),
            .object_density = default_of(info, params, kObjectDensityParam)};
}

std::vector<GridSize> listed_sizes(const TracerInfo& info, const SweepOptions& options) {
    const GridSize usual = default_size(info, options.params);
    if (!options.resolutions.empty() && !has_param(info, kResolutionParam)) {
        throw Error({info.name, "no parameter 'resolution'", "a strategy over uniform grids",
                     "Leave --resolutions out, or name another with -s."});
    }
    std::vector<double> top_densities = options.top_densities;
    if (top_densities.empty()) top_densities = {usual.top_density};
    std::vector<double> object_densities = options.object_densities;
    if (object_densities.empty() && options.resolutions.empty()) {
        object_densities = {usual.object_density};
    }
    std::vector<GridSize> sizes;
    for (const double top : top_densities) {
        for (const double density : object_densities) {
            sizes.push_back({top, density, {}, {}, kListedSize});
        }
        for (const std::string& text : options.resolutions) {
            const std::string resolution = to_text(parse_resolution(text, "--resolutions"));
            sizes.push_back({top, usual.object_density, resolution, {}, kListedSize});
        }
    }
    return sizes;
}

std::vector<SweepPoint> measure_together(const SweepCase& sweep, std::span<const GridSize> sizes,
                                         const SweepOptions& options, const Progress& progress) {
    // Build, count, check.
    std::vector<SweepPoint> points;
    std::vector<std::unique_ptr<Tracer>> owned;
    std::vector<size_t> built;
    std::vector<Tracer*> contestants = {&sweep.oracle};
    for (const GridSize& size : sizes) {
        if (!go_on(progress, 0.0)) return {};
        SweepPoint& point = points.emplace_back(point_at(sweep, size));
        try {
            owned.push_back(sweep.entry.make(sweep.scene,
                                             sized_params(sweep.entry.info, options.params, size)));
        } catch (const Error& error) {
            point.failure = error.what();
            continue;
        }
        inspect(point, *owned.back(), sweep, options);
        built.push_back(points.size() - 1);
        contestants.push_back(owned.back().get());
    }
    if (built.empty()) return points;

    // Speed: every size in every round.
    const std::vector<TimingRecord> timings =
        time_casts(contestants, 0, sweep.rays, options.timing, progress);
    if (timings.front().wall_ms.empty()) return {};
    for (size_t i = 0; i < built.size(); ++i) take_times(points[built[i]], timings[i + 1]);
    return points;
}

std::vector<SweepPoint> sweep_grid_sizes(const CatalogueEntry& entry, const ScenePtr& scene,
                                         const RaySet& rays, Tracer& oracle, const Judge& judge,
                                         const SweepOptions& options, const Progress& progress,
                                         const SweepHooks& hooks) {
    const std::vector<GridSize> sizes = listed_sizes(entry.info, options);
    const CastResult truth = oracle.cast(oracle.upload(rays.rays), {.query = rays.query});
    const SweepCase sweep{entry, scene, rays, oracle, judge, truth};
    std::vector<SweepPoint> points;
    for (size_t i = 0; i < sizes.size(); ++i) {
        const Progress inner = [&](double share) {
            return go_on(progress,
                         (static_cast<double>(i) + share) / static_cast<double>(sizes.size()));
        };
        if (hooks.is_done && hooks.is_done(sizes[i])) continue;
        if (!inner(0.0)) break;
        std::vector<SweepPoint> one =
            measure_together(sweep, std::span(&sizes[i], 1), options, inner);
        if (one.empty()) break;  // stopped before its first round
        if (hooks.finished) hooks.finished(one.front());
        points.push_back(std::move(one.front()));
    }
    return points;
}

std::vector<double> next_densities(std::span<const TriedDensity> tried,
                                   const DensitySearch& search) {
    // The coarse ones.
    std::vector<double> next;
    if (tried.empty()) {
        std::copy_if(search.coarse.begin(), search.coarse.end(), std::back_inserter(next),
                     [&](double density) { return density <= search.highest; });
        if (next.empty()) next = {search.highest};
        return next;
    }
    std::vector<TriedDensity> sorted(tried.begin(), tried.end());
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.density < b.density; });
    const auto slower = [](const TriedDensity& a, const TriedDensity& b) {
        return std::isnan(b.ns) ? !std::isnan(a.ns) : a.ns < b.ns;
    };
    const auto best = std::min_element(sorted.begin(), sorted.end(), slower);
    if (std::isnan(best->ns)) return {};

    // Beyond an end, as far as it may.
    const bool is_first = best == sorted.begin();
    const bool is_last = best + 1 == sorted.end();
    if (is_first && best->density > search.lowest) {
        return {std::max(search.lowest, best->density / search.step)};
    }
    if (is_last && best->density < search.highest) {
        return {std::min(search.highest, best->density * search.step)};
    }

    // Between the best and its neighbours.
    const auto halve = [&](const TriedDensity& a, const TriedDensity& b) {
        if (b.density / a.density > search.finest) next.push_back(std::sqrt(a.density * b.density));
    };
    if (!is_first) halve(*(best - 1), *best);
    if (!is_last) halve(*best, *(best + 1));
    return next;
}

double highest_density(const Scene& scene) {
    double triangles = 0.0;
    for (const Object& object : scene.objects) {
        triangles += static_cast<double>(object.triangles.size());
    }
    return kMostSearchedCells / std::max(1.0, triangles);
}

std::vector<SweepPoint> search_sizes(const SweepCase& sweep, const SweepOptions& options,
                                     const Progress& progress) {
    const TracerInfo& info = sweep.entry.info;
    const GridSize usual = default_size(info, options.params);
    SweepOptions quickly = options;
    quickly.timing = quick(options.timing);
    std::vector<SweepPoint> points;

    // The objects.
    DensitySearch objects;
    objects.highest = std::min(objects.highest, highest_density(*sweep.scene));
    const std::optional<GridSize> best =
        search_axis(sweep, quickly, objects, ObjectAxis{usual.top_density}, points, progress);

    // The top level, where there is one.
    const bool has_top = sweep.scene->instances.size() > 1 && has_param(info, kTopDensityParam);
    if (has_top && best) {
        DensitySearch top;
        top.coarse = {usual.top_density / 4.0, usual.top_density, usual.top_density * 4.0};
        search_axis(sweep, quickly, top, TopAxis{best->object_density}, points, progress);
    }

    // Each once: the second search meets the first one's best again.
    std::vector<SweepPoint> unique;
    for (SweepPoint& point : points) {
        const bool known = std::any_of(unique.begin(), unique.end(), [&](const SweepPoint& p) {
            return p.top_density == point.top_density && p.object_density == point.object_density;
        });
        if (!known) unique.push_back(std::move(point));
    }
    return unique;
}

const SweepPoint* best_point(std::span<const SweepPoint> points) {
    const SweepPoint* best = nullptr;
    for (const SweepPoint& point : points) {
        if (!point.failure.empty()) continue;
        if (!best ||
            std::tuple(point.errors, -point.ratio) < std::tuple(best->errors, -best->ratio)) {
            best = &point;
        }
    }
    return best;
}

}  // namespace onepass
