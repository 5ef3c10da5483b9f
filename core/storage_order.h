// The order in which triangles are best stored: what lies together in space, together in memory.
#pragma once

#include "core/bounds.h"
#include "core/raw_vector.h"
#include "core/scene.h"

namespace onepass {

/// The place of each triangle in that order, its slot.
///
/// Triangles are ordered by the cubes that their first corners lie in, cubes along a Morton curve,
/// and in a cube by their numbers. There are no more cubes than triangles, and 64 x 64 x 64
/// at most. `box`: around the object, better not much larger.
/// Cost:   O(triangles); parallel, the same order for any number of threads; beside the result 4
///         MiB at most.
/// Source: Morton 1966.
RawVector<uint32_t> storage_slots(const Object& object, const Bounds& box);

}  // namespace onepass
