// How cost grows: charts on log axes with fitted power laws, their exponents, and every size.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"

namespace onepass::report {
namespace {

using Cost = GrowthCurve::Cost;

bool of_one_chart(const GrowthCurve& a, const GrowthCurve& b) {
    return a.cost == b.cost && a.over_rays == b.over_rays && a.rays == b.rays;
}

/// "65,536 rays", or from the fewest to the most; "" without any.
std::string counts_text(const std::vector<uint64_t>& counts, const std::string& noun) {
    if (counts.empty()) return {};
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    return *least == *most ? counted(*least, noun)
                           : fmt::format("{} to {}", grouped(*least), counted(*most, noun));
}

/// What a chart's curves hold fixed: "1,048,576 rays", "1,002,528 triangles".
std::string held_fixed(const Results& run, const GrowthCurve& curve) {
    std::vector<uint64_t> counts;
    for (const GrowthTrace& trace : run.growth_traces) {
        if (trace.growing_rays != curve.over_rays || trace.rays != curve.rays) continue;
        counts.push_back(curve.over_rays ? trace.triangles : trace.ray_count);
    }
    return counts_text(counts, curve.over_rays ? "triangle" : "ray");
}

std::string chart_title(const Results& run, const GrowthCurve& curve) {
    if (curve.cost == Cost::build_ms) return "Build time, ms";
    if (curve.cost == Cost::bytes) return "Memory of the structure, MiB";
    return fmt::format("{} rays: time, ms ({})", curve.rays, held_fixed(run, curve));
}

std::string tracer_cell(const std::string& tracer, const std::string& setting) {
    return fmt::format("<th scope=\"row\">{}{}</th>", breakable(escape(tracer)),
                       setting.empty() ? "" : fmt::format("<small>{}</small>", escape(setting)));
}

std::string open_table(const std::string& name) {
    return fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>"
        "<thead><tr>",
        escape(name));
}
constexpr char kCloseTable[] = "</tbody></table></div>\n";

/// One row a cost, one column a tracer.
std::string exponent_table(const std::vector<GrowthChart>& charts) {
    std::vector<std::string> names;
    for (const GrowthChart& chart : charts) {
        for (const std::string& name : chart.names) {
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        }
    }
    std::string html =
        open_table("Exponents") + heading_cell("Exponent of", "text") + heading_cell("Sizes");
    for (const std::string& name : names) html += heading_cell(breakable(escape(name)), "name");
    html += "</tr></thead><tbody>\n";
    for (const GrowthChart& chart : charts) {
        const GrowthCurve& first = chart.curves.front();
        html += fmt::format("<tr><th scope=\"row\">{}</th>", escape(cost_text(first)));
        html += cell(grouped(first.x.size()));
        for (const std::string& name : names) {
            const auto found = std::find(chart.names.begin(), chart.names.end(), name);
            if (found == chart.names.end()) {
                html += cell("–");
                continue;
            }
            const GrowthCurve& curve =
                chart.curves[static_cast<size_t>(found - chart.names.begin())];
            const std::string error = std::isnan(curve.law.standard_error)
                                          ? "error unknown"
                                          : fmt::format("± {:.3f}", curve.law.standard_error);
            html += cell(fmt::format("{:.3f}<small>{}{}</small>", curve.law.exponent, error,
                                     curve.by_device ? ", device" : ""),
                         "speed");
        }
        html += "</tr>\n";
    }
    return html + kCloseTable;
}

std::string build_table(const Results& run) {
    std::string html = open_table("Builds");
    html += heading_cell("Triangles") + heading_cell("Tracer", "text");
    html += heading_cell("Build, ms") + heading_cell("Builds") + heading_cell("Memory");
    html += heading_cell("Bytes a triangle") + heading_cell("Cells") + heading_cell("References");
    html += "</tr></thead><tbody>\n";
    for (const GrowthBuild& build : run.growth_builds) {
        html += "<tr>" + cell(grouped(build.triangles)) + tracer_cell(build.tracer, build.setting);
        if (!build.failure.empty()) {
            html += fmt::format("<td class=\"text bad\" colspan=\"6\">{}</td></tr>\n",
                                escape(build.failure));
            continue;
        }
        const double bytes = static_cast<double>(build.bytes);
        html += cell(significant(median(build.build_ms)), "speed");
        html += cell(grouped(build.build_ms.size())) + cell(byte_size(bytes));
        html += cell(significant(bytes / static_cast<double>(build.triangles)));
        html += cell(build.cells > 0 ? grouped(build.cells) : "–");
        html += cell(build.references > 0 ? grouped(build.references) : "–") + "</tr>\n";
    }
    return html + kCloseTable;
}

std::string trace_table(const Results& run) {
    std::string html = open_table("Casts");
    html += heading_cell("Triangles") + heading_cell("Rays") + heading_cell("Tracer", "text");
    html += heading_cell("Mrays/s") + heading_cell("Errors<small>of judged rays</small>");
    html += heading_cell("Edges") + heading_cell("Median, ms");
    html += heading_cell("Device, ms<small>Mrays/s</small>") + heading_cell("Samples");
    html += "</tr></thead><tbody>\n";
    for (const GrowthTrace& trace : run.growth_traces) {
        const double rays = static_cast<double>(trace.ray_count);
        const double wall_ms = median(trace.wall_ms), device_ms = median(trace.device_ms);
        html += "<tr>" + cell(grouped(trace.triangles));
        html +=
            cell(fmt::format("{}<small>{}</small>", grouped(trace.ray_count), escape(trace.rays)));
        html += tracer_cell(trace.tracer, trace.setting);
        html += cell(significant(rays / (1e3 * wall_ms)), "speed");
        html += cell(
            fmt::format("{}<small>of {}</small>", grouped(trace.errors), grouped(trace.judged)),
            trace.errors == 0 ? "errors" : "errors bad");
        html += cell(grouped(trace.edges), trace.edges == 0 ? "zero" : "");
        html += cell(significant(wall_ms));
        html += trace.device_ms.empty()
                    ? cell("–")
                    : cell(fmt::format("{}<small>{}</small>", significant(device_ms),
                                       significant(rays / (1e3 * device_ms))));
        html += cell(grouped(trace.wall_ms.size())) + "</tr>\n";
    }
    return html + kCloseTable;
}

std::string chart_figure(const GrowthChart& chart, size_t index) {
    return fmt::format(
        "<figure class=\"chart small\"><figcaption><strong>{0}</strong></figcaption>"
        "<div class=\"plot growth\" data-chart=\"growth\" data-growth=\"{1}\"><canvas role=\"img\" "
        "aria-label=\"{0} over {2}, both axes logarithmic. The tables below hold the same "
        "figures.\"></canvas></div></figure>\n",
        escape(chart.title), index, chart.curves.front().over_rays ? "rays" : "triangles");
}

}  // namespace

