// The paper's tables and figures with ours beside them, moving objects, streaming, and where the
// tracers depart from the printed text.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "compare/manifest.h"
#include "compare/paper_figures.h"
#include "compare/report/html.h"
#include "compare/report/pictures.h"
#include "compare/report/sections.h"
#include "compare/statistics.h"

namespace onepass::report {
namespace {

std::string table(const std::string& name, const std::string& head, const std::string& rows) {
    return fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table "
        "class=\"dense\"><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
        escape(name), head, rows);
}

std::string row_head(const PaperScene& scene) {
    return fmt::format("<th scope=\"row\">{}<small>{}</small></th>", escape(scene.printed),
                       escape(scene.name));
}

// ---- Table 1: what the scenes hold.

const SceneRecord* find_scene(const Dossier& dossier, std::string_view name) {
    for (const SceneDossier& scene : dossier.scenes) {
        if (scene.name == name && !scene.versions.empty()) return scene.versions.front().record;
    }
    return nullptr;
}

std::string count_cells(uint64_t then, const uint64_t* now) {
    if (!now) return cell(then ? grouped(then) : "–") + cell("–", "quiet");
    const bool differs = then > 0 && then != *now;
    return cell(then ? grouped(then) : "–") + cell(grouped(*now), differs ? "bad" : "");
}

std::string table_of_counts(const Dossier& dossier) {
    std::string rows;
    for (const PaperScene& scene : kPaperScenes) {
        const SceneRecord* ours = find_scene(dossier, scene.name);
        rows += "<tr>" + row_head(scene);
        rows += count_cells(scene.triangles, ours ? &ours->triangles : nullptr);
        rows += count_cells(scene.instances, ours ? &ours->instances : nullptr);
        rows += count_cells(scene.lights, ours ? &ours->lights : nullptr);
        rows += cell(ours ? grouped(ours->unique_triangles) : "not measured") + "</tr>\n";
    }
    std::string head = heading_cell("Scene<small>our stand-in</small>", "text");
    for (const char* name : {"Triangles", "Instances", "Lights"}) {
        head += heading_cell(fmt::format("{}<small>then</small>", name)) +
                heading_cell(fmt::format("{}<small>now</small>", name));
    }
    head += heading_cell("Triangles stored<small>now</small>");
    return "<h3>Table 1: the scenes</h3>\n" + table("Table 1", head, rows);
}

// ---- Table 2: how fast.

/// Rendered stills of the paper's size; of several sizes, the largest.
const FrameTimingRecord* find_frames(const Results& run, std::string_view scene,
                                     const std::string& tracer) {
    const FrameTimingRecord* best = nullptr;
    for (const FrameTimingRecord& record : run.frame_timings) {
        if (record.scene != scene || record.tracer != tracer || record.frames != 1) continue;
        if (!record.setting.empty() || record.wall_ms.empty()) continue;
        if (!best || record.width > best->width) best = &record;
    }
    return best;
}

const TimingRecord* find_timing(const Results& run, std::string_view scene,
                                const std::string& tracer, std::string_view rays) {
    for (const TimingRecord& record : run.timings) {
        if (record.scene == scene && record.tracer == tracer && record.rays == rays) return &record;
    }
    return nullptr;
}

std::string with_ratio(double value, const char* other, double ratio, double low, double high) {
    return fmt::format("{}<small>{} × {}</small><small>{} – {}</small>", significant(value),
                       significant(ratio), other, significant(low), significant(high));
}

std::string frame_cells(const FrameTimingRecord* record) {
    if (!record) return cell("not measured", "quiet") + cell("–") + cell("–");
    const double rays = static_cast<double>(record->primary_rays + record->secondary_rays) /
                        static_cast<double>(record->primary_rays);
    std::string html = cell(with_ratio(record->frames_per_s, "Embree", record->ratio,
                                       record->ratio_low, record->ratio_high),
                            "speed");
    html += cell(fmt::format("{}<small>of {}</small>", grouped(record->differing_pixels),
                             grouped(record->compared_pixels)),
                 record->differing_pixels == 0 ? "zero" : "");
    return html + cell(significant(rays));
}

std::string cast_cells(const TimingRecord* record) {
    if (!record) return cell("–", "quiet") + cell("–", "quiet");
    return cell(with_ratio(record->mrays_per_s, "Embree", record->ratio, record->ratio_low,
                           record->ratio_high),
                "speed") +
           cell(fmt::format("{}<small>{}</small>", grouped(record->errors),
                            percent(record->errors, record->ray_count)),
                record->errors == 0 ? "errors" : "errors bad");
}

constexpr const char* kRayKinds[] = {"primary", "shadow", "reflection"};

std::string table_of_speeds(const Results& run, const std::string& tracer) {
    uint32_t side = 0;
    std::string rows;
    for (const PaperScene& scene : kPaperScenes) {
        const FrameTimingRecord* frames = find_frames(run, scene.name, tracer);
        if (frames) side = frames->width;
        rows += "<tr>" + row_head(scene);
        rows += cell(significant(scene.frames_per_s)) + frame_cells(frames);
        rows += cell(significant(scene.primary_mrays_per_s()));
        for (const char* kind : kRayKinds) {
            rows += cast_cells(find_timing(run, scene.name, tracer, kind));
        }
        rows += "</tr>\n";
    }
    std::string head = heading_cell("Scene", "text") + heading_cell("Frames/s<small>then</small>") +
                       heading_cell("Frames/s<small>now</small>") + heading_cell("Pixels off") +
                       heading_cell("Rays a pixel") +
                       heading_cell("Primary Mrays/s<small>then</small>");
    for (const char* kind : kRayKinds) {
        head += heading_cell(fmt::format("{} Mrays/s<small>now</small>", kind));
        head += heading_cell("Errors");
    }
    const std::string device =
        run.manifest.gl_renderer + (run.manifest.software_renderer ? ", a software renderer" : "");
    return fmt::format(
               "<h3>Table 2: the speed <span class=\"quiet\">then {}; now <code>{}</code> on {}, "
               "{} × {} pixels</span></h3>\n",
               escape(kPaperDevice), escape(tracer), escape(device), side, side) +
           table("Table 2", head, rows);
}

/// Tracers with stills of the paper's scenes, without the oracles.
std::vector<std::string> table_tracers(const Results& run) {
    std::vector<std::string> tracers;
    for (const PaperScene& scene : kPaperScenes) {
        for (const FrameTimingRecord& record : run.frame_timings) {
            const bool wanted =
                record.scene == scene.name && record.frames == 1 && record.setting.empty() &&
                record.tracer != record.oracle &&
                find_timing(run, scene.name, record.tracer, "primary") &&
                std::find(tracers.begin(), tracers.end(), record.tracer) == tracers.end();
            if (wanted) tracers.push_back(record.tracer);
        }
    }
    return tracers;
}

// ---- Figures.

std::string figure_title(std::string_view name) {
    if (name == "balls-1") return "Figures 1 and 4: Balls-1, two mirrors that reflect each other";
    for (const PaperScene& scene : kPaperScenes) {
        if (scene.name == name) return fmt::format("Figure 1: {}", scene.printed);
    }
    return std::string(name);
}

std::string picture(const std::string& path_bytes, const std::string& title,
                    const std::string& text) {
    const PngSize size = png_size(path_bytes);
    return fmt::format(
        "<figure><button type=\"button\" class=\"zoom\" aria-label=\"Enlarge: {0}\"><img "
        "src=\"{1}\" "
        "width=\"{2}\" height=\"{3}\" alt=\"{0}\"></button><figcaption><strong>{0}</strong>{4}"
        "</figcaption></figure>\n",
        escape(title), data_uri(path_bytes), size.width, size.height, text);
}

std::string figure_row(const Dossier& dossier, const Entry<ImageRecord>& image) {
    std::string html = fmt::format("<h3>{}</h3>\n<div class=\"pictures wide\">\n",
                                   escape(figure_title(image->scene)));
    for (const auto& [role, file] : image->pictures) {
        const std::string bytes = read_png((*dossier.folders)[image.run] / file);
        if (role == "image") {
            html += picture(bytes, image->tracer,
                            fmt::format("{} × {} pixels, {} rays a pixel", image->width,
                                        image->height, significant(image->rays_per_pixel)));
        } else if (role == "oracle") {
            html += picture(bytes, image->oracle, "the oracle, with the same shading model");
        } else if (role == "difference") {
            html += picture(
                bytes, "Difference, largest channel",
                fmt::format("<span class=\"ramp\"></span><span class=\"ends\"><span>{}</span>"
                            "<span>1, logarithmic</span></span>{} of {} pixels off by more; PSNR "
                            "{} dB",
                            significant(image->tolerance), grouped(image->differing_pixels),
                            grouped(uint64_t{image->width} * image->height),
                            significant(image->psnr_db)));
        }
    }
    return html + "</div>\n";
}

// ---- Costs.

double cost(const FrameTimingRecord& record, const std::string& name) {
    return stat_value(record.costs, name);
}

std::string streaming_row(const FrameTimingRecord& record) {
    const double read = cost(record, "state_bytes_read");
    const double written = cost(record, "state_bytes_written");
    const double copy_ms = cost(record, "copy_ms");
    std::string html = fmt::format("<tr><th scope=\"row\">{}</th>", escape(record.scene));
    html += cell(fmt::format("<code>{}</code><small>{}</small>", escape(record.tracer),
                             escape(record.setting)),
                 "text");
    html += cell(grouped(uint64_t{record.width} * record.height));
    html += cell(grouped(static_cast<uint64_t>(cost(record, "passes"))));
    html += cell(byte_size(read)) + cell(byte_size(written));
    html += cell(significant(record.median_ms), "speed");
    html += cell(with_ratio(record.frames_per_s, "one pass", record.ratio, record.ratio_low,
                            record.ratio_high));
    html += cell(copy_ms > 0.0 ? significant(copy_ms) : "–");
    html += cell(copy_ms > 0.0 ? significant(record.median_ms / copy_ms) : "–");
    return html +
           cell(grouped(record.differing_pixels), record.differing_pixels == 0 ? "zero" : "bad") +
           "</tr>\n";
}

// ---- Deviations.

/// One deviation over all checks of all scenes.
struct DeviationCount {
    Deviation deviation;
    std::map<std::string, uint64_t> rays;  ///< by tracer
};

struct DeviationTally {
    std::vector<std::string> tracers;
    std::vector<DeviationCount> counts;
    std::map<std::string, uint64_t> wrong, unattributed;  ///< by tracer
};

void add_deviations(DeviationTally& tally, const TracerRecord& tracer) {
    for (const Deviation& deviation : tracer.deviations) {
        const bool known =
            std::any_of(tally.counts.begin(), tally.counts.end(), [&](const DeviationCount& c) {
                return c.deviation.id == deviation.id && c.deviation.param == deviation.param;
            });
        if (!known) tally.counts.push_back({deviation, {}});
    }
}

void add_attribution(DeviationTally& tally, const CheckRecord& check) {
    if (!check.attribution.asked) return;
    if (std::find(tally.tracers.begin(), tally.tracers.end(), check.tracer) ==
        tally.tracers.end()) {
        tally.tracers.push_back(check.tracer);
    }
    tally.wrong[check.tracer] += check.errors();
    tally.unattributed[check.tracer] += check.attribution.unattributed;
    for (const auto& [id, rays] : check.attribution.by_deviation) {
        for (DeviationCount& count : tally.counts) {
            if (count.deviation.id == id) count.rays[check.tracer] += rays;
        }
    }
}

DeviationTally deviation_tally(const Dossier& dossier) {
    DeviationTally tally;
    for (const Results& run : *dossier.runs) {
        for (const TracerRecord& tracer : run.tracers) add_deviations(tally, tracer);
        for (const CheckRecord& check : run.checks) add_attribution(tally, check);
    }
    return tally;
}

std::string deviation_table(const DeviationTally& tally) {
    std::string head = heading_cell("", "text") + heading_cell("What it is", "text") +
                       heading_cell("Switched off by", "text");
    for (const std::string& tracer : tally.tracers) {
        head += heading_cell("Wrong rays<small>" + escape(tracer) + "</small>");
    }
    std::string rows;
    for (const auto& [deviation, rays] : tally.counts) {
        rows += fmt::format("<tr><th scope=\"row\">{}</th>", escape(deviation.id));
        rows += cell(escape(deviation.summary), "text");
        rows += cell(
            fmt::format("<code>{}={}</code>", escape(deviation.param), escape(deviation.value)),
            "text");
        for (const std::string& tracer : tally.tracers) {
            const auto found = rays.find(tracer);
            const uint64_t count = found == rays.end() ? 0 : found->second;
            rows += cell(grouped(count), count == 0 ? "zero" : "");
        }
        rows += "</tr>\n";
    }
    const auto sum_row = [&](const std::string& name, const std::map<std::string, uint64_t>& sums,
                             bool watched) {
        rows += fmt::format("<tr><th scope=\"row\">{}</th><td></td><td></td>", name);
        for (const std::string& tracer : tally.tracers) {
            const uint64_t count = sums.at(tracer);
            rows += cell(grouped(count), count == 0 ? "zero" : watched ? "bad" : "");
        }
        rows += "</tr>\n";
    };
    if (!tally.tracers.empty()) {
        sum_row("Unattributed", tally.unattributed, true);
        sum_row("All wrong rays", tally.wrong, false);
    }
    return table("Deviations", head, rows);
}

}  // namespace

