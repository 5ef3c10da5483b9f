// The exact truth against a brute force of whole numbers that shares nothing with it.
//
// All inputs are multiples of a power of two, so the same questions can be asked of integers: every
// triangle, no search, no filter, no rational class.
#include "cpu_ref/exact_truth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "tests/unit/cpu_ref/meshes.h"

namespace onepass {
namespace {

using namespace test;
using Integer = boost::multiprecision::int512_t;

/// Positions, directions and transforms are multiples of 2^-kBits; products of a transform and a
/// position, of its square.
constexpr int kBits = 23;

Integer whole(double x, int bits) {
    const double scaled = std::ldexp(x, bits);
    EXPECT_EQ(scaled, std::floor(scaled)) << x << " is no multiple of 2^-" << bits;
    return Integer(scaled);
}

struct Point {
    Integer x, y, z;
};
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Integer volume(const Point& a, const Point& b, const Point& c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
           a.z * (b.x * c.y - b.y * c.x);
}

/// A crossing at t = above / below, below > 0.
struct Found {
    uint32_t inst_id;
    uint32_t prim_id;
    Integer above;
    Integer below;
};

struct WholeTriangle {
    uint32_t inst_id;
    uint32_t prim_id;
    std::array<Point, 3> corners;  ///< in the world, in units of 2^-(2 kBits)
};

std::vector<WholeTriangle> whole_triangles(const Scene& scene) {
    std::vector<WholeTriangle> result;
    for (uint32_t inst_id = 0; inst_id < scene.instances.size(); ++inst_id) {
        const Instance& instance = scene.instances[inst_id];
        const Affine& m = instance.world_from_object;
        const Object& object = scene.objects[instance.object];
        for (uint32_t prim_id = 0; prim_id < object.triangles.size(); ++prim_id) {
            WholeTriangle& triangle = result.emplace_back(inst_id, prim_id);
            for (int i = 0; i < 3; ++i) {
                const vec3 p = object.positions[object.triangles[prim_id][i]];
                Integer world[3];
                for (int k = 0; k < 3; ++k) {
                    world[k] = whole(m[3][k], 2 * kBits);
                    for (int column = 0; column < 3; ++column) {
                        world[k] += whole(m[column][k], kBits) * whole(p[column], kBits);
                    }
                }
                triangle.corners[static_cast<size_t>(i)] = {world[0], world[1], world[2]};
            }
        }
    }
    return result;
}

/// Every crossing with 0 <= t, nearest first, then by ids.
std::vector<Found> brute_force(const std::vector<WholeTriangle>& triangles, const Ray& ray) {
    const auto point = [](const vec3& v) {
        return Point{whole(v.x, 2 * kBits), whole(v.y, 2 * kBits), whole(v.z, 2 * kBits)};
    };
    const Point org = point(ray.org);
    const Point dir = point(ray.dir);
    std::vector<Found> found;
    for (const WholeTriangle& triangle : triangles) {
        // Moller and Trumbore's form of the question, on integers.
        const Point e1 = triangle.corners[1] - triangle.corners[0];
        const Point e2 = triangle.corners[2] - triangle.corners[0];
        const Point s = org - triangle.corners[0];
        Integer det = -volume(e1, e2, dir);
        if (det == 0) continue;
        const int sign = det < 0 ? -1 : 1;
        det *= sign;
        const Integer u = volume(s, e2, dir) * -sign;
        if (u < 0 || u > det) continue;
        const Integer v = volume(e1, s, dir) * -sign;
        if (v < 0 || u + v > det) continue;
        const Integer t = volume(e1, e2, s) * sign;
        if (t >= 0) found.push_back({triangle.inst_id, triangle.prim_id, t, det});
    }
    std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
        return a.above * b.below < b.above * a.below;
    });
    return found;
}

