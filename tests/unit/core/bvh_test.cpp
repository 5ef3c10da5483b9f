// Bounding volume hierarchies: every primitive once, every box what it must be, bounded depth, and
// the same bits for any number of threads.
#include "core/bvh/bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "scenes/shapes.h"

namespace onepass {
namespace {

std::vector<Bounds> random_boxes(size_t count, uint32_t seed) {
    std::mt19937 bits(seed);
    const auto unit = [&] { return static_cast<float>(bits() >> 8) * 0x1p-24f; };
    std::vector<Bounds> boxes(count);
    for (Bounds& box : boxes) {
        box.lower = vec3(unit(), unit(), unit());
        box.upper = box.lower + 0.01f * vec3(unit(), unit(), unit());
    }
    return boxes;
}

/// Walks the whole tree: boxes are exactly those of what lies below, leaves within their size, no
/// node shared. Returns the depth.
uint32_t expect_sound(const Bvh& bvh, std::span<const Bounds> boxes, uint32_t most_leaf) {
    std::vector<uint32_t> sorted = bvh.primitives;
    std::sort(sorted.begin(), sorted.end());
    std::vector<uint32_t> all(boxes.size());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(sorted, all) << "each primitive once";

    std::vector<int> met(bvh.primitives.size());
    std::vector<int> visits(bvh.nodes.size());
    uint32_t deepest = 0;
    const auto box_of = [&](auto&& self, uint32_t node, uint32_t depth) -> Bounds {
        ++visits[node];
        deepest = std::max(deepest, depth);
        Bounds whole;
        for (const BvhChild& child : bvh.nodes[node].children) {
            Bounds box;
            if (child.is_leaf()) {
                EXPECT_LE(child.count, most_leaf);
                for (uint32_t k = child.first; k < child.first + child.count; ++k) {
                    ++met[k];
                    box.extend(boxes[bvh.primitives[k]]);
                }
            } else {
                EXPECT_GT(child.first, node);
                box = self(self, child.first, depth + 1);
            }
            EXPECT_EQ(box, child.box) << "child of node " << node;
            whole.extend(box);
        }
        return whole;
    };
    EXPECT_EQ(box_of(box_of, 0, 1), bvh.bounds);
    const int times = boxes.size() == 1 ? 2 : 1;
    EXPECT_TRUE(std::all_of(met.begin(), met.end(), [&](int n) { return n == times; }));
    EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](int n) { return n == 1; }));
    EXPECT_EQ(bvh.depth, deepest);
    return deepest;
}

/// The surface area heuristic's estimate of a ray's cost: nodes and tests, by the share of area.
double expected_cost(const Bvh& bvh) {
    const auto area = [](const Bounds& box) {
        const dvec3 e(box.extent());
        return e.x * e.y + e.y * e.z + e.z * e.x;
    };
    double cost = area(bvh.bounds);
    for (const BvhNode& node : bvh.nodes) {
        for (const BvhChild& child : node.children) {
            cost += area(child.box) * (child.is_leaf() ? child.count : 1.0);
        }
    }
    return cost / area(bvh.bounds);
}

TEST(Bvh, trees_of_all_small_sizes_hold_each_primitive_once_in_exact_boxes) {
    for (size_t count = 1; count <= 40; ++count) {
        for (const uint32_t most_leaf : {1u, 4u, 15u}) {
            const std::vector<Bounds> boxes = random_boxes(count, static_cast<uint32_t>(count));
            expect_sound(build_bvh(boxes, {.most_leaf = most_leaf}), boxes, most_leaf);
        }
    }
}

TEST(Bvh, a_large_tree_is_sound_and_the_same_for_any_number_of_threads) {
    const std::vector<Bounds> boxes = random_boxes(60000, 1);
    const Bvh all = build_bvh(boxes, {});
    EXPECT_LT(expect_sound(all, boxes, 4), 30u);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(build_bvh(boxes, {}), all);
}

TEST(Bvh, splits_follow_the_surface_area_heuristic) {
    // Two clusters far apart: the root must separate them, whatever their sizes.
    std::vector<Bounds> boxes = random_boxes(1000, 2);
    for (size_t i = 0; i < 10; ++i) {
        boxes[i].lower.x += 100.0f;
        boxes[i].upper.x += 100.0f;
    }
    const Bvh bvh = build_bvh(boxes, {});
    EXPECT_LT(bvh.nodes[0].children[0].box.upper.x, 2.0f);
    EXPECT_GT(bvh.nodes[0].children[1].box.lower.x, 99.0f);

    // Halving alone costs more.
    const Object ball = make_sphere(64, 48);
    const std::vector<Bounds> triangles = triangle_bounds(ball);
    const auto least = static_cast<uint32_t>(std::ceil(std::log2(triangles.size())));
    EXPECT_LT(expected_cost(build_bvh(triangles, {})),
              0.95 * expected_cost(build_bvh(triangles, {.most_depth = least})));
}