std::string paper_tables_section(const Dossier& dossier) {
    std::string speeds;
    for (const Results& run : *dossier.runs) {
        for (const std::string& tracer : table_tracers(run)) speeds += table_of_speeds(run, tracer);
    }
    if (speeds.empty()) return {};
    return "<section id=\"tables\">\n<h2>The paper’s tables</h2>\n" + table_of_counts(dossier) +
           speeds +
           "<p class=\"note\">Frames hold primary, shadow and reflection rays; the paper counts "
           "one "
           "primary ray a pixel and gives frames/s. Our Mrays/s are of casting the rays of one "
           "kind alone. × Embree: against Embree’s robust mode on all threads in the same rounds, "
           "with its 95 % interval; above 1 is faster. <em>Pixels off</em>: of the frame, by more "
           "than one 8-bit step from Embree’s. Stand-in scenes: frame rates are not comparable "
           "scene by scene.</p>\n</section>\n";
}

std::string figures_section(const Dossier& dossier) {
    if (!is_reproduction(dossier)) return {};
    std::string rows;
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& image : scene.images) {
            if (!image->pictures.empty()) rows += figure_row(dossier, image);
        }
    }
    if (rows.empty()) return {};
    return "<section id=\"figures\">\n<h2>The figures, rendered again</h2>\n" + rows +
           "</section>\n";
}

