// Records of the bounding volume hierarchy's buffers, in texels. One text for C++ and GLSL.
#pragma once

// Words: the first child's lower and upper corner and reference (7), the second's (7), 0, 0. The
// corners are floats' bits, from the centre of the box around the tree.
const int kBvhNodeTexels = 4;

// What a reference says: kBvhInner plus an inner node's index; or, of a leaf, 16 times the first
// slot plus the number of slots. A slot is a place in the leaves' order. 0, a leaf of none, is the
// end of a walk. (It is what lanes that are switched off read from storage blocks on a software
// renderer, while they run loops.)
const uint kBvhInner = 0x80000000u;
const uint kBvhSlot = 16u;
const uint kBvhNothing = 0u;

// The corners, in the object's frame.
const int kBvhTriangleTexels = 3;

// Of each instance's object: its centre in the object's frame, and from there its lower and upper
// corner.
const int kBvhBoxTexels = 3;

// Of the stack: of 40 and 24 levels of two trees (core/bvh/bvh.h), and what ends either walk. (A
// macro: in a twin a constant is a member of a class, of which no array can take its size.)
#define BVH_STACK_ENTRIES 66
