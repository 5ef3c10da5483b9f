// The order of storage: every triangle once, and together what lies together.
#include "core/storage_order.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "scenes/shapes.h"

namespace onepass::test {
namespace {

/// The same mesh, its triangles and vertices in an order without sense.
Object shuffled(Object object) {
    std::mt19937 random(1);
    std::vector<uint32_t> places(object.positions.size());
    std::iota(places.begin(), places.end(), 0u);
    std::ranges::shuffle(places, random);
    std::vector<vec3> positions(object.positions.size());
    for (size_t i = 0; i < places.size(); ++i) positions[places[i]] = object.positions[i];
    object.positions = positions;
    for (uvec3& triangle : object.triangles) {
        for (int v = 0; v < 3; ++v) triangle[v] = places[triangle[v]];
    }
    std::ranges::shuffle(object.triangles, random);
    return object;
}

vec3 middle_of(const Object& object, uint32_t triangle) {
    const uvec3& t = object.triangles[triangle];
    return (object.positions[t.x] + object.positions[t.y] + object.positions[t.z]) / 3.0f;
}

/// Of how far a triangle lies from the one stored before it.
float mean_step(const Object& object, const std::vector<uint32_t>& order) {
    float sum = 0.0f;
    for (size_t i = 1; i < order.size(); ++i) {
        sum += glm::distance(middle_of(object, order[i - 1]), middle_of(object, order[i]));
    }
    return sum / static_cast<float>(order.size() - 1);
}

/// The triangles as they lie in storage, each once.
std::vector<uint32_t> stored(const Object& object) {
    constexpr uint32_t kNone = ~0u;
    const RawVector<uint32_t> slots = storage_slots(object, object_bounds(object));
    EXPECT_EQ(slots.size(), object.triangles.size());
    std::vector<uint32_t> triangles(slots.size(), kNone);
    for (uint32_t i = 0; i < slots.size(); ++i) {
        EXPECT_EQ(std::exchange(triangles.at(slots[i]), i), kNone);
    }
    return triangles;
}

TEST(StorageOrder, keeps_together_what_lies_together) {
    const Object ball = shuffled(make_sphere(60, 40));
    const std::vector<uint32_t> order = stored(ball);
    std::vector<uint32_t> as_given(ball.triangles.size());
    std::iota(as_given.begin(), as_given.end(), 0u);
    // Of one cube, 1/16 of the ball wide, they are at most 0.22 apart; any two are 1.33 on average.
    EXPECT_LT(mean_step(ball, order), 0.3f * mean_step(ball, as_given));
}

TEST(StorageOrder, is_the_same_for_any_number_of_threads) {
    const Object ball = shuffled(make_sphere(200, 120));
    const RawVector<uint32_t> many = storage_slots(ball, object_bounds(ball));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(storage_slots(ball, object_bounds(ball)), many);
}

TEST(StorageOrder, puts_those_of_one_cube_by_number) {
    Object points;
    points.positions = {vec3(1, 2, 3), vec3(9, 9, 9), vec3(1, 2, 3)};
    points.triangles = {uvec3(2, 2, 2), uvec3(1, 1, 1), uvec3(0, 0, 0), uvec3(0, 2, 0),
                        uvec3(1, 1, 1), uvec3(0, 0, 2), uvec3(2, 0, 0), uvec3(0, 0, 0)};
    EXPECT_EQ(stored(points), (std::vector<uint32_t>{0, 2, 3, 5, 6, 7, 1, 4}));
    points.positions[1] = points.positions[0];  // a box without an extent
    EXPECT_EQ(stored(points), (std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_TRUE(storage_slots(Object{}, Bounds{}).empty());
}

TEST(StorageOrder, takes_any_finite_numbers) {
    constexpr float kMost = std::numeric_limits<float>::max();
    constexpr float kLeast = std::numeric_limits<float>::denorm_min();
    for (const float size : {kMost, kLeast}) {
        Object corners;
        for (uint32_t i = 0; i < 64; ++i) {
            corners.positions.push_back(size *
                                        vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
            corners.triangles.push_back(uvec3(i));
        }
        const std::vector<uint32_t> order = stored(corners);
        const bool is_one_cube = size == kLeast;
        for (size_t i = 0; i < order.size(); ++i) {
            EXPECT_EQ(order[i] % 8, is_one_cube ? i % 8 : i / 8);
        }
    }
}

}  // namespace
}  // namespace onepass::test
