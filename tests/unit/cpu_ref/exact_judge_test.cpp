// The exact judge against tracers broken on purpose: every class gets its name.
#include "cpu_ref/exact_judge.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cpu_ref/embree_scene.h"
#include "cpu_ref/exact_truth.h"
#include "tests/unit/cpu_ref/meshes.h"

namespace onepass {

/// GoogleTest prints classes by name.
void PrintTo(HitClass hit_class, std::ostream* out) { *out << to_string(hit_class); }

namespace {

using namespace test;

constexpr float kUlp = std::numeric_limits<float>::epsilon();  // of 1

Hit hit(float t, uint32_t prim_id, uint32_t inst_id = 0) {
    return {.t = t, .u = 0.0f, .v = 0.0f, .prim_id = prim_id, .inst_id = inst_id};
}

/// Judges one answer.
struct Bench {
    ScenePtr scene;
    std::unique_ptr<Judge> judge;

    explicit Bench(const ScenePtr& s) : scene(s), judge(make_exact_judge(s)) {}
    Verdict verdict(const Ray& ray, const Hit& answer, Query query = Query::closest) const {
        return judge->judge(ray, query, std::span(&answer, 1))[0];
    }
    HitClass hit_class(const Ray& ray, const Hit& answer, Query query = Query::closest) const {
        return verdict(ray, answer, query).hit_class;
    }
};

/// Squares at z = 0 (half size 1, triangles 0 and 1) and z = -1 (half size 2, triangles 2 and 3).
/// Triangle 0 is below the diagonal y = x.
Bench two_squares() {
    Object object;
    add_square(object, 1.0f, 0.0f);
    add_square(object, 2.0f, -1.0f);
    return Bench(one_object(object));
}

Bench one_square() {
    Object object;
    add_square(object, 1.0f, 0.0f);
    return Bench(one_object(object));
}

/// Down along z from z = 1.
Ray down(float x, float y) { return {.org = {x, y, 1}, .dir = {0, 0, -1}}; }

TEST(ExactJudge, right_answers_agree) {
    const Bench bench = two_squares();
    const Verdict front = bench.verdict(down(0.5f, 0.25f), hit(1.0f, 0));
    EXPECT_EQ(front.hit_class, HitClass::agree);
    EXPECT_EQ(front.true_t, 1.0);
    EXPECT_EQ(front.true_prim_id, 0u);
    EXPECT_EQ(front.true_inst_id, 0u);
    EXPECT_EQ(front.t_error_ulps, 0.0);
    EXPECT_EQ(front.backward_error, 0.0);
    EXPECT_EQ(bench.hit_class(down(1.5f, 0.25f), hit(2.0f, 2)), HitClass::agree);
    const Verdict miss = bench.verdict(down(3, 0), Hit{});
    EXPECT_EQ(miss.hit_class, HitClass::agree);
    EXPECT_EQ(miss.true_t, std::numeric_limits<double>::infinity());
    EXPECT_EQ(miss.true_prim_id, kNoId);
}

TEST(ExactJudge, a_shifted_t_is_an_edge_within_the_reach_and_a_t_error_beyond) {
    // t may be off by 16 ulps; E_ray moves the plane's t by 4 ulps of origin and 4 of direction.
    const Bench bench = one_square();
    const Ray ray = down(0.5f, 0.25f);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f + 16 * kUlp, 0)), HitClass::agree);
    const Verdict edge = bench.verdict(ray, hit(1.0f + 20 * kUlp, 0));
    EXPECT_EQ(edge.hit_class, HitClass::edge);
    EXPECT_GT(edge.backward_error, 0.0);
    EXPECT_LE(edge.backward_error, 1.0);
    EXPECT_EQ(edge.t_error_ulps, 20.0);
    // Only what exceeds the 16 ulps needs a move: 2 of the 8 ulps.
    EXPECT_NEAR(bench.verdict(ray, hit(1.0f + 18 * kUlp, 0)).backward_error, 2.0 / 8.0, 0.05);
    const Verdict error = bench.verdict(ray, hit(1.0f + 32 * kUlp, 0));
    EXPECT_EQ(error.hit_class, HitClass::t_error);
    EXPECT_EQ(error.t_error_ulps, 32.0);
    EXPECT_EQ(error.backward_error, std::numeric_limits<double>::infinity());
    EXPECT_EQ(bench.hit_class(ray, hit(1.001f, 0)), HitClass::t_error);
    EXPECT_EQ(bench.hit_class(ray, hit(kInfinity, 0)), HitClass::t_error);
}

