// One scene: its pictures, the table of disagreements, the worst rays, and why.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/pictures.h"
#include "compare/report/sections.h"

namespace onepass::report {
namespace {

HitClass class_at(size_t index) { return static_cast<HitClass>(index); }

// ---- What the scene is.

std::string scene_facts(const SceneDossier& scene) {
    std::string html;
    for (const auto& version : scene.versions) {
        html += fmt::format("<p class=\"facts\">{}", counted(version->triangles, "triangle"));
        if (version->unique_triangles != version->triangles) {
            html += fmt::format(" ({} stored)", grouped(version->unique_triangles));
        }
        html += fmt::format(" · {} · {} · content <code>{}</code></p>\n",
                            counted(version->instances, "instance"),
                            counted(version->lights, "light"), escape(version->hash));
        for (const std::string& note : version->notes) {
            html += fmt::format("<p class=\"note\">{}</p>\n", escape(note));
        }
    }
    if (scene.versions.size() > 1) {
        html +=
            "<p class=\"flag\"><strong>Not one scene.</strong> The runs of this page hold "
            "different contents under this name; compare figures within a run only.</p>\n";
    }
    return html;
}

// ---- Pictures.

/// Embeds a picture unless this scene has shown the same bytes already: then it says so.
class Gallery {
  public:
    Gallery(const Dossier& dossier, const SceneDossier& scene)
        : dossier_(dossier), slug_(slug(scene.name)) {}

    /// `group` and `name`: what the closer look calls it.
    std::string figure(size_t run, const std::string& file, const std::string& title,
                       const std::string& legend, const std::string& group,
                       const std::string& name) {
        const std::string bytes = read_png((*dossier_.folders)[run] / file);
        const auto [shown, is_new] = shown_.emplace(
            bytes, Shown{fmt::format("picture-{}-{}", slug_, shown_.size() + 1), title});
        const auto& [id, first_title] = shown->second;
        layers_ +=
            fmt::format("<option value=\"{}\" data-group=\"{}\">{}</option>", id, group, name);
        if (!is_new && title == first_title) return {};
        if (!is_new) {
            return fmt::format(
                "<figure><figcaption><strong>{}</strong>byte for byte the picture of "
                "{}</figcaption></figure>\n",
                title, first_title);
        }
        const PngSize size = png_size(bytes);
        return fmt::format(
            "<figure><button type=\"button\" class=\"zoom\" aria-label=\"Enlarge: {0}\">"
            "<img id=\"{5}\" src=\"{1}\" width=\"{2}\" height=\"{3}\" alt=\"{0}\"></button>"
            "<figcaption><strong>{0}</strong>{4}</figcaption></figure>\n",
            title, data_uri(bytes), size.width, size.height, legend, id);
    }

    /// Every picture of the gallery by name, with the place where it is shown.
    std::string layers() const { return "<template class=\"layers\">" + layers_ + "</template>\n"; }

  private:
    struct Shown {
        std::string id;
        std::string title;
    };

