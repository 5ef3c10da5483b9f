// Motions for built-in scenes: they add an animation to a scene and change nothing else of it, so
// that the scene at rest, and at time 0, stays the one that was built.
#pragma once

#include <cstdint>

#include "core/scene.h"

namespace onepass {

/// Small shapes swarming in a cube, each turning about an axis of its own and circling its place in
/// a loop of 2 s: the load of benchmarks of moving instances. Their density does not depend on
/// `instances`. The same seed gives the same scene on every machine.
///
/// Objects: one sphere of 176 triangles.
Scene make_swarm(uint32_t instances, uint64_t seed);

}  // namespace onepass
