// What the exact judge tells a reader about one ray: hits in order, conditioning, near misses.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "cpu_ref/exact_judge.h"
#include "tests/unit/cpu_ref/meshes.h"

namespace onepass {
namespace {

using namespace test;

/// Squares at z = 0 (half size 1, triangles 0 and 1) and z = -1 (half size 2, triangles 2 and 3).
ScenePtr two_squares() {
    Object object;
    add_square(object, 1.0f, 0.0f);
    add_square(object, 2.0f, -1.0f);
    return one_object(object);
}

RayTruth truth_of(const ScenePtr& scene, const Ray& ray, std::vector<Hit> answers = {}) {
    return make_exact_judge(scene)->explain(ray, answers);
}

Ray down(float x, float y, float speed = 1.0f) { return {.org = {x, y, 1}, .dir = {0, 0, -speed}}; }

TEST(ExplainedTruth, hits_come_in_order_with_exact_t_and_barycentric_coordinates) {
    const RayTruth truth = truth_of(two_squares(), down(0.5f, 0.25f, 3.0f));
    ASSERT_EQ(truth.hits.size(), 2u);
    EXPECT_EQ(truth.hits[0].prim_id, 0u);
    EXPECT_EQ(truth.hits[0].t, 1.0 / 3.0);
    EXPECT_EQ(truth.hits[0].t_digits, "0.333333333333333333333333333333");
    // (0.5, 0.25) in the triangle (-1, -1), (1, -1), (1, 1): u = (x - y) / 2, v = (y + 1) / 2.
    EXPECT_EQ(truth.hits[0].u, 0.125);
    EXPECT_EQ(truth.hits[0].v, 0.625);
    EXPECT_TRUE(truth.hits[0].is_right);
    EXPECT_EQ(truth.hits[1].prim_id, 2u);
    EXPECT_EQ(truth.hits[1].t_digits, "0.666666666666666666666666666666");
    EXPECT_FALSE(truth.hits[1].is_right);
    EXPECT_FALSE(truth.miss_is_right);
    // A third further, in ulps of 1/3, which are 2^-25.
    EXPECT_NEAR(truth.hits[0].gap_ulps, 0x1p25 / 3.0, 1e-6);
    EXPECT_EQ(truth.hits[1].gap_ulps, std::numeric_limits<double>::infinity());
}

TEST(ExplainedTruth, digits_are_those_of_the_real_t) {
    const ScenePtr scene = two_squares();
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f)).hits.at(0).t_digits, "1");
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f, 0x1p-10f)).hits.at(0).t_digits, "1024");
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f, 16.0f)).hits.at(0).t_digits, "0.0625");
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f, 0x1p20f)).hits.at(0).t_digits,
              "9.5367431640625e-7");
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f, 0x1p-120f)).hits.at(0).t_digits,
              "1.32922799578491587290380706028e36");
    EXPECT_EQ(truth_of(scene, down(0.5f, 0.25f, 3e-3f)).hits.at(0).t_digits.substr(0, 12),
              "333.33332794");
}

TEST(ExplainedTruth, a_ray_through_a_shared_edge_is_a_tie_that_exact_numbers_decide) {
    const RayTruth truth = truth_of(two_squares(), down(0.5f, 0.5f));
    ASSERT_EQ(truth.hits.size(), 4u);
    for (const size_t i : {0, 1}) {
        EXPECT_EQ(truth.hits[i].prim_id, i);
        EXPECT_TRUE(truth.hits[i].is_right);
        EXPECT_TRUE(truth.hits[i].on_edge);
        EXPECT_EQ(truth.hits[i].edge_distance, 0.0);
        EXPECT_EQ(truth.hits[i].edge_moves, 0.0);
        EXPECT_TRUE(truth.hits[i].close_side);
        EXPECT_TRUE(truth.hits[i].close_order);
    }
    EXPECT_EQ(truth.hits[0].edge, 2u) << "from v2 to v0";
    EXPECT_EQ(truth.hits[1].edge, 0u);
    EXPECT_EQ(truth.hits[0].gap_ulps, 0.0);
    EXPECT_GT(truth.hits[1].gap_ulps, 1e6);
    const RayTruth plain = truth_of(two_squares(), down(0.5f, 0.25f));
    EXPECT_FALSE(plain.hits[0].on_edge);
    EXPECT_FALSE(plain.hits[0].close_side);
    EXPECT_FALSE(plain.hits[0].close_order);
}