/// Holds find_all() and find() against the brute force; returns how many rays hit something, and
/// how many of them have more than one nearest surface.
struct Tally {
    size_t hits = 0;
    size_t ties = 0;
};
Tally expect_equal_to_brute_force(const ScenePtr& scene, const std::vector<Ray>& rays) {
    const CandidateSearch candidates(scene);
    const ExactTruth truth(candidates);
    const std::vector<WholeTriangle> triangles = whole_triangles(*scene);
    Tally tally;
    for (const Ray& ray : rays) {
        const std::vector<Found> expected = brute_force(triangles, ray);
        const std::vector<ExactHit> all = truth.find_all(exact_ray(ray));
        EXPECT_EQ(all.size(), expected.size());
        if (all.size() != expected.size()) return tally;
        for (size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(all[i].inst_id, expected[i].inst_id);
            EXPECT_EQ(all[i].prim_id, expected[i].prim_id);
            const double t =
                (expected[i].above.convert_to<double>()) / expected[i].below.convert_to<double>();
            EXPECT_NEAR(all[i].t_rounded, t, 0x1p-38 * t);
        }

        const Truth nearest = truth.find(exact_ray(ray));
        EXPECT_EQ(nearest.nearest.has_value(), !expected.empty());
        if (expected.empty()) continue;
        EXPECT_EQ(nearest.nearest->inst_id, expected[0].inst_id);
        EXPECT_EQ(nearest.nearest->prim_id, expected[0].prim_id);
        size_t equal = 1;
        while (equal < expected.size() && expected[equal].above * expected[0].below ==
                                              expected[0].above * expected[equal].below) {
            ++equal;
        }
        if (expected[0].above > 0) {
            EXPECT_EQ(nearest.right.size(), equal);
        }
        ++tally.hits;
        tally.ties += equal > 1 ? 1 : 0;
    }
    return tally;
}

/// The nearest multiple of 2^-bits.
float rounded_to(double x, int bits) {
    return static_cast<float>(std::ldexp(std::nearbyint(std::ldexp(x, bits)), -bits));
}
vec3 rounded_to(const dvec3& v, int bits) {
    return vec3(rounded_to(v.x, bits), rounded_to(v.y, bits), rounded_to(v.z, bits));
}

/// A closed ball whose corners are multiples of 2^-bits, within the unit box.
Object ball(int bits) {
    Object object = make_sphere(7, 5, 0.9f, vec3(0));
    for (vec3& p : object.positions) p = rounded_to(dvec3(p), bits);
    return object;
}

/// Two balls, one sheared, mirrored and moved by numbers of few bits.
ScenePtr two_balls(int bits) {
    Scene scene;
    scene.materials.resize(1);
    const uint32_t object = add_object(scene, ball(bits));
    add_instance(scene, object, affine_identity());
    add_instance(scene, object,
                 Affine(vec3(-0.5f, 0.25f, 0), vec3(0.125f, 0.75f, 0.5f), vec3(0, 0.25f, 1.5f),
                        vec3(0.5f, -0.25f, 1.25f)));
    return checked(std::move(scene));
}

TEST(ExactTruth, agrees_with_whole_numbers_on_10000_random_rays) {
    const ScenePtr scene = two_balls(kBits);
    Random random(21);
    std::vector<Ray> rays;
    while (rays.size() < 10000) {
        const vec3 from = rounded_to(dvec3(random.in_box({vec3(-1.9f), vec3(1.9f)})), kBits);
        const vec3 to = rounded_to(dvec3(random.in_box({vec3(-1.2f), vec3(1.2f)})), kBits);
        rays.push_back({.org = from, .dir = rounded_to(dvec3(to) - dvec3(from), kBits)});
    }
    EXPECT_GT(expect_equal_to_brute_force(scene, rays).hits, 4000u);
}

TEST(ExactTruth, agrees_with_whole_numbers_on_10000_rays_through_corners_edges_and_planes) {
    // Coarse numbers, so that rays pass exactly through corners and edges, start on surfaces, lie
    // in planes; every triangle twice, so that each hit has its duplicate.
    constexpr int kCoarse = 3;
    Scene scene;
    scene.materials.resize(1);
    Object doubled = ball(kCoarse);
    const std::vector<uvec3> once = doubled.triangles;
    doubled.triangles.insert(doubled.triangles.end(), once.begin(), once.end());
    const uint32_t object = add_object(scene, doubled);
    add_instance(scene, object, affine_identity());
    add_instance(scene, object,
                 Affine(vec3(0, 1, 0), vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0.25f, 0, 0)));
    const ScenePtr shared = checked(std::move(scene));
    Random random(22);
    const auto lattice = [&] {
        return rounded_to(dvec3(random.in_box({vec3(-1.5f), vec3(1.5f)})), kCoarse);
    };
    std::vector<Ray> rays;
    while (rays.size() < 10000) {
        const vec3 from = rays.size() % 4 == 0
                              ? doubled.positions[random.below(doubled.positions.size())]
                              : lattice();
        vec3 to = lattice();
        if (rays.size() % 2 == 0) to = doubled.positions[random.below(doubled.positions.size())];
        if (rays.size() % 5 == 0) to = from + vec3(0, 0, rays.size() % 3 == 0 ? -1 : 1);
        if (to == from) continue;
        rays.push_back({.org = from, .dir = to - from});
    }
    const Tally tally = expect_equal_to_brute_force(shared, rays);
    EXPECT_GT(tally.hits, 4000u);
    EXPECT_GT(tally.ties, 3000u);
}