    const Dossier& dossier_;
    std::string slug_;
    std::map<std::string, Shown> shown_;  ///< by content
    std::string layers_;
};

std::string ramp_legend(const std::string& low, const std::string& high) {
    return fmt::format(
        "<span class=\"ramp\"></span><span class=\"ends\"><span>{}</span><span>{}</span></span>",
        low, high);
}

std::string class_legend(const CheckRecord& check) {
    std::string html = "<span class=\"swatches\">";
    for (size_t c = 0; c < kHitClassCount; ++c) {
        html += fmt::format("<span class=\"swatch class-{0}\">{0} {1}</span>",
                            to_string(class_at(c)), grouped(check.classes[c].count));
    }
    return html + "</span>";
}

/// The title and the legend of a picture, by its role.
std::pair<std::string, std::string> caption(const ImageRecord& image, const std::string& role,
                                            const std::string& tracer) {
    if (role == "image") return {escape(tracer), fmt::format("{} × {}", image.width, image.height)};
    if (role == "oracle") {
        return {escape(image.oracle), "the oracle, with the same shading model"};
    }
    if (role == "difference") {
        return {"Difference, largest channel",
                ramp_legend(significant(image.tolerance), "1, logarithmic") +
                    fmt::format("black: at most {}", significant(image.tolerance))};
    }
    if (role == "cells") {
        return {"Cells visited, all rays of a pixel",
                ramp_legend("0", significant(image.cells_full_scale) + " and more")};
    }
    return {escape(role), {}};
}

/// In the lists of the closer look: the kind of picture, and whose it is.
std::pair<std::string, std::string> layer_name(const ImageRecord& image, const std::string& role,
                                               const std::string& tracer) {
    if (role == "image") return {"Image", escape(tracer)};
    if (role == "oracle") return {"Image", escape(image.oracle)};
    if (role == "difference") return {"Difference from the oracle", escape(tracer)};
    return {role == "cells" ? "Cells visited" : escape(role), escape(tracer)};
}

std::string image_figures(const ImageRecord& image) {
    std::string html = "<dl class=\"metrics\">";
    const auto metric = [&](const std::string& name, const std::string& value) {
        html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", name, value);
    };
    metric("Verdict", badge(image.passed));
    metric("PSNR", significant(image.psnr_db) + " dB");
    metric("RMSE, linear RGB", significant(image.rmse));
    metric("Largest difference", fmt::format("{} at ({}, {})", significant(image.max_difference),
                                             image.max_x, image.max_y));
    metric(
        fmt::format("Pixels off by more than {}", significant(image.tolerance)),
        fmt::format("{} of {}, allowed {}", grouped(image.differing_pixels),
                    grouped(uint64_t{image.width} * image.height), grouped(image.allowed_pixels)));
    metric("Rays a pixel", significant(image.rays_per_pixel));
    html += "</dl>\n";
    if (!image.reason.empty()) {
        html += fmt::format("<p class=\"note\">Bound: {}</p>\n", escape(image.reason));
    }
    return html;
}

const Entry<CheckRecord>* primary_check(const SceneDossier& scene,
                                        const Entry<ImageRecord>& image) {
    for (const auto& check : scene.checks) {
        if (check->rays == "primary" && check->tracer == image->tracer && check.run == image.run &&
            !check->picture.empty()) {
            return &check;
        }
    }
    return nullptr;
}

std::string image_block(const SceneDossier& scene, const Entry<ImageRecord>& image,
                        Gallery& gallery) {
    const std::string tracer = label(scene.images, image);
    const std::string tracer_text = escape(tracer);
    std::string html = "<div class=\"pictures\">\n";
    for (const auto& [role, file] : image->pictures) {
        const auto [title, legend] = caption(*image.record, role, tracer);
        const auto [group, name] = layer_name(*image.record, role, tracer);
        html += gallery.figure(image.run, file, title, legend, group, name);
    }
    if (const auto* check = primary_check(scene, image)) {
        html += gallery.figure(check->run, (*check)->picture, "Classes of the primary rays",
                               class_legend(*check->record), "Classes of the primary rays",
                               tracer_text);
    }
    return html + "</div>\n" + image_figures(*image.record);
}

std::string pictures(const Dossier& dossier, const SceneDossier& scene) {
    if (scene.images.empty()) return {};
    if (is_reproduction(dossier)) {
        return "<p class=\"note\">Its pictures are among the <a "
               "href=\"#figures\">figures</a>.</p>\n";
    }
    Gallery gallery(dossier, scene);
    std::string html = "<h3>Pictures</h3>\n" + image_block(scene, scene.images.front(), gallery);
    for (size_t i = 1; i < scene.images.size(); ++i) {
        const auto& image = scene.images[i];
        html += fmt::format(
            "<details><summary>{} {}, PSNR {} dB</summary>\n"
            "<p class=\"note\">A picture equal byte for byte to one above is not repeated.</p>\n"
            "{}</details>\n",
            badge(image->passed), escape(label(scene.images, image)), significant(image->psnr_db),
            image_block(scene, image, gallery));
    }
    const auto index = static_cast<size_t>(&scene - dossier.scenes.data());
    return html + closer_block(scene, index, gallery.layers());
}

// ---- The table of disagreements.

std::string class_cell(const CheckRecord& check, size_t c) {
    const uint64_t count = check.classes[c].count;
    std::string html = grouped(count);
    if (class_at(c) == HitClass::edge || (is_error(class_at(c)) && check.allowed[c] > 0)) {
        html += fmt::format("<small>≤ {}</small>", grouped(check.allowed[c]));
    }
    if (count == 0) return cell(html, "zero");
    const bool over_budget = class_at(c) == HitClass::edge && count > check.allowed[c];
    return cell(html, is_error(class_at(c)) || over_budget ? "bad" : "");
}

/// A count that should be 0.
std::string watched_cell(uint64_t count) {
    return cell(grouped(count), count == 0 ? "zero" : "bad");
}

/// Whether the oracle's own answers to the check's rays have a row of their own.
bool oracle_has_row(const SceneDossier& scene, const CheckRecord& check) {
    return std::any_of(scene.references.begin(), scene.references.end(), [&](const auto& row) {
        return row->tracer == check.oracle && row->ray_hash == check.ray_hash;
    });
}

std::string check_rows(const SceneDossier& scene, const Entry<CheckRecord>& check) {
    // The tracer's own line.
    const bool shows_oracle = !check->reference && !oracle_has_row(scene, *check.record);
    const char* span = shows_oracle ? " rowspan=\"2\"" : "";
    const std::string verdict =
        check->reference ? "<span class=\"badge\">Beside</span>" : badge(check->passed);
    std::string html = check->reference ? "<tr class=\"oracle\">" : "<tr>";
    html += fmt::format("<th scope=\"row\"{}>{}</th>", span, escape(label(scene.checks, check)));
    html += fmt::format("<td{} class=\"text\">{}<small>{}</small></td>", span, escape(check->rays),
                        counted(check->ray_count, "ray"));
    html += fmt::format("<td{} class=\"text\">{}</td>", span, verdict);
    html += cell(check->tracer == check->oracle ? "oracle" : "tracer", "text");
    for (size_t c = 0; c < kHitClassCount; ++c) html += class_cell(*check.record, c);
    html +=
        cell(fmt::format("{}<small>{}</small>", percent(check->wrong_triangle, check->ray_count),
                         grouped(check->wrong_triangle)),
             check->wrong_triangle == 0 ? "zero" : "");
    html += watched_cell(check->exhausted);
    html += cell(grouped(check->oracle_invalid), check->oracle_invalid == 0 ? "zero" : "");
    html += cell(grouped(check->judged)) + "</tr>\n";
    if (!shows_oracle) return html;

    // The oracle's answers to the rays that were judged.
    html += "<tr class=\"oracle\">" + cell("oracle", "text");
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const uint64_t count = check->oracle_classes[c];
        html += cell(grouped(count), count == 0 ? "zero" : is_error(class_at(c)) ? "bad" : "");
    }
    return html + "<td colspan=\"4\" class=\"text\">on the judged rays</td></tr>\n";
}

std::string check_table(const SceneDossier& scene, const std::vector<Entry<CheckRecord>>& checks) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Classes of hits\">"
        "<table class=\"classes\"><thead><tr>";
    for (const char* name : {"Tracer", "Rays", "Verdict", "Whose"}) {
        html += heading_cell(name, "text");
    }
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const HitClass hit_class = class_at(c);
        html += heading_cell(breakable(to_string(hit_class)), is_error(hit_class) ? "error" : "");
    }
    for (const char* name : {"wrong triangle", "exhausted", "oracle-invalid", "judged"}) {
        html += heading_cell(name);
    }
    html += "</tr></thead>\n";
    for (const auto& check : checks) {
        html += "<tbody>\n" + check_rows(scene, check) + "</tbody>\n";
    }
    return html + "</table></div>\n";
}

