// Where lists of references lie in the reference texture: a list never crosses a row.
//
// The object grids' lists come first and the top level's after them, from a row of its own on, so
// that it can be laid again without moving theirs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/uniform_grid.h"

namespace onepass {

/// One a cell: the index (column + width * row) of the cell's first reference.
using ListPlaces = std::vector<uint32_t>;

/// Lays lists behind each other in rows of `width` texels.
class ListRows {
  public:
    explicit ListRows(uint32_t width, uint32_t first_row = 0) : width_(width), row_(first_row) {}

    /// No list may be longer than a row.
    ListPlaces lay(const UniformGrid& grid);

    /// The row after the last one begun.
    uint64_t end_row() const { return column_ == 0 ? row_ : row_ + 1; }

  private:
    uint64_t width_;
    uint64_t row_;
    uint64_t column_ = 0;
};

/// Where the lists of all grids lie.
struct ListLayout {
    uint32_t width = 0;          ///< of the texture
    uint32_t rows = 0;           ///< of the texture
    uint32_t first_top_row = 0;  ///< those before it are the objects'
    std::vector<ListPlaces> objects;
    ListPlaces top;
};

/// As square as powers of two allow, but no side below that of `least`. `room_to_grow`: with rows
/// for a top level of twice the references, as far as `max_side` reaches.
/// Throws: Error if the lists exceed `max_side`.
ListLayout choose_list_layout(std::span<const UniformGrid> objects, const UniformGrid& top,
                              uint32_t max_side, bool room_to_grow, uvec2 least);

/// The length of a grid's longest list.
uint32_t longest_list(const UniformGrid& grid);

}  // namespace onepass
