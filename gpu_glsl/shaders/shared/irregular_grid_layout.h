// Records of an irregular grid's own buffers; all else is as in shared/grid_buffers_layout.h. One text
// for C++ and GLSL.
#pragma once

// A word a node. Its lowest bits say by which power of two its cube is divided on each axis, the
// others the first of the parts' nodes; or, if it is not divided, the cell.
const uint kNodeBits = 3u;

// Four words a cell: for x, y and z the first place of its box, in the lower half, and the last; then
// kEmptyCell, or the index of its first reference.
const uint kLastPlaceShift = 16u;
