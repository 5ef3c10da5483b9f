// Speed: the timing table with errors beside every speed, and the places of its charts.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/time_to_image.h"
#include "compare/timing.h"
#include "compare/verdict.h"

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

constexpr uint64_t kBootstrapSeed = 0;  ///< every reader of the same samples gets the same figures

using Case = std::vector<Entry<TimingRecord>>;

/// The scene's timings by run and rays, in file order.
std::vector<Case> cases_of(const SceneDossier& scene) {
    std::vector<Case> cases;
    for (const auto& timing : scene.timings) {
        const auto same = std::find_if(cases.begin(), cases.end(), [&](const Case& c) {
            return c.front().run == timing.run && c.front()->rays == timing->rays;
        });
        if (same == cases.end()) {
            cases.push_back({timing});
        } else {
            same->push_back(timing);
        }
    }
    return cases;
}

std::vector<const TimingRecord*> records_of(const Case& timings) {
    std::vector<const TimingRecord*> records;
    for (const auto& timing : timings) records.push_back(timing.record);
    return records;
}

std::string verdict_cell(const SpeedComparison& comparison) {
    return cell(escape(to_string(comparison.verdict)), "text");
}

std::string noise_text(double noise) {
    return std::isnan(noise) ? "not known" : significant(100.0 * noise, 2) + " %";
}

std::string errors_cell(uint64_t errors) {
    return cell(grouped(errors), errors == 0 ? "errors" : "errors bad");
}

/// A table under its own heading; empty without rows.
std::string titled_table(const std::string& title, const std::string& headings,
                         const std::string& rows, const std::string& note) {
    if (rows.empty()) return {};
    return fmt::format(
        "<h4>{0}</h4>\n<p class=\"note\">{1}</p>\n<div class=\"scroll\" "
        "tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><thead><tr>{2}"
        "</tr></thead><tbody>\n{3}</tbody></table></div>\n",
        title, note, headings, rows);
}

std::string case_heading(const SceneDossier& scene, const Entry<TimingRecord>& timing) {
    return fmt::format("<tr><th scope=\"row\">{}<small>{}</small></th>",
                       escape(label(scene.timings, timing)), escape(timing->rays));
}

/// Each tracer against the one that had a rival in the same rounds.
std::string pair_table(const SceneDossier& scene) {
    std::string rows;
    for (const Case& timings : cases_of(scene)) {
        const std::vector<const TimingRecord*> records = records_of(timings);
        const TimingRecord* baseline = baseline_of(records);
        if (!baseline) continue;
        for (const auto& timing : timings) {
            if (timing.record == baseline) continue;
            const bool by_device = !timing->device_ms.empty() && !baseline->device_ms.empty();
            const double noise = noise_of_case(records, by_device, kBootstrapSeed);
            const SpeedComparison c =
                compare_speeds(*timing.record, *baseline, noise, kBootstrapSeed);
            rows += case_heading(scene, timing);
            rows += cell(escape(baseline->tracer), "text");
            rows += cell(fmt::format("{} ×<small>{} – {}</small>", significant(c.speed.ratio),
                                     significant(c.speed.low), significant(c.speed.high)));
            rows += cell(noise_text(noise)) + verdict_cell(c);
            rows += errors_cell(timing->errors) + errors_cell(baseline->errors) + "</tr>\n";
        }
    }
    return titled_table(
        "Pair by pair on " + escape(scene.name),
        heading_cell("Tracer", "text") + heading_cell("Against", "text") +
            heading_cell("Speed<small>95 % interval</small>") + heading_cell("Noise") +
            heading_cell("Verdict", "text") + heading_cell("Errors") +
            heading_cell("Errors of the other"),
        rows,
        "The median of the rounds’ ratios, with its 95 % bootstrap interval over rounds. The noise "
        "is how far the same interval reaches from 1 for the tracer held against and a rival "
        "identical to it, in the same rounds. Faster or slower is said only if the interval, "
        "widened on both sides by the noise, leaves 1 out.");
}

std::string per_ray_cell(uint64_t count, const TimingRecord& timing) {
    return cell(significant(static_cast<double>(count) / static_cast<double>(timing.ray_count)));
}