TEST(Bvh, depth_is_bounded_where_the_heuristic_would_dig) {
    // Each box is half as far from 0 as the one before: bins cut off one box at a time.
    std::vector<Bounds> boxes(120);
    for (size_t i = 0; i < boxes.size(); ++i) {
        const float at = std::ldexp(1.0f, -static_cast<int>(i));
        boxes[i].lower = vec3(at);
        boxes[i].upper = vec3(1.01f * at);
    }
    EXPECT_LE(expect_sound(build_bvh(boxes, {.most_leaf = 1}), boxes, 1), kBvhMostDepth);
    EXPECT_LE(expect_sound(build_bvh(boxes, {.most_leaf = 1, .most_depth = 8}), boxes, 1), 8u);
}

TEST(Bvh, coincident_points_and_extreme_coordinates_are_built) {
    std::vector<Bounds> boxes(100);
    for (Bounds& box : boxes) box.extend(vec3(1, 2, 3));
    expect_sound(build_bvh(boxes, {}), boxes, 4);
    const float largest = std::numeric_limits<float>::max();
    for (size_t i = 0; i < boxes.size(); ++i) {
        boxes[i] = {};
        boxes[i].extend(vec3(i % 2 ? largest : -largest));
        if (i % 3 == 0) boxes[i].extend(vec3(0.0f));
    }
    expect_sound(build_bvh(boxes, {}), boxes, 4);
}

TEST(Bvh, a_scene_has_a_tree_an_object_and_one_over_its_instances) {
    Scene scene;
    scene.objects = {make_sphere(8, 6), make_sphere(12, 9)};
    for (uint32_t i = 0; i < 5; ++i) {
        Instance instance{.name = "ball", .object = i % 2, .materials = {0}};
        instance.world_from_object[3].x = static_cast<float>(3 * i);
        scene.instances.push_back(instance);
    }
    scene.materials.resize(1);
    validate(scene);
    const TwoLevelBvh bvh = build_two_level_bvh(scene, {});
    ASSERT_EQ(bvh.objects.size(), 2u);
    for (size_t k = 0; k < 2; ++k) {
        expect_sound(bvh.objects[k], triangle_bounds(scene.objects[k]), 4);
    }
    expect_sound(bvh.top, instance_bounds(scene), 4);
    EXPECT_GT(bvh.build_ms, 0.0);
}

TEST(Bvh, of_triangles_with_the_same_corners_only_the_first_is_in_the_tree) {
    Scene scene;
    Object ball = make_sphere(12, 9);
    const std::vector<uvec3> once = ball.triangles;
    for (const uvec3& t : once) ball.triangles.push_back({t.z, t.x, t.y});
    ball.triangles.push_back(once.front());
    ball.groups = {{"all", 0, static_cast<uint32_t>(ball.triangles.size())}};
    scene.objects = {ball};
    scene.instances = {{.name = "ball", .object = 0, .materials = {0}}};
    scene.materials.resize(1);
    validate(scene);
    std::vector<uint32_t> named = build_two_level_bvh(scene, {}).objects[0].primitives;
    std::sort(named.begin(), named.end());
    ASSERT_EQ(named.size(), once.size());
    for (uint32_t i = 0; i < named.size(); ++i) EXPECT_EQ(named[i], i);
}

TEST(Bvh, bad_boxes_and_settings_are_refused) {
    std::vector<Bounds> boxes = random_boxes(10, 3);
    EXPECT_THROW(build_bvh({}, {}), Error);
    EXPECT_THROW(build_bvh(boxes, {.bins = 1}), Error);
    EXPECT_THROW(build_bvh(boxes, {.bins = 1000}), Error);
    EXPECT_THROW(build_bvh(boxes, {.most_leaf = 0}), Error);
    EXPECT_THROW(build_bvh(boxes, {.most_leaf = kBvhMostLeaf + 1}), Error);
    EXPECT_THROW(build_bvh(boxes, {.test_cost = 0.0}), Error);
    EXPECT_THROW(build_bvh(boxes, {.most_depth = 3}), Error);
    EXPECT_THROW(build_bvh(boxes, {.most_depth = kBvhMostDepth + 1}), Error);
    boxes[7].upper.y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(build_bvh(boxes, {}), Error);
    boxes[7] = {};
    EXPECT_THROW(build_bvh(boxes, {}), Error);
}

}  // namespace
}  // namespace onepass
