// The ladders keep what they promise: valid scenes, sound rays, and truth that is mostly a hit.
// What a rung claims to be is measured on it.
#include "scenes/ladders.h"

#include <cmath>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "core/grid/sizing.h"
#include "cpu_ref/exact_judge.h"
#include "cpu_ref/ray_spread.h"

namespace onepass {
namespace {

constexpr size_t kRays = 96;

const Ladder& find_ladder(const std::string& id) {
    for (const Ladder& ladder : ladders()) {
        if (ladder.id == id) return ladder;
    }
    throw std::runtime_error("no ladder " + id);
}

std::string place(const Ladder& ladder, const Rung& rung) {
    return ladder.id + " at " + std::to_string(rung.knob) + " " + rung.label;
}

bool same_bits(const std::vector<Ray>& a, const std::vector<Ray>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Ray)) == 0;
}

/// The share of rays that hit, by the exact judge: what it says of a miss.
double hit_share(const Scene& scene, const std::vector<Ray>& rays) {
    const auto judge = make_exact_judge(std::make_shared<const Scene>(scene));
    const Hit miss;
    size_t hits = 0;
    for (const Ray& ray : rays) {
        const Verdict verdict = judge->judge(ray, Query::any, std::span(&miss, 1)).front();
        hits += verdict.true_inst_id != kNoId;
    }
    return static_cast<double>(hits) / static_cast<double>(rays.size());
}

TEST(Ladders, are_told_apart_by_their_ids_and_rungs_by_knob_and_label) {
    std::set<std::string> ids;
    for (const Ladder& ladder : ladders()) {
        EXPECT_TRUE(ids.insert(ladder.id).second) << ladder.id;
        EXPECT_FALSE(ladder.title.empty() || ladder.question.empty() || ladder.knob.empty());
        EXPECT_GE(ladder.rungs.size(), 6u) << ladder.id;
        std::set<std::pair<double, std::string>> steps;
        for (const Rung& rung : ladder.rungs) {
            EXPECT_TRUE(steps.insert({rung.knob, rung.label}).second) << place(ladder, rung);
        }
    }
}

TEST(Ladders, have_valid_scenes_of_moderate_size) {
    constexpr uint64_t kMostTriangles = 15'000;
    for (const Ladder& ladder : ladders()) {
        const bool grows = ladder.id == "half-addresses";  // the size is its knob
        for (const Rung& rung : ladder.rungs) {
            const Scene scene = rung.make_scene();
            EXPECT_NO_THROW(validate(scene)) << place(ladder, rung);
            EXPECT_TRUE(grows || instanced_triangle_count(scene) <= kMostTriangles)
                << place(ladder, rung);
        }
    }
}

TEST(Ladders, have_rays_that_are_finite_and_depend_on_the_seed_alone) {
    for (const Ladder& ladder : ladders()) {
        for (const Rung& rung : ladder.rungs) {
            if (!rung.ray_kind.empty()) {
                EXPECT_TRUE(rung.ray_kind == "vertex" || rung.ray_kind == "edge");
                continue;
            }
            const Scene scene = rung.make_scene();
            const std::vector<Ray> rays = rung.make_rays(scene, kRays, 5);
            ASSERT_EQ(rays.size(), kRays) << place(ladder, rung);
            for (const Ray& ray : rays) EXPECT_TRUE(is_traceable(ray)) << place(ladder, rung);
            EXPECT_TRUE(same_bits(rays, rung.make_rays(scene, kRays, 5))) << place(ladder, rung);
            EXPECT_FALSE(same_bits(rays, rung.make_rays(scene, kRays, 6))) << place(ladder, rung);
        }
    }
}

