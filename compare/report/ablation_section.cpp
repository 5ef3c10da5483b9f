// Ablations: what each step of a strategy is worth, scene by scene.
#include <fmt/format.h>

#include "compare/ablation.h"
#include "compare/report/html.h"
#include "compare/report/sections.h"

namespace onepass::report {
namespace {

bool same_table(const AblationRecord& a, const AblationRecord& b) {
    return a.scene == b.scene && a.work == b.work;
}

std::string row(const AblationRecord& r, bool is_first) {
    const char* whole = is_first ? "as it is" : "as it is, again";
    std::string html =
        fmt::format("<tr><th scope=\"row\">{}<small><code>{}</code></small></th>",
                    r.without.empty() ? whole : escape(r.without), breakable(escape(r.setting)));
    if (!r.failure.empty()) {
        return html +
               fmt::format("<td class=\"text\" colspan=\"5\">{}</td></tr>\n", escape(r.failure));
    }
    html += cell(fmt::format("{}<small>{} – {}</small>", significant(r.ratio),
                             significant(r.ratio_low), significant(r.ratio_high)),
                 "speed");
    html += cell(significant(mrays_per_s(r))) + cell(significant(median_ms(r)));
    html += cell(fmt::format("{}<small>{}</small>", grouped(r.errors), percent(r.errors, r.rays)),
                 r.errors == 0 ? "errors" : "errors bad");
    return html + cell(grouped(r.edges), r.edges == 0 ? "zero" : "") + "</tr>\n";
}

std::string table(const AblationRecord& full, const std::string& device, const std::string& rows) {
    const bool is_image = full.work == "image";
    const std::string title = escape(fmt::format(
        "{}, {}, {}", full.scene, is_image ? "the whole image" : full.work + " rays", full.tracer));
    return fmt::format(
               "<h3>{0} <span class=\"quiet\">{1}, {2}</span></h3>\n<div class=\"scroll\" "
               "tabindex=\"0\" role=\"region\" aria-label=\"Ablations, {0}\"><table><thead><tr>",
               title, counted(full.rays, is_image ? "pixel" : "ray"), escape(device)) +
           heading_cell("Without", "text") +
           heading_cell("Speed, relative<small>95 % interval</small>") + heading_cell("Mrays/s") +
           heading_cell("Median, ms") + heading_cell("Errors") + heading_cell("Edges") +
           "</tr></thead><tbody>\n" + rows + "</tbody></table></div>\n";
}

}  // namespace

std::string ablation_section(const Dossier& dossier) {
    std::string tables;
    for (const Results& run : *dossier.runs) {
        const std::vector<AblationRecord>& all = run.ablations;
        for (size_t begin = 0; begin < all.size();) {
            const AblationRecord& full = all[begin];
            std::string rows;
            for (; begin < all.size() && same_table(all[begin], full); ++begin) {
                rows += row(all[begin], rows.empty());
            }
            tables += table(full, run.manifest.gl_renderer, rows);
        }
    }
    if (tables.empty()) return {};
    return "<section id=\"ablations\">\n<h2>Ablations</h2>\n"
           "<p class=\"lead\">The strategy as it is, and with one step taken out at a time: all in "
           "random order in the same rounds. Below 1 the step pays.</p>\n" +
           tables +
           "<p class=\"note\"><em>As it is</em> stands twice: how far the second is from 1 is what "
           "the run can tell apart. Times are the device’s own where it has a timer to trust, else "
           "wall times. <em>Errors</em> of rays are judged; those of an image are pixels unlike "
           "the strategy’s as it is, and its Mrays/s are primary rays.</p>\n</section>\n";
}

}  // namespace onepass::report
