#include "compare/growth.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/experiments.h"
#include "compare/hits.h"
#include "compare/manifest.h"
#include "compare/rays.h"
#include "core/error.h"

namespace onepass {
namespace {

/// A contestant made ready for one size.
struct Builder {
    std::string setting;
    std::unique_ptr<Tracer> tracer;
};

/// What building took, packing included.
double built_in_ms(const std::vector<Stat>& stats) {
    return stat_value(stats, "build_ms") + stat_value(stats, "pack_ms");
}

/// What the structure takes where it is traced: on the device, or in Embree's own count.
uint64_t bytes_of(const std::vector<Stat>& stats) {
    return static_cast<uint64_t>(stat_value(stats, "device_bytes") + stat_value(stats, "bytes"));
}

/// Builds over and over; the last tracer is kept.
std::unique_ptr<Tracer> build(const GrowthSetup& setup, const Contestant& contestant,
                              const ScenePtr& scene, bool once, GrowthBuild& record) {
    std::unique_ptr<Tracer> tracer;
    double spent_ms = 0.0;
    do {
        tracer.reset();  // one at a time has to fit
        tracer = contestant.entry->make(scene, contestant.params);
        record.build_ms.push_back(built_in_ms(tracer->stats()));
        spent_ms += record.build_ms.back();
    } while (!once && record.build_ms.size() < setup.most_builds && spent_ms < setup.builds_ms);
    const std::vector<Stat> stats = tracer->stats();
    record.bytes = bytes_of(stats);
    record.cells = static_cast<uint64_t>(stat_value(stats, "cells"));
    record.references = static_cast<uint64_t>(stat_value(stats, "references"));
    return tracer;
}

/// `count` rays of the set, or all, evenly spread.
RaySet sample_of(const RaySet& rays, size_t count) {
    RaySet sample;
    sample.name = rays.name;
    sample.query = rays.query;
    const size_t kept = std::min(count, rays.rays.size());
    for (size_t i = 0; i < kept; ++i) sample.rays.push_back(rays.rays[i * rays.rays.size() / kept]);
    return sample;
}

/// Errors and edges of each tracer on the sample; tracers[0] is the oracle.
void judge_sample(std::span<Tracer* const> tracers, const RaySet& sample, const Judge& judge,
                  uint64_t seed, std::span<GrowthTrace> traces) {
    std::vector<CastResult> answers;
    for (Tracer* tracer : tracers) {
        answers.push_back(tracer->cast(tracer->upload(sample.rays), {.query = sample.query}));
    }
    const std::vector<HitComparison> comparisons =
        compare_hits(sample.rays, sample.query, answers, answers.front(), judge,
                     {.agreement_sample = 1.0, .seed = seed});
    for (size_t i = 0; i < traces.size(); ++i) {
        const CheckRecord& record = comparisons[i].record;
        traces[i].judged = sample.rays.size();
        traces[i].errors = record.errors();
        traces[i].edges = record.classes[static_cast<size_t>(HitClass::edge)].count;
    }
}

/// Times and judges one kind of rays; false if stopped.
bool trace(const GrowthSetup& setup, const GrowthStep& step, const Scene& scene,
           const std::vector<Builder>& builders, const Judge& judge, const std::string& kind,
           const Progress& progress, Results& results) {
    std::vector<Tracer*> tracers;
    for (const Builder& builder : builders) tracers.push_back(builder.tracer.get());
    const auto side = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(step.rays))));
    const RaySet rays =
        make_ray_set(kind, scene, *tracers.front(),
                     {.width = side, .height = side, .camera = 0, .seed = setup.timing.seed});

    // Time.
    PacedTimings paced = time_with_pace(tracers, 0, rays, setup.timing, setup.clocks, progress);
    const std::vector<TimingRecord>& timings = paced.timings;
    if (timings.front().wall_ms.size() < setup.timing.repetitions) return false;
    if (paced.pace) {
        paced.pace->scene = scene.name;
        results.paces.push_back(std::move(*paced.pace));
    }

    // Judge.
    std::vector<GrowthTrace> traces;
    for (size_t i = 0; i < builders.size(); ++i) {
        GrowthTrace& record = traces.emplace_back();
        record.scene = setup.shape;
        record.triangles = instanced_triangle_count(scene);
        record.tracer = timings[i].tracer;
        record.setting = builders[i].setting;
        record.rays = kind;
        record.ray_count = rays.rays.size();
        record.growing_rays = step.growing_rays;
        record.wall_ms = timings[i].wall_ms;
        record.device_ms = timings[i].device_ms;
    }
    judge_sample(tracers, sample_of(rays, setup.judged), judge, setup.timing.seed, traces);
    results.growth_traces.insert(results.growth_traces.end(), traces.begin(), traces.end());
    return true;
}

// ---- Curves

