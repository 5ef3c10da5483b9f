// Expansion: a cell that has all triangles of its neighbours on one side answers for them as well.
#include <algorithm>

#include <tbb/parallel_for.h>

#include "core/irregular_grid/stages.h"

namespace onepass {
namespace {

/// A pass reads the boxes that the pass before it left, so that the order of cells cannot show. A
/// box read so may reach farther than the cell that is found there; what it holds, it answers for.
class Pass {
  public:
    explicit Pass(const IrregularGrid& grid) : grid_(grid), dims_(grid.dims()) {}

    IrregularCell widened(IrregularCell cell) const {
        for (int axis = 0; axis < 3; ++axis) {
            cell.last[axis] = upwards(cell, axis);
            cell.lower[axis] = downwards(cell, axis);
        }
        return cell;
    }

  private:
    bool has_all_of(const IrregularCell& cell, const IrregularCell& other) const {
        if (other.count > cell.count) return false;
        return std::ranges::includes(grid_.cell_references(cell), grid_.cell_references(other));
    }

    uint32_t upwards(const IrregularCell& cell, int axis) const {
        const uint32_t side = cell.last[axis];
        if (side + 1 == dims_[axis]) return side;
        uint32_t reach = dims_[axis] - 1;
        const bool may = for_each_beside(cell, axis, side + 1, [&](const IrregularCell& other) {
            reach = std::min(reach, other.last[axis]);
        });
        return may ? reach : side;
    }

    uint32_t downwards(const IrregularCell& cell, int axis) const {
        const uint32_t side = cell.lower[axis];
        if (side == 0) return side;
        uint32_t reach = 0;
        const bool may = for_each_beside(cell, axis, side - 1, [&](const IrregularCell& other) {
            reach = std::max(reach, other.lower[axis]);
        });
        return may ? reach : side;
    }

    /// Visits boxes that cover the cell's cross-section in the layer `at`; false as soon as one has
    /// a triangle of its own.
    template <class Visit>
    bool for_each_beside(const IrregularCell& cell, int axis, uint32_t at, Visit&& visit) const {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        uvec3 place;
        place[axis] = at;
        // Row after row, as high as the lowest box of the row.
        for (uint32_t row = cell.lower[v]; row <= cell.last[v];) {
            uint32_t row_last = cell.last[v];
            place[v] = row;
            for (uint32_t column = cell.lower[u]; column <= cell.last[u];) {
                place[u] = column;
                const IrregularCell& other = grid_.cells[grid_.cell_at(place)];
                if (!has_all_of(cell, other)) return false;
                visit(other);
                row_last = std::min(row_last, other.last[v]);
                column = other.last[u] + 1;
            }
            row = row_last + 1;
        }
        return true;
    }

    const IrregularGrid& grid_;
    uvec3 dims_;
};

}  // namespace

void expand_cells(IrregularGrid& grid, uint32_t passes) {
    for (uint32_t i = 0; i < passes; ++i) {
        std::vector<IrregularCell> widened(grid.cells.size());
        const Pass pass(grid);
        tbb::parallel_for(size_t{0}, grid.cells.size(),
                          [&](size_t k) { widened[k] = pass.widened(grid.cells[k]); });
        grid.cells = std::move(widened);
    }
}

}  // namespace onepass
