// The sections of the page, each a function from the sorted data to HTML; and the data of its
// charts. A section without data is an empty string.
#pragma once

#include <string>
#include <vector>

#include "compare/growth.h"
#include "compare/report/dossier.h"
#include "compare/report/ladders.h"

namespace onepass::report {

/// Whether some run is a reproduction of the paper: it holds claims. The page then opens with them.
bool is_reproduction(const Dossier& dossier);

/// The paper's claims: a table with verdicts, a plot of all ratios, and the measurements.
std::string claims_section(const Dossier& dossier);

/// Tables 1 and 2 of the paper, ours beside them.
std::string paper_tables_section(const Dossier& dossier);

/// The paper's scenes by the tracer and by the oracle, and their difference. Throws: as
/// render_report for a picture.
std::string figures_section(const Dossier& dossier);

/// Animated frames: update, upload and trace.
std::string motion_section(const Dossier& dossier);

/// Tracers that take several passes a frame: passes and bytes.
std::string streaming_section(const Dossier& dossier);

/// Where the tracers depart from the paper's text, and the wrong rays that each place costs. Empty
/// unless some run is a reproduction or attributed its wrong rays.
std::string deviation_section(const Dossier& dossier);

/// What was compared, on what, and one sentence of verdict a scene.
std::string summary_section(const Dossier& dossier);

/// Pictures, the table of disagreements, the worst rays and, for the faithful paper tracer, why it
/// picks wrong triangles. Throws: as render_report for a picture.
std::string scene_section(const Dossier& dossier, const SceneDossier& scene);

/// Two of the scene's pictures under a divider, and its pixels; number `index` of closer_data().
/// `layers`: the pictures to choose from, a template of option elements.
std::string closer_block(const SceneDossier& scene, size_t index, const std::string& layers);

/// JSON of what closer_block()s show: one element a scene, in the dossier's order. Not yet safe
/// inside a script element. Throws: Error for a sheet of pixels that is missing or was edited.
std::string closer_data(const Dossier& dossier);

/// Where each tracer fails on each ladder: one table over all, then ladder by ladder.
std::string ladder_section(const Dossier& dossier);

/// Rate against errors of every setting, with the Pareto front: over all scenes, then each scene.
std::string tradeoff_section(const Dossier& dossier);

/// Timing table and charts; error counts stand beside every speed.
std::string speed_section(const Dossier& dossier);

/// Time, cells and tests per ray and memory against grid density.
std::string sweep_section(const Dossier& dossier);

/// What each step of a strategy is worth: the strategy as it is, and with each step taken out.
std::string ablation_section(const Dossier& dossier);

/// How build time, memory and trace time grow: charts, exponents, all sizes.
std::string growth_section(const Dossier& dossier);

/// What each tracer built: cells, references, bytes, build times.
std::string structure_section(const Dossier& dossier);

/// Manifest of every run, the tracers with their parameters, the scenes, the commands.
std::string environment_section(const Dossier& dossier);

/// The JSON text that page.js draws the charts from; safe inside a script element.
std::string chart_data(const Dossier& dossier);

/// Points of one scene, ray kind and tracer, in file order.
struct Sweep {
    const SceneDossier* scene = nullptr;
    std::string rays;
    std::string tracer;
    std::vector<SweepPoint> points;
};
std::vector<Sweep> sweeps(const Dossier& dossier);

/// One chart of a growth study.
struct GrowthChart {
    size_t run = 0;
    std::string title;
    std::vector<std::string> names;  ///< of the curves: tracer and setting
    std::vector<size_t> colours;     ///< the same for a tracer in all charts of the run
    std::vector<GrowthCurve> curves;
};
/// Build time, memory, then one a ray kind over triangles and over rays; run by run.
std::vector<GrowthChart> growth_charts(const Dossier& dossier);

/// The frames of an animation, by scene and tracer, in file order.
std::vector<Entry<FrameTimingRecord>> animations(const Dossier& dossier);

/// A ladder with its run.
struct LadderOfRun {
    const LadderRecord* record = nullptr;
    size_t run = 0;
    bool repeated = false;  ///< other runs hold a ladder of this id as well

    const LadderRecord* operator->() const { return record; }
};
std::vector<LadderOfRun> ladders_of(const Dossier& dossier);

/// On how many ladders `grid` fails, and on which it is among the first to: of all, and of itself
/// and Embree. Escaped; one paragraph or two, without the outer tags.
std::string grid_first_sentence(const std::vector<LadderOfRun>& ladders);

/// One chart of speed against accuracy.
struct Cloud {
    std::string title;
    size_t run = 0;
    bool over_scenes = false;
    bool every_answer_judged = true;    ///< false: made of timings, errors as `check` counts them
    std::vector<TradeoffPoint> points;  ///< pooled over the parts
    std::vector<TradeoffPoint> parts;   ///< by scene and ray kind
    std::vector<size_t> numbers;        ///< of the settings, from 1; the same in all of the run
    std::vector<bool> front;            ///< on_front()
    std::vector<bool> front_of_rest;    ///< on_front() among all but Embree's
};

/// Of each run one over all its scenes, if they are several, and one a scene. A run without
/// settings held against each other gives its timings, by the device's timer where there is one.
std::vector<Cloud> clouds(const Dossier& dossier);

/// Where the cloud's points lie along the error rate.
struct CloudAxis {
    ZeroBand band;
    std::vector<double> x;  ///< error_rate(); in the strip if that is 0
};
CloudAxis cloud_axis(const Cloud& cloud);

/// "--ray 0,0,5,0,0,-1,0,inf", as onepass explain takes it; reads back bit-equal. Not escaped.
std::string ray_text(const Ray& ray);

/// A hit as a table cell has it: "t 2.25" and the ids, or "miss".
std::string hit_text(double t, uint32_t prim_id, uint32_t inst_id);

/// "Holds", "Fails", "Depends" or "Not measured", told apart by shape and word as well as by
/// colour.
std::string badge(ClaimVerdict verdict);

/// How far the measurement lies on the claim's side of its bound, and the ends of its interval as
/// widened by the noise: above 1 it speaks for the claim. NaN for what has no ratio.
struct Support {
    double value = 0.0;
    double low = 0.0;
    double high = 0.0;
};
Support support_of(const ClaimMeasurement& measurement);

/// "Pass" or "Fail", told apart by shape and word as well as by colour.
std::string badge(bool passed);

/// What the scene's checks say, in one sentence. Escaped.
std::string verdict_sentence(const SceneDossier& scene);

/// No check and no picture of the scene failed.
bool scene_passed(const SceneDossier& scene);

/// Something of the scene was compared with the oracle.
bool scene_judged(const SceneDossier& scene);

}  // namespace onepass::report
