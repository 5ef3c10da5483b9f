// What a grid-size study says: derived from its points alone, for the command and the page alike.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/cost_model.h"
#include "compare/results.h"
#include "compare/statistics.h"

namespace onepass {

/// SweepPoint::chosen: how a size came to be measured.
inline constexpr char kListedSize[] = "listed";         ///< asked for
inline constexpr char kCoarseSize[] = "coarse";         ///< of the search's first, wide steps
inline constexpr char kRefinedSize[] = "refined";       ///< between two that the search had tried
inline constexpr char kAutoSize[] = "auto";             ///< by known costs, no ray timed
inline constexpr char kPerObjectSize[] = "per object";  ///< a density of its own for each object
inline constexpr char kFileSize[] = "file";             ///< read from a sizing file

/// True for a size by one density for all objects: what curves and bands over density are made of.
bool is_by_density(const SweepPoint& point);

/// The time of a ray of each point in ns, by the device's own timer where all points have one. NaN
/// for a refused size.
///
/// Points whose rounds were not the same are brought to one pace: each is multiplied with the
/// oracle's median over all rounds and divided by that over the point's own.
std::vector<double> comparable_ns(std::span<const SweepPoint> points);

/// How much longer a choice took than the best: time / best - 1, with the 95 % interval of paired
/// rounds; its ends are NaN where the two were not measured in the same rounds.
struct Regret {
    double share = 0.0;
    double low = 0.0;
    double high = 0.0;
};

/// Densities about the best whose time is within `share` of its own, interpolated between points
/// (time and density on logarithms). `low_open`, `high_open`: all measured sizes on that side are
/// within it.
struct DensityBand {
    double share = 0.0;
    double low = 0.0;
    double high = 0.0;
    bool low_open = false;
    bool high_open = false;
};
inline constexpr double kBandShares[] = {0.05, 0.20};

/// "No finer than the scene needs": a grid may take this much longer than the best.
inline constexpr double kNoFinerShare = 0.05;

/// Indices are into the points.
struct Tuning {
    std::vector<double> ns;  ///< comparable_ns
    size_t best = 0;         ///< the fastest

    std::optional<CostModel> model;    ///< fitted to these points
    std::vector<double> predicted_ns;  ///< by the model; empty without
    std::optional<size_t> predicted;   ///< the size by density of the model's least time
    Regret predicted_regret{};
    std::vector<DensityBand> bands;  ///< by kBandShares; empty if nothing but the best is by
                                     ///< density at its top density

    size_t smallest = 0;       ///< the fewest bytes within kNoFinerShare of the best
    double saved_bytes = 0.0;  ///< against the best

    std::optional<size_t> automatic;  ///< the point chosen by `auto`
    Regret automatic_regret{};
    std::optional<size_t> per_object;  ///< each object its own density ...
    double per_object_gain = 0.0;      ///< ... best size by one density / this - 1
};

/// `points`: of one scene, ray kind and tracer. Nothing if all were refused.
std::optional<Tuning> tuning_of(std::span<const SweepPoint> points);

/// One scene of a leave-one-out study.
struct LeftOut {
    std::string scene;
    std::string rays;
    CostModel costs;      ///< fitted to all other scenes
    size_t points = 0;    ///< sizes by density that the costs chose from
    double chosen = 0.0;  ///< density of their choice
    double best = 0.0;    ///< density of the best measured
    Regret regret{};
};

/// For each scene: costs are fitted to the points of all other scenes, choose a density by this
/// scene's counts alone, and are judged by its times. Points of one tracer; scenes are told apart
/// by name, the ray kinds of a scene stand or fall together. Empty for fewer than two scenes.
std::vector<LeftOut> leave_one_out(std::span<const SweepPoint> points);

/// Median of the regrets' shares.
double median_regret(std::span<const LeftOut> left_out);

/// Costs of one tracer, fitted to its points of all scenes. Nothing for fewer than three points.
std::optional<CostModel> costs_of(std::span<const SweepPoint> points, const std::string& tracer);

/// The coarsest of several sizes, coarse to fine, whose predicted time is within kWorthwhile of the
/// least: a finer grid must promise to be worth its memory.
size_t coarsest_worthwhile(std::span<const double> predicted_ns);
inline constexpr double kWorthwhile = 0.02;

}  // namespace onepass
