// Triangles that equal a lower one: which they are, and that a grid without them loses nothing
// else.
#include "core/grid/duplicates.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/grid/uniform_grid.h"

namespace onepass {
namespace {

/// Triangles among few places, so that many are equal: by index, by place, turned and reversed.
Object crowded_object(uint32_t triangles) {
    std::mt19937 engine(7);
    std::uniform_int_distribution<int> place(0, 2);
    Object object;
    object.name = "crowded";
    for (uint32_t i = 0; i < triangles; ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            object.positions.emplace_back(place(engine), place(engine), place(engine));
        }
        object.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    object.groups = {{"all", 0, triangles}};
    return object;
}

bool equal_corners(const Object& object, size_t a, size_t b) {
    const auto corners = [&](size_t t) {
        std::vector<vec3> all;
        for (int c = 0; c < 3; ++c) all.push_back(object.positions[object.triangles[t][c]]);
        return all;
    };
    const std::vector<vec3> first = corners(a);
    const std::vector<vec3> second = corners(b);
    return std::is_permutation(first.begin(), first.end(), second.begin());
}

TEST(Duplicates, are_those_that_a_comparison_of_all_pairs_finds) {
    const Object object = crowded_object(600);
    const std::vector<uint8_t> found = later_duplicates(object);
    ASSERT_EQ(found.size(), object.triangles.size());
    size_t count = 0;
    for (size_t i = 0; i < found.size(); ++i) {
        bool expected = false;
        for (size_t j = 0; j < i; ++j) expected = expected || equal_corners(object, i, j);
        EXPECT_EQ(found[i] != 0, expected) << i;
        count += expected ? 1 : 0;
    }
    EXPECT_GT(count, 20u);
    EXPECT_LT(count, 580u);
}

TEST(Duplicates, of_distinct_triangles_there_are_none) {
    Object object = crowded_object(1);
    object.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    object.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {0, 0, 1}, {0, 1, 1}};
    EXPECT_TRUE(later_duplicates(object).empty());
}

TEST(Duplicates, know_that_minus_zero_is_zero) {
    Object object = crowded_object(1);
    object.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, -0.0f}};
    object.triangles = {{0, 1, 2}, {2, 3, 1}};
    EXPECT_EQ(later_duplicates(object), (std::vector<uint8_t>{0, 1}));
}

TEST(Duplicates, are_found_in_a_large_object_too) {
    // A fifth of them again, reversed.
    Object object = crowded_object(1);
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    object.positions.clear();
    object.triangles.clear();
    constexpr uint32_t kDistinct = 40000;
    for (uint32_t i = 0; i < 3 * kDistinct; ++i) {
        const float x = unit(engine);
        const float y = unit(engine);
        object.positions.emplace_back(x, y, unit(engine));
    }
    for (uint32_t i = 0; i < kDistinct; ++i)
        object.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    EXPECT_TRUE(later_duplicates(object).empty());
    for (uint32_t i = 0; i < kDistinct; i += 5) {
        object.triangles.emplace_back(3 * i + 2, 3 * i + 1, 3 * i);
    }
    std::vector<uint8_t> expected(object.triangles.size(), 0);
    std::fill(expected.begin() + kDistinct, expected.end(), uint8_t{1});
    EXPECT_EQ(later_duplicates(object), expected);
}

TEST(Duplicates, are_the_same_for_any_number_of_threads) {
    const Object object = crowded_object(30000);
    std::vector<uint8_t> alone;
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        alone = later_duplicates(object);
    }
    ASSERT_FALSE(alone.empty()) << "or there is nothing to compare";
    EXPECT_EQ(later_duplicates(object), alone);
}

TEST(Duplicates, a_grid_without_them_names_all_other_triangles_where_it_did) {
    const Object object = crowded_object(600);
    const std::vector<uint8_t> is_later = later_duplicates(object);
    const GridSizing sizing{.resolution = uvec3(4, 5, 6)};
    const UniformGrid all = build_triangle_grid(object, sizing);
    const UniformGrid some = build_triangle_grid(object, sizing, Duplicates::dropped);
    ASSERT_EQ(all.dims, some.dims);
    uvec3 cell(0);
    for (cell.z = 0; cell.z < all.dims.z; ++cell.z) {
        for (cell.y = 0; cell.y < all.dims.y; ++cell.y) {
            for (cell.x = 0; cell.x < all.dims.x; ++cell.x) {
                std::vector<uint32_t> expected;
                for (const uint32_t t : all.cell_references(cell)) {
                    if (is_later[t] == 0) expected.push_back(t);
                }
                EXPECT_TRUE(std::ranges::equal(some.cell_references(cell), expected));
            }
        }
    }
    EXPECT_LT(some.references.size(), all.references.size());
}

}  // namespace
}  // namespace onepass
