// The judge in exact arithmetic: who is right on a ray, decided without any tolerance.
#pragma once

#include <memory>

#include "core/catalogue.h"
#include "core/judge.h"

namespace onepass {

/// Judges by exact real arithmetic on the numbers as given (cpu_ref/exact_truth.h), over its own
/// candidate search; independent of every tracer.
///
/// A triangle without area and one seen exactly edge-on are never hit; edges and corners belong to
/// a triangle; coincident triangles tie. A ray that is not finite, has direction 0 or an empty
/// interval is a miss. `edge` needs a witness, a moved ray for which the answer is right, found by
/// a bounded search: an error can be reported too often, never hidden. An answer outside
/// [tmin, tmax] is no `edge`, because the interval is not moved. For Query::any only is_hit()
/// counts.
/// Cost: building is O(n log n) in the scene's triangles; a right answer costs some microseconds,
/// one at an edge tens, an error some milliseconds.
std::unique_ptr<Judge> make_exact_judge(ScenePtr scene);

}  // namespace onepass