std::vector<GrowthChart> growth_charts(const Dossier& dossier) {
    std::vector<GrowthChart> charts;
    for (size_t r = 0; r < dossier.runs->size(); ++r) {
        const Results& run = (*dossier.runs)[r];
        const size_t first = charts.size();
        std::vector<std::string> tracers;
        for (GrowthCurve& curve : growth_curves(run)) {
            const std::string name =
                curve.setting.empty() ? curve.tracer : curve.tracer + " (" + curve.setting + ")";
            auto colour = std::find(tracers.begin(), tracers.end(), name);
            if (colour == tracers.end()) colour = tracers.insert(tracers.end(), name);
            auto chart = std::find_if(
                charts.begin() + static_cast<std::ptrdiff_t>(first), charts.end(),
                [&](const GrowthChart& c) { return of_one_chart(c.curves.front(), curve); });
            if (chart == charts.end()) {
                chart = charts.insert(charts.end(), {r, chart_title(run, curve), {}, {}, {}});
            }
            chart->names.push_back(name);
            chart->colours.push_back(static_cast<size_t>(colour - tracers.begin()));
            chart->curves.push_back(std::move(curve));
        }
    }
    return charts;
}

std::string growth_section(const Dossier& dossier) {
    const std::vector<GrowthChart> charts = growth_charts(dossier);
    std::string blocks;
    for (size_t r = 0; r < dossier.runs->size(); ++r) {
        const Results& run = (*dossier.runs)[r];
        if (run.growth_builds.empty() && run.growth_traces.empty()) continue;
        const std::string& device =
            run.manifest.gl_renderer.empty() ? run.manifest.cpu : run.manifest.gl_renderer;
        const std::string& shape =
            run.growth_traces.empty() ? run.growth_builds[0].scene : run.growth_traces[0].scene;
        blocks += fmt::format("<h3>{} <span class=\"quiet\">{}; CPU: {}, {}</span></h3>\n",
                              escape(shape), escape(device), escape(run.manifest.cpu),
                              counted(run.manifest.cores, "core"));
        std::string figures;
        std::vector<GrowthChart> of_run;
        for (size_t i = 0; i < charts.size(); ++i) {
            if (charts[i].run != r) continue;
            figures += chart_figure(charts[i], i);
            of_run.push_back(charts[i]);
        }
        if (!of_run.empty()) {
            blocks +=
                "<div class=\"plots wide\">\n" + figures + "</div>\n" + exponent_table(of_run);
        }
        if (!run.growth_builds.empty()) blocks += "<h4>Builds</h4>\n" + build_table(run);
        if (!run.growth_traces.empty()) blocks += "<h4>Casts</h4>\n" + trace_table(run);
    }
    if (blocks.empty()) return {};
    return "<section id=\"growth\">\n<h2>How cost grows</h2>\n"
           "<p class=\"lead\">One closed shape in ever more triangles, then ever more rays into "
           "one of its sizes. Both axes are logarithmic, so that a power law is a straight line "
           "and its exponent the slope.</p>\n" +
           blocks +
           "<p class=\"note\"><em>Exponents</em>: least squares through the logarithms of the "
           "medians, ± one standard error, which comes from the scatter about the line and says "
           "nothing of "
           "a bend, which the charts show. Build times include packing and leave out upload; "
           "memory is the structure’s on the device, of Embree what it reports. Times of casts "
           "are the device’s own where it has a timer, marked so, and wall times elsewhere. "
           "<em>Errors</em> are counted in a sample of the same rays, every answer of it "
           "judged.</p>\n</section>\n";
}

}  // namespace onepass::report
