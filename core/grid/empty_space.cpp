// The edge of the largest empty cube at a corner is one more than the least of its seven
// neighbours' that lie in the cube's direction: so a pass over the grid against that direction
// finds them all.
#include "core/grid/empty_space.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

namespace onepass {
namespace {

constexpr uint8_t kGreatest = kEmptyCubeEdges.back();

/// Adds the codes of a row's edges to the row's words: how many of the edges to choose from, but
/// for the first, are no larger.
void add_codes(uint32_t* __restrict codes, const uint8_t* __restrict edges, size_t count,
               uint32_t shift, uint8_t* __restrict scratch) {
    for (size_t x = 0; x < count; ++x) {
        uint8_t code = 0;
        for (size_t k = 1; k < kEmptyCubeEdges.size(); ++k) code += edges[x] >= kEmptyCubeEdges[k];
        scratch[x] = code;
    }
    for (size_t x = 0; x < count; ++x) codes[x] |= uint32_t{scratch[x]} << shift;
}

/// The longest step along a row: steps of 1, 2, 4, ... add up to all distances below kGreatest.
constexpr size_t kLongestStep = 32;
static_assert(2 * kLongestStep > kGreatest);

/// One plane of edges with a border of the greatest edge: what is outside is empty.
class Plane {
  public:
    explicit Plane(const uvec3& dims)
        : pitch_(dims.x + 2), edges_(pitch_ * (dims.y + 2), kGreatest) {}

    /// Row y from -1 to dims.y; of which cells -1 to dims.x may be read.
    uint8_t* row(ptrdiff_t y) { return &edges_[pitch_ * static_cast<size_t>(y + 1) + 1]; }

  private:
    size_t pitch_;
    std::vector<uint8_t> edges_;
};

/// By value, unlike std::min, and written so that g++ 12 finds the vector instruction.
uint8_t least(uint8_t a, uint8_t b) { return a < b ? a : b; }

/// distance + step, but at most kGreatest.
uint8_t advance(uint8_t distance, uint8_t step) {
    return static_cast<uint8_t>(least(distance, static_cast<uint8_t>(kGreatest - step)) + step);
}

/// Room for the steps of one row, with kLongestStep cells more on both sides.
struct Scratch {
    explicit Scratch(size_t count)
        : a(count + 2 * kLongestStep, kGreatest), b(a), nearest(count + 2) {}

    std::vector<uint8_t> a;
    std::vector<uint8_t> b;
    std::vector<uint8_t> nearest;
};

/// Edges of a row of cells, from the three rows ahead of it: `beside` in the same plane, `behind`
/// and `across` in the next. `ahead`: 1 or -1, the cube's direction along the row.
void measure_row(const uint32_t* begin, size_t count, ptrdiff_t ahead, uint8_t* __restrict row,
                 const uint8_t* beside, const uint8_t* behind, const uint8_t* across,
                 Scratch& scratch) {
    // What the rows ahead allow at most.
    uint8_t* const __restrict nearest = scratch.nearest.data();
    for (size_t k = 0; k < count + 2; ++k) {
        nearest[k] = least(least(beside[ptrdiff_t(k) - 1], behind[ptrdiff_t(k) - 1]),
                           across[ptrdiff_t(k) - 1]);
    }
    uint8_t* now = scratch.a.data() + kLongestStep;
    uint8_t* next = scratch.b.data() + kLongestStep;
    {
        const uint8_t* const __restrict here = nearest + 1;
        const uint8_t* const __restrict there = here + ahead;
        uint8_t* const __restrict to = now;
        for (size_t x = 0; x < count; ++x) {
            const uint8_t full = begin[x] != begin[x + 1] ? uint8_t{0} : kGreatest;
            to[x] = least(full, advance(least(here[x], there[x]), 1));
        }
    }
    // And what the cells ahead in the row allow, each step taken by all cells at once.
    for (size_t step = 1; step <= kLongestStep && step < count; step *= 2) {
        const uint8_t* const __restrict from = now;
        const uint8_t* const __restrict farther = now + ahead * static_cast<ptrdiff_t>(step);
        uint8_t* const __restrict to = next;
        for (size_t x = 0; x < count; ++x) {
            to[x] = least(from[x], advance(farther[x], static_cast<uint8_t>(step)));
        }
        std::swap(now, next);
    }
    std::copy_n(now, count, row);
}

/// The codes of one octant in planes [z_first, z_end). Edges end at kGreatest, so a pass that
/// begins so many planes ahead is right when it comes to them.
void find_in_planes(const UniformGrid& grid, uint32_t octant, ptrdiff_t z_first, ptrdiff_t z_end,
                    uint32_t* codes) {
    const auto [nx, ny, nz] = std::array<ptrdiff_t, 3>{grid.dims.x, grid.dims.y, grid.dims.z};
    const ptrdiff_t ahead_x = (octant & 1) != 0 ? 1 : -1;
    const ptrdiff_t ahead_y = (octant & 2) != 0 ? 1 : -1;
    const ptrdiff_t ahead_z = (octant & 4) != 0 ? 1 : -1;
    const uint32_t shift = empty_cube_shift(octant);
    Plane now(grid.dims);
    Plane last(grid.dims);
    Scratch scratch(grid.dims.x);
    const ptrdiff_t z_begin = ahead_z > 0 ? std::min(z_end + kGreatest, nz) - 1
                                          : std::max<ptrdiff_t>(z_first - kGreatest, 0);
    const ptrdiff_t z_last = ahead_z > 0 ? z_first : z_end - 1;
    for (ptrdiff_t z = z_begin;; z -= ahead_z) {
        for (ptrdiff_t k = 0; k < ny; ++k) {
            const ptrdiff_t y = ahead_y > 0 ? ny - 1 - k : k;
            const ptrdiff_t first_cell = nx * (y + ny * z);
            uint8_t* const row = now.row(y);
            measure_row(&grid.cell_begin[static_cast<size_t>(first_cell)], grid.dims.x, ahead_x,
                        row, now.row(y + ahead_y), last.row(y), last.row(y + ahead_y), scratch);
            if (z < z_first || z >= z_end) continue;
            add_codes(codes + first_cell, row, grid.dims.x, shift, scratch.nearest.data());
        }
        if (z == z_last) break;
        std::swap(now, last);
    }
}

}  // namespace

void find_empty_cubes(const UniformGrid& grid, uint32_t* codes) {
    // Fewer planes a task would do more of the work twice.
    constexpr uint32_t kPlanesATask = 2 * kGreatest;
    const uint32_t tasks = (grid.dims.z + kPlanesATask - 1) / kPlanesATask;
    tbb::parallel_for(uint32_t{0}, tasks, [&](uint32_t task) {
        const size_t plane = size_t{grid.dims.x} * grid.dims.y;
        const uint32_t first = task * kPlanesATask;
        const uint32_t end = std::min(first + kPlanesATask, grid.dims.z);
        std::fill(codes + plane * first, codes + plane * end, 0u);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            find_in_planes(grid, octant, first, end, codes);
        }
    });
}

}  // namespace onepass
