// What a cast does, counted in a pass apart from the timed ones: cells, tests, references, and
// tests of triangles that a ray had tested before.
#pragma once

#include <optional>

#include "compare/rays.h"
#include "compare/results.h"
#include "core/tracer.h"

namespace onepass {

/// Rays whose way is followed for the repeated tests: a tracer follows them one by one.
inline constexpr size_t kWalkedRays = 1024;

/// One counted cast; nothing from a tracer that does not count. Never part of a timing: counting
/// is slower.
std::optional<CastCounts> count_cast(Tracer& tracer, const RaySet& rays);

/// Of one ray's tests, how many were of a triangle (of an instance) that it had tested before.
uint64_t repeated_tests(const RayWalk& walk);

}  // namespace onepass
