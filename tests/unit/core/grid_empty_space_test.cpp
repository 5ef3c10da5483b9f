// Empty cubes against their definition, cell by cell.
#include <random>
#include <vector>

#include <gtest/gtest.h>

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

/// The definition: the largest of the edges whose cube, from `cell` towards the octant, is empty.
uint32_t expected_code(const UniformGrid& grid, const ivec3& cell, uint32_t octant) {
    const ivec3 ahead((octant & 1) != 0 ? 1 : -1, (octant & 2) != 0 ? 1 : -1,
                      (octant & 4) != 0 ? 1 : -1);
    const auto is_full = [&](const ivec3& at) {
        const bool is_inside = glm::all(glm::greaterThanEqual(at, ivec3(0))) &&
                               glm::all(glm::lessThan(at, ivec3(grid.dims)));
        return is_inside && !grid.cell_references(uvec3(at)).empty();
    };
    const auto fits = [&](int edge) {
        for (int k = 0; k < edge * edge * edge; ++k) {
            if (is_full(cell + ahead * ivec3(k % edge, k / edge % edge, k / (edge * edge)))) {
                return false;
            }
        }
        return true;
    };
    uint32_t code = 0;
    while (code + 1 < kEmptyCubeEdges.size() && fits(kEmptyCubeEdges[code + 1])) ++code;
    return code;
}

/// All cells, or every `stride`-th.
void expect_cubes(const UniformGrid& grid, uint64_t stride = 1) {
    std::vector<uint32_t> codes(grid.cell_count(), 0xFFFFFFFFu);
    find_empty_cubes(grid, codes.data());
    size_t wrong = 0;
    for (uint64_t i = 0; i < grid.cell_count(); i += stride) {
        const uvec3 cell(i % grid.dims.x, i / grid.dims.x % grid.dims.y,
                         i / (uint64_t{grid.dims.x} * grid.dims.y));
        const bool is_empty = grid.cell_references(cell).empty();
        uint32_t expected = is_empty ? kEmptyCellBit : 0;
        for (uint32_t octant = 0; octant < 8 && is_empty; ++octant) {
            expected |= expected_code(grid, ivec3(cell), octant) << empty_cube_shift(octant);
        }
        wrong += codes[i] != expected;
    }
    EXPECT_EQ(wrong, 0u) << grid.dims.x << " x " << grid.dims.y << " x " << grid.dims.z;
}

TEST(EmptyCubes, are_as_large_as_fits_among_sparse_and_dense_cells) {
    for (const int full : {1, 2, 5, 30, 400}) {
        expect_cubes(random_grid(uvec3(13, 11, 9), full, uint32_t(full)), full < 30 ? 13 : 1);
    }
    expect_cubes(random_grid(uvec3(60, 50, 41), 3, 1), 9973);
    expect_cubes(random_grid(uvec3(200, 9, 7), 5, 2), 101);
}

TEST(EmptyCubes, are_found_in_grids_of_one_row_one_plane_and_one_cell) {
    for (const uvec3& dims : {uvec3(1), uvec3(70, 1, 1), uvec3(1, 70, 1), uvec3(1, 1, 70),
                              uvec3(2, 20, 1), uvec3(1, 12, 15)}) {
        expect_cubes(random_grid(dims, 1, 1), 3);
        expect_cubes(random_grid(dims, 3, 2), 3);
    }
}

TEST(EmptyCubes, are_the_greatest_everywhere_if_no_cell_is_full) {
    expect_cubes(grid_with(uvec3(9, 8, 7), {}), 101);
}

TEST(EmptyCubes, do_not_show_where_one_task_ends_and_the_next_begins) {
    expect_cubes(random_grid(uvec3(6, 5, 300), 12, 1), 61);
}

}  // namespace
}  // namespace onepass