std::string counter_table(const SceneDossier& scene) {
    std::string rows;
    for (const auto& timing : scene.timings) {
        if (!timing->counts) continue;
        const CastCounts& counts = *timing->counts;
        rows += case_heading(scene, timing);
        rows += per_ray_cell(counts.cells, *timing.record);
        rows += per_ray_cell(counts.tests, *timing.record);
        rows += cell(
            counts.walked_tests == 0 ? "–" : percent(counts.repeated_tests, counts.walked_tests));
        rows += per_ray_cell(counts.references, *timing.record);
        rows += cell(significant(timing->mrays_per_s)) + errors_cell(timing->errors) + "</tr>\n";
    }
    return titled_table(
        "What a ray costs on " + escape(scene.name),
        heading_cell("Tracer", "text") + heading_cell("Cells a ray") + heading_cell("Tests a ray") +
            heading_cell("Repeated tests") + heading_cell("References a ray") +
            heading_cell("Mrays/s") + heading_cell("Errors"),
        rows,
        "Counted in a pass of its own: no timed cast counts. <em>Repeated tests</em> "
        "are of a triangle that the ray had tested before, of a sample of rays, "
        "where a tracer tells its way.");
}

std::string crossing_text(const Crossing& from) {
    if (from.rays == 0.0) return "0";
    return fmt::format("{}<small>{} – {}</small>", significant(from.rays), significant(from.low),
                       significant(from.high));
}

/// Build and rays: who has an image first, from how many rays on.
std::string image_table(const Dossier& dossier, const SceneDossier& scene) {
    std::string rows;
    for (const Case& timings : cases_of(scene)) {
        const std::vector<const TimingRecord*> records = records_of(timings);
        const Results& run = (*dossier.runs)[timings.front().run];
        const std::vector<ImageLine> lines = image_lines(records, run.builds);
        for (const FirstWithImage& first : first_with_image(lines, kBootstrapSeed)) {
            const ImageLine& line = lines[first.line];
            const auto timing = std::find_if(timings.begin(), timings.end(), [&](const auto& t) {
                return t.record == line.timing;
            });
            rows += case_heading(scene, *timing);
            rows += cell(crossing_text(first.from)) + cell(significant(build_ms(line)));
            rows +=
                cell(significant(ms_per_mray(line))) + errors_cell(line.timing->errors) + "</tr>\n";
        }
    }
    return titled_table("Time to image on " + escape(scene.name),
                        heading_cell("First with its image", "text") +
                            heading_cell("From, rays<small>95 % interval</small>") +
                            heading_cell("Build, ms") + heading_cell("ms a million rays") +
                            heading_cell("Errors"),
                        rows,
                        "An image costs the build, packing included, and then its rays by wall "
                        "time. From the number of rays named on, this tracer has its image before "
                        "all others; who is not listed never has. ∞: the rounds leave open whether "
                        "it ever does. Compiling shaders and bringing structures to a device are "
                        "not in it.");
}

std::string timing_row(const SceneDossier& scene, const Entry<TimingRecord>& timing, double noise) {
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
    html += timing->tracer == timing->oracle
                ? cell("–")
                : verdict_cell(compare_with_oracle(*timing.record, noise, kBootstrapSeed));
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
    html += heading_cell("Verdict", "text");
    html += heading_cell("Median, ms") + heading_cell("Spread");
    html += heading_cell("Device, ms<small>Mrays/s, ratio</small>") + heading_cell("Samples") +
            "</tr></thead><tbody>\n";
    const std::vector<Case> cases = cases_of(scene);
    for (const auto& timing : scene.timings) {
        const auto of = std::find_if(cases.begin(), cases.end(), [&](const Case& c) {
            return c.front().run == timing.run && c.front()->rays == timing->rays;
        });
        const double noise = noise_of_case(records_of(*of), false, kBootstrapSeed);
        html += timing_row(scene, timing, noise);
    }
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
        if (scene.timings.empty()) continue;
        tables += timing_table(scene) + pair_table(scene) + counter_table(scene) +
                  image_table(dossier, scene);
    }
    const std::string paces = pace_table(dossier);
    std::string html = "<section id=\"speed\">\n<h2>Speed</h2>\n";
    if (tables.empty()) return paces.empty() ? "" : html + paces + "</section>\n";
    html += chart("ratios", "Speed relative to Embree",
                  "Above 1 is faster than the oracle on the same rays in the same rounds. The "
                  "whisker is the 95 % bootstrap interval; the count after each name is its "
                  "errors.");
    html += tables;
    html +=
        "<p class=\"note\">Times are wall times from launch to finish, without upload and "
        "read-back; all tracers of a table took turns in random order in one process. "
        "<em>Errors</em> are those of the same tracer on the same rays in the same run. "
        "<em>Verdict</em>: against the oracle, by the rule of the pairs; without a rival in the "
        "run, by the interval alone. <em>Spread</em>: the middle half of the samples, as a share "
        "of the median. "
        "<em>Device</em>: the device’s own timer, where it can be trusted; its ratio is of the "
        "oracle’s wall time to it.</p>\n";
    html += paces;
    return html + "</section>\n";
}

}  // namespace onepass::report