TEST(ExactJudge, a_lost_surface_is_a_false_miss) {
    const Bench bench = two_squares();
    EXPECT_EQ(bench.hit_class(down(0.5f, 0.25f), Hit{}), HitClass::false_miss);
    EXPECT_EQ(bench.hit_class(down(1.5f, 0.25f), Hit{}), HitClass::false_miss);
}

TEST(ExactJudge, the_surface_behind_is_a_wrong_surface) {
    const Bench bench = two_squares();
    const Verdict verdict = bench.verdict(down(0.5f, 0.25f), hit(2.0f, 2));
    EXPECT_EQ(verdict.hit_class, HitClass::wrong_surface);
    EXPECT_EQ(verdict.t_error_ulps, 0.0);  // its own t is right
    EXPECT_EQ(verdict.true_prim_id, 0u);
    EXPECT_EQ(bench.hit_class(down(0.5f, 0.25f), hit(1.0f, 1)), HitClass::wrong_surface);
}

TEST(ExactJudge, a_hit_in_empty_space_is_a_false_hit) {
    const Bench bench = two_squares();
    EXPECT_EQ(bench.hit_class(down(3, 0), hit(2.0f, 2)), HitClass::false_hit);
    EXPECT_TRUE(std::isnan(bench.verdict(down(3, 0), hit(2.0f, 2)).t_error_ulps));
}

TEST(ExactJudge, coincident_duplicates_tie) {
    Object object;
    add_square(object, 1.0f, 0.0f);
    add_square(object, 1.0f, 0.0f);
    const Bench bench(one_object(object));
    const Ray ray = down(0.5f, 0.25f);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::agree);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 2)), HitClass::tie);
    EXPECT_EQ(bench.hit_class(ray, hit(1.5f, 2)), HitClass::t_error);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 3)), HitClass::wrong_surface);
}

TEST(ExactJudge, a_ray_through_a_shared_edge_ties_and_one_beside_it_is_an_edge) {
    const Bench bench = one_square();
    const Ray through = down(0.25f, 0.25f);
    EXPECT_EQ(bench.hit_class(through, hit(1.0f, 0)), HitClass::agree);
    EXPECT_EQ(bench.hit_class(through, hit(1.0f, 1)), HitClass::tie);
    const Ray beside = down(0.25f, std::nextafter(0.25f, 1.0f));
    EXPECT_EQ(bench.hit_class(beside, hit(1.0f, 1)), HitClass::agree);
    const Verdict other = bench.verdict(beside, hit(1.0f, 0));
    EXPECT_EQ(other.hit_class, HitClass::edge);
    // The gap of 2^-25 is shared by origin and direction, each of which reaches 4 ulps of 1. The
    // nearest point of the diagonal takes half of it in x and half in y.
    EXPECT_NEAR(other.backward_error, 0.5 * 0x1p-25 / (8 * kUlp), 1e-6);
}

TEST(ExactJudge, a_ray_at_a_corner_ties_with_every_triangle_around_it) {
    Object fan;
    fan.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    fan.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    const Bench bench(one_object(fan));
    EXPECT_EQ(bench.hit_class(down(0, 0), hit(1.0f, 0)), HitClass::agree);
    for (const uint32_t prim_id : {1u, 2u, 3u}) {
        EXPECT_EQ(bench.hit_class(down(0, 0), hit(1.0f, prim_id)), HitClass::tie);
        EXPECT_FALSE(is_error(bench.hit_class(down(1e-8f, 2e-8f), hit(1.0f, prim_id))));
    }
    EXPECT_EQ(bench.hit_class(down(0, 0), Hit{}), HitClass::false_miss);
}

TEST(ExactJudge, a_miss_at_a_silhouette_is_an_edge_within_the_reach_only) {
    const Bench bench = one_square();
    const Verdict grazing = bench.verdict(down(1.0f - 2 * kUlp, 0.25f), Hit{});
    EXPECT_EQ(grazing.hit_class, HitClass::edge);
    EXPECT_NEAR(grazing.backward_error, 2.0 / 8.0, 1e-3);
    EXPECT_EQ(bench.hit_class(down(1.0f - 16 * kUlp, 0.25f), Hit{}), HitClass::false_miss);
    // The other way round: a hit just outside.
    EXPECT_EQ(bench.hit_class(down(1.0f + 2 * kUlp, 0.25f), hit(1.0f, 0)), HitClass::edge);
    EXPECT_EQ(bench.hit_class(down(1.0f + 16 * kUlp, 0.25f), hit(1.0f, 0)), HitClass::false_hit);
}

