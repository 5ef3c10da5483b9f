// How far a ray may go through empty cells without asking: empty cubes ahead of every cell.
//
// Computed from a built grid; who packs grids keeps it in the words of empty cells, which hold
// nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/grid/uniform_grid.h"
#include "core/raw_vector.h"

namespace onepass {

/// Edges of cubes that a code of three bits can say, in cells. Each is at most twice the one
/// before: so the cubes of one edge, laid over each other, fill those of the next.
inline constexpr std::array<uint8_t, 8> kEmptyCubeEdges = {1, 2, 4, 7, 11, 16, 22, 29};

/// The place of an octant's code in a cell's word, in bits. Octant: 1 for rays towards greater x,
/// plus 2 for greater y, plus 4 for greater z.
constexpr uint32_t empty_cube_shift(uint32_t octant) { return 3 * octant; }

/// The bit of an empty cell's word.
inline constexpr uint32_t kEmptyCellBit = 0x80000000u;

/// For each cell and each octant of directions the edge of a cube of empty cells that has the cell
/// at the corner where rays of the octant come from: the largest of kEmptyCubeEdges that fits.
/// Cells outside the grid are empty.
///
/// What is empty is kept as bits, one a cell and edge; words are made of them row by row, so that
/// the grid's own arrays may give way to the words.
/// Cost:   O(cells) time, parallel, 64 cells at once; 8 bits a cell, and a border.
/// Source: after Cohen & Sheffer 1994 (proximity clouds), one cube an octant.
class EmptyCubes {
  public:
    explicit EmptyCubes(const UniformGrid& grid);

    /// The words of the row of cells (0, y, z) ..: 0 for a full cell, else kEmptyCellBit and the
    /// eight codes, indices into kEmptyCubeEdges, at empty_cube_shift(). `words`: one a cell.
    void row_words(uint32_t y, uint32_t z, uint32_t* words) const;

  private:
    /// Whether a box of cells is empty, a bit for each of its places. Bit (x, y, z) is that of the
    /// box whose *last* cell is (x, y, z); with all that reach into the grid, x goes from 0 to
    /// dims.x + edges.x - 2. What lies farther is empty.
    struct Level {
        uvec3 edges;  ///< of the box; never more than the grid's, which would say the same
        uvec2 rows;   ///< in y and z
        RawVector<uint64_t> bits;
    };

    /// The bits of a row, or a row of ones where no box reaches into the grid.
    const uint64_t* row(const Level& level, int64_t y, int64_t z) const;

    Level first_level(const UniformGrid& grid) const;
    Level next_level(const Level& from, uint32_t edge) const;

    uvec3 dims_;
    size_t pitch_;                   ///< words of a row of bits
    std::vector<uint64_t> outside_;  ///< a row of ones
    std::vector<Level> levels_;      ///< one an edge of kEmptyCubeEdges
};

/// The words of all cells. Layout: `words` as UniformGrid::cell_begin.
void find_empty_cubes(const UniformGrid& grid, uint32_t* words);

}  // namespace onepass
