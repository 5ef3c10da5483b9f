// What a step and a test cost: a linear model of the time of a ray, fitted to what was counted and
// measured.
//
//     time of a ray = ray + cell * cells visited + test * triangle tests
//
// The literature's T_setup + T_step E[cells] + T_test E[tests]. The counts are exact and the same
// on every machine, so that three numbers carry a measurement from sizes that were timed to sizes
// that were only counted.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace onepass {

/// Costs in ns; none is negative.
struct CostModel {
    double ray = 0.0;
    double cell = 0.0;
    double test = 0.0;
    double relative_error = 0.0;  ///< root mean square of predicted / measured - 1 in the fit

    double ns(double cells, double tests) const { return ray + cell * cells + test * tests; }
};

/// What a ray of one measurement did and took on average.
struct WorkSample {
    double cells = 0.0;
    double tests = 0.0;
    double ns = 0.0;
    size_t scene = 0;  ///< samples of one scene share a scale
};

/// Least squares of relative errors, no cost below 0 (all sets of costs that may be above 0 are
/// tried: there are seven).
///
/// Each scene has a scale of its own beside the costs: how well its rays go together, how much of
/// it the caches hold. Only what a scale cannot explain, how time turns with the size of the
/// grid, decides about the costs. The scales' geometric mean is 1, and so is the scale of a scene
/// alone. Nothing for fewer than three samples.
std::optional<CostModel> fit_costs(std::span<const WorkSample> samples);

/// Costs that come with the program, for `auto` sizes on a machine that was never measured: those
/// of a tracer's strategy; null if there are none. Their origin stands in cost_model.cpp.
const CostModel* known_costs_of(const std::string& tracer);

}  // namespace onepass