std::vector<Entry<FrameTimingRecord>> animations(const Dossier& dossier) {
    std::vector<Entry<FrameTimingRecord>> all;
    const std::vector<Results>& runs = *dossier.runs;
    for (size_t r = 0; r < runs.size(); ++r) {
        for (const FrameTimingRecord& record : runs[r].frame_timings) {
            if (!record.update_ms.empty()) all.push_back({&record, nullptr, r});
        }
    }
    return all;
}

std::string motion_section(const Dossier& dossier) {
    const auto all = animations(dossier);
    if (all.empty()) return {};
    std::string rows;
    for (const auto& record : all) {
        const double update = median(record->update_ms);
        const double upload = median(record->upload_ms);
        rows += fmt::format("<tr><th scope=\"row\">{}<small>{} × {}</small></th>",
                            escape(record->scene), record->width, record->height);
        rows += cell(fmt::format("<code>{}</code>", escape(record->tracer)), "text");
        rows += cell(grouped(record->frames));
        rows += cell(significant(update)) + cell(significant(upload));
        rows += cell(significant(record->median_ms), "speed");
        rows += cell(significant(100.0 * (update + upload) / record->median_ms, 2) + " %");
        rows += cell(fmt::format("{}<small>of {}</small>", grouped(record->differing_pixels),
                                 grouped(record->compared_pixels)),
                     record->differing_pixels == 0 ? "zero" : "");
        rows += "</tr>\n";
    }
    std::string head = heading_cell("Scene", "text") + heading_cell("Tracer", "text");
    for (const char* name : {"Frames", "Update, ms", "Upload, ms", "Trace, ms",
                             "Update and upload<small>of the tracing</small>",
                             "Pixels off<small>all frames</small>"}) {
        head += heading_cell(name);
    }
    return "<section id=\"motion\">\n<h2>Moving objects</h2>\n"
           "<p>Each frame moves the instances: the top level is rebuilt and brought to the device, "
           "what was built for the objects stays. Medians over all frames.</p>\n"
           "<figure class=\"chart\"><figcaption><strong>Where a frame’s time goes, "
           "ms</strong></figcaption>"
           "<div class=\"plot\" data-chart=\"motion\"><canvas role=\"img\" aria-label=\"Update, "
           "upload and trace of a frame; the table holds the same figures.\"></canvas></div>"
           "</figure>\n" +
           table("Moving objects", head, rows) + "</section>\n";
}

