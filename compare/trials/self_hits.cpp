// Secondary rays against the surface that they start from. See self_hit_trial().
//
// Whether a point is behind a plane is decided in double: what is asked about are floats, whose
// errors are 2^29 times as large.
#include <algorithm>
#include <cmath>
#include <optional>

#include "compare/trials/common.h"
#include "core/error.h"
#include "core/shading.h"

namespace onepass {
namespace {

using namespace trials;

/// A ray that leaves a surface, and the surface.
struct Departure {
    size_t primary = 0;  ///< index of the ray that found the surface
    Hit from;
    Ray ray;
    vec3 way{0.0f};               ///< of the primary ray, to the surface
    bool behind = false;          ///< starts on or behind the plane of its triangle
    std::optional<Ray> way_back;  ///< from its origin to the surface; none where they are one point
};

double largest(const vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Positions on a surface err by some ulps of the largest coordinate there, and along the way by
/// the rounding of its length (kOffsetOfWay, core/shading.h: 5.2 u, which may put them beside the
/// triangle that was hit). What is crossed nearer than this to the surface is the surface.
constexpr double kPositionUlps = 8.0;
constexpr double kWayRounding = 5.2 * 0x1p-24;

/// What share of the way back is not within the rounding of where the surface is; `way` led there.
double clear_share(const Ray& way_back, const vec3& way) {
    const double coordinate = std::max(largest(way_back.org), largest(way_back.org + way_back.dir));
    const double rounding = kPositionUlps * 0x1p-23 * coordinate + kWayRounding * largest(way);
    return 1.0 - rounding / glm::length(dvec3(way_back.dir));
}

/// The secondary rays of one primary hit that truly lead away from its surface.
void depart(const ShadingScene& shading, float offset_factor, size_t index, const Ray& primary,
            const Hit& hit, std::vector<Departure>& departures) {
    const Scene& scene = *shading.scene;
    const auto [a, b, c] = world_corners(scene, hit.inst_id, hit.prim_id);
    const dvec3 plane = glm::cross(b - a, c - a);
    const double side = glm::dot(plane, dvec3(primary.dir)) < 0.0 ? 1.0 : -1.0;

    const SurfacePoint point = surface_point(shading, primary, hit);
    const float offset = offset_at(shading, primary, hit.t) * offset_factor;
    const vec3 origin = point.position + point.geometric_normal * offset;
    const auto add = [&](const vec3& dir, float tmax) {
        if (!(side * glm::dot(plane, dvec3(dir)) > 0.0)) return;
        Departure departure{index, hit, Ray{origin, 0.0f, dir, tmax}, primary.dir * hit.t,
                            false, {}};
        departure.behind = side * glm::dot(plane, dvec3(origin) - a) <= 0.0;
        const vec3 back = point.position - origin;
        if (back != vec3(0.0f)) departure.way_back = Ray{origin, 0.0f, back, 1.0f};
        departures.push_back(departure);
    };

    // As shade_path() makes them, but both from every hit and about the geometric normal: a shading
    // normal may well send a mirror ray into the surface.
    const vec3 n = point.geometric_normal;
    const vec3 incoming = glm::normalize(primary.dir);
    add(incoming - n * (2.0f * glm::dot(incoming, n)), kInfinity);
    const auto& lights = scene.lights;
    const auto faced = std::find_if(lights.begin(), lights.end(), [&](const PointLight& light) {
        return glm::dot(light.position - origin, n) > 0.0f;
    });
    if (faced != lights.end()) add(faced->position - origin, 1.0f);
}

bool same_triangle(const Hit& a, uint32_t inst_id, uint32_t prim_id) {
    return a.inst_id == inst_id && a.prim_id == prim_id;
}

/// Another surface lies between the origin and the surface that it belongs to.
bool crossed_another(const Departure& departure, const Verdict& on_way_back) {
    return on_way_back.true_inst_id != kNoId &&
           !same_triangle(departure.from, on_way_back.true_inst_id, on_way_back.true_prim_id) &&
           on_way_back.true_t < clear_share(*departure.way_back, departure.way);
}

void run_rung(const SelfHitRung& rung, const ShadingScene& shading, const Judge& judge,
              const std::vector<Ray>& primary, Tracer& tracer, RungRecord& record) {
    // Depart from what the contestant hits.
    const CastResult hits = cast_closest(tracer, primary);
    std::vector<Departure> departures;
    for (size_t i = 0; i < primary.size(); ++i) {
        if (!hits.hits[i].is_hit()) continue;
        depart(shading, rung.offset_factor, i, primary[i], hits.hits[i], departures);
    }

    // The contestant's answers and the truth, forwards and on the way back.
    std::vector<Ray> forwards;
    std::vector<Ray> backwards;
    for (const Departure& departure : departures) {
        forwards.push_back(departure.ray);
        if (departure.way_back) backwards.push_back(*departure.way_back);
    }
    const JudgedCast ahead = cast_and_judge(tracer, judge, forwards);
    const JudgedCast back = cast_and_judge(tracer, judge, backwards);

    // Count.
    record.trials = departures.size();
    size_t next_back = 0;
    for (size_t i = 0; i < departures.size(); ++i) {
        const Departure& departure = departures[i];
        const Verdict& truth = ahead.verdicts[i];
        const Hit& answer = ahead.cast.hits[i];
        const bool crossed =
            departure.way_back && crossed_another(departure, back.verdicts[next_back++]);
        const char* kind = nullptr;
        if (ahead.cast.flags[i] & kFlagExhausted) {
            kind = kExhausted;
        } else if (same_triangle(departure.from, truth.true_inst_id, truth.true_prim_id)) {
            kind = "self_hit";
        } else if (departure.behind || crossed) {
            kind = "leak";
        } else if (same_triangle(departure.from, answer.inst_id, answer.prim_id)) {
            kind = "false_self_hit";
        }
        if (kind == nullptr) continue;
        add_failure(record, kind);
        keep_first(record, departure.primary, departure.ray, answer, truth);
    }
    if (departures.empty()) record.refusal = "no primary ray hits: nothing to start from";
}

}  // namespace

StressExperiment self_hit_trial(TrialTitle title, std::vector<SelfHitRung> rungs) {
    const auto run = [title, rungs](const StressSetup& setup, const Progress& progress) {
        LadderRecord ladder = empty_record(title);
        Steps step(progress, rungs.size(), setup);
        for (const SelfHitRung& rung : rungs) {
            const auto scene = std::make_shared<const Scene>(rung.make_scene());
            const ShadingScene shading(*scene);
            const auto judge = setup.make_judge(scene);
            ladder.judge = judge->name();
            const std::vector<Ray> primary =
                rays_from_outside(*scene, setup.rays, rung.view_distance, 0.0, setup.seed);
            const bool on = for_each_contestant(
                setup, rung.knob, rung.label, ladder, step,
                [&](const Contestant& contestant, RungRecord& record) {
                    const auto tracer = contestant.entry->make(scene, contestant.params);
                    run_rung(rung, shading, *judge, primary, *tracer, record);
                });
            if (!on) break;
        }
        return ladder;
    };
    return {title.id, title.title, run};
}

}  // namespace onepass
