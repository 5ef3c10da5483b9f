// How far a ray may go through empty cells without asking: empty cubes ahead of every cell.
//
// Computed from a built grid; who packs grids keeps it in the words of empty cells, which hold
// nothing else.
#pragma once

#include <array>
#include <cstdint>

#include "core/grid/uniform_grid.h"

namespace onepass {

/// Edges of cubes that a code of three bits can say, in cells.
inline constexpr std::array<uint8_t, 8> kEmptyCubeEdges = {1, 2, 3, 5, 8, 13, 21, 34};

/// The place of an octant's code in a cell's word, in bits. Octant: 1 for rays towards greater x,
/// plus 2 for greater y, plus 4 for greater z.
constexpr uint32_t empty_cube_shift(uint32_t octant) { return 3 * octant; }

/// For each cell and each octant of directions the edge of a cube of empty cells that has the cell
/// at the corner where rays of the octant come from: the largest of kEmptyCubeEdges that fits.
/// Cells outside the grid are empty.
///
/// Layout: `codes` as UniformGrid::cell_begin, one word a cell: the eight codes, indices into
/// kEmptyCubeEdges, at empty_cube_shift(); 0 for a full cell.
/// Cost:   O(cells) time, parallel by planes; two planes of bytes a task.
/// Source: after Cohen & Sheffer 1994 (proximity clouds), one cube an octant.
void find_empty_cubes(const UniformGrid& grid, uint32_t* codes);

}  // namespace onepass
