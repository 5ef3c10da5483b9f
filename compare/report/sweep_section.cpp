// The grid-size study: plots and a table for each scene, ray kind and tracer.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/sweep.h"
#include "compare/tuning.h"

namespace onepass::report {
namespace {

constexpr int kColumnsAfterSize = 11;

/// The densities or cells of a point, as its row is headed.
std::string size_name(const SweepPoint& point) {
    if (!point.sizes.empty()) return "by object<small>" + escape(point.sizes) + "</small>";
    if (!point.resolution.empty()) return escape(point.resolution);
    return significant(point.object_density);
}

std::string percent(double share) { return significant(100.0 * share) + " %"; }

std::string point_row(const SweepPoint& point, const Tuning* tuning, size_t index, bool best) {
    std::string html = best ? "<tr class=\"best\">" : "<tr>";
    html += fmt::format("<th scope=\"row\">{}</th>", size_name(point));
    html += cell(significant(point.top_density)) + cell(escape(point.chosen), "text");
    if (!point.failure.empty()) {
        return html + fmt::format("<td class=\"text bad\" colspan=\"{}\">{}</td></tr>\n",
                                  kColumnsAfterSize - 1, escape(point.failure));
    }
    html += cell(significant(median(point.wall_ms)), "speed");
    html += cell(grouped(point.errors), point.errors == 0 ? "errors" : "errors bad");
    html += cell(percent(tuning->ns[index] / tuning->ns[tuning->best] - 1.0));
    html += cell(tuning->model ? percent(tuning->predicted_ns[index] / tuning->ns[index] - 1.0)
                               : std::string("–"));
    html += cell(fmt::format("{}<small>{} – {}</small>", significant(point.ratio),
                             significant(point.ratio_low), significant(point.ratio_high)));
    html += cell(significant(point.cells_per_ray)) + cell(significant(point.tests_per_ray));
    html += cell(grouped(point.cells)) + cell(grouped(point.references));
    html += cell(byte_size(static_cast<double>(point.bytes)));
    return html + cell(significant(point.build_ms)) + "</tr>\n";
}

std::string point_table(const Sweep& sweep, const Tuning* tuning) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Grid sizes\"><table>"
        "<thead><tr>";
    html += heading_cell("Object λ", "text");
    for (const char* name :
         {"Top λ", "Chosen", "Median, ms", "Errors", "Slower than the fastest", "Model’s error",
          "Ratio to Embree<small>95 % interval</small>", "Cells a ray", "Tests a ray", "Cells",
          "References", "Memory", "Build, ms"}) {
        html += heading_cell(name);
    }
    html += "</tr></thead><tbody>\n";
    const SweepPoint* best = best_point(sweep.points);
    for (size_t i = 0; i < sweep.points.size(); ++i) {
        html += point_row(sweep.points[i], tuning, i, &sweep.points[i] == best);
    }
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
                              size_name(*best), significant(best->top_density));
}

std::string regret_text(const Regret& regret) {
    std::string text = percent(regret.share);
    if (std::isnan(regret.low)) return text;
    return text + fmt::format(" (95 %: {} to {})", percent(regret.low), percent(regret.high));
}

std::string band_text(const DensityBand& band) {
    return fmt::format("<dt>Within {:.0f} % of the fastest</dt><dd>object λ {}{} to {}{}</dd>\n",
                       100.0 * band.share, significant(band.low),
                       band.low_open ? " (the lowest measured)" : "", significant(band.high),
                       band.high_open ? " (the highest measured)" : "");
}

/// What the study comes to, as a list of terms.
std::string outcome(const Sweep& sweep, const Tuning& tuning) {
    const auto size = [&](size_t i) {
        return fmt::format("object λ {}, top λ {}", size_name(sweep.points[i]),
                           significant(sweep.points[i].top_density));
    };
    std::string html =
        fmt::format("<dl class=\"facts\"><dt>Fastest</dt><dd>{}: {}</dd>\n", size(tuning.best),
                    counted(sweep.points[tuning.best].errors, "error"));
    if (tuning.predicted) {
        const CostModel& m = *tuning.model;
        html += fmt::format(
            "<dt>Model</dt><dd>{} ns a ray + {} ns a cell + {} ns a test, off by {} (root mean "
            "square)</dd>\n<dt>The model’s best</dt><dd>{}: regret {}</dd>\n",
            significant(m.ray), significant(m.cell), significant(m.test), percent(m.relative_error),
            size(*tuning.predicted), regret_text(tuning.predicted_regret));
    }
    if (tuning.automatic) {
        html += fmt::format("<dt>Auto</dt><dd>{}: regret {}</dd>\n", size(*tuning.automatic),
                            regret_text(tuning.automatic_regret));
    }
    if (tuning.per_object) {
        const double gain = tuning.per_object_gain;
        html += fmt::format(
            "<dt>Each object its own λ</dt><dd>{} {} than the best single λ"
            "</dd>\n",
            percent(std::abs(gain)), gain < 0.0 ? "slower" : "faster");
    }
    for (const DensityBand& band : tuning.bands) html += band_text(band);
    return html + fmt::format(
                      "<dt>No finer than needed</dt><dd>{}: within {:.0f} % of the fastest, {}, "
                      "{} less</dd></dl>\n",
                      size(tuning.smallest), 100.0 * kNoFinerShare,
                      byte_size(static_cast<double>(sweep.points[tuning.smallest].bytes)),
                      byte_size(tuning.saved_bytes));
}

