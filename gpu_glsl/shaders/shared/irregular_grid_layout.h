// Records of an irregular grid's own buffers; all else is as in shared/grid_buffers_layout.h. One
// text for C++ and GLSL.
#pragma once

// A word a node. Its lowest bits say by which power of two its cube is divided on each axis, the
// others the first of the parts' nodes; or, if it is not divided, the cell.
const uint kNodeBits = 3u;

// Four words a cell: for x, y and z how many places lie before its box, in the lower half, and in
// the upper half how many beyond it; then kEmptyCell, or the index of its first reference.
// (So words of 0 are a box without end, which a walk leaves at once: lanes that are switched off
// read zeros from storage blocks on a software renderer, while they run loops.)
const uint kBeyondShift = 16u;
const uint kPlacesMask = 0xFFFFu;
