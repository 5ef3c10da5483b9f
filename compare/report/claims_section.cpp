// The paper's claims: what it said, what was found, and the verdict; every measurement is one click
// away.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "compare/claims.h"
#include "compare/paper_figures.h"
#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"

namespace onepass::report {
namespace {

// ---- One measurement.

std::string medians(const ClaimMeasurement& m) {
    const auto text = [](const std::vector<double>& samples) {
        return samples.empty() ? std::string("–") : significant(median(samples));
    };
    return fmt::format("{} → {}<small>{}</small>", text(m.baseline_samples),
                       text(m.variant_samples), escape(m.unit));
}

std::string ratio_text(const ClaimMeasurement& m) {
    if (m.again_samples.empty()) return significant(m.ratio) + "<small>counted</small>";
    return fmt::format("{}<small>{} – {}</small>", significant(m.ratio), significant(m.ratio_low),
                       significant(m.ratio_high));
}

std::string bound_text(const ClaimMeasurement& m) {
    switch (m.expectation) {
        case Expectation::above:
            return "&gt; " + significant(m.bound);
        case Expectation::below:
            return "&lt; " + significant(m.bound);
        case Expectation::possible:
            return "can be made";
        case Expectation::none:
            break;
    }
    return "shown beside";
}

std::string measurement_verdict(const ClaimMeasurement& m) {
    if (m.expectation == Expectation::none && m.failure.empty()) return "–";
    return m.verdict == ClaimVerdict::depends ? "<span class=\"badge depends\">Undecided</span>"
                                              : badge(m.verdict);
}

std::string measurement_row(const ClaimMeasurement& m) {
    std::string html = fmt::format("<tr><th scope=\"row\">{}<small>{}, {}</small></th>",
                                   escape(m.scene), escape(m.work), counted(m.rays, "ray"));
    html += cell(measurement_verdict(m), "text");
    html += cell(escape(m.quantity), "text");
    html += cell(fmt::format("<code>{}</code>", breakable(escape(m.baseline))), "text setting");
    html += cell(fmt::format("<code>{}</code>", breakable(escape(m.variant))), "text setting");
    if (!m.failure.empty()) {
        return html +
               fmt::format("<td class=\"text\" colspan=\"5\">{}</td></tr>\n", escape(m.failure));
    }
    html += cell(medians(m));
    html += cell(ratio_text(m), "speed") + cell(bound_text(m));
    html += cell(m.again_samples.empty() ? "–" : "±" + significant(100.0 * m.noise, 2) + " %");
    return html +
           cell(fmt::format("{} / {}", grouped(m.baseline_errors), grouped(m.variant_errors)),
                m.baseline_errors + m.variant_errors == 0 ? "zero" : "bad") +
           "</tr>\n";
}

std::string measurement_table(const ClaimRecord& claim) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Measurements of " +
        escape(claim.id) + "\"><table><thead><tr>";
    for (const char* name : {"Scene, work", "Speaks", "Quantity", "Baseline", "Variant"}) {
        html += heading_cell(name, "text");
    }
    for (const char* name : {"Baseline → variant", "Variant / baseline<small>95 % interval</small>",
                             "Claimed", "Noise", "Errors<small>baseline / variant</small>"}) {
        html += heading_cell(name);
    }
    html += "</tr></thead><tbody>\n";
    for (const ClaimMeasurement& m : claim.measurements) html += measurement_row(m);
    return html + "</tbody></table></div>\n";
}

// ---- One claim.

std::string claim_rows(const ClaimRecord& claim) {
    std::string html = fmt::format("<tbody class=\"claim\" id=\"claim-{}-{}\">\n<tr>",
                                   slug(claim.id), slug(claim.entry));
    html += cell(badge(claim.verdict), "text");
    html += fmt::format("<th scope=\"row\">{}<small>{}</small></th>", escape(claim.claim),
                        escape(claim.source));
    html += cell(escape(claim.then), "text");
    html += cell(escape(claim.now.empty() ? "nothing measured" : claim.now), "text");
    html += "</tr>\n<tr class=\"more\"><td colspan=\"4\" class=\"text\"><details><summary>";
    html += fmt::format("Rule, {}, command</summary>\n<p>{}</p>\n{}",
                        counted(claim.measurements.size(), "measurement"), escape(claim.rule),
                        measurement_table(claim));
    html += fmt::format("<p>Again: <code class=\"copy\">{}</code></p></details></td></tr>\n",
                        escape(claim.command));
    return html + "</tbody>\n";
}

constexpr std::array kVerdicts = {ClaimVerdict::holds, ClaimVerdict::fails, ClaimVerdict::depends,
                                  ClaimVerdict::not_measured};

std::string tally(const std::vector<const ClaimRecord*>& claims) {
    std::string html = "<dl class=\"figures\">";
    for (const ClaimVerdict verdict : kVerdicts) {
        const auto count = std::count_if(claims.begin(), claims.end(), [&](const ClaimRecord* c) {
            return c->verdict == verdict;
        });
        if (count == 0) continue;
        html += fmt::format("<div><dd>{}</dd><dt>{}</dt></div>", count, badge(verdict));
    }
    return html + "</dl>\n";
}

/// The claims of one run that were tested with one entry.
std::string claims_block(const Results& run, size_t index, const std::string& entry) {
    std::vector<const ClaimRecord*> claims;
    for (const ClaimRecord& claim : run.claims) {
        if (claim.entry == entry) claims.push_back(&claim);
    }
    const std::string device =
        run.manifest.gl_renderer.empty() ? "no GL device" : run.manifest.gl_renderer;
    std::string html = fmt::format(
        "<h3>By {} shaders <span class=\"quiet\">{}{}; CPU: {}, {}</span></h3>\n", escape(entry),
        escape(device), run.manifest.software_renderer ? ", a software renderer" : "",
        escape(run.manifest.cpu), counted(run.manifest.cores, "core"));
    html += tally(claims);
    html +=
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Claims\">"
        "<table class=\"claims\"><thead><tr>";
    for (const char* name : {"Verdict", "Claim", "Then", "Now"}) {
        html += heading_cell(name, "text");
    }
    html += "</tr></thead>\n";
    for (const ClaimRecord* claim : claims) html += claim_rows(*claim);
    html += "</table></div>\n";
    html += fmt::format(
        "<figure class=\"chart\"><figcaption><strong>How far each measurement speaks for its "
        "claim</strong>To the right of the line it speaks for the claim, to the left against it. "
        "The whisker is the 95 % interval widened by the noise; one that touches the line decides "
        "nothing.</figcaption><div class=\"plot\" data-chart=\"claims\" data-run=\"{}\" "
        "data-entry=\"{}\"><canvas role=\"img\" aria-label=\"All ratios of the claims; the tables "
        "hold the same figures.\"></canvas></div></figure>\n",
        index, escape(entry));
    return html;
}

/// Places for the charts of claims that run over sizes; page.js fills those that have data.
std::string series_charts(const Results& run, size_t index, const std::string& entry) {
    static constexpr std::array<std::array<const char*, 3>, 2> kCharts = {
        {{"brute-force", "Where brute force wins",
          "Time of the same 64 × 64 rays against the number of triangles of a ball."},
         {"default-grid", "Grid density against the default",
          "Time relative to the default density; below 1 a hand-tuned grid is faster."}}};
    std::string html;
    for (const auto& [id, title, text] : kCharts) {
        for (const ClaimRecord& claim : run.claims) {
            const bool measured = std::any_of(
                claim.measurements.begin(), claim.measurements.end(),
                [](const ClaimMeasurement& m) { return m.size > 0.0 && m.failure.empty(); });
            if (claim.id != id || claim.entry != entry || !measured) continue;
            html += fmt::format(
                "<figure class=\"chart small\"><figcaption><strong>{0}</strong>{1}</figcaption>"
                "<div class=\"plot\" data-chart=\"series\" data-run=\"{2}\" data-entry=\"{3}\" "
                "data-claim=\"{4}\"><canvas role=\"img\" aria-label=\"{0}. The claim’s "
                "measurements hold the same figures.\"></canvas></div></figure>\n",
                title, text, index, escape(entry), id);
        }
    }
    return html.empty() ? html : "<div class=\"plots\">\n" + html + "</div>\n";
}

}  // namespace

