// Records of storage/triangle_list. One text for C++ and GLSL.
#pragma once

// The rows of object_from_world, then (first triangle, triangle count, 0, 0).
const int kListedInstanceTexels = 4;