bool same_curve(const GrowthCurve& a, const GrowthCurve& b) {
    return a.cost == b.cost && a.over_rays == b.over_rays && a.tracer == b.tracer &&
           a.setting == b.setting && a.rays == b.rays;
}

/// The point goes to its curve, which is begun if there is none.
void add_point(std::vector<GrowthCurve>& curves, GrowthCurve curve, double x, double y) {
    auto found = std::find_if(curves.begin(), curves.end(),
                              [&](const GrowthCurve& c) { return same_curve(c, curve); });
    if (found == curves.end()) found = curves.insert(curves.end(), std::move(curve));
    found->x.push_back(x);
    found->y.push_back(y);
}

}  // namespace

std::string GrowthStep::id() const {
    return growing_rays ? fmt::format("rays-{}", rays) : fmt::format("triangles-{}", triangles);
}

std::vector<GrowthStep> growth_steps(const std::vector<uint64_t>& triangles,
                                     const std::vector<uint64_t>& ray_counts, uint64_t fixed_rays,
                                     uint64_t fixed_triangles) {
    std::vector<GrowthStep> steps;
    for (const uint64_t count : triangles) steps.push_back({count, fixed_rays, false});
    for (const uint64_t count : ray_counts) steps.push_back({fixed_triangles, count, true});
    return steps;
}

Results measure_growth(const GrowthSetup& setup, const GrowthStep& step, const Progress& progress) {
    ONEPASS_CHECK(!setup.contestants.empty());
    if (!go_on(progress, 0.0)) return {};
    const ScenePtr scene = setup.make_scene(step.triangles);

    // Build.
    Results results;
    std::vector<Builder> builders;
    for (const Contestant& contestant : setup.contestants) {
        GrowthBuild record;
        record.scene = setup.shape;
        record.triangles = instanced_triangle_count(*scene);
        record.tracer = contestant.entry->info.name;
        record.setting = params_text(contestant.params);
        try {
            builders.push_back(
                {record.setting, build(setup, contestant, scene, step.growing_rays, record)});
        } catch (const Error& error) {
            if (builders.empty() || error.kind() == Error::Kind::device) throw;
            record.build_ms.clear();
            record.failure = error.what();
        }
        if (!step.growing_rays) results.growth_builds.push_back(std::move(record));
        if (!go_on(progress, 0.0)) return {};
    }

    // Trace.
    const std::unique_ptr<Judge> judge = setup.make_judge(scene);
    results.manifest.judge = judge->name();
    const double kinds = static_cast<double>(setup.kinds.size());
    for (size_t k = 0; k < setup.kinds.size(); ++k) {
        const Progress part = [&](double done) {
            return go_on(progress, (static_cast<double>(k) + done) / kinds);
        };
        if (!trace(setup, step, *scene, builders, *judge, setup.kinds[k], part, results)) return {};
    }
    return results;
}

std::string cost_text(const GrowthCurve& curve) {
    switch (curve.cost) {
        case GrowthCurve::Cost::build_ms:
            return "build time over triangles";
        case GrowthCurve::Cost::bytes:
            return "bytes over triangles";
        case GrowthCurve::Cost::trace_ms:
            break;
    }
    return fmt::format("time over {}, {}", curve.over_rays ? "rays" : "triangles", curve.rays);
}

std::vector<GrowthCurve> growth_curves(const Results& results) {
    using enum GrowthCurve::Cost;
    std::vector<GrowthCurve> curves;
    const auto add_builds = [&](GrowthCurve::Cost cost, auto&& value) {
        for (const GrowthBuild& build : results.growth_builds) {
            if (!build.failure.empty()) continue;
            GrowthCurve curve;
            curve.cost = cost;
            curve.tracer = build.tracer;
            curve.setting = build.setting;
            add_point(curves, std::move(curve), static_cast<double>(build.triangles), value(build));
        }
    };
    add_builds(build_ms, [](const GrowthBuild& build) { return median(build.build_ms); });
    add_builds(bytes, [](const GrowthBuild& build) { return static_cast<double>(build.bytes); });

    for (const bool over_rays : {false, true}) {
        for (const GrowthTrace& trace : results.growth_traces) {
            if (trace.growing_rays != over_rays) continue;
            GrowthCurve curve;
            curve.cost = trace_ms;
            curve.over_rays = over_rays;
            curve.tracer = trace.tracer;
            curve.setting = trace.setting;
            curve.rays = trace.rays;
            curve.by_device = !trace.device_ms.empty();
            add_point(curves, std::move(curve),
                      static_cast<double>(over_rays ? trace.ray_count : trace.triangles),
                      median(trace.device_ms.empty() ? trace.wall_ms : trace.device_ms));
        }
    }
    std::erase_if(curves, [](const GrowthCurve& curve) { return curve.x.size() < 2; });
    for (GrowthCurve& curve : curves) curve.law = fit_power(curve.x, curve.y);
    return curves;
}

}  // namespace onepass
