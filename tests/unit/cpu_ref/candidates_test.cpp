// The candidate search loses no triangle: against all triangles, one by one.
#include "cpu_ref/candidates.h"

#include <set>

#include <gtest/gtest.h>

#include "cpu_ref/exact_truth.h"
#include "tests/unit/cpu_ref/meshes.h"

namespace onepass {
namespace {

using namespace test;
using Ids = std::pair<uint32_t, uint32_t>;

std::set<Ids> candidates_of(const CandidateSearch& search, const SpreadRay& ray) {
    std::set<Ids> ids;
    search.visit(ray, [&](uint32_t inst_id, uint32_t prim_id) {
        EXPECT_TRUE(ids.emplace(inst_id, prim_id).second) << "visited twice";
        return ray.tmax;
    });
    return ids;
}

/// Every triangle that the exact intersection hits must have been a candidate. Returns the hits.
size_t expect_all_hits_found(const CandidateSearch& candidates, const SpreadRay& search_ray,
                             const SpreadRay& hit_ray) {
    const std::set<Ids> found = candidates_of(candidates, search_ray);
    const ExactTruth truth(candidates);
    const Scene& scene = candidates.scene();
    size_t hits = 0;
    for (uint32_t inst_id = 0; inst_id < scene.instances.size(); ++inst_id) {
        const Object& object = scene.objects[scene.instances[inst_id].object];
        for (uint32_t prim_id = 0; prim_id < object.triangles.size(); ++prim_id) {
            const std::optional<ExactHit> c = truth.crossing(hit_ray, inst_id, prim_id);
            if (!c || c->t.upper < hit_ray.tmin || c->t.lower > hit_ray.tmax) continue;
            ++hits;
            EXPECT_TRUE(found.contains({inst_id, prim_id}))
                << "triangle " << prim_id << " of instance " << inst_id << " lost";
        }
    }
    return hits;
}

TEST(Candidates, no_hit_of_a_random_or_edge_aimed_ray_is_lost) {
    for (const ScenePtr& scene :
         {one_object(make_sphere(32, 24, 1.0f, vec3(100, -50, 3))), instanced_spheres()}) {
        const CandidateSearch candidates(scene);
        size_t hits = 0;
        for (const Ray& ray : random_rays(*scene, 300, 1)) {
            hits += expect_all_hits_found(candidates, exact_ray(ray), exact_ray(ray));
        }
        for (const Ray& ray : edge_rays(*scene, 300, 2)) {
            hits += expect_all_hits_found(candidates, exact_ray(ray), exact_ray(ray));
        }
        EXPECT_GT(hits, 600u);
    }
}

TEST(Candidates, no_hit_of_an_axis_parallel_ray_in_the_plane_of_a_box_side_is_lost) {
    Object squares;
    for (int i = -8; i <= 8; ++i) add_square(squares, 1.0f, 0.25f * static_cast<float>(i));
    const auto scene = one_object(squares);
    const CandidateSearch candidates(scene);
    size_t hits = 0;
    for (const float x : {-1.0f, 0.0f, 1.0f}) {
        for (const float y : {-1.0f, -0.0f, 0.3f, 1.0f}) {
            const Ray ray{.org = {x, y, 5}, .dir = {0, -0.0f, -1}};
            hits += expect_all_hits_found(candidates, exact_ray(ray), exact_ray(ray));
        }
    }
    EXPECT_GE(hits, 12u * 17u);
}

TEST(Candidates, hits_of_every_ray_within_the_reach_are_candidates_of_the_ray) {
    const auto scene = instanced_spheres();
    const CandidateSearch candidates(scene);
    Random random(3);
    size_t hits = 0;
    // Wide enough to change what is hit: by the origin alone, by the direction alone, by both.
    constexpr std::array<std::pair<double, double>, 3> kReaches = {
        {{1e-2, 0.0}, {0.0, 1e-2}, {1e-2, 1e-2}}};
    for (const Ray& ray : edge_rays(*scene, 900, 4)) {
        const auto [org_reach, dir_reach] = kReaches[random.below(3)];
        SpreadRay spread = exact_ray(ray);
        spread.org_reach = org_reach;
        spread.dir_reach = dir_reach * largest_component(spread.dir);
        SpreadRay moved = exact_ray(ray);
        for (int k = 0; k < 3; ++k) {
            moved.org[k] += spread.org_reach * (random.unit() < 0.5f ? -1.0 : 1.0);
            moved.dir[k] += spread.dir_reach * (random.unit() < 0.5f ? -1.0 : 1.0);
        }
        hits += expect_all_hits_found(candidates, spread, moved);
    }
    EXPECT_GT(hits, 900u);
}

TEST(Candidates, a_search_looks_at_few_of_many_triangles) {
    const auto scene = one_object(make_sphere(128, 96, 1.0f, vec3(0)));
    const CandidateSearch search(scene);
    size_t visited = 0;
    const std::vector<Ray> rays = random_rays(*scene, 500, 5);
    for (const Ray& ray : rays) visited += candidates_of(search, exact_ray(ray)).size();
    EXPECT_LT(visited, 20 * rays.size());

    // Axis-parallel rays, whose zero components must cut off as much as others.
    visited = 0;
    for (Ray ray : rays) {
        ray.dir = vec3(0, 0, -1);
        visited += candidates_of(search, exact_ray(ray)).size();
    }
    EXPECT_LT(visited, 20 * rays.size());
}

TEST(Candidates, the_interval_and_a_shrinking_tmax_cut_the_search) {
    Object squares;
    for (int i = 0; i < 32; ++i) add_square(squares, 1.0f, -static_cast<float>(i));
    const CandidateSearch search(one_object(squares));
    Ray ray{.org = {0.5f, 0.25f, 1}, .dir = {0, 0, -1}};
    ray.tmin = 9.5f;
    ray.tmax = 12.5f;
    EXPECT_EQ(candidates_of(search, exact_ray(ray)).size(), 3u * 2u);

    ray = {.org = {0.5f, 0.25f, 1}, .dir = {0, 0, -1}};
    size_t visited = 0;
    search.visit(exact_ray(ray), [&](uint32_t, uint32_t prim_id) {
        ++visited;
        return 1.0 + prim_id / 2;
    });
    EXPECT_LT(visited, 16u);
}

TEST(Candidates, float_ulp_is_the_spacing_of_floats) {
    for (const float x : {1.0f, 1.5f, 0.1f, 3e-39f, 1e-45f, 16777216.0f, 3e38f}) {
        EXPECT_EQ(float_ulp(x), double{std::nextafter(x, kInfinity)} - double{x}) << x;
        EXPECT_EQ(float_ulp(-x), float_ulp(x));
    }
    EXPECT_EQ(float_ulp(0.0), std::ldexp(1.0, -149));
}

TEST(Candidates, e_ray_reaches_four_ulps_of_the_larger_coordinate) {
    const Ray ray{.org = {0.5f, 0, 0}, .dir = {0, 3, -1}};
    const SpreadRay spread = e_ray(ray, 8.0);
    EXPECT_EQ(spread.org_reach, 4.0 * 0x1p-20);
    EXPECT_EQ(spread.dir_reach, 4.0 * 0x1p-22);
    EXPECT_EQ(e_ray(ray, 0.25).org_reach, 4.0 * 0x1p-24);
}

}  // namespace
}  // namespace onepass
