// The same rays before and after a change that must not matter. See change_trial().
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <tbb/global_control.h>

#include "compare/trials/common.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

using namespace trials;

/// Origins are so many diagonals from the centre, and a ray ends after so many lengths of its
/// direction: beyond the box, which it leaves after (1 + 1/2) / (1 - 1/2) = 3 of them at the
/// latest, and, at most 4 * 3/2 diagonals long, well before what is 10 diagonals away.
constexpr float kViewDistance = 1.0f;
constexpr float kReach = 4.0f;

Ray same_ray(const Ray& ray) { return ray; }
Hit same_hit(const Hit& hit) { return hit; }

/// Where the far copy goes: along no axis, so that no coordinate stays as it was.
vec3 far_away(const Scene& scene, double diagonals) {
    const vec3 along = glm::normalize(vec3(1.0f, -0.6f, 0.4f));
    return along * static_cast<float>(diagonals * double{scene_bounds(scene).diagonal()});
}

/// Objects with their triangles in random order; old_ids[object][new id] is the old id.
std::vector<std::vector<uint32_t>> permute(Scene& scene, uint64_t seed) {
    Random random(seed);
    std::vector<std::vector<uint32_t>> old_ids;
    for (Object& object : scene.objects) {
        std::vector<uint32_t> order(object.triangles.size());
        std::iota(order.begin(), order.end(), 0u);
        random.shuffle(std::span(order));
        std::vector<uvec3> triangles;
        for (const uint32_t id : order) triangles.push_back(object.triangles[id]);
        object.triangles = std::move(triangles);
        old_ids.push_back(std::move(order));
    }
    return old_ids;
}

/// Appends a moved copy of an object's triangles to it, to its last group.
void append_far_copy(Object& object, const vec3& offset) {
    const auto corners = static_cast<uint32_t>(object.positions.size());
    const size_t triangles = object.triangles.size();
    for (uint32_t i = 0; i < corners; ++i) {
        object.positions.push_back(object.positions[i] + offset);
        if (!object.normals.empty()) object.normals.push_back(object.normals[i]);
    }
    for (size_t i = 0; i < triangles; ++i) {
        object.triangles.push_back(object.triangles[i] + uvec3(corners));
    }
    object.groups.back().triangle_count += static_cast<uint32_t>(triangles);
}

/// Equal bit by bit: t and ids.
bool same_hit_bits(const Hit& a, const Hit& b) {
    return std::bit_cast<uint32_t>(a.t) == std::bit_cast<uint32_t>(b.t) && a.prim_id == b.prim_id &&
           a.inst_id == b.inst_id;
}

/// The rays of a rung with what was answered before and after, hits brought back.
struct BeforeAfter {
    const std::vector<Ray>& rays;
    CastResult before;
    CastResult after;
};

void compare(const BeforeAfter& casts, const Judge& judge, RungRecord& record) {
    record.trials = casts.rays.size();
    for (size_t i = 0; i < casts.rays.size(); ++i) {
        const Hit& before = casts.before.hits[i];
        const Hit& after = casts.after.hits[i];
        if ((casts.before.flags[i] ^ casts.after.flags[i]) & kFlagExhausted) {
            add_failure(record, kExhausted);
            continue;
        }
        if (same_hit_bits(before, after)) continue;

        const std::array<Hit, 2> answers = {before, after};
        const std::vector<Verdict> verdicts = judge.judge(casts.rays[i], Query::closest, answers);
        const auto both = [&](const auto& is) { return is(verdicts[0]) && is(verdicts[1]); };
        const bool no_error = both([](const Verdict& v) { return !is_error(v.hit_class); });
        const bool right = both([](const Verdict& v) {
            return v.hit_class == HitClass::agree || v.hit_class == HitClass::tie;
        });
        const bool same_ids = before.prim_id == after.prim_id && before.inst_id == after.inst_id;
        if (!same_ids && (right || (no_error && before.t == after.t))) {
            ++record.ties;
            continue;
        }
        add_failure(record, !no_error ? "changed" : same_ids ? "changed_t" : "changed_edge");
        keep_first(record, i, casts.rays[i], after, verdicts[1]);
    }
}

/// Holds TBB to one thread while it lives; what builds and traces on the CPU here uses TBB.
struct OneThread {
    tbb::global_control limit{tbb::global_control::max_allowed_parallelism, 1};
};

