// The sections of the page, each a function from the sorted data to HTML; and the data of its
// charts. A section without data is an empty string.
#pragma once

#include <string>
#include <vector>

#include "compare/report/dossier.h"

namespace onepass::report {

/// What was compared, on what, and one sentence of verdict a scene.
std::string summary_section(const Dossier& dossier);

/// Pictures, the table of disagreements, the worst rays and, for the faithful paper tracer, why it
/// picks wrong triangles. Throws: as render_report for a picture.
std::string scene_section(const Dossier& dossier, const SceneDossier& scene);

/// Timing table and charts; error counts stand beside every speed.
std::string speed_section(const Dossier& dossier);

/// Time, cells and tests per ray and memory against grid density.
std::string sweep_section(const Dossier& dossier);

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

/// "Pass" or "Fail", told apart by shape and word as well as by colour.
std::string badge(bool passed);

/// What the scene's checks say, in one sentence. Escaped.
std::string verdict_sentence(const SceneDossier& scene);

/// No check and no picture of the scene failed.
bool scene_passed(const SceneDossier& scene);

/// Something of the scene was compared with the oracle.
bool scene_judged(const SceneDossier& scene);

}  // namespace onepass::report
