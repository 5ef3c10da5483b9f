// The distance to the nearest full cell against its definition, cell by cell.
#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "core/grid/empty_space.h"

namespace onepass {
namespace {

/// A grid whose full cells are given; each has one reference.
UniformGrid grid_with(const uvec3& dims, const std::vector<uvec3>& full) {
    UniformGrid grid;
    grid.dims = dims;
    std::vector<bool> is_full(grid.cell_count(), false);
    for (const uvec3& cell : full) is_full[grid.cell_index(cell)] = true;
    grid.cell_begin.push_back(0);
    for (const bool one : is_full) grid.cell_begin.push_back(grid.cell_begin.back() + one);
    grid.references.assign(grid.cell_begin.back(), 0);
    return grid;
}

UniformGrid random_grid(const uvec3& dims, int full_count, uint32_t seed) {
    std::mt19937 engine(seed);
    const auto below = [&](uint32_t n) {
        return std::uniform_int_distribution<uint32_t>(0, n - 1)(engine);
    };
    std::vector<uvec3> full;
    for (int i = 0; i < full_count; ++i) {
        const uint32_t x = below(dims.x);
        const uint32_t y = below(dims.y);
        full.emplace_back(x, y, below(dims.z));
    }
    return grid_with(dims, full);
}

std::vector<uvec3> full_cells(const UniformGrid& grid) {
    std::vector<uvec3> full;
    for (uint32_t z = 0; z < grid.dims.z; ++z) {
        for (uint32_t y = 0; y < grid.dims.y; ++y) {
            for (uint32_t x = 0; x < grid.dims.x; ++x) {
                if (!grid.cell_references({x, y, z}).empty()) full.emplace_back(x, y, z);
            }
        }
    }
    return full;
}

/// The definition.
uint8_t expected_distance(const std::vector<uvec3>& full, const ivec3& cell, int greatest) {
    int distance = greatest;
    for (const uvec3& other : full) {
        const ivec3 apart = glm::abs(ivec3(other) - cell);
        distance = std::min(distance, std::max({apart.x, apart.y, apart.z}));
    }
    return static_cast<uint8_t>(distance);
}

void expect_distances(const UniformGrid& grid, uint8_t greatest) {
    const RawVector<uint8_t> distances = distance_to_full_cell(grid, greatest);
    ASSERT_EQ(distances.size(), grid.cell_count());
    const std::vector<uvec3> full = full_cells(grid);
    size_t wrong = 0;
    for (uint32_t z = 0; z < grid.dims.z; ++z) {
        for (uint32_t y = 0; y < grid.dims.y; ++y) {
            for (uint32_t x = 0; x < grid.dims.x; ++x) {
                const uint8_t expected = expected_distance(full, ivec3(x, y, z), greatest);
                wrong += distances[grid.cell_index({x, y, z})] != expected;
            }
        }
    }
    EXPECT_EQ(wrong, 0u) << grid.dims.x << " x " << grid.dims.y << " x " << grid.dims.z << ", "
                         << full.size() << " full, at most " << int(greatest);
}

TEST(DistanceToFullCell, is_exact_for_sparse_and_dense_cells) {
    for (const int full : {1, 2, 5, 30, 400}) {
        expect_distances(random_grid(uvec3(23, 19, 17), full, uint32_t(full)), 255);
    }
}

TEST(DistanceToFullCell, is_exact_in_grids_of_one_row_one_plane_and_one_cell) {
    for (const uvec3& dims : {uvec3(1), uvec3(70, 1, 1), uvec3(1, 70, 1), uvec3(1, 1, 70),
                              uvec3(2, 40, 1), uvec3(1, 30, 40), uvec3(40, 1, 30)}) {
        expect_distances(random_grid(dims, 1, 1), 255);
        expect_distances(random_grid(dims, 3, 2), 255);
    }
}

TEST(DistanceToFullCell, ends_at_the_greatest) {
    for (const uint8_t greatest : {1, 2, 6, 254, 255}) {
        expect_distances(random_grid(uvec3(20, 15, 11), 2, greatest), greatest);
        expect_distances(random_grid(uvec3(600, 2, 1), 1, greatest), greatest);
        expect_distances(random_grid(uvec3(2, 1, 600), 1, greatest), greatest);
    }
}

TEST(DistanceToFullCell, is_the_greatest_everywhere_if_no_cell_is_full) {
    expect_distances(grid_with(uvec3(9, 8, 7), {}), 255);
    expect_distances(grid_with(uvec3(9, 8, 7), {}), 3);
}

TEST(DistanceToFullCell, is_the_same_for_any_thread_count_where_a_plane_is_many_tasks) {
    const UniformGrid grid = random_grid(uvec3(512, 300, 5), 40, 1);
    const auto with_threads = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return tbb::task_arena(threads).execute([&] { return distance_to_full_cell(grid); });
    };
    expect_distances(grid, 255);
    EXPECT_EQ(with_threads(1), with_threads(7));
}

}  // namespace
}  // namespace onepass
