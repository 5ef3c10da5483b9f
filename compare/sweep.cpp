#include "compare/sweep.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "compare/manifest.h"
#include "core/error.h"

namespace onepass {
namespace {

const ParamInfo* find_param(const TracerInfo& info, const std::string& name) {
    const auto found = std::find_if(info.params.begin(), info.params.end(),
                                    [&](const ParamInfo& param) { return param.name == name; });
    return found == info.params.end() ? nullptr : &*found;
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

void measure(SweepPoint& point, Tracer& tracer, const RaySet& rays, Tracer& oracle,
             const CastResult& truth, const Judge& judge, const SweepOptions& options,
             const Progress& progress) {
    const std::vector<Stat> stats = tracer.stats();
    point.cells = static_cast<uint64_t>(stat_value(stats, "cells"));
    point.references = static_cast<uint64_t>(stat_value(stats, "references"));
    point.bytes = static_cast<uint64_t>(stat_value(stats, "device_bytes"));
    point.build_ms = stat_value(stats, "build_ms");

    // Correctness and counters, apart from the timing.
    const CastOptions counted{.query = rays.query, .counters = tracer.capabilities().counters};
    const CastResult cast = tracer.cast(tracer.upload(rays.rays), counted);
    count(point, cast);
    point.errors =
        compare_hits(rays.rays, rays.query, cast, truth, judge, options.check).record.errors();

    // Speed.
    Tracer* const contestants[] = {&tracer, &oracle};
    const TimingRecord timing = time_casts(contestants, 1, rays, options.timing, progress).front();
    point.wall_ms = timing.wall_ms;
    point.ratio = timing.ratio;
    point.ratio_low = timing.ratio_low;
    point.ratio_high = timing.ratio_high;
}

}  // namespace

bool has_grid_density(const TracerInfo& info) { return find_param(info, kObjectDensityParam); }

std::vector<SweepPoint> sweep_grid_sizes(const CatalogueEntry& entry, const ScenePtr& scene,
                                         const RaySet& rays, Tracer& oracle, const Judge& judge,
                                         const SweepOptions& options, const Progress& progress) {
    if (!has_grid_density(entry.info)) {
        throw Error({entry.info.name, "no parameter 'density'", "a strategy over grids",
                     "Name one with -s."});
    }
    const ParamInfo* top_param = find_param(entry.info, kTopDensityParam);
    std::vector<double> top_densities = options.top_densities;
    if (top_densities.empty()) {
        top_densities = {top_param ? std::stod(top_param->default_value) : 0.0};
    }
    const CastResult truth = oracle.cast(oracle.upload(rays.rays), {.query = rays.query});

    std::vector<SweepPoint> points;
    const double total =
        static_cast<double>(top_densities.size() * options.object_densities.size());
    for (const double top_density : top_densities) {
        for (const double object_density : options.object_densities) {
            const double done = static_cast<double>(points.size());
            const Progress inner = [&](double share) {
                return go_on(progress, (done + share) / total);
            };
            if (!inner(0.0)) return points;

            SweepPoint point;
            point.rays = rays.name;
            point.tracer = entry.info.name;
            point.top_density = top_density;
            point.object_density = object_density;
            ParamValues params = options.params;
            params[kObjectDensityParam] = fmt::format("{}", object_density);
            if (top_param) params[kTopDensityParam] = fmt::format("{}", top_density);
            std::unique_ptr<Tracer> tracer;
            try {
                tracer = entry.make(scene, params);
            } catch (const Error& error) {
                point.failure = error.what();
            }
            if (tracer) {
                measure(point, *tracer, rays, oracle, truth, judge, options, inner);
                if (point.wall_ms.empty()) return points;  // stopped before its first round
            }
            points.push_back(std::move(point));
        }
    }
    return points;
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