TEST(ExplainedTruth, distances_to_edges_are_in_units_of_what_the_ray_may_move) {
    // From (0.75, 0.25) the nearest edge is v1-v2, at x = 1: only x has to be moved, by 0.25. The
    // scene's largest coordinate is 2, so that the origin may move by 4 ulp of 2 = 2^-20, and at
    // t = 1 the direction gives 4 ulp of 1 = 2^-21 more.
    const RayTruth truth = truth_of(two_squares(), down(0.75f, 0.25f));
    const Meeting& m = truth.hits.at(0);
    EXPECT_EQ(truth.org_reach, 0x1p-20);
    EXPECT_EQ(truth.dir_reach, 0x1p-21);
    EXPECT_EQ(m.edge, 1u);
    EXPECT_EQ(m.edge_distance, 0.25);
    EXPECT_EQ(m.edge_moves, 0.25 / (0x1p-20 + 0x1p-21));
    EXPECT_EQ(m.incidence, 1.0);
    const RayTruth grazing = truth_of(two_squares(), {.org = {-3, 0.25f, 1}, .dir = {3, 0, -1}});
    EXPECT_NEAR(grazing.hits.at(0).incidence, 1.0 / std::sqrt(10.0), 1e-15);
}

TEST(ExplainedTruth, triangles_passed_within_reach_are_told_and_others_when_asked) {
    // Past the small square's side by half an ulp of 1: within reach. Below lies the large one.
    const Ray ray = down(1.0f + 0x1p-23f, 0.25f);
    const RayTruth truth = truth_of(two_squares(), ray);
    ASSERT_EQ(truth.hits.size(), 1u);
    ASSERT_EQ(truth.passed.size(), 1u);
    EXPECT_EQ(truth.passed[0].prim_id, 0u);
    EXPECT_FALSE(truth.passed[0].crosses);
    EXPECT_FALSE(truth.passed[0].is_right);
    EXPECT_NEAR(truth.passed[0].edge_moves, 0x1p-23 / (0x1p-20 + 0x1p-21), 1e-9);
    EXPECT_GT(truth.passed[0].u + truth.passed[0].v, 1.0 - 1e-6);

    const Hit asked{.t = 1.0f, .u = 0, .v = 0, .prim_id = 1, .inst_id = 0};
    const Hit nonsense{.t = 1.0f, .u = 0, .v = 0, .prim_id = 77, .inst_id = 3};
    const RayTruth told = truth_of(two_squares(), ray, {asked, asked, nonsense, Hit{}});
    ASSERT_EQ(told.passed.size(), 2u);
    EXPECT_EQ(told.passed[1].prim_id, 1u);
    EXPECT_GT(told.passed[1].edge_moves, 1e4);
}

TEST(ExplainedTruth, ends_of_the_interval_and_rays_that_are_none) {
    Ray ray = down(0.5f, 0.25f);
    ray.tmin = 1.0f;
    const RayTruth at_end = truth_of(two_squares(), ray);
    ASSERT_EQ(at_end.hits.size(), 2u);
    EXPECT_TRUE(at_end.hits[0].at_interval_end);
    EXPECT_TRUE(at_end.hits[0].is_right);
    EXPECT_TRUE(at_end.hits[1].is_right) << "where the end does not count";
    ray.tmin = 1.5f;
    const RayTruth behind = truth_of(two_squares(), ray, {Hit{1.0f, 0, 0, 0, 0}});
    ASSERT_EQ(behind.passed.size(), 1u);
    EXPECT_TRUE(behind.passed[0].crosses);
    ray.dir = vec3(0.0f);
    EXPECT_FALSE(truth_of(two_squares(), ray).traceable);
    EXPECT_TRUE(truth_of(two_squares(), ray).miss_is_right);
    EXPECT_TRUE(truth_of(two_squares(), down(5, 5)).hits.empty());
    EXPECT_TRUE(truth_of(two_squares(), down(5, 5)).miss_is_right);
}

TEST(ExplainedTruth, what_is_called_right_is_judged_right_and_nothing_else_is) {
    const ScenePtr scene = instanced_spheres();
    const auto judge = make_exact_judge(scene);
    std::vector<Ray> rays = edge_rays(*scene, 150, 11);
    const std::vector<Ray> others = random_rays(*scene, 150, 12);
    rays.insert(rays.end(), others.begin(), others.end());
    size_t right = 0;
    size_t wrong = 0;
    for (const Ray& ray : rays) {
        const RayTruth truth = judge->explain(ray, {});
        double last_t = 0.0;
        for (const Meeting& m : truth.hits) {
            EXPECT_GE(m.t, last_t);
            last_t = m.t;
            const Hit answer{static_cast<float>(m.t), 0, 0, m.prim_id, m.inst_id};
            const HitClass hit_class =
                judge->judge(ray, Query::closest, std::span(&answer, 1))[0].hit_class;
            const bool judged_right = hit_class == HitClass::agree || hit_class == HitClass::tie;
            EXPECT_EQ(m.is_right, judged_right) << to_string(hit_class);
            // The rounded coordinates say the same point as t, to within double's rounding.
            EXPECT_GE(std::min({m.u, m.v, 1.0 - m.u - m.v}), -1e-15);
            (m.is_right ? right : wrong) += 1;
        }
    }
    EXPECT_GT(right, 100u);
    EXPECT_GT(wrong, 50u);
}

}  // namespace
}  // namespace onepass
