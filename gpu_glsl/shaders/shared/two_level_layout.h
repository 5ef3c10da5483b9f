// Records of the two-level grid's textures, in texels of four floats. One text for C++ and GLSL.
#pragma once

// Four planes: the triangle's own (unit normal), then the sides as barycentric coordinates: the
// weights of v1, v2 and v0. The printed test reads three; the fourth texel is (v0, 0) where planes
// are relative to v0 (local_planes), and ends in the triangle's number where lists hold copies.
const int kTriangleTexels = 4;

// (a, step budget), (b, first triangle), (lower, 0), (upper, 0); see strategies/paper.glsl.
const int kGridTexels = 4;

// The rows of object_from_world, then (address of the object's grid, inst_id, 0).
const int kInstanceTexels = 4;

// Grids are allocated in the cell texture in cubes of this many cells a side (the paper's 16^3).
const int kBlockCells = 16;
