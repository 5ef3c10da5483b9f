// The cells of an object's grid where all are of one size: a word each.
//
//   uint cell_word(int index)
//
// What a walk asks of cells:
//
//   CELL fetch_cell(Grid, Walk), no_cell()
//   bool is_empty_cell(CELL)
//   int first_reference(CELL)      of a full one
//   vec3 left_behind_empty(CELL, Walk, uint octant_shift), left_behind_full(CELL, Walk)
//                                  how many cells are left, not biased, where a ray has left it
#pragma once
#include "storage/two_level_grid/grid_buffers.glsl"

#include "lib/grid/walk.glsl"

CONSTANT(int, skip_empty)  // 0: cell by cell through empty space as well

#define CELL uint

CELL no_cell() { return kEmptyCell; }

CELL fetch_cell(Grid grid, Walk walk) { return cell_word(cell_index(walk)); }

// An empty cell's cube ahead.
vec3 left_behind_empty(CELL cell, Walk walk, uint octant_shift) {
    return left_behind_cube(walk, skip_empty == 1 ? empty_cube(cell, octant_shift) : biased(1u));
}

vec3 left_behind_full(CELL cell, Walk walk) { return left_behind_cube(walk, biased(1u)); }
