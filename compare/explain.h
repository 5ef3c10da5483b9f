// One ray, explained: what is true of it, what each tracer said, and where a tracer went wrong.
//
// The judge knows the truth, a tracer that can (a shader's twin) tells its walk; this puts the two
// beside each other and draws the conclusion. compare/reproduction.h makes a small scene of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/judge.h"
#include "core/scene.h"
#include "core/tracer.h"

namespace onepass {

/// Reads "ox,oy,oz,dx,dy,dz" or "ox,oy,oz,dx,dy,dz,tmin,tmax"; numbers in decimal or as hexadecimal
/// floats, inf and nan too. Throws: Error for anything else.
Ray parse_ray(const std::string& text);

/// The same text from a ray: reads back bit by bit. The interval is left out where it is [0, inf].
std::string ray_text(const Ray& ray);

/// What one tracer said of the ray.
struct Statement {
    std::string tracer;
    Hit hit;
    uint32_t flags = 0;  ///< RayFlag bits
    Verdict verdict;
    std::optional<RayWalk> walk;  ///< where it can tell
    /// Why its answer is not simply the true one, a sentence each; empty for `agree`.
    std::vector<std::string> reasons;
};

struct Explanation {
    Ray ray;
    std::string judge;  ///< Judge::name()
    RayTruth truth;
    std::vector<Statement> statements;  ///< one a tracer, in their order
};

/// Casts, judges and reads the walks. A tracer without a walk is explained by the walk of its twin
/// (same strategy and storage) where the twin gave the same answer bit by bit.
/// Cost: a cast of one ray a tracer, some milliseconds for the judge.
Explanation explain_ray(const Ray& ray, const Judge& judge, std::span<Tracer* const> tracers);

/// For a terminal. `scene` names groups.
std::string explanation_text(const Explanation& explanation, const Scene& scene);

/// The same and more as a JSON document; numbers that are not finite are texts ("inf").
std::string explanation_json(const Explanation& explanation, const Scene& scene);

/// "miss", or "t 0.5 instance 0 triangle 3".
std::string answer_text(const Hit& hit);

}  // namespace onepass
