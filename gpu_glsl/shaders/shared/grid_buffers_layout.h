// Records of the two-level grid's buffers, in texels. One text for C++ and GLSL.
#pragma once

// Floats: lower corner, upper corner, edge lengths of a cell, cells per unit of length.
const int kGridFrameTexels = 4;

// Integers: dims and the index of the first cell; then first triangle, 0, 0, 0.
const int kGridNumberTexels = 2;

// The corners, in the frame of the object's grid.
const int kTriangleVertexTexels = 3;

// The rows of the map from the world to the frame of the object's grid, each as the sum of two floats: the
// leading parts of the three, then the trailing parts.
const int kInstanceRowTexels = 6;

// The number of grid 0, which is the top level; that of object k is k + 1.
const int kTopGrid = 0;
