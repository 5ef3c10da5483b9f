// The cells of an object's grid where all are of one size: a word each. What a walk asks of cells:
// storage/two_level_grid/grid_buffers.glsl.
#pragma once
#include "storage/two_level_grid/grid_buffers.glsl"

#define CELL uint

CELL fetch_cell(Grid grid, ivec3 place) { return cell_word(cell_index(grid, place)); }

// An empty cell's cube ahead; a full cell is its own.
ivec3 far_corner(CELL cell, ivec3 place, ivec3 step, uint octant_shift) {
    return place + step * (empty_cube(cell, octant_shift) - 1);
}
