// Triangles that can never be the answer: the very same three corners as one before them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene.h"

namespace onepass {

/// For each triangle, 1 if one of a lower index has the same three positions, in any order; empty
/// if none has. Both are hit at the same t, and an equal t goes to the lower index.
///
/// Positions must be finite. Cost: O(triangles), parallel; 8 to 16 bytes a triangle while it works.
/// The result does not depend on the number of threads.
std::vector<uint8_t> later_duplicates(const Object& object);

}  // namespace onepass