std::string mismatch_tables(const SceneDossier& scene) {
    if (scene.checks.empty() && scene.references.empty()) return {};
    std::vector<Entry<CheckRecord>> rows = scene.checks;
    rows.insert(rows.end(), scene.references.begin(), scene.references.end());
    std::string html = "<h3>Hits, ray by ray</h3>\n" + check_table(scene, rows);
    html +=
        "<p class=\"note\">Every ray is in one class. A check passes when <code>false_miss</code>, "
        "<code>false_hit</code>, <code>wrong_surface</code> and <code>t_error</code> are within "
        "their bounds (0 unless ≤ is given) and <code>edge</code> is within its budget. "
        "<em>Wrong triangle</em>: both answers are hits and their ids differ, as a share of all "
        "rays. <em>Exhausted</em>: the ray ran out of a loop budget. <em>Oracle-invalid</em>: the "
        "oracle cannot take the ray; it is in no class. <em>Judged</em>: rays that went to the "
        "judge; on the others all tracers and the oracle agree. <em>Beside</em>: Embree, judged by "
        "the same truth; it fails no check.</p>\n";
    if (scene.lesser_checks.empty()) return html;
    return html + fmt::format(
                      "<details><summary>{} of the same tracers and ray kinds on no more "
                      "rays</summary>\n{}</details>\n",
                      counted(scene.lesser_checks.size(), "more check"),
                      check_table(scene, scene.lesser_checks));
}