TEST(ExactJudge, a_surface_seen_past_a_silhouette_is_an_edge_within_the_reach_only) {
    const Bench bench = two_squares();
    EXPECT_EQ(bench.hit_class(down(1.0f - 2 * kUlp, 0.25f), hit(2.0f, 2)), HitClass::edge);
    EXPECT_EQ(bench.hit_class(down(1.0f - 40 * kUlp, 0.25f), hit(2.0f, 2)),
              HitClass::wrong_surface);
    EXPECT_EQ(bench.hit_class(down(1.0f + 2 * kUlp, 0.25f), hit(1.0f, 0)), HitClass::edge);
}

TEST(ExactJudge, a_crack_in_a_closed_mesh_is_a_false_miss_never_an_edge) {
    const Bench bench(one_object(make_sphere(24, 16, 1.0f, vec3(0.5f, 2, -1))));
    // From inside, so that no silhouette is near.
    Random random(7);
    for (const Ray& aimed : edge_rays(*bench.scene, 200, 8)) {
        Ray ray = aimed;
        const vec3 target = ray.org + ray.dir;
        ray.org = vec3(0.5f, 2, -1) + random.in_box({vec3(-0.4f), vec3(0.4f)});
        ray.dir = target - ray.org;
        EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::false_miss);
    }
}

TEST(ExactJudge, equality_with_tmin_or_tmax_ties) {
    const Bench bench = two_squares();
    Ray ray = down(0.5f, 0.25f);
    ray.tmin = 1.0f;
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::agree);
    EXPECT_EQ(bench.hit_class(ray, hit(2.0f, 2)), HitClass::tie);
    EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::false_miss);
    ray = down(0.5f, 0.25f);
    ray.tmax = 1.0f;
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::agree);
    EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::tie);
    ray.tmax = 1.0f + 2 * kUlp;
    EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::edge);
    ray.tmax = 1.0f - 2 * kUlp;
    EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::agree);
    EXPECT_EQ(bench.hit_class(ray, hit(ray.tmax, 0)), HitClass::edge);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::false_hit) << "t beyond tmax";
    ray.tmax = 1.0f - 40 * kUlp;
    EXPECT_EQ(bench.hit_class(ray, hit(ray.tmax, 0)), HitClass::false_hit);
}

TEST(ExactJudge, a_t_outside_the_interval_is_no_answer) {
    const Bench bench = two_squares();
    Ray ray = down(0.5f, 0.25f);
    ray.tmin = 1.0f - kUlp;
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::agree);
    EXPECT_EQ(bench.hit_class(ray, hit(1.0f - 4 * kUlp, 0)), HitClass::t_error);
}

TEST(ExactJudge, answers_that_cannot_be_are_errors) {
    const Bench bench = two_squares();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Ray hits = down(0.5f, 0.25f);
    const Ray misses = down(3, 0);
    EXPECT_EQ(bench.hit_class(hits, hit(nan, 0)), HitClass::t_error);
    EXPECT_EQ(bench.hit_class(hits, hit(1.0f, 4)), HitClass::wrong_surface);
    EXPECT_EQ(bench.hit_class(hits, hit(1.0f, 0, 1)), HitClass::wrong_surface);
    EXPECT_EQ(bench.hit_class(hits, hit(1.0f, kNoId)), HitClass::wrong_surface);
    EXPECT_EQ(bench.hit_class(misses, hit(1.0f, 0, 77)), HitClass::false_hit);
    EXPECT_EQ(bench.hit_class(misses, hit(nan, 0)), HitClass::false_hit);
    EXPECT_TRUE(std::isnan(bench.verdict(hits, hit(nan, 0)).t_error_ulps));
}

