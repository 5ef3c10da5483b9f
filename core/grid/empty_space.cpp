// The chessboard distance transform, one axis after the other (Rosenfeld & Pfaltz 1968, in 3D).
//
// A cell's distance is at most one more than that of any of its neighbours, and two passes that
// apply this in opposite directions are enough. First each row along x by itself; then the rows of
// each plane, from the row before, diagonal neighbours included; then the planes, from the nine
// neighbours in the plane before. All but the first step works on whole rows at a time, every cell
// of a row alike, which the compiler turns into vector code.
#include "core/grid/empty_space.h"

#include <algorithm>
#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace onepass {
namespace {

/// Cells that are worth a task of their own.
constexpr size_t kCellsATask = size_t{1} << 15;

/// Distances, row by row.
struct Distances {
    uint8_t* cells;
    uvec3 dims;
    uint8_t greatest;

    uint8_t* row(size_t y, size_t z) const { return cells + dims.x * (y + dims.y * z); }
};

uint8_t one_more(uint8_t distance, uint8_t greatest) {
    return distance < greatest ? static_cast<uint8_t>(distance + 1) : greatest;
}

/// Distances within the row: 0 for full cells, then one more from cell to cell, both ways.
void measure_row(const UniformGrid& grid, const Distances& distances, size_t y, size_t z) {
    uint8_t* const row = distances.row(y, z);
    const uint32_t* const begin = grid.cell_begin.data() + (row - distances.cells);
    const uint8_t greatest = distances.greatest;
    uint8_t distance = greatest;
    for (size_t x = 0; x < distances.dims.x; ++x) {
        distance = begin[x] != begin[x + 1] ? uint8_t{0} : one_more(distance, greatest);
        row[x] = distance;
    }
    for (size_t x = distances.dims.x; x-- > 0;) {
        distance = std::min(row[x], one_more(distance, greatest));
        row[x] = distance;
    }
}

/// Each cell of `row` is at most one more than the three of `beside` at x - 1, x and x + 1. The
/// rows do not overlap.
void approach_row(uint8_t* __restrict row, const uint8_t* __restrict beside, size_t count,
                  uint8_t greatest) {
    if (count == 1) {
        row[0] = std::min(row[0], one_more(beside[0], greatest));
        return;
    }
    row[0] = std::min(row[0], one_more(std::min(beside[0], beside[1]), greatest));
    for (size_t x = 1; x + 1 < count; ++x) {
        const uint8_t nearest = std::min(std::min(beside[x - 1], beside[x]), beside[x + 1]);
        row[x] = std::min(row[x], one_more(nearest, greatest));
    }
    const size_t last = count - 1;
    row[last] = std::min(row[last], one_more(std::min(beside[last - 1], beside[last]), greatest));
}

/// Distances within plane z, from those within its rows.
void measure_plane(const Distances& distances, size_t z) {
    const auto [dims, greatest] = std::pair(distances.dims, distances.greatest);
    for (size_t y = 1; y < dims.y; ++y) {
        approach_row(distances.row(y, z), distances.row(y - 1, z), dims.x, greatest);
    }
    for (size_t y = dims.y - 1; y-- > 0;) {
        approach_row(distances.row(y, z), distances.row(y + 1, z), dims.x, greatest);
    }
}

/// nearest[x] is the least of the three cells x of the rows y - 1, y and y + 1 of a plane.
void least_of_rows(const Distances& distances, size_t y, size_t z, uint8_t* __restrict nearest) {
    const uint8_t* const middle = distances.row(y, z);
    const uint8_t* const below = y > 0 ? distances.row(y - 1, z) : middle;
    const uint8_t* const above = y + 1 < distances.dims.y ? distances.row(y + 1, z) : middle;
    for (size_t x = 0; x < distances.dims.x; ++x) {
        nearest[x] = std::min(std::min(below[x], middle[x]), above[x]);
    }
}

/// Each cell of plane z is at most one more than its nine neighbours in the plane `beside`.
void approach_plane(const Distances& distances, size_t z, size_t beside) {
    const size_t rows_a_task = std::max<size_t>(1, kCellsATask / distances.dims.x);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, distances.dims.y, rows_a_task),
                      [&](const auto& rows) {
                          std::vector<uint8_t> nearest(distances.dims.x);
                          for (size_t y = rows.begin(); y != rows.end(); ++y) {
                              least_of_rows(distances, y, beside, nearest.data());
                              approach_row(distances.row(y, z), nearest.data(), nearest.size(),
                                           distances.greatest);
                          }
                      });
}

}  // namespace

RawVector<uint8_t> distance_to_full_cell(const UniformGrid& grid, uint8_t greatest) {
    RawVector<uint8_t> cells(grid.cell_count());
    const Distances distances{cells.data(), grid.dims, greatest};

    // Along x, then along y: planes on their own.
    tbb::parallel_for(uint32_t{0}, grid.dims.z, [&](uint32_t z) {
        for (uint32_t y = 0; y < grid.dims.y; ++y) measure_row(grid, distances, y, z);
        measure_plane(distances, z);
    });

    // Along z: plane after plane, the rows of each on their own.
    for (uint32_t z = 1; z < grid.dims.z; ++z) approach_plane(distances, z, z - 1);
    for (uint32_t z = grid.dims.z - 1; z-- > 0;) approach_plane(distances, z, z + 1);
    return cells;
}

}  // namespace onepass