// ---- The worst rays.

std::string worst_row(const SceneDossier& scene, const Entry<CheckRecord>& check, size_t c) {
    const WorstRay& worst = *check->classes[c].worst;
    const Verdict& verdict = worst.verdict;
    std::string html = "<tr>";
    html += fmt::format("<th scope=\"row\">{}<small>{}, ray {}</small></th>",
                        escape(label(scene.checks, check)), escape(check->rays), worst.index);
    html += cell(to_string(class_at(c)), is_error(class_at(c)) ? "text bad" : "text");
    html += cell(hit_text(worst.answer.t, worst.answer.prim_id, worst.answer.inst_id), "text");
    html += cell(hit_text(worst.oracle.t, worst.oracle.prim_id, worst.oracle.inst_id), "text");
    html += cell(hit_text(verdict.true_t, verdict.true_prim_id, verdict.true_inst_id), "text");
    html += cell(significant(verdict.t_error_ulps)) + cell(significant(verdict.backward_error));
    const std::string ray = breakable(escape(ray_text(worst.ray)));
    return html + fmt::format("<td class=\"text\"><code class=\"copy\">{}</code></td></tr>\n", ray);
}

std::string worst_rays(const SceneDossier& scene) {
    std::string rows;
    for (const auto* checks : {&scene.checks, &scene.references}) {
        for (const auto& check : *checks) {
            for (size_t c = 0; c < kHitClassCount; ++c) {
                if (class_at(c) != HitClass::agree && check->classes[c].worst) {
                    rows += worst_row(scene, check, c);
                }
            }
        }
    }
    if (rows.empty()) return {};
    return "<details class=\"worst\"><summary>The worst ray of each class</summary>\n"
           "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Worst rays\"><table>"
           "<thead><tr><th class=\"text\">Tracer, rays</th><th class=\"text\">Class</th>"
           "<th class=\"text\">Its answer</th><th class=\"text\">The oracle’s</th>"
           "<th class=\"text\">The judge’s</th><th>t error, ulps</th><th>Backward error</th>"
           "<th class=\"text\">The ray, for onepass explain</th></tr></thead>"
           "<tbody>\n" +
           rows +
           "</tbody></table></div>\n"
           "<p class=\"note\">Backward error: the least move of the ray that makes the answer "
           "right, in units of the allowed move (4 ulps of the largest coordinate); ∞ if no "
           "allowed move does.</p></details>\n";
}

// ---- Why the faithful paper tracer errs.

/// The paper's own acceptance of a hit: a slack on one edge only.
bool is_slack_check(const Entry<CheckRecord>& check) {
    return strategy_of(check->tracer) == "paper" && check->rays == "primary" &&
           param_value(check.tracer, "edge_tolerance") > 1.0;
}

bool is_strict_check(const Entry<CheckRecord>& check) {
    return strategy_of(check->tracer) == "paper" && check->rays == "primary" &&
           param_value(check.tracer, "edge_tolerance") <= 1.0;
}

uint64_t ties(const CheckRecord& check) {
    return check.classes[static_cast<size_t>(HitClass::tie)].count;
}