TEST(ExactJudge, any_asks_only_whether_something_is_hit) {
    const Bench bench = two_squares();
    const auto any = [&](const Ray& ray, const Hit& answer) {
        return bench.hit_class(ray, answer, Query::any);
    };
    const Hit nameless = hit(0.0f, 0);
    EXPECT_EQ(any(down(0.5f, 0.25f), nameless), HitClass::agree);
    EXPECT_EQ(any(down(0.5f, 0.25f), Hit{}), HitClass::false_miss);
    EXPECT_EQ(any(down(3, 0), Hit{}), HitClass::agree);
    EXPECT_EQ(any(down(3, 0), nameless), HitClass::false_hit);
    EXPECT_EQ(any(down(2.0f - 4 * kUlp, 0.25f), Hit{}), HitClass::edge);
    EXPECT_EQ(any(down(2.0f + 4 * kUlp, 0.25f), nameless), HitClass::edge);
    Ray ray = down(1.5f, 0.25f);
    ray.tmax = 2.0f;
    EXPECT_EQ(any(ray, nameless), HitClass::agree);
    EXPECT_EQ(any(ray, Hit{}), HitClass::tie);
    ray.tmax = 2.0f - 4 * kUlp;
    EXPECT_EQ(any(ray, nameless), HitClass::edge);
}

TEST(ExactJudge, degenerate_and_edge_on_triangles_are_never_hit) {
    Object object;
    add_triangle(object, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});   // a line
    add_triangle(object, {0, 0, 0}, {0, 0, 0}, {0, 1, 0});   // two equal corners
    add_triangle(object, {0, 0, 0}, {0, 1, 0}, {0, 0, -1});  // in the plane x = 0
    const Bench bench(one_object(object));
    EXPECT_EQ(bench.hit_class(down(1, 0), Hit{}), HitClass::agree);
    EXPECT_EQ(bench.hit_class(down(0, 0.5f), Hit{}), HitClass::agree);
    EXPECT_EQ(bench.hit_class(down(1, 0), hit(1.0f, 0)), HitClass::false_hit);
}

TEST(ExactJudge, corners_on_a_slanted_line_make_no_surface) {
    Object object;
    add_triangle(object, {0, 0, 0}, {1, 3, 7}, {2, 6, 14});
    add_square(object, 20.0f, -5.0f);
    const auto scene = one_object(object);
    const CandidateSearch candidates(scene);
    const ExactTruth truth(candidates);
    Random random(14);
    for (int i = 0; i < 1000; ++i) {
        const vec3 from = random.in_box({vec3(-5, -5, 3), vec3(5, 5, 9)});
        const SpreadRay ray = exact_ray(ray_between(from, vec3(1, 3, 7) * random.unit()));
        EXPECT_EQ(truth.find(ray).find(0, 0), nullptr);
    }
}

TEST(ExactJudge, rays_that_are_no_rays_miss) {
    const Bench bench = one_square();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays(5, down(0.5f, 0.25f));
    rays[0].org.x = nan;
    rays[1].dir.y = kInfinity;
    rays[2].dir = vec3(0);
    rays[3].tmin = 2.0f;
    rays[3].tmax = 1.0f;
    rays[4].tmax = nan;
    for (const Ray& ray : rays) {
        EXPECT_EQ(bench.hit_class(ray, Hit{}), HitClass::agree);
        EXPECT_EQ(bench.hit_class(ray, hit(1.0f, 0)), HitClass::false_hit);
    }
}

TEST(ExactJudge, one_call_judges_all_answers_in_order) {
    const Bench bench = two_squares();
    const std::array<Hit, 3> answers = {hit(2.0f, 2), hit(1.0f, 0), Hit{}};
    const auto verdicts = bench.judge->judge(down(0.5f, 0.25f), Query::closest, answers);
    ASSERT_EQ(verdicts.size(), 3u);
    EXPECT_EQ(verdicts[0].hit_class, HitClass::wrong_surface);
    EXPECT_EQ(verdicts[1].hit_class, HitClass::agree);
    EXPECT_EQ(verdicts[2].hit_class, HitClass::false_miss);
}

TEST(ExactJudge, closed_meshes_have_no_crack_in_its_own_arithmetic) {
    const auto scene = one_object(make_sphere(48, 32, 1.0f, vec3(1000, -3, 0.1f)));
    const CandidateSearch candidates(scene);
    const ExactTruth truth(candidates);
    for (const Ray& aimed : edge_rays(*scene, 20000, 9)) {
        Ray ray = aimed;
        const vec3 target = ray.org + ray.dir;
        ray.org = vec3(1000, -3, 0.1f);
        ray.dir = target - ray.org;
        ASSERT_TRUE(truth.find(exact_ray(ray)).nearest.has_value());
    }
}

