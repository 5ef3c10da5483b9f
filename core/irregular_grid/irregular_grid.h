// Irregular grids: cells as large or small as the triangles ask for, for the `irregular_grid`
// strategy.
//
// All borders lie on the planes of one fine lattice, so that a walk needs integers alone. The build
// is three stages (stages.h): cells are divided while that pays, neighbours are merged where that
// pays, and each cell's box is widened over neighbours that hold no triangle of their own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/bounds.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// A box of lattice cells, both ends inclusive, and the triangles that reach into it:
/// references[first] .. references[first + count - 1] of its grid, ascending.
struct IrregularCell {
    uvec3 lower{0};
    uvec3 last{0};
    uint32_t first = 0;
    uint32_t count = 0;

    bool operator==(const IrregularCell&) const = default;
};

/// A node says where a cube of the lattice belongs: to one cell, or divided by 2^bits on each axis,
/// x fastest, then y, then z, into nodes that follow each other.
struct IrregularNode {
    static constexpr uint32_t kBits = 3;  ///< of a word, for `bits`; the rest is `first`
    static constexpr uint32_t kMostFirst = (1u << (32 - kBits)) - 1;

    uint32_t bits = 0;   ///< 0: a cell
    uint32_t first = 0;  ///< the first of the nodes, or the cell

    bool operator==(const IrregularNode&) const = default;
};

/// Layout: the first nodes are the top cells, x fastest, then y, then z; each is a cube of 2^depth
///         lattice cells a side. Cells' boxes overlap: a cell answers for all of its box, and the
///         nodes say which of them a lattice cell finds.
/// Units:  `bounds` and `edge` in object space. Lattice cell (0, 0, 0) is at bounds.lower; the
///         lattice may reach beyond bounds.upper, because its cells are cubes.
struct IrregularGrid {
    Bounds bounds;
    double edge = 0.0;  ///< of a lattice cell
    uvec3 top_dims{1};
    uint32_t depth = 0;
    std::vector<IrregularNode> nodes;
    std::vector<IrregularCell> cells;
    std::vector<uint32_t> references;

    uvec3 dims() const { return top_dims << depth; }
    /// The cell that a place of the lattice finds: an index.
    uint32_t cell_at(uvec3 place) const;
    std::span<const uint32_t> cell_references(const IrregularCell& cell) const {
        return std::span(references).subspan(cell.first, cell.count);
    }

    bool operator==(const IrregularGrid&) const = default;
};

/// How a grid is made.
struct IrregularGridSettings {
    double top_density = 0.12;  ///< top cells a triangle
    double density = 1.0;       ///< cells that a cell is divided into, a triangle in it
    double cell_cost = 3.0;     ///< of a step to a cell, in triangle tests
    uint32_t expansions = 3;    ///< passes that widen cells

    bool operator==(const IrregularGridSettings&) const = default;
};

/// Lattice cells an axis, at most: a cell's two ends on an axis share a word.
inline constexpr uint32_t kLatticeMost = 1u << 16;

/// A triangle is in the lists of all cells that it comes this near to, as a share of the lattice's
/// extent on each axis: 32 half ulps, where a walk is off by 20 at most (gpu_glsl/README.md).
inline constexpr double kLatticePad = 0x1p-19;

/// Builds a grid over an object's triangles. A triangle's exact surface decides, not its box
/// (separating axes). One that equals a lower one is in no cell (core/grid/duplicates.h).
///
/// Cost:   O(references log references) time a level; parallel, the same bits for any thread count.
/// Throws: Error if there is no triangle, if the box is not finite, or if nodes, cells or
/// references
///         exceed what a word can name.
/// Source: Kalojanov, Billeter & Slusallek 2011 (nested cells); Perard-Gayot, Kalojanov & Slusallek
///         2017 (merging, expansion). Cells are divided again as long as it pays, not once.
IrregularGrid build_irregular_grid(const Object& object, const IrregularGridSettings& settings);

}  // namespace onepass