std::string streaming_section(const Dossier& dossier) {
    std::string rows;
    for (const Results& run : *dossier.runs) {
        for (const FrameTimingRecord& record : run.frame_timings) {
            if (cost(record, "passes") > 0.0) rows += streaming_row(record);
        }
    }
    if (rows.empty()) return {};
    std::string head = heading_cell("Scene", "text") + heading_cell("Tracer", "text");
    for (const char* name : {"Pixels", "Passes", "State read", "State written", "Frame, ms",
                             "Frames/s", "Plain copy, ms", "Frame / copy", "Pixels off"}) {
        head += heading_cell(name);
    }
    return "<section id=\"streaming\">\n<h2>Streaming</h2>\n"
           "<p>The approach the paper argues against: the ray state lies in textures, and each "
           "pass "
           "reads it, does one step of the work and writes it back. The plain copy moves the same "
           "bytes on the same path and does nothing else.</p>\n" +
           table("Streaming", head, rows) + "</section>\n";
}

std::string deviation_section(const Dossier& dossier) {
    const DeviationTally tally = deviation_tally(dossier);
    if (tally.counts.empty()) return {};
    if (tally.tracers.empty() && !is_reproduction(dossier)) return {};
    std::string html =
        "<section id=\"deviations\">\n<h2>Deviations</h2>\n"
        "<p>As printed, the paper’s text cannot run. D1 to D7 of "
        "<code>gpu_glsl/README.md</code> mend misprints: the map into the grid (D1), the scale of "
        "a triangle’s side planes (D2), the order of stepping and asking for the end (D3), the "
        "sign "
        "of a step (D4), the start cell (D5), the end of the walk (D6), and the centre of a texel "
        "(D7). The table lists behaviours of the published algorithm that cost accuracy and are "
        "kept, each behind a switch. A wrong ray counts for the first deviation that it disappears "
        "without.</p>\n";
    html += deviation_table(tally);
    if (tally.tracers.empty()) {
        html += "<p class=\"note\">These runs hold no attribution of wrong rays.</p>\n";
    }
    return html + "</section>\n";
}

}  // namespace onepass::report
