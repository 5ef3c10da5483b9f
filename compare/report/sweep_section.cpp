// The grid-size study: plots and a table for each scene, ray kind and tracer.
#include <algorithm>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/sweep.h"

namespace onepass::report {
namespace {

constexpr int kColumnsAfterDensities = 9;

std::string point_row(const SweepPoint& point, bool best) {
    std::string html = best ? "<tr class=\"best\">" : "<tr>";
    html += fmt::format("<th scope=\"row\">{}</th>", exact(point.object_density));
    html += cell(exact(point.top_density));
    if (!point.failure.empty()) {
        return html + fmt::format("<td class=\"text bad\" colspan=\"{}\">{}</td></tr>\n",
                                  kColumnsAfterDensities, escape(point.failure));
    }
    html += cell(significant(median(point.wall_ms)), "speed");
    html += cell(grouped(point.errors), point.errors == 0 ? "errors" : "errors bad");
    html += cell(fmt::format("{}<small>{} – {}</small>", significant(point.ratio),
                             significant(point.ratio_low), significant(point.ratio_high)));
    html += cell(significant(point.cells_per_ray)) + cell(significant(point.tests_per_ray));
    html += cell(grouped(point.cells)) + cell(grouped(point.references));
    html += cell(byte_size(static_cast<double>(point.bytes)));
    return html + cell(significant(point.build_ms)) + "</tr>\n";
}

std::string point_table(const Sweep& sweep) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Grid sizes\"><table>"
        "<thead><tr>";
    html += heading_cell("Object λ", "text");
    for (const char* name :
         {"Top λ", "Median, ms", "Errors", "Ratio to Embree<small>95 % interval</small>",
          "Cells a ray", "Tests a ray", "Cells", "References", "Memory", "Build, ms"}) {
        html += heading_cell(name);
    }
    html += "</tr></thead><tbody>\n";
    const SweepPoint* best = best_point(sweep.points);
    for (const SweepPoint& point : sweep.points) html += point_row(point, &point == best);
    return html + "</tbody></table></div>\n";
}

/// The errors at all sizes, and the best size.
std::string finding(const Sweep& sweep) {
    const SweepPoint* best = best_point(sweep.points);
    if (!best) return "None could be built.";
    uint64_t most = 0;
    size_t refused = 0;
    for (const SweepPoint& point : sweep.points) {
        most = std::max(most, point.errors);
        refused += point.failure.empty() ? 0 : 1;
    }
    std::string text = most == best->errors ? counted(most, "error") + " at every size."
                                            : fmt::format("{} to {} errors, by size.",
                                                          grouped(best->errors), grouped(most));
    if (refused > 0) text += fmt::format(" {} could not be built.", refused);
    return text + fmt::format(" Best, by errors and then by speed: object λ {}, top λ {}.",
                              exact(best->object_density), exact(best->top_density));
}

std::string sweep_block(const Sweep& sweep, size_t index) {
    static constexpr std::pair<const char*, const char*> kPlots[] = {
        {"time", "Median time, ms"},
        {"cells", "Cells a ray"},
        {"tests", "Triangle tests a ray"},
        {"memory", "Memory on the device, MiB"}};
    std::string html = fmt::format(
        "<h3>{} <span class=\"quiet\">{} rays, <code>{}</code></span></h3>\n"
        "<p>{}: {}</p>\n<div class=\"plots\">\n",
        escape(sweep.scene->name), escape(sweep.rays), escape(sweep.tracer),
        counted(sweep.points.size(), "grid size"), finding(sweep));
    for (const auto& [kind, title] : kPlots) {
        html += fmt::format(
            "<figure class=\"chart small\"><figcaption><strong>{}</strong></figcaption>"
            "<div class=\"plot\" data-chart=\"sweep\" data-sweep=\"{}\" data-measure=\"{}\">"
            "<canvas role=\"img\" aria-label=\"{} against density; the table below holds the same "
            "figures.\"></canvas></div></figure>\n",
            title, index, kind, title);
    }
    return html + "</div>\n" + point_table(sweep);
}

}  // namespace

std::vector<Sweep> sweeps(const Dossier& dossier) {
    std::vector<Sweep> all;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& point : scene.sweeps) {
            const auto known = std::find_if(all.begin(), all.end(), [&](const Sweep& s) {
                return s.scene == &scene && s.rays == point->rays && s.tracer == point->tracer;
            });
            if (known == all.end()) {
                all.push_back({&scene, point->rays, point->tracer, {*point.record}});
            } else {
                known->points.push_back(*point.record);
            }
        }
    }
    return all;
}

std::string sweep_section(const Dossier& dossier) {
    const std::vector<Sweep> all = sweeps(dossier);
    if (all.empty()) return {};
    std::string html =
        "<section id=\"grid-size\">\n<h2>Grid size</h2>\n"
        "<p class=\"note\">λ is a grid’s density: cells a primitive, of the object grids (cells a "
        "triangle) and of the top-level grid (cells an instance). Cells and tests come from a "
        "separate, counted pass.</p>\n";
    for (size_t i = 0; i < all.size(); ++i) html += sweep_block(all[i], i);
    return html + "</section>\n";
}

}  // namespace onepass::report
