#include "compare/report/report.h"

#include <map>

#include <fmt/format.h>

#include "compare/images.h"
#include "compare/report/assets.h"
#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "core/error.h"

namespace onepass {
namespace {

using namespace report;

/// Replaces every {{name}} of the page in one pass, so that a value can hold braces itself.
std::string fill(std::string_view page, const std::map<std::string, std::string>& values) {
    std::string out;
    for (size_t at = 0;;) {
        const size_t open = page.find("{{", at);
        if (open == std::string_view::npos) return out.append(page.substr(at));
        const size_t close = page.find("}}", open);
        ONEPASS_CHECK(close != std::string_view::npos);
        const auto value = values.find(std::string(page.substr(open + 2, close - open - 2)));
        ONEPASS_CHECK(value != values.end());
        out.append(page.substr(at, open - at)).append(value->second);
        at = close + 2;
    }
}

std::string link(const std::string& id, const std::string& text) {
    return fmt::format("<li><a href=\"#{}\">{}</a></li>", id, text);
}

/// The colours of the legends, from those of the pictures.
std::string palette_css() {
    constexpr int kStops = 16;
    const auto rgb = [](const std::array<uint8_t, 3>& c) {
        return fmt::format("rgb({} {} {})", c[0], c[1], c[2]);
    };
    std::string css = ".ramp { background: linear-gradient(to right";
    for (int i = 0; i <= kStops; ++i) css += ", " + rgb(false_color(double(i) / kStops));
    css += "); }\n";
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const auto hit_class = static_cast<HitClass>(c);
        css += fmt::format(".class-{} {{ --swatch: {}; }}\n", to_string(hit_class),
                           rgb(class_color(hit_class)));
    }
    return css;
}

std::string page_heading(const Dossier& dossier) {
    if (is_reproduction(dossier)) return "The paper, reproduced: what still holds";
    if (!dossier.scenes.empty()) return "Ray traversal, judged against Embree";
    if (!ladders_of(dossier).empty()) return "Ray traversal, pushed until it fails";
    return growth_charts(dossier).empty() ? "Ray traversal, judged against Embree"
                                          : "Ray traversal: how cost grows";
}

std::string page_title(const Dossier& dossier) {
    if (is_reproduction(dossier)) return "Onepass: the paper, reproduced";
    std::string names;
    for (const SceneDossier& scene : dossier.scenes) {
        names += (names.empty() ? "" : ", ") + scene.name;
    }
    return names.empty() ? "Onepass report" : "Onepass report: " + names;
}

constexpr size_t kShortCommit = 12;  ///< digits of the title; the table has them all

std::string subtitle(const std::vector<Results>& runs) {
    const Manifest& last = runs.back().manifest;
    return escape(
        fmt::format("{} · commit {}{} · {}", last.time_utc, last.commit.substr(0, kShortCommit),
                    last.dirty ? ", with uncommitted changes" : "", counted(runs.size(), "run")));
}

}  // namespace

std::string render_report(const std::vector<Results>& runs,
                          const std::vector<std::filesystem::path>& folders) {
    ONEPASS_CHECK_EQ(runs.size(), folders.size());
    if (runs.empty()) {
        throw Error({"report", "no result file", "at least one",
                     "Make one: onepass check bunny --json results/local/check.json"});
    }

    // The sections, and the way to them.
    const Dossier dossier = gather(runs, folders);
    std::string body, navigation;
    const auto add = [&](const std::string& id, const std::string& name, const std::string& html) {
        if (html.empty()) return;
        body += html;
        navigation += link(id, name);
    };
    add("claims", "Claims", claims_section(dossier));
    add("tables", "Tables", paper_tables_section(dossier));
    add("figures", "Figures", figures_section(dossier));
    add("motion", "Moving objects", motion_section(dossier));
    add("streaming", "Streaming", streaming_section(dossier));
    add("deviations", "Deviations", deviation_section(dossier));
    add("summary", "Summary", summary_section(dossier));
    for (const SceneDossier& scene : dossier.scenes) {
        add("scene-" + slug(scene.name), escape(scene.name), scene_section(dossier, scene));
    }
    add("ladders", "Ladders", ladder_section(dossier));
    add("tradeoff", "Speed and accuracy", tradeoff_section(dossier));
    add("speed", "Speed", speed_section(dossier));
    add("ablations", "Ablations", ablation_section(dossier));
    add("grid-size", "Grid size", sweep_section(dossier));
    add("growth", "Growth", growth_section(dossier));
    add("structures", "Structures", structure_section(dossier));
    add("environment", "Environment", environment_section(dossier));

    // One file.
    std::string page = fill(kPageHtml, {{"title", escape(page_title(dossier))},
                                        {"heading", page_heading(dossier)},
                                        {"subtitle", subtitle(runs)},
                                        {"navigation", navigation},
                                        {"body", body},
                                        {"data", chart_data(dossier)},
                                        {"css", std::string(kPageCss)},
                                        {"palette", palette_css()},
                                        {"chart_js", std::string(kChartJs)},
                                        {"page_js", std::string(kPageJs)}});
    if (page.size() > kReportMaxBytes) {
        throw Error({"report", byte_size(static_cast<double>(page.size())),
                     "at most " + byte_size(static_cast<double>(kReportMaxBytes)),
                     "Give fewer result files at a time, or render smaller pictures with --size"});
    }
    return page;
}

}  // namespace onepass