TEST(Ladders, have_rays_that_mostly_hit) {
    // Rays are aimed at surfaces, but those that lie in a plane of flat faces (direction, lattice)
    // and those that are rounded past what they are aimed at (the last rungs) may miss.
    constexpr double kLeastShare = 0.5;
    constexpr uint64_t kMostTriangles = 20'000;  // so that the judge is soon ready
    for (const Ladder& ladder : ladders()) {
        for (const Rung& rung : ladder.rungs) {
            if (!rung.ray_kind.empty()) continue;
            const Scene scene = rung.make_scene();
            if (instanced_triangle_count(scene) > kMostTriangles) continue;
            EXPECT_GE(hit_share(scene, rung.make_rays(scene, kRays, 1)), kLeastShare)
                << place(ladder, rung);
        }
    }
}

TEST(Ladders, the_direction_ladders_smallest_component_is_what_its_knob_says) {
    for (const Rung& rung : find_ladder("direction").rungs) {
        if (rung.knob == 1.0) continue;
        for (const Ray& ray : rung.make_rays(rung.make_scene(), kRays, 2)) {
            const vec3 size = glm::abs(ray.dir);
            const float least = std::min({size.x, size.y, size.z});
            const float most = std::max({size.x, size.y, size.z});
            EXPECT_LE(least, rung.knob * most * 1.001 + 0x1p-149) << rung.label;
            EXPECT_TRUE(rung.knob == 0.0 || least > 0.0f) << rung.label;
            if (rung.knob != 0.0) continue;
            for (int k = 0; k < 3; ++k) {
                if (ray.dir[k] != 0.0f) continue;
                EXPECT_EQ(std::signbit(ray.dir[k]), rung.label == "-0");
            }
        }
    }
}

TEST(Ladders, the_planes_of_cell_planes_are_exact_and_its_rays_lie_in_them) {
    for (const Rung& rung : find_ladder("cell-planes").rungs) {
        const Scene scene = rung.make_scene();
        const Bounds box = padded_bounds(object_bounds(scene.objects[0]));
        EXPECT_EQ(box.lower, vec3(-1.0f));
        EXPECT_EQ(box.upper, vec3(1.0f));
        const double cell = 2.0 / rung.knob;
        const auto on_plane = [&](float x) {
            return std::fmod(static_cast<double>(x), cell) == 0.0;
        };
        for (const Ray& ray : rung.make_rays(scene, kRays, 3)) {
            bool in_a_plane = false;
            bool through_corners = true;
            for (int k = 0; k < 3; ++k) {
                in_a_plane |= ray.dir[k] == 0.0f && on_plane(ray.org[k]);
                const bool whole = ray.dir[k] == std::floor(ray.dir[k]);
                through_corners &= whole && on_plane(ray.org[k]);
            }
            EXPECT_TRUE(in_a_plane || through_corners);
        }
    }
}

TEST(Ladders, the_needles_are_as_thin_as_their_knob_says) {
    for (const Rung& rung : find_ladder("needles").rungs) {
        if (rung.knob > 1e5) continue;  // rounding moves their corners by as much as they are wide
        const Object needles = rung.make_scene().objects[0];
        const uvec3 triangle = needles.triangles[needles.triangles.size() / 2];
        double longest = 0.0;
        double shortest = kInfinity;
        for (int k = 0; k < 3; ++k) {
            const double length = glm::distance(dvec3(needles.positions[triangle[k]]),
                                                dvec3(needles.positions[triangle[(k + 1) % 3]]));
            longest = std::max(longest, length);
            shortest = std::min(shortest, length);
        }
        EXPECT_GT(longest / shortest, 0.9 * rung.knob);
        EXPECT_LT(longest / shortest, 1.5 * rung.knob);
    }
}

TEST(Ladders, coincident_sheets_are_the_same_triangles_at_last) {
    const Scene mesh = find_ladder("coincident").rungs.back().make_scene();
    const std::vector<vec3>& positions = mesh.objects[0].positions;
    for (size_t i = 0; i < positions.size() / 2; ++i) {
        EXPECT_EQ(positions[i], positions[i + positions.size() / 2]);
    }
    const Scene twice = find_ladder("coincident-instances").rungs.back().make_scene();
    ASSERT_EQ(twice.instances.size(), 2u);
    EXPECT_EQ(twice.instances[0].world_from_object, twice.instances[1].world_from_object);
}

}  // namespace
}  // namespace onepass
