// Triangles that can never be the answer: the very same three corners as one before them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene.h"

namespace onepass {

/// For each triangle, 1 if one of a lower index has the same three positions, in any order; empty
/// if none has, or hardly any: of a large object a 64th is looked at first. Two such triangles are
/// hit at the same t, and an equal t goes to the lower index, so that the other can be left out.
///
/// Positions must be finite. Cost: O(triangles), parallel; 13 to 25 bytes a triangle while it
/// works. The result does not depend on the number of threads.
std::vector<uint8_t> later_duplicates(const Object& object);

}  // namespace onepass
