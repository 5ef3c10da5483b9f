// The ladders that `onepass stress` climbs: each turns one knob, from harmless to hard, on meshes
// of some hundred to a few thousand triangles.
#pragma once

#include <vector>

#include "core/ladder.h"

namespace onepass {

/// All ladders, in the order in which they are climbed. Every scene is valid, every ray is finite
/// and has a direction, and most rays of every rung hit something.
const std::vector<Ladder>& ladders();

}  // namespace onepass