/// Answers each ray with the truth about another ray of its E_ray; returns how many of those the
/// judge calls errors, wrongly.
size_t over_reported(const ScenePtr& scene, const std::vector<Ray>& rays) {
    const CandidateSearch candidates(scene);
    const ExactTruth truth(candidates);
    const auto judge = make_exact_judge(scene);
    Random random(15);
    size_t errors = 0;
    for (const Ray& ray : rays) {
        SpreadRay moved = e_ray(ray, candidates.magnitude());
        for (int k = 0; k < 3; ++k) {
            moved.org[k] += moved.org_reach * (2.0 * random.unit() - 1.0);
            moved.dir[k] += moved.dir_reach * (2.0 * random.unit() - 1.0);
        }
        Hit answer;
        if (const auto nearest = truth.find(moved).nearest) {
            answer =
                hit(static_cast<float>(nearest->crossing.t), nearest->prim_id, nearest->inst_id);
        }
        const Verdict v = judge->judge(ray, Query::closest, std::span(&answer, 1))[0];
        errors += is_error(v.hit_class) ? 1 : 0;
    }
    return errors;
}

TEST(ExactJudge, answers_right_for_a_ray_nearby_are_not_called_errors) {
    // The search is bounded, so it may miss a witness; it must not do so often enough to drown real
    // errors.
    Scene disc = *one_object(make_sphere(96, 64, 1.0f, vec3(0)));
    disc.instances[0].world_from_object[2] *= 1e-3f;  // nearly every ray grazes it
    for (const ScenePtr& scene :
         {one_object(make_sphere(96, 64, 1.0f, vec3(0))), checked(disc), instanced_spheres()}) {
        EXPECT_EQ(over_reported(scene, edge_rays(*scene, 20000, 16)), 0u);
        EXPECT_EQ(over_reported(scene, random_rays(*scene, 20000, 17)), 0u);
    }
}

/// Counts Embree's errors on the rays and expects at most this many.
void expect_embree_errors(const ScenePtr& scene, const std::vector<Ray>& rays, size_t most) {
    const EmbreeScene embree(*scene, {});
    const auto judge = make_exact_judge(scene);
    size_t hits = 0;
    size_t errors = 0;
    std::string worst;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Hit answer = embree.closest(rays[i]);
        hits += answer.is_hit() ? 1 : 0;
        const Verdict v = judge->judge(rays[i], Query::closest, std::span(&answer, 1))[0];
        if (!is_error(v.hit_class)) continue;
        ++errors;
        worst = fmt::format("ray {}: {}, t {} of triangle {}, truth {} of {}, {} ulps", i,
                            to_string(v.hit_class), answer.t, answer.prim_id, v.true_t,
                            v.true_prim_id, v.t_error_ulps);
    }
    EXPECT_LE(errors, most) << worst;
    EXPECT_GT(hits, rays.size() / 50);
}

/// Rays aimed at corners and edges that Embree's robust mode may get wrong, of 1000. Its edge
/// functions are not consistent at a corner, so that all triangles around one can refuse a ray:
/// measured 3 to 4 of 1000, rays from inside a closed sphere among them.
constexpr size_t kCornerLeaksPerMille = 10;

TEST(ExactJudge, embree_robust_makes_no_error_on_random_rays) {
    const auto sphere = one_object(make_sphere(96, 64, 1.0f, vec3(0)));
    expect_embree_errors(sphere, random_rays(*sphere, 20000, 10), 0);
    const auto instances = instanced_spheres();
    expect_embree_errors(instances, random_rays(*instances, 20000, 12), 0);
}

TEST(ExactJudge, embree_robust_errs_on_few_of_the_rays_aimed_at_corners_and_edges) {
    const auto sphere = one_object(make_sphere(96, 64, 1.0f, vec3(0)));
    expect_embree_errors(sphere, edge_rays(*sphere, 20000, 11), 20 * kCornerLeaksPerMille);
    const auto instances = instanced_spheres();
    expect_embree_errors(instances, edge_rays(*instances, 20000, 13), 20 * kCornerLeaksPerMille);
}

}  // namespace
}  // namespace onepass
