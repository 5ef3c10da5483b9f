// Records of the two-level grid's buffers, in texels. One text for C++ and GLSL.
#pragma once

// Floats: lower and upper corner from the centre, edge lengths of a cell, cells per unit of length,
// the centre.
const int kGridFrameTexels = 5;

// Integers: dims and the index of the first cell; then first triangle, depth, 0, 0.
const int kGridNumberTexels = 2;

// A word a cell. An empty one has this bit, and below it, for each octant of directions, the code
// of the edge of an empty cube ahead (core/grid/empty_space.h): 1 + code (code + 1) / 2. A full one
// is the index of its first reference.
const uint kEmptyCell = 0x80000000u;

// Lists hold what is within a pad of their cell; so many pads make a cell's edge
// (core/grid/uniform_grid.h: kBinningPad).
const int kListPadsACell = 512;

// A word a reference: this bit says that the list goes on. (So a word of 0 ends it: that is what
// lanes that are switched off read from storage blocks on a software renderer, while they run
// loops.)
const uint kMoreReferences = 0x80000000u;

// q = M (p - place) - origin takes the world to the frame of the object's grid. The rows of M, each
// number as the sum of two floats: the leading parts of the three rows, with the place's
// coordinates as fourth numbers; then the trailing parts, with the origin's.
const int kInstanceRowTexels = 6;

// Floats: the lower and upper corner of an instance's box in the frame of the top level, moved
// outwards by the lists' pad (1 / kListPadsACell of a cell of the top level).
const int kInstanceBoxTexels = 2;
