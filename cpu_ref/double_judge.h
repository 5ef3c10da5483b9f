// A judge in double precision: stands in the Judge seam until the exact one exists.
#pragma once

#include <memory>

#include "core/catalogue.h"
#include "core/judge.h"

namespace onepass {

/// Judges with double arithmetic over its own candidate search; independent of every tracer.
/// Cost: building is O(n log n) in the scene's triangles; a judgement a few microseconds.
std::unique_ptr<Judge> make_double_judge(ScenePtr scene);

}  // namespace onepass