CastResult cast_changed(const Contestant& contestant, const ScenePtr& scene, const Change& change,
                        const ChangedScene& changed, const std::vector<Ray>& rays) {
    std::optional<OneThread> alone;
    if (change.one_thread) alone.emplace();
    const auto tracer = contestant.entry->make(scene, contestant.params);
    if (change.one_thread && tracer->capabilities().threads == 0) {
        throw Error({tracer->name(), "a device whose threads are not this process's",
                     "a tracer on the CPU", "Leave this change to the others."});
    }
    std::vector<Ray> there;
    for (const Ray& ray : rays) there.push_back(changed.ray_there(ray));
    CastResult cast = cast_closest(*tracer, there);
    for (Hit& hit : cast.hits) hit = changed.hit_back(hit);
    return cast;
}

}  // namespace

Change far_instance(double diagonals) {
    const auto make = [diagonals](const Scene& scene, uint64_t) {
        ChangedScene changed{scene, same_ray, same_hit};
        Instance copy = scene.instances.front();
        copy.name = "far copy";
        copy.world_from_object[3] += far_away(scene, diagonals);
        changed.scene.instances.push_back(copy);
        return changed;
    };
    return {.knob = diagonals, .make = make};
}

Change far_triangles(double diagonals) {
    const auto make = [diagonals](const Scene& scene, uint64_t) {
        ChangedScene changed{scene, same_ray, same_hit};
        append_far_copy(changed.scene.objects.front(), far_away(scene, diagonals));
        return changed;
    };
    return {.knob = diagonals, .make = make};
}

Change permuted_triangles() {
    const auto make = [](const Scene& scene, uint64_t seed) {
        ChangedScene changed{scene, same_ray, same_hit};
        const auto old_ids = permute(changed.scene, seed);
        changed.hit_back = [old_ids, instances = scene.instances](const Hit& hit) {
            Hit back = hit;
            if (hit.is_hit()) {
                back.prim_id = old_ids.at(instances.at(hit.inst_id).object).at(hit.prim_id);
            }
            return back;
        };
        return changed;
    };
    return {.label = "triangles permuted", .make = make};
}

Change scaled_by_power_of_two(int exponent) {
    const auto make = [exponent](const Scene& scene, uint64_t) {
        const float factor = std::ldexp(1.0f, exponent);
        const float back = std::ldexp(1.0f, -exponent);
        ChangedScene changed{scene, {}, {}};
        for (Object& object : changed.scene.objects) {
            for (vec3& p : object.positions) p *= factor;
        }
        for (Instance& instance : changed.scene.instances) instance.world_from_object[3] *= factor;
        changed.ray_there = [factor](const Ray& ray) {
            return Ray{ray.org * factor, ray.tmin * factor, ray.dir, ray.tmax * factor};
        };
        changed.hit_back = [back](const Hit& hit) {
            Hit result = hit;
            result.t *= back;
            return result;
        };
        return changed;
    };
    return {.label = "scaled by 2^" + std::to_string(exponent), .make = make};
}

Change one_thread() {
    const auto make = [](const Scene& scene, uint64_t) {
        return ChangedScene{scene, same_ray, same_hit};
    };
    return {.label = "one thread", .make = make, .one_thread = true};
}

StressExperiment change_trial(TrialTitle title, std::function<Scene()> make_scene,
                              std::vector<Change> changes) {
    const auto run = [title, make_scene, changes](const StressSetup& setup,
                                                  const Progress& progress) {
        LadderRecord ladder = empty_record(title);
        const auto scene = std::make_shared<const Scene>(make_scene());
        const auto judge = setup.make_judge(scene);
        ladder.judge = judge->name();
        constexpr double kAtCorners = 0.5;
        std::vector<Ray> rays =
            rays_from_outside(*scene, setup.rays, kViewDistance, kAtCorners, setup.seed);
        for (Ray& ray : rays) ray.tmax = kReach;

        Steps step(progress, changes.size(), setup);
        for (const Change& change : changes) {
            const ChangedScene changed = change.make(*scene, setup.seed);
            const auto changed_scene = std::make_shared<const Scene>(changed.scene);
            const bool on = for_each_contestant(
                setup, change.knob, change.label, ladder, step,
                [&](const Contestant& contestant, RungRecord& record) {
                    CastResult after =
                        cast_changed(contestant, changed_scene, change, changed, rays);
                    const auto tracer = contestant.entry->make(scene, contestant.params);
                    compare({rays, cast_closest(*tracer, rays), std::move(after)}, *judge, record);
                });
            if (!on) break;
        }
        return ladder;
    };
    return {title.id, title.title, run};
}

}  // namespace onepass
