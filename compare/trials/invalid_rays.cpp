// Rays that are a miss by definition. See invalid_ray_trial().
#include <limits>

#include <fmt/format.h>

#include "compare/trials/common.h"

namespace onepass {
namespace {

using namespace trials;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kViewDistance = 1.0f;

/// The bad value in x, y, z, all of them, by turns; an infinity with either sign.
vec3 spoiled(const vec3& good, float bad, uint64_t index) {
    vec3 result = good;
    const uint64_t place = index % 4;
    const float value = index % 8 < 4 ? bad : -bad;
    for (int k = 0; k < 3; ++k) {
        if (place == 3 || place == static_cast<uint64_t>(k)) result[k] = value;
    }
    return result;
}

Spoiler spoil_origin(const std::string& label, float bad) {
    return {label, [bad](const Ray& good, uint64_t index) {
                Ray ray = good;
                ray.org = spoiled(good.org, bad, index);
                return ray;
            }};
}

Spoiler spoil_direction(const std::string& label, float bad) {
    return {label, [bad](const Ray& good, uint64_t index) {
                Ray ray = good;
                ray.dir = spoiled(good.dir, bad, index);
                return ray;
            }};
}

Spoiler with_interval(const std::string& label, float tmin, float tmax) {
    return {label, [tmin, tmax](const Ray& good, uint64_t) {
                return Ray{good.org, tmin, good.dir, tmax};
            }};
}

void count(const std::vector<Ray>& rays, const JudgedCast& answers, RungRecord& record) {
    for (size_t i = 0; i < rays.size(); ++i) {
        if (answers.cast.flags[i] & kFlagOracleInvalid) continue;
        ++record.trials;
        const bool exhausted = (answers.cast.flags[i] & kFlagExhausted) != 0;
        const Verdict& verdict = answers.verdicts[i];
        if (!exhausted && !is_error(verdict.hit_class)) continue;
        add_failure(record, exhausted ? kExhausted : to_string(verdict.hit_class));
        keep_first(record, i, rays[i], answers.cast.hits[i], verdict);
    }
    if (record.trials < rays.size()) {
        record.refusal = fmt::format("takes {} of {} rays", record.trials, rays.size());
    }
}

}  // namespace

const std::vector<Spoiler>& spoilers() {
    static const std::vector<Spoiler> kSpoilers = {
        spoil_origin("NaN origin", kNaN),
        spoil_origin("infinite origin", kInfinity),
        spoil_direction("NaN direction", kNaN),
        spoil_direction("infinite direction", kInfinity),
        with_interval("NaN tmin", kNaN, kInfinity),
        with_interval("infinite tmin", kInfinity, kInfinity),
        with_interval("NaN tmax", 0.0f, kNaN),
        with_interval("tmax of minus infinity", 0.0f, -kInfinity),
        {"no direction",
         [](const Ray& good, uint64_t index) {
             const float zero = index % 2 == 0 ? 0.0f : -0.0f;
             return Ray{good.org, good.tmin, vec3(zero), good.tmax};
         }},
        with_interval("reversed interval", 2.0f, 0.5f),
        with_interval("negative tmin", -1.0f, kInfinity),
    };
    return kSpoilers;
}

StressExperiment invalid_ray_trial(TrialTitle title, std::function<Scene()> make_scene) {
    const auto run = [title, make_scene](const StressSetup& setup, const Progress& progress) {
        LadderRecord ladder = empty_record(title);
        const auto scene = std::make_shared<const Scene>(make_scene());
        const auto judge = setup.make_judge(scene);
        ladder.judge = judge->name();
        const std::vector<Ray> good =
            rays_from_outside(*scene, setup.rays, kViewDistance, 1.0, setup.seed);

        Steps step(progress, spoilers().size(), setup);
        double knob = 0.0;
        for (const Spoiler& spoiler : spoilers()) {
            std::vector<Ray> rays;
            for (const Ray& ray : good) rays.push_back(spoiler.spoil(ray, rays.size()));
            knob += 1.0;
            const bool on = for_each_contestant(
                setup, knob, spoiler.label, ladder, step,
                [&](const Contestant& contestant, RungRecord& record) {
                    const auto tracer = contestant.entry->make(scene, contestant.params);
                    const JudgedCast answers = cast_and_judge(*tracer, *judge, rays);
                    count(rays, answers, record);
                });
            if (!on) break;
        }
        return ladder;
    };
    return {title.id, title.title, run};
}

}  // namespace onepass
