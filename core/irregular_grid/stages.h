// The stages of an irregular grid's build (internal to core/irregular_grid).
#pragma once

#include <cstdint>
#include <vector>

#include "core/irregular_grid/irregular_grid.h"

namespace onepass {

/// Part of a grid by itself: what one cube of the lattice is divided into. Nodes, cells and
/// references count from its own beginnings.
struct Subtree {
    IrregularNode root;
    std::vector<IrregularNode> nodes;
    std::vector<IrregularCell> cells;
    std::vector<uint32_t> references;
};

/// Divides a cube of 2^size_bits lattice cells a side, with these triangles in it, while that
/// lowers the expected cost of a ray that meets it.
/// `grid` says where the lattice lies: bounds, edge, top_dims and depth.
Subtree divide_cube(const Object& object, const IrregularGrid& grid,
                    const IrregularGridSettings& settings, uvec3 lower, uint32_t size_bits,
                    std::vector<uint32_t> references);

/// Merges neighbours that make a box together, where that lowers the expected cost.
void merge_cells(Subtree& tree, double cell_cost);

/// Widens the boxes of cells over neighbours all of whose triangles they have themselves.
void expand_cells(IrregularGrid& grid, uint32_t passes);

/// Expected tests and steps of a ray that meets a cell, beside those of other cells: its surface
/// times what it costs.
inline double expected_cost(uvec3 lower, uvec3 last, size_t triangles, double cell_cost) {
    const dvec3 size = dvec3(last - lower) + 1.0;
    return (size.x * size.y + size.y * size.z + size.z * size.x) *
           (static_cast<double>(triangles) + cell_cost);
}

}  // namespace onepass
