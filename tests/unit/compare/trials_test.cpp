// Trials over an honest tracer and over tracers broken on purpose: each must be counted, and
// nothing of the honest one.
#include "compare/trials.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "cpu_ref/exact_judge.h"
#include "scenes/shapes.h"
#include "tests/support/brute_tracer.h"

namespace onepass::test {
namespace {

constexpr size_t kRays = 150;

Scene scene_of(Object object) {
    Scene scene;
    scene.objects.push_back(std::move(object));
    scene.instances.push_back({.name = "only", .object = 0, .materials = {0}});
    scene.materials.push_back({});
    scene.lights.push_back({.name = "lamp", .position = vec3(3.0f, 5.0f, 4.0f)});
    validate(scene);
    return scene;
}

Scene ball() { return scene_of(make_sphere(12, 8)); }

/// Two of a ball, one of them mirrored and unevenly scaled, apart from each other.
Scene two_balls() {
    Scene scene = ball();
    Instance second = scene.instances.front();
    second.world_from_object =
        compose(translation(vec3(3.0f, 0.5f, 0.0f)), scaling(vec3(-1.0f, 0.5f, 1.2f)));
    scene.instances.push_back(second);
    return scene;
}

/// A setup with one contestant, which must outlive its use.
struct OneContestant {
    explicit OneContestant(const Sabotage& sabotage = {}) : entry(brute_entry(sabotage)) {
        setup.contestants = {{&entry, {}}};
        setup.make_judge = [](ScenePtr scene) { return make_exact_judge(std::move(scene)); };
        setup.rays = kRays;
        setup.seed = 3;
    }
    CatalogueEntry entry;
    StressSetup setup;
};

LadderRecord run(const StressExperiment& trial, const Sabotage& sabotage = {}) {
    return trial.run(OneContestant(sabotage).setup, {});
}

uint64_t failures(const RungRecord& rung, const std::string& kind) {
    for (const FailureCount& failure : rung.failures) {
        if (failure.kind == kind) return failure.count;
    }
    return 0;
}

TrialTitle title() { return {.id = "t", .title = "T", .question = "Q?", .knob = "k"}; }

// ---- Self-hits

StressExperiment self_hits(float factor, std::function<Scene()> make_scene = ball) {
    return self_hit_trial(
        title(), {{.knob = 1.0, .make_scene = std::move(make_scene), .offset_factor = factor}});
}

TEST(SelfHitTrial, an_honest_tracer_fails_at_no_offset_and_passes_at_the_one_in_use) {
    const LadderRecord sound = run(self_hits(1.0f));
    ASSERT_EQ(sound.rungs.size(), 1u);
    EXPECT_GT(sound.rungs[0].trials, kRays / 2);
    EXPECT_EQ(sound.rungs[0].failed(), 0u);
    EXPECT_FALSE(sound.rungs[0].worst.has_value());
    EXPECT_EQ(sound.judge, make_exact_judge(std::make_shared<Scene>(ball()))->name());

    const RungRecord none = run(self_hits(0.0f)).rungs[0];
    EXPECT_GT(failures(none, "self_hit"), none.trials / 10) << "rounding falls to either side";
    EXPECT_LT(none.failed(), none.trials) << "rounding falls to either side";
    ASSERT_TRUE(none.worst.has_value());
    EXPECT_EQ(none.worst->ray.tmin, 0.0f);
}

TEST(SelfHitTrial, a_tracer_that_goes_back_before_tmin_hits_falsely) {
    const RungRecord rung = run(self_hits(1.0f), {.slack_before_tmin = 0.01f}).rungs[0];
    EXPECT_GT(failures(rung, "false_self_hit"), rung.trials / 4);
    EXPECT_EQ(failures(rung, "self_hit"), 0u) << "the truth is not to blame";
}

/// Two plates that face each other across a gap of 2^-13: eight offsets of a scene of size 1.
Scene narrow_gap() {
    Object plates = make_grid(2, 2);
    append_shape(plates, make_grid(2, 2),
                 compose(translation(vec3(0.0f, 0x1p-13f, 0.0f)), scaling(vec3(1.0f))), "upper");
    plates.normals.clear();
    plates.groups = {{"plates", 0, static_cast<uint32_t>(plates.triangles.size())}};
    return scene_of(std::move(plates));
}

TEST(SelfHitTrial, an_offset_that_leads_across_another_surface_leaks) {
    // From below and above only outer sides are seen: nothing to cross there.
    EXPECT_EQ(run(self_hits(1.0f, narrow_gap)).rungs[0].failed(), 0u);

    // A tracer that does not see the upper plate starts between the two.
    const Sabotage blind{.drops = [](const Hit& hit) { return hit.prim_id >= 8; }};
    const RungRecord within = run(self_hits(1.0f, narrow_gap), blind).rungs[0];
    EXPECT_EQ(failures(within, "leak"), 0u);
    const RungRecord beyond = run(self_hits(64.0f, narrow_gap), blind).rungs[0];
    EXPECT_GT(failures(beyond, "leak"), beyond.trials / 4);
}

TEST(SelfHitTrial, the_offset_in_use_knows_how_far_the_eye_is) {
    const auto from = [](float distance) {
        return self_hit_trial(title(),
                              {{.knob = 1.0, .make_scene = ball, .view_distance = distance}});
    };
    for (const float distance : {1e1f, 1e2f, 1e3f, 1e4f}) {
        const RungRecord rung = run(from(distance)).rungs[0];
        EXPECT_GT(rung.trials, kRays / 2);
        EXPECT_EQ(rung.failed(), 0u) << distance << " sizes away";
    }
}

TEST(SelfHitTrial, an_offset_that_grows_with_the_way_leaks_where_it_is_longer_than_a_gap_is_wide) {
    const Sabotage blind{.drops = [](const Hit& hit) { return hit.prim_id >= 8; }};
    const RungRecord rung =
        run(self_hit_trial(title(),
                           {{.knob = 1.0, .make_scene = narrow_gap, .view_distance = 200.0f}}),
            blind)
            .rungs[0];
    EXPECT_GT(failures(rung, "leak"), rung.trials / 4);
}

// ---- Closed meshes

StressExperiment closed(std::function<Scene()> make_scene) {
    return closed_mesh_trial(title(), {{.knob = 1.0, .make_scene = std::move(make_scene)}});
}

TEST(ClosedMeshTrial, an_honest_tracer_leaves_what_it_entered_mirrored_instances_too) {
    const RungRecord rung = run(closed(two_balls)).rungs[0];
    EXPECT_EQ(rung.trials, kRays);
    EXPECT_EQ(rung.failed(), 0u);
    EXPECT_EQ(rung.ties, 0u);
}

TEST(ClosedMeshTrial, lost_crossings_are_counted_by_what_they_lead_to) {
    const Sabotage holes{.drops = [](const Hit& hit) { return hit.prim_id % 2 == 0; }};
    const RungRecord rung = run(closed(two_balls), holes).rungs[0];
    EXPECT_GT(failures(rung, "left_without_entering"), 0u);
    EXPECT_GT(failures(rung, "never_left"), 0u);
    EXPECT_GT(failures(rung, "entered_twice"), 0u) << "into the second while still in the first";
    EXPECT_EQ(rung.failures.size(), 3u);
}

TEST(ClosedMeshTrial, a_crossing_counted_twice_is_found) {
    const RungRecord rung = run(closed(ball), {.slack_before_tmin = 1e-3f}).rungs[0];
    EXPECT_EQ(failures(rung, "entered_twice"), rung.failed());
    EXPECT_GT(rung.failed(), kRays / 3);
}

TEST(ClosedMeshTrial, crossings_that_floats_cannot_keep_apart_are_ties) {
    const auto foil = [] {
        Object box = make_box(2, 2, 2);
        for (vec3& p : box.positions) p.y *= 0x1p-24f;
        return scene_of(std::move(box));
    };
    const RungRecord rung = run(closed(foil)).rungs[0];
    EXPECT_EQ(rung.failed(), 0u);
    EXPECT_GT(rung.ties, kRays / 10);
}

TEST(ClosedMeshTrial, exhausted_rays_fail_as_such) {
    const Sabotage tired{
        .spoils = [](const Scene&, const Ray&, Hit&, uint32_t& flags) { flags = kFlagExhausted; }};
    const RungRecord rung = run(closed(ball), tired).rungs[0];
    EXPECT_EQ(failures(rung, "exhausted"), kRays);
}

// ---- Changes

std::vector<Change> all_changes() {
    return {far_instance(10.0),         far_instance(1e6),          far_triangles(10.0),
            far_triangles(1e5),         permuted_triangles(),       one_thread(),
            scaled_by_power_of_two(20), scaled_by_power_of_two(-20)};
}

TEST(ChangeTrial, nothing_changes_for_an_honest_tracer) {
    const LadderRecord ladder = run(change_trial(title(), two_balls, all_changes()));
    ASSERT_EQ(ladder.rungs.size(), all_changes().size());
    for (const RungRecord& rung : ladder.rungs) {
        EXPECT_EQ(rung.trials, kRays) << rung.label;
        EXPECT_EQ(rung.failed(), 0u) << rung.label << " " << rung.knob;
    }
}

/// One change, and a tracer that is spoiled.
RungRecord changed_by(const Change& change, Sabotage sabotage,
                      std::function<Scene()> make_scene = two_balls) {
    return run(change_trial(title(), std::move(make_scene), {change}), sabotage).rungs.at(0);
}

TEST(ChangeTrial, a_tracer_whose_t_depends_on_the_scene_is_found_by_the_bit) {
    const Sabotage sensitive{.spoils = [](const Scene& scene, const Ray&, Hit& hit, uint32_t&) {
        if (scene_bounds(scene).magnitude() > 10.0f) hit.t = std::nextafter(hit.t, 0.0f);
    }};
    const RungRecord far = changed_by(far_instance(10.0), sensitive);
    EXPECT_GT(failures(far, "changed_t"), kRays / 4);
    EXPECT_EQ(failures(far, "changed"), 0u);
    EXPECT_EQ(changed_by(permuted_triangles(), sensitive).failed(), 0u);
    EXPECT_GT(failures(changed_by(far_triangles(10.0), sensitive), "changed_t"), kRays / 4);
    EXPECT_GT(failures(changed_by(scaled_by_power_of_two(8), sensitive), "changed_t"), kRays / 4);
    EXPECT_EQ(changed_by(scaled_by_power_of_two(-8), sensitive).failed(), 0u);
}

/// Another triangle of the corner that the hit is at, if it is at one.
uint32_t neighbour_at_corner(const Object& object, const Hit& hit) {
    constexpr float kAtCorner = 0.9999f;
    const float weights[] = {1.0f - hit.u - hit.v, hit.u, hit.v};
    for (int k = 0; k < 3; ++k) {
        if (weights[k] < kAtCorner) continue;
        const uint32_t corner = object.triangles[hit.prim_id][k];
        for (uint32_t id = 0; id < object.triangles.size(); ++id) {
            const uvec3& t = object.triangles[id];
            if (id != hit.prim_id && (t.x == corner || t.y == corner || t.z == corner)) return id;
        }
    }
    return hit.prim_id;
}

TEST(ChangeTrial, a_neighbour_at_a_corner_is_a_tie_at_the_same_t_and_changed_at_another) {
    const auto turning = [](float towards) {
        return Sabotage{.spoils = [towards](const Scene& scene, const Ray&, Hit& hit, uint32_t&) {
            if (scene.instances.size() < 3 || !hit.is_hit()) return;
            const uint32_t id = neighbour_at_corner(scene.objects[0], hit);
            if (id != hit.prim_id) hit.t = std::nextafter(hit.t, towards < 0.0f ? 0.0f : hit.t);
            hit.prim_id = id;
        }};
    };
    const RungRecord same_t = changed_by(far_instance(10.0), turning(0.0f));
    EXPECT_GT(same_t.ties, kRays / 8);
    EXPECT_EQ(failures(same_t, "changed_edge"), 0u);
    const RungRecord other_t = changed_by(far_instance(10.0), turning(-1.0f));
    EXPECT_GT(failures(other_t, "changed_edge"), kRays / 8);
}

TEST(ChangeTrial, a_tracer_whose_answer_depends_on_the_order_is_found) {
    const Sabotage partial{.drops = [](const Hit& hit) { return hit.prim_id < 40; }};
    EXPECT_GT(failures(changed_by(permuted_triangles(), partial), "changed"), kRays / 20);
    EXPECT_EQ(changed_by(one_thread(), partial).failed(), 0u);
}

TEST(ChangeTrial, a_tracer_whose_answer_depends_on_threads_is_found) {
    if (tbb::this_task_arena::max_concurrency() == 1) GTEST_SKIP() << "one core: all is one thread";
    const Sabotage racy{.spoils = [](const Scene&, const Ray&, Hit& hit, uint32_t&) {
        const auto threads =
            tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
        if (threads == 1) hit = {};
    }};
    EXPECT_GT(failures(changed_by(one_thread(), racy), "changed"), kRays / 4);
    EXPECT_EQ(changed_by(permuted_triangles(), racy).failed(), 0u);
}

TEST(ChangeTrial, a_device_whose_threads_are_its_own_refuses) {
    const RungRecord rung = changed_by(one_thread(), {.threads = 0});
    EXPECT_EQ(rung.trials, 0u);
    EXPECT_NE(rung.refusal.find("threads"), std::string::npos) << rung.refusal;
}

TEST(ChangeTrial, coincident_triangles_tie_whichever_is_first) {
    const auto twice = [] {
        Object object = make_sphere(12, 8);
        const std::vector<uvec3> copy = object.triangles;
        object.triangles.insert(object.triangles.end(), copy.begin(), copy.end());
        object.groups[0].triangle_count *= 2;
        return scene_of(std::move(object));
    };
    const RungRecord rung = changed_by(permuted_triangles(), {}, twice);
    EXPECT_EQ(rung.failed(), 0u);
    EXPECT_GT(rung.ties, kRays / 8);
}

TEST(ChangeTrial, a_budget_that_ends_on_one_side_alone_is_found) {
    const Sabotage tired{.spoils = [](const Scene& scene, const Ray&, Hit&, uint32_t& flags) {
        if (scene.instances.size() > 2) flags = kFlagExhausted;
    }};
    EXPECT_EQ(failures(changed_by(far_instance(10.0), tired), "exhausted"), kRays);
}

// ---- Invalid rays

TEST(InvalidRayTrial, misses_pass_and_hits_are_counted_kind_by_kind) {
    const StressExperiment trial = invalid_ray_trial(title(), ball);
    const LadderRecord honest = run(trial);
    ASSERT_EQ(honest.rungs.size(), spoilers().size());
    for (const RungRecord& rung : honest.rungs) {
        EXPECT_EQ(rung.trials, kRays) << rung.label;
        EXPECT_EQ(rung.failed(), 0u) << rung.label;
    }

    // Arithmetic alone, without a look at the ray, lets these through.
    const LadderRecord careless = run(trial, {.takes_any_ray = true});
    const auto false_hits = [&](const std::string& label) {
        const auto rung = std::find_if(careless.rungs.begin(), careless.rungs.end(),
                                       [&](const RungRecord& r) { return r.label == label; });
        return rung == careless.rungs.end() ? uint64_t{0} : failures(*rung, "false_hit");
    };
    EXPECT_GT(false_hits("negative tmin"), kRays / 2);
    EXPECT_GT(false_hits("NaN tmin"), kRays / 2);
    EXPECT_GT(false_hits("NaN tmax"), kRays / 2);

    const Sabotage eager{.spoils = [](const Scene&, const Ray&, Hit& hit, uint32_t&) {
        hit = {1.0f, 0.0f, 0.0f, 0, 0};
    }};
    for (const RungRecord& rung : run(trial, eager).rungs) {
        EXPECT_EQ(failures(rung, "false_hit"), kRays) << rung.label << " is no invalid ray";
    }
}

TEST(InvalidRayTrial, exhaustion_fails_and_shielded_rays_are_no_trials) {
    const StressExperiment trial = invalid_ray_trial(title(), ball);
    const auto flagging = [](uint32_t flag) {
        return Sabotage{
            .spoils = [flag](const Scene&, const Ray&, Hit&, uint32_t& flags) { flags = flag; }};
    };
    EXPECT_EQ(failures(run(trial, flagging(kFlagExhausted)).rungs[0], "exhausted"), kRays);
    const RungRecord shielded = run(trial, flagging(kFlagOracleInvalid)).rungs[0];
    EXPECT_EQ(shielded.trials, 0u);
    EXPECT_EQ(shielded.refusal, "takes 0 of 150 rays");
}

// ---- All of them

TEST(Trials, stopped_early_they_return_whole_rungs) {
    OneContestant one;
    one.setup.contestants.push_back(one.setup.contestants[0]);
    const StressExperiment trial = closed_mesh_trial(
        title(), {{.knob = 1.0, .make_scene = ball}, {.knob = 2.0, .make_scene = ball}});
    const LadderRecord ladder = trial.run(one.setup, [](double done) { return done < 0.7; });
    ASSERT_EQ(ladder.rungs.size(), 2u) << "both contestants on the first rung, none on the second";
    EXPECT_EQ(ladder.rungs[1].knob, 1.0);
}

TEST(Trials, a_tracer_that_refuses_a_scene_says_why) {
    OneContestant one;
    one.entry.make = [](ScenePtr, const ParamValues&) -> std::unique_ptr<Tracer> {
        throw Error({"its buffers", "too much", "less", "Ask for less."});
    };
    const RungRecord rung = self_hits(1.0f).run(one.setup, {}).rungs.at(0);
    EXPECT_EQ(rung.trials, 0u);
    EXPECT_EQ(rung.refusal, "its buffers: too much");
}

TEST(Trials, a_cast_that_ends_with_an_error_fails_every_ray_of_the_rung) {
    const Sabotage out_of_range{.spoils = [](const Scene&, const Ray&, Hit&, uint32_t&) {
        throw Error({"fetch", "texel 9", "8 at most", ""});
    }};
    for (const StressExperiment& trial :
         {self_hits(1.0f), closed(ball), change_trial(title(), two_balls, {far_instance(10.0)}),
          invalid_ray_trial(title(), ball)}) {
        const RungRecord rung = run(trial, out_of_range).rungs.at(0);
        EXPECT_EQ(rung.trials, kRays);
        EXPECT_EQ(failures(rung, "gave_up"), kRays);
        EXPECT_EQ(rung.refusal, "");
    }
}

TEST(Trials, a_cast_that_ends_with_an_error_takes_back_what_was_counted_before) {
    const Sabotage second_cast{
        .spoils = [casts = std::make_shared<size_t>(0)](const Scene&, const Ray&, Hit&, uint32_t&) {
            if (++*casts > kRays) throw Error({"fetch", "texel 9", "8 at most", ""});
        }};
    const RungRecord rung = run(closed(ball), second_cast).rungs.at(0);
    EXPECT_EQ(rung.trials, kRays);
    EXPECT_EQ(failures(rung, "gave_up"), kRays);
    EXPECT_EQ(rung.failures.size(), 1u);
}

}  // namespace
}  // namespace onepass::test
