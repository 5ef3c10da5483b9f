// Speed: the timing table with errors beside every speed, and the places of its charts.
#include <cmath>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/timing.h"

namespace onepass::report {
namespace {

/// The middle half of the samples, as a share of the median: robust against one disturbed round.
std::string spread(const std::vector<double>& samples) {
    const double middle = quantile(samples, 0.5);
    if (!(middle > 0.0)) return "–";
    return significant(100.0 * (quantile(samples, 0.75) - quantile(samples, 0.25)) / middle, 2) +
           " %";
}

/// By the device's own timer: median, rate, ratio.
std::string device_cell(const TimingRecord& timing) {
    const DeviceSpeed speed = device_speed(timing, 0);
    if (std::isnan(speed.median_ms)) return cell("–");
    return cell(fmt::format("{}<small>{} Mrays/s</small><small>{} ×, {} – {}</small>",
                            significant(speed.median_ms, 4), significant(speed.mrays_per_s, 4),
                            significant(speed.ratio.ratio), significant(speed.ratio.low),
                            significant(speed.ratio.high)));
}

std::string clock_cell(const std::optional<ClockReading>& clocks) {
    if (!clocks) return cell("–");
    return cell(fmt::format("{} MHz<small>memory {} MHz, {} °C</small>",
                            significant(clocks->sm_mhz, 4), significant(clocks->memory_mhz, 4),
                            significant(clocks->temperature_c, 2)));
}

/// Whether each device held its pace. Empty where no tracer ran on one.
std::string pace_table(const Dossier& dossier) {
    std::string rows;
    for (const Results& run : *dossier.runs) {
        for (const PaceRecord& pace : run.paces) {
            rows +=
                fmt::format("<tr><th scope=\"row\">{}<small>{}, {}</small></th>",
                            escape(pace.scene), escape(pace.rays), counted(pace.ray_count, "ray"));
            rows += cell(fmt::format("{} s<small>{}</small>", significant(1e-3 * pace.warm_up_ms),
                                     counted(pace.warm_up_rounds, "round")));
            rows += cell(fmt::format("{} %{}", significant(100.0 * pace.change, 2),
                                     pace.steady ? "" : "<small>not steady</small>"),
                         pace.steady ? "" : "bad");
            rows += clock_cell(pace.before) + clock_cell(pace.after);
            rows += cell(escape(pace.clocks_of), "text") + "</tr>\n";
        }
    }
    if (rows.empty()) return {};
    return "<h3>Pace of the device</h3>\n<p class=\"note\">An idle chip clocks low. Before the "
           "counted casts it was kept at work until its pace, the median of a few rounds, held "
           "still; the clocks were read just before and just after them.</p>\n"
           "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Pace of the "
           "device\"><table><thead><tr>" +
           heading_cell("Casts of", "text") + heading_cell("Warm-up") +
           heading_cell("Last change of pace") + heading_cell("SM clock before") +
           heading_cell("SM clock after") + heading_cell("Clocks of", "text") +
           "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
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
    html += device_cell(*timing.record);
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
    html += heading_cell("Device, ms<small>Mrays/s, ratio</small>") + heading_cell("Samples") +
            "</tr></thead><tbody>\n";
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
    const std::string paces = pace_table(dossier);
    std::string html = "<section id=\"speed\">\n<h2>Speed</h2>\n";
    if (tables.empty()) return paces.empty() ? "" : html + paces + "</section>\n";
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
        "<em>Device</em>: the device’s own timer, where it can be trusted; its ratio is of the "
        "oracle’s wall time to it.</p>\n";
    html += paces;
    return html + "</section>\n";
}

}  // namespace onepass::report
