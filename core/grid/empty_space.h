// How far a ray may go through empty cells without asking: the distance to the nearest full cell.
//
// Computed from a built grid; who packs grids may keep it in the words of empty cells, which hold
// nothing else.
#pragma once

#include <cstdint>

#include "core/grid/uniform_grid.h"
#include "core/raw_vector.h"

namespace onepass {

/// For each cell the Chebyshev distance (the largest of the three coordinate differences), in
/// cells, to the nearest cell that has references, but at most `greatest`: 0 for a full cell, 1 for
/// an empty one with a full neighbour among its 26. From an empty cell with distance d all cells
/// less than d away, those outside the grid included, are empty.
///
/// Layout: as UniformGrid::cell_begin, one byte a cell.
/// Cost:   O(cells) time, parallel; 1 byte a cell, the result, and a row of cells a task.
RawVector<uint8_t> distance_to_full_cell(const UniformGrid& grid, uint8_t greatest = 255);

}  // namespace onepass
