// Speed: the timing table with errors beside every speed, and the places of its charts.
#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"

namespace onepass::report {
namespace {

/// The middle half of the samples, as a share of the median: robust against one disturbed round.
std::string spread(const std::vector<double>& samples) {
    const double middle = quantile(samples, 0.5);
    if (!(middle > 0.0)) return "–";
    return significant(100.0 * (quantile(samples, 0.75) - quantile(samples, 0.25)) / middle, 2) +
           " %";
}

std::string timing_row(const SceneDossier& scene, const Entry<TimingRecord>& timing) {
    const bool software = timing.tracer && timing.tracer->software_renderer;
    std::string html =
        fmt::format("<tr><th scope=\"row\">{}{}</th>", escape(label(scene.timings, timing)),
                    software ? "<small>software renderer</small>" : "");
    html += cell(
        fmt::format("{}<small>{}</small>", escape(timing->rays), counted(timing->ray_count, "ray")),
        "text");
    html += cell(significant(timing->mrays_per_s), "speed");
    html += cell(fmt::format("{}<small>{}</small>", grouped(timing->errors),
                             percent(timing->errors, timing->ray_count)),
                 timing->errors == 0 ? "errors" : "errors bad");
    html += cell(grouped(timing->edges), timing->edges == 0 ? "zero" : "");
    html += cell(fmt::format("{}<small>{} – {}</small>", significant(timing->ratio),
                             significant(timing->ratio_low), significant(timing->ratio_high)));
    html += cell(significant(timing->median_ms));
    html += cell(spread(timing->wall_ms));
    html += cell(significant(median(timing->device_ms)));
    return html + cell(grouped(timing->wall_ms.size())) + "</tr>\n";
}

std::string timing_table(const SceneDossier& scene) {
    std::string html = fmt::format(
        "<h3>{0}</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
        "aria-label=\"Timing of {0}\"><table><thead><tr>",
        escape(scene.name));
    html += heading_cell("Tracer", "text") + heading_cell("Rays", "text");
    html += heading_cell("Mrays/s") + heading_cell("Errors") + heading_cell("Edges");
    html += heading_cell("Ratio to Embree<small>95 % interval</small>");
    html += heading_cell("Median, ms") + heading_cell("Spread");
    html += heading_cell("Device, ms") + heading_cell("Samples") + "</tr></thead><tbody>\n";
    for (const auto& timing : scene.timings) html += timing_row(scene, timing);
    return html + "</tbody></table></div>\n";
}

std::string chart(const std::string& kind, const std::string& title, const std::string& caption) {
    return fmt::format(
        "<figure class=\"chart\"><figcaption><strong>{1}</strong>{2}</figcaption>"
        "<div class=\"plot\" data-chart=\"{0}\"><canvas role=\"img\" aria-label=\"{1}. The table "
        "of "
        "this section holds the same figures.\"></canvas></div></figure>\n",
        kind, title, caption);
}

}  // namespace

std::string speed_section(const Dossier& dossier) {
    std::string tables;
    for (const SceneDossier& scene : dossier.scenes) {
        if (!scene.timings.empty()) tables += timing_table(scene);
    }
    if (tables.empty()) return {};

    std::string html = "<section id=\"speed\">\n<h2>Speed</h2>\n";
    html += chart("ratios", "Speed relative to Embree",
                  "Above 1 is faster than the oracle on the same rays in the same rounds. The "
                  "whisker is the 95 % bootstrap interval; the count after each name is its "
                  "errors.");
    html += chart("scatter", "Speed against errors",
                  "Up is faster, left is cleaner. One point a scene, ray kind and tracer; the "
                  "colour is the tracer, the shape the scene.");
    html += tables;
    html +=
        "<p class=\"note\">Times are wall times from launch to finish, without upload and "
        "read-back; all tracers of a table took turns in random order in one process. "
        "<em>Errors</em> are those of the same tracer on the same rays in the same run. "
        "<em>Spread</em>: the middle half of the samples, as a share of the median. "
        "<em>Device</em>: the device’s own timer, where it can be trusted.</p>\n";
    return html + "</section>\n";
}

}  // namespace onepass::report
