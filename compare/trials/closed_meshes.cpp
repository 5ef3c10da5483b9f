// Rays marched through closed meshes. See closed_mesh_trial().
#include <cmath>
#include <limits>

#include "compare/hits.h"
#include "compare/trials/common.h"

namespace onepass {
namespace {

using namespace trials;

/// Far more than any ray crosses of the meshes that trials use.
constexpr size_t kMostCrossings = 256;

/// From one diagonal outside the box, as far from its corners as from its centre.
constexpr float kViewDistance = 1.5f;

/// A ray on its way.
struct March {
    Ray ray;  ///< what is left of it
    bool inside = false;
    const char* failure = nullptr;
    Ray failed_ray;  ///< the part whose answer failed
    Hit failed_answer;
};

/// Takes in one crossing, or the end. False if the march is over.
bool advance(const Scene& scene, const Hit& hit, uint32_t flags, March& march) {
    const auto fail = [&](const char* kind) {
        march.failure = kind;
        march.failed_ray = march.ray;
        march.failed_answer = hit;
        return false;
    };
    if (flags & kFlagExhausted) return fail(kExhausted);
    if (!hit.is_hit()) return march.inside ? fail("never_left") : false;
    const dvec3 normal = outward_normal(scene, hit.inst_id, hit.prim_id);
    const bool entering = glm::dot(normal, dvec3(march.ray.dir)) < 0.0;
    if (entering && march.inside) return fail("entered_twice");
    if (!entering && !march.inside) return fail("left_without_entering");
    march.inside = entering;
    march.ray.tmin = std::nextafter(hit.t, kInfinity);
    return true;
}

std::vector<March> march_all(const Scene& scene, const std::vector<Ray>& rays, Tracer& tracer) {
    std::vector<March> marches(rays.size());
    std::vector<size_t> under_way;
    for (size_t i = 0; i < rays.size(); ++i) {
        marches[i].ray = rays[i];
        under_way.push_back(i);
    }
    for (size_t crossing = 0; crossing < kMostCrossings && !under_way.empty(); ++crossing) {
        std::vector<Ray> parts;
        for (const size_t i : under_way) parts.push_back(marches[i].ray);
        const CastResult cast = cast_closest(tracer, parts);
        std::vector<size_t> going_on;
        for (size_t k = 0; k < under_way.size(); ++k) {
            const size_t i = under_way[k];
            if (advance(scene, cast.hits[k], cast.flags[k], marches[i])) going_on.push_back(i);
        }
        under_way = std::move(going_on);
    }
    for (const size_t i : under_way) marches[i].failure = "never_left";
    return marches;
}

/// The least gap between two true crossings of the ray, in ulps of t; 0 where the truth, marched as
/// the tracers are, goes in and out out of turn: then it has crossings within one float.
double least_gap_in_ulps(const Judge& judge, const Scene& scene, Ray ray) {
    double least = std::numeric_limits<double>::infinity();
    double last_t = -std::numeric_limits<double>::infinity();
    bool inside = false;
    for (size_t crossing = 0; crossing < kMostCrossings; ++crossing) {
        const Hit miss;
        const Verdict truth = judge.judge(ray, Query::closest, std::span(&miss, 1)).front();
        if (truth.true_inst_id == kNoId) return inside ? 0.0 : least;
        const dvec3 normal = outward_normal(scene, truth.true_inst_id, truth.true_prim_id);
        const bool entering = glm::dot(normal, dvec3(ray.dir)) < 0.0;
        if (entering == inside) return 0.0;
        inside = entering;
        const float t = static_cast<float>(truth.true_t);
        ray.tmin = std::nextafter(t, kInfinity);
        least = std::min(least, (truth.true_t - last_t) / double{ray.tmin - t});
        last_t = truth.true_t;
    }
    return least;
}

void count(const std::vector<March>& marches, const std::vector<Ray>& rays, const Judge& judge,
           const Scene& scene, RungRecord& record) {
    // Each of two crossings may be answered kTUlps off: nearer ones can change places.
    constexpr double kLeastGap = 2.0 * kTUlps;

    std::vector<size_t> failed;
    for (size_t i = 0; i < marches.size(); ++i) {
        if (marches[i].failure != nullptr) failed.push_back(i);
    }
    std::vector<double> gaps(failed.size());
    tbb::parallel_for(size_t{0}, failed.size(), [&](size_t k) {
        gaps[k] = least_gap_in_ulps(judge, scene, rays[failed[k]]);
    });

    record.trials = marches.size();
    for (size_t k = 0; k < failed.size(); ++k) {
        const March& march = marches[failed[k]];
        if (gaps[k] < kLeastGap) {
            ++record.ties;
            continue;
        }
        add_failure(record, march.failure);
        const Verdict verdict =
            judge.judge(march.failed_ray, Query::closest, std::span(&march.failed_answer, 1))
                .front();
        keep_first(record, failed[k], march.failed_ray, march.failed_answer, verdict);
    }
}

}  // namespace

StressExperiment closed_mesh_trial(TrialTitle title, std::vector<TrialScene> rungs) {
    const auto run = [title, rungs](const StressSetup& setup, const Progress& progress) {
        LadderRecord ladder = empty_record(title);
        Steps step(progress, rungs.size(), setup);
        for (const TrialScene& rung : rungs) {
            const auto scene = std::make_shared<const Scene>(rung.make_scene());
            const auto judge = setup.make_judge(scene);
            ladder.judge = judge->name();
            const std::vector<Ray> rays =
                rays_from_outside(*scene, setup.rays, kViewDistance, 0.0, setup.seed);
            const bool on = for_each_contestant(
                setup, rung.knob, rung.label, ladder, step,
                [&](const Contestant& contestant, RungRecord& record) {
                    const auto tracer = contestant.entry->make(scene, contestant.params);
                    count(march_all(*scene, rays, *tracer), rays, *judge, *scene, record);
                });
            if (!on) break;
        }
        return ladder;
    };
    return {title.id, title.title, run};
}

}  // namespace onepass
