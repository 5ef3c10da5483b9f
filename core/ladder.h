// The seam between who makes hard scenes and who runs tracers on them: a ladder of ever harder
// cases, data only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/params.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// One step of a ladder: a scene and rays that are hard in one measured way.
struct Rung {
    double knob = 0.0;  ///< what the ladder turns, as the plot's axis has it
    std::string label;  ///< where a number says too little ("-0", "NaN"); else empty
    std::function<Scene()> make_scene;
    /// A ray kind that compare/rays.h makes ("vertex", "edge", "random", ...); or empty, and then
    /// `make_rays` makes exactly `count` rays from the seed.
    std::string ray_kind;
    std::function<std::vector<Ray>(const Scene& scene, size_t count, uint64_t seed)> make_rays;
    /// Given to every tracer that has such a parameter; one with none of them sits the rung out.
    ParamValues params;
};

/// Turns one knob until methods break. Rungs go from harmless to hard.
struct Ladder {
    std::string id;        ///< "translation"
    std::string title;     ///< "Far from the origin"
    std::string question;  ///< what it tests and why that is hard, in a sentence or two
    std::string knob;      ///< axis title: "distance from the origin"
    std::string unit;      ///< "scene sizes"; or empty
    bool log_axis = true;
    std::vector<Rung> rungs;
};

}  // namespace onepass