TEST(ExactTruth, tells_apart_what_double_cannot) {
    // Two planes 2^-60 apart, met at t = 1: doubles of their t would be equal.
    Object object;
    const float far = 0x1p20f;
    const float tiny = 0x1p-60f;
    add_triangle(object, {-far, -far, 0}, {far, -far, 0}, {0, far, 0});
    add_triangle(object, {-far, -far, tiny}, {far, -far, tiny}, {0, far, tiny});
    const CandidateSearch candidates(one_object(object));
    const ExactTruth truth(candidates);
    const Truth from_above = truth.find(exact_ray({.org = {0, 0, 1}, .dir = {0, 0, -1}}));
    ASSERT_TRUE(from_above.nearest);
    EXPECT_EQ(from_above.nearest->prim_id, 1u);
    EXPECT_EQ(from_above.right.size(), 1u);
    const Truth from_below = truth.find(exact_ray({.org = {0, 0, -1}, .dir = {0, 0, 1}}));
    EXPECT_EQ(from_below.nearest->prim_id, 0u);
    EXPECT_EQ(from_below.right.size(), 1u);
}

TEST(ExactTruth, a_surface_at_an_interval_end_may_count_or_not) {
    Object object;
    add_square(object, 1.0f, 0.0f);
    add_square(object, 2.0f, -1.0f);
    const CandidateSearch candidates(one_object(object));
    const ExactTruth truth(candidates);
    // Starts exactly on the upper square: t = 0 = tmin.
    const Truth on = truth.find(exact_ray({.org = {0.5f, 0.25f, 0}, .dir = {0, 0, -1}}));
    EXPECT_EQ(on.nearest->prim_id, 0u);
    EXPECT_TRUE(on.nearest->optional);
    EXPECT_EQ(on.nearest->crossing.t, 0.0);
    EXPECT_NE(on.find(0, 2), nullptr) << "who leaves tmin out finds the square below";
    EXPECT_FALSE(on.miss_is_right);
}

TEST(Interval, holds_the_real_result_of_every_operation) {
    Random random(23);
    using boost::multiprecision::cpp_rational;
    const auto holds = [](const Interval& i, const cpp_rational& real) {
        return cpp_rational(i.lower) <= real && real <= cpp_rational(i.upper);
    };
    for (int k = 0; k < 2000; ++k) {
        const double a = std::ldexp(random.unit() - 0.5, static_cast<int>(random.below(80)) - 40);
        const double b = std::ldexp(random.unit() - 0.5, static_cast<int>(random.below(80)) - 40);
        const double c = random.unit() + 0.1;
        const cpp_rational ra(a), rb(b), rc(c);
        EXPECT_TRUE(holds(Interval(a) + b, ra + rb));
        EXPECT_TRUE(holds(Interval(a) - b, ra - rb));
        EXPECT_TRUE(holds(Interval(a) * b, ra * rb));
        EXPECT_TRUE(holds(Interval(a) / c, ra / rc));
        const Interval chain = (Interval(a) + b) * (Interval(b) - c) / c;
        EXPECT_TRUE(holds(chain, (ra + rb) * (rb - rc) / rc));
    }
    const double huge = 1e308;
    EXPECT_FALSE(sign_of(Interval(huge) * huge - Interval(huge) * huge).has_value());
    EXPECT_EQ(sign_of(Interval(1.0) - 2.0), -1);
    EXPECT_EQ(sign_of(Interval(0.0)), 0);
}

}  // namespace
}  // namespace onepass