/// The check that shows the slack: more wrong triangles than ties, where either triangle is right.
const Entry<CheckRecord>* slack_check(const SceneDossier& scene) {
    for (const auto& check : scene.checks) {
        if (is_slack_check(check) && check->wrong_triangle > ties(*check.record)) return &check;
    }
    return nullptr;
}

std::string wrong_share(const CheckRecord& check) {
    return fmt::format("{} of {} ({})", grouped(check.wrong_triangle), grouped(check.ray_count),
                       percent(check.wrong_triangle, check.ray_count));
}

/// The same rays without the slack, if some run has them.
std::string without_slack(const SceneDossier& scene, const CheckRecord& slack) {
    for (const auto& check : scene.checks) {
        if (!is_strict_check(check) || check->ray_hash != slack.ray_hash ||
            check->tracer != slack.tracer) {
            continue;
        }
        return fmt::format(" With <code>edge_tolerance={}</code> the same rays give {}.",
                           exact(param_value(check.tracer, "edge_tolerance")),
                           wrong_share(*check.record));
    }
    return {};
}

std::string slack_cause(double tolerance) {
    return fmt::format(
        " The paper accepts a hit when its two barycentric coordinates are not negative and their "
        "sum is at most {} instead of 1. So every triangle is larger than it is, by {} % of its "
        "height, across one of its three edges only. A ray that passes just outside that edge hits "
        "the enlarged triangle as well as its true neighbour, and the nearer of the two wins; at "
        "an "
        "outline, where there is no neighbour, it is a <code>false_hit</code>. This is the "
        "paper’s own test, kept because the strategy is faithful: deviation D11 in "
        "<code>gpu_glsl/README.md</code>. <code>--param edge_tolerance=1</code> switches the slack "
        "off.",
        exact(tolerance), significant(100.0 * (tolerance - 1.0), 2));
}

/// In full at the first scene that shows it; later scenes give their figures and point there.
std::string slack_explanation(const Dossier& dossier, const SceneDossier& scene) {
    const Entry<CheckRecord>* slack = slack_check(scene);
    if (!slack) return {};
    const auto first = std::find_if(dossier.scenes.begin(), dossier.scenes.end(),
                                    [](const SceneDossier& s) { return slack_check(s); });
    const CheckRecord& check = *slack->record;
    const std::string tie_note =
        ties(check) == 0
            ? ""
            : fmt::format("; up to {} of them are ties, where either is right", ties(check));
    const std::string reason =
        first->name == scene.name
            ? slack_cause(param_value(slack->tracer, "edge_tolerance"))
            : fmt::format(" The reason is given at <a href=\"#why\">{}</a>.", escape(first->name));
    return fmt::format(
        "<aside class=\"why\"{}><h4>Why <code>{}</code> picks wrong triangles</h4>\n"
        "<p>On the primary rays it names another triangle than the oracle for "
        "{}{}.{}{}</p></aside>\n",
        first->name == scene.name ? " id=\"why\"" : "", escape(check.tracer), wrong_share(check),
        tie_note, reason, without_slack(scene, check));
}

}  // namespace

std::string ray_text(const Ray& ray) {
    return fmt::format("--ray {},{},{},{},{},{},{},{}", exact(ray.org.x), exact(ray.org.y),
                       exact(ray.org.z), exact(ray.dir.x), exact(ray.dir.y), exact(ray.dir.z),
                       exact(ray.tmin), exact(ray.tmax));
}

std::string hit_text(double t, uint32_t prim_id, uint32_t inst_id) {
    if (inst_id == kNoId) return "miss";
    return fmt::format("t\u00a0{:.9g}<small>triangle {}<br>instance {}</small>", t, prim_id,
                       inst_id);
}

std::string scene_section(const Dossier& dossier, const SceneDossier& scene) {
    std::string html = fmt::format("<section id=\"scene-{}\" class=\"scene\">\n<h2>{}</h2>\n",
                                   slug(scene.name), escape(scene.name));
    html += scene_facts(scene);
    html += fmt::format("<p class=\"verdict\">{}</p>\n", verdict_sentence(scene));
    html += pictures(dossier, scene);
    html += mismatch_tables(scene);
    html += slack_explanation(dossier, scene);
    html += worst_rays(scene);
    return html + "</section>\n";
}

}  // namespace onepass::report
