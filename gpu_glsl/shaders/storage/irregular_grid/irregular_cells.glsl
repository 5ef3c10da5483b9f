// The cells of an object's grid where they are of any size: boxes of places in a fine lattice,
// found through a tree of few levels. Frames, triangles, lists, instances and the top level are
// those of the two-level grid.
//
//   uint node_word(int index)
//   uvec4 cell_record(int index)
#pragma once
#include "shared/irregular_grid_layout.h"
#include "storage/two_level_grid/grid_buffers.glsl"

#define CELL uvec4

// From the top cell that holds the place down to the cell that answers for it. A word of 0, which
// is what lanes that are switched off read, ends the loop.
CELL fetch_cell(Grid grid, ivec3 place) {
    int shift = grid.depth;
    ivec3 top = place >> shift;
    ivec3 dims = grid.dims >> shift;
    uint node = node_word(grid.first_cell + top.x + dims.x * (top.y + dims.y * top.z));
    const uint kBitsMask = (1u << kNodeBits) - 1u;
    const int kMostLevels = 16;
    for (int left = kMostLevels; left > 0 && (node & kBitsMask) != 0u; --left) {
        int bits = int(node & kBitsMask);
        shift -= bits;
        ivec3 part = (place >> shift) & ivec3((1 << bits) - 1);
        node = node_word(int(node >> kNodeBits) + part.x + ((part.y + (part.z << bits)) << bits));
    }
    return cell_record(int(node >> kNodeBits));
}

bool is_empty_cell(CELL cell) { return is_empty_cell(cell.w); }
int first_reference(CELL cell) { return first_reference(cell.w); }

// The last place of a cell's box for a ray that goes up, the first for one that goes down.
int far_place(uint ends, int step) {
    return int(step > 0 ? kMostPlace - (ends >> kLastPlaceShift) : ends & kMostPlace);
}

ivec3 far_corner(CELL cell, ivec3 place, ivec3 step, uint octant_shift) {
    return ivec3(far_place(cell.x, step.x), far_place(cell.y, step.y), far_place(cell.z, step.z));
}