std::string sweep_block(const Sweep& sweep, size_t index) {
    static constexpr std::pair<const char*, const char*> kPlots[] = {
        {"time", "Time of a ray, ns"},
        {"cells", "Cells a ray"},
        {"tests", "Triangle tests a ray"},
        {"memory", "Memory on the device, MiB"}};
    const std::optional<Tuning> tuning = tuning_of(sweep.points);
    std::string html = fmt::format(
        "<h3>{} <span class=\"quiet\">{} rays, <code>{}</code></span></h3>\n"
        "<p>{}: {}</p>\n{}<div class=\"plots\">\n",
        escape(sweep.scene->name), escape(sweep.rays), escape(sweep.tracer),
        counted(sweep.points.size(), "grid size"), finding(sweep),
        tuning ? outcome(sweep, *tuning) : std::string());
    for (const auto& [kind, title] : kPlots) {
        html += fmt::format(
            "<figure class=\"chart small\"><figcaption><strong>{}</strong></figcaption>"
            "<div class=\"plot{}\" data-chart=\"sweep\" data-sweep=\"{}\" data-measure=\"{}\">"
            "<canvas role=\"img\" aria-label=\"{} against density; the table below holds the same "
            "figures.\"></canvas></div></figure>\n",
            title, kind == std::string_view("time") ? " growth" : "", index, kind, title);
    }
    return html + "</div>\n" + point_table(sweep, tuning ? &*tuning : nullptr);
}

/// One row a study: the whole section at a glance.
std::string scenes_table(const std::vector<Sweep>& all) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Studies of grid "
        "sizes\"><table><thead><tr>" +
        heading_cell("Scene", "text");
    for (const char* name :
         {"Rays", "Tracer", "Fastest λ", "Within 5 %", "Model’s λ", "Its regret", "Auto’s λ",
          "Its regret", "No finer than needed: λ", "Memory saved", "Errors"}) {
        html += heading_cell(name);
    }
    html += "</tr></thead><tbody>\n";
    std::vector<double> regrets;
    for (const Sweep& sweep : all) {
        const std::optional<Tuning> tuning = tuning_of(sweep.points);
        if (!tuning) continue;
        const auto lambda = [&](std::optional<size_t> i) {
            return cell(i ? size_name(sweep.points[*i]) : std::string("–"));
        };
        const auto regret = [&](std::optional<size_t> i, const Regret& value) {
            return cell(i ? percent(value.share) : std::string("–"));
        };
        html += fmt::format("<tr><th scope=\"row\">{}</th>", escape(sweep.scene->name));
        html += cell(escape(sweep.rays), "text") + cell(escape(sweep.tracer), "text");
        html += lambda(tuning->best);
        html += cell(tuning->bands.empty() ? std::string("–")
                                           : significant(tuning->bands.front().low) + " – " +
                                                 significant(tuning->bands.front().high));
        html += lambda(tuning->predicted) + regret(tuning->predicted, tuning->predicted_regret);
        html += lambda(tuning->automatic) + regret(tuning->automatic, tuning->automatic_regret);
        html += lambda(tuning->smallest) + cell(byte_size(tuning->saved_bytes));
        const uint64_t errors = sweep.points[tuning->best].errors;
        html += cell(grouped(errors), errors == 0 ? "errors" : "errors bad") + "</tr>\n";
        if (tuning->automatic) regrets.push_back(tuning->automatic_regret.share);
    }
    html += "</tbody></table></div>\n";
    if (regrets.empty()) return html;
    return html + fmt::format("<p>Median regret of auto: <strong>{}</strong>, over {}.</p>\n",
                              percent(median(regrets)), counted(regrets.size(), "sweep"));
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
        "separate, counted pass. The grey strips hold the λ whose time is within 5 % and 20 % of "
        "the fastest; regret is how much longer a choice takes than the fastest size.</p>\n" +
        scenes_table(all);
    for (size_t i = 0; i < all.size(); ++i) html += sweep_block(all[i], i);
    return html + "</section>\n";
}

}  // namespace onepass::report
