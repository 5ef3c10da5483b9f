// A judge in double precision: stands in the Judge seam until the exact one exists.
#pragma once

#include <memory>

#include "core/catalogue.h"
#include "core/judge.h"

namespace onepass {

/// Judges with double arithmetic over its own candidate search; independent of every tracer.
///
/// A triangle without area and one seen exactly edge-on are never hit; edges belong to a triangle;
/// a ray that is not finite, has direction 0 or an empty interval is a miss. Distances that double
/// cannot tell apart tie. `edge` needs a witness, a moved ray for which the answer is right, found
/// by a bounded search: an error can be reported too often, never hidden. An answer outside
/// [tmin, tmax] is no `edge`, because the interval is not moved. For Query::any only is_hit()
/// counts.
/// Cost: building is O(n log n) in the scene's triangles; a right answer costs a few microseconds,
/// one at an edge tens, an error up to a millisecond.
std::unique_ptr<Judge> make_double_judge(ScenePtr scene);

}  // namespace onepass
