// Records of the two-level grid's buffers, in texels. One text for C++ and GLSL.
#pragma once

// Floats: lower corner, upper corner, edge lengths of a cell, cells per unit of length.
const int kGridFrameTexels = 4;

// Integers: dims and the index of the first cell; then first triangle, depth, 0, 0.
const int kGridNumberTexels = 2;

// The corners, in the frame of the object's grid.
const int kTriangleVertexTexels = 3;

// A word a cell. An empty one has this bit, and below it, for each octant of directions, the code of
// the edge of an empty cube ahead (core/grid/empty_space.h). A full one is the index of its first
// reference.
const uint kEmptyCell = 0x80000000u;
const uint kEmptyCubeEdges0 = 0x05030201u;  // edges of codes 0 to 3, a byte each ...
const uint kEmptyCubeEdges4 = 0x22150D08u;  // ... and 4 to 7

// A word a reference: this bit says that the list goes on. (So a word of 0 ends it: that is what lanes
// that are switched off read from storage blocks on a software renderer, while they run loops.)
const uint kMoreReferences = 0x80000000u;

// q = M (p - place) - origin takes the world to the frame of the object's grid. The rows of M, each
// number as the sum of two floats: the leading parts of the three rows, with the place's
// coordinates as fourth numbers; then the trailing parts, with the origin's.
const int kInstanceRowTexels = 6;
