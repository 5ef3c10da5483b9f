// The cells of an object's grid where they are of any size: boxes of places in a fine lattice,
// found through a tree of few levels. Frames, triangles, lists, instances and the top level are
// those of the two-level grid.
//
//   uint node_word(int index)
//   uvec4 cell_record(int index)
#pragma once
#include "shared/irregular_grid_layout.h"
#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/walked_instance.glsl"

#include "lib/grid/walk.glsl"

#define CELL uvec4

CELL no_cell() { return uvec4(0u, 0u, 0u, 0u); }

// From the top cell that holds the place down to the cell that answers for it. A word of 0, which
// is what lanes that are switched off read, ends the loop.
CELL fetch_cell(Grid grid, Walk walk) {
    ivec3 place = cell_of(grid, walk);
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

// How many places are left behind a cell's box: for a ray that goes up all beyond its last, for one
// that goes down all before its first.
float left_behind(uint ends, int stride) {
    return float(stride < 0 ? ends >> kBeyondShift : ends & kPlacesMask);
}

vec3 left_behind_full(CELL cell, Walk walk) {
    return vec3(left_behind(cell.x, walk.stride.x), left_behind(cell.y, walk.stride.y),
                left_behind(cell.z, walk.stride.z));
}

vec3 left_behind_empty(CELL cell, Walk walk, uint octant_shift) {
    return left_behind_full(cell, walk);
}