bool is_reproduction(const Dossier& dossier) {
    return std::any_of(dossier.runs->begin(), dossier.runs->end(),
                       [](const Results& run) { return !run.claims.empty(); });
}

std::string badge(ClaimVerdict verdict) {
    switch (verdict) {
        case ClaimVerdict::holds:
            return "<span class=\"badge pass\">Holds</span>";
        case ClaimVerdict::fails:
            return "<span class=\"badge fail\">Fails</span>";
        case ClaimVerdict::depends:
            return "<span class=\"badge depends\">Depends</span>";
        case ClaimVerdict::not_measured:
            break;
    }
    return "<span class=\"badge\">Not measured</span>";
}

Support support_of(const ClaimMeasurement& m) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const double low = m.ratio_low / (1.0 + m.noise);
    const double high = m.ratio_high * (1.0 + m.noise);
    if (!m.failure.empty() || m.baseline_samples.empty()) return {kNone, kNone, kNone};
    if (m.expectation == Expectation::above)
        return {m.ratio / m.bound, low / m.bound, high / m.bound};
    if (m.expectation == Expectation::below)
        return {m.bound / m.ratio, m.bound / high, m.bound / low};
    return {kNone, kNone, kNone};
}

std::string claims_section(const Dossier& dossier) {
    if (!is_reproduction(dossier)) return {};
    std::string html = "<section id=\"claims\">\n<h2>Claims</h2>\n";
    html += fmt::format(
        "<p class=\"lead\">{}. What it says of its tracer, each sentence put to the test on scenes "
        "with its published counts.</p>\n"
        "<p class=\"note\">Its models, cameras and materials are not public: the scenes are "
        "stand-ins with the published triangle, instance and light counts, so frame rates are not "
        "comparable scene by scene.</p>\n",
        escape(kPaperSource));
    const std::vector<Results>& runs = *dossier.runs;
    for (size_t r = 0; r < runs.size(); ++r) {
        std::vector<std::string> entries;
        for (const ClaimRecord& claim : runs[r].claims) {
            if (std::find(entries.begin(), entries.end(), claim.entry) == entries.end()) {
                entries.push_back(claim.entry);
            }
        }
        for (const std::string& entry : entries) {
            html += claims_block(runs[r], r, entry) + series_charts(runs[r], r, entry);
        }
    }
    html += fmt::format("<p class=\"note\"><em>Verdicts.</em> {}</p>\n", escape(kVerdictRule));
    return html + "</section>\n";
}

}  // namespace onepass::report
