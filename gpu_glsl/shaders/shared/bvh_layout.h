// Records of the bounding volume hierarchy's buffers, in texels. One text for C++ and GLSL.
#pragma once

// Words: the first child's lower and upper corner and reference (7), the second's (7), 0, 0. The
// corners are floats' bits.
const int kBvhNodeTexels = 4;

// What a reference says: an inner node's index; or kBvhLeaf plus 16 times the first slot plus the
// number of slots. A slot is a place in the leaves' order.
const uint kBvhLeaf = 0x80000000u;
const uint kBvhSlot = 16u;

// What floats test (pack/barycentric_planes.h), from the centre of the object's box.
const int kBvhPlanesTexels = 3;

// The corners, in the object's frame.
const int kBvhTriangleTexels = 3;

// As kInstanceRowTexels of grid_buffers_layout.h; then the lower and the upper corner of the object
// in its frame, and the centre of that box.
const int kBvhInstanceTexels = 9;
