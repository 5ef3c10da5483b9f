// Speed against accuracy: one cloud of points over all scenes and one a scene, each with its table.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "compare/report/html.h"
#include "compare/report/ladders.h"
#include "compare/report/sections.h"
#include "compare/timing.h"
#include "compare/tradeoff.h"

namespace onepass::report {
namespace {

Climber setting_of(const TradeoffPoint& point) { return {point.tracer, point.setting}; }

/// The settings of a run in the order that ladders have: a setting's number is the same in every
/// chart and table.
std::vector<Climber> settings_of(const std::vector<TradeoffPoint>& points) {
    LadderRecord all;
    for (const TradeoffPoint& point : points) {
        RungRecord& rung = all.rungs.emplace_back();
        rung.tracer = point.tracer;
        rung.setting = point.setting;
    }
    return climbers({&all});
}

Cloud make_cloud(const std::string& title, size_t run, const std::vector<Climber>& settings,
                 std::vector<TradeoffPoint> parts) {
    Cloud cloud;
    cloud.title = title;
    cloud.run = run;
    cloud.points = pool(parts);
    cloud.parts = std::move(parts);
    for (const TradeoffPoint& point : cloud.points) {
        const auto found = std::find(settings.begin(), settings.end(), setting_of(point));
        cloud.numbers.push_back(static_cast<size_t>(found - settings.begin()) + 1);
    }
    cloud.front = on_front(cloud.points);

    // The front once more, without Embree's points.
    std::vector<TradeoffPoint> rest = cloud.points;
    for (TradeoffPoint& point : rest) {
        if (point.tracer.starts_with("embree/")) point.ratio = std::nan("");
    }
    cloud.front_of_rest = on_front(rest);
    return cloud;
}

std::vector<std::string> kinds_of(const Cloud& cloud) {
    std::vector<std::string> kinds;
    for (const TradeoffPoint& part : cloud.parts) {
        if (std::find(kinds.begin(), kinds.end(), part.rays) == kinds.end()) {
            kinds.push_back(part.rays);
        }
    }
    return kinds;
}

std::string ratio_cell(const TradeoffPoint& point) {
    return cell(fmt::format("{}<small>{} – {}</small>", significant(point.ratio),
                            significant(point.ratio_low), significant(point.ratio_high)),
                "speed");
}

std::string front_cell(bool front, bool of_rest) {
    if (front) return cell("<span class=\"badge pass\">On it</span>", "text");
    if (of_rest) return cell("<span class=\"badge depends\">Without Embree</span>", "text");
    return cell("–", "text quiet");
}

/// Of one ray kind, its speed with its errors.
std::string part_cell(const Cloud& cloud, const TradeoffPoint& point, const std::string& kind) {
    for (const TradeoffPoint& part : cloud.parts) {
        if (part.rays != kind || !(setting_of(part) == setting_of(point))) continue;
        return cell(fmt::format("{} ×<small{}>{}</small>", significant(part.ratio),
                                part.errors == 0 ? "" : " class=\"bad\"",
                                counted(part.errors, "error")));
    }
    return cell("–");
}

std::string point_row(const Cloud& cloud, size_t i, const std::vector<std::string>& kinds) {
    const TradeoffPoint& point = cloud.points[i];
    std::string html = "<tr>" + cell(std::to_string(cloud.numbers[i]));
    html += fmt::format("<th scope=\"row\"><code>{}</code>", breakable(escape(point.tracer)));
    if (!point.setting.empty()) {
        html += fmt::format("<small>{}</small>", escape(point.setting));
    }
    html += "</th>" + front_cell(cloud.front[i], cloud.front_of_rest[i]) + ratio_cell(point);
    html += cell(fmt::format("{}<small>{}</small>", grouped(point.errors),
                             percent(point.errors, point.ray_count)),
                 point.errors == 0 ? "errors" : "errors bad");
    html += cell(grouped(point.edges), point.edges == 0 ? "zero" : "");
    html += cell(grouped(point.ray_count));
    for (const std::string& kind : kinds) html += part_cell(cloud, point, kind);
    return html + "</tr>\n";
}

/// Kinds are told apart where all parts are of one scene.
std::string point_table(const Cloud& cloud) {
    std::string html = fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Speed and errors, {}\">"
        "<table class=\"tradeoff\"><thead><tr>",
        escape(cloud.title));
    html += heading_cell("No.") + heading_cell("Tracer, setting", "text") +
            heading_cell("Pareto front", "text") +
            heading_cell("Ratio to Embree<small>95 % interval</small>") + heading_cell("Errors") +
            heading_cell("Edges") + heading_cell("Rays");
    const std::vector<std::string> kinds =
        cloud.over_scenes ? std::vector<std::string>{} : kinds_of(cloud);
    for (const std::string& kind : kinds) html += heading_cell(escape(kind));
    html += "</tr></thead><tbody>\n";
    std::vector<size_t> order;
    for (size_t i = 0; i < cloud.points.size(); ++i) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return cloud.points[a].ratio > cloud.points[b].ratio;
    });
    for (const size_t i : order) html += point_row(cloud, i, kinds);
    return html + "</tbody></table></div>\n";
}

/// Settings that some scene or ray kind lacks.
std::string left_out(const Cloud& cloud) {
    std::string names;
    for (const Climber& setting : settings_of(cloud.parts)) {
        const bool pooled =
            std::any_of(cloud.points.begin(), cloud.points.end(),
                        [&](const TradeoffPoint& p) { return setting_of(p) == setting; });
        if (pooled) continue;
        names +=
            fmt::format("{}<code>{}</code>", names.empty() ? "" : ", ", escape(name_of(setting)));
    }
    if (names.empty()) return {};
    return fmt::format("<p class=\"note\">Not measured everywhere, and so not here: {}.</p>\n",
                       names);
}

std::string cloud_block(const Cloud& cloud, size_t index, const std::string& device) {
    return fmt::format(
               "<h3>{0}{2}</h3>\n<figure class=\"chart\"><div class=\"plot tall\" "
               "data-chart=\"tradeoff\" data-cloud=\"{1}\"><canvas role=\"img\" "
               "aria-label=\"{0}: speed against the share of wrong answers. The table below holds "
               "the same figures.\"></canvas></div></figure>\n",
               escape(cloud.title), index, device) +
           point_table(cloud) + left_out(cloud);
}

std::string device_of(const Manifest& manifest) {
    const std::string& name = manifest.gl_renderer.empty() ? manifest.cpu : manifest.gl_renderer;
    return fmt::format(" <span class=\"quiet\">{}</span>", escape(name));
}

/// A timing as a point: by the device's timer where there is one, as tables of rates are read.
TradeoffPoint point_of(const TimingRecord& timing, uint64_t seed) {
    TradeoffPoint point;
    point.scene = timing.scene;
    point.rays = timing.rays;
    point.tracer = timing.tracer;
    point.oracle = timing.oracle;
    point.ray_count = timing.ray_count;
    point.errors = timing.errors;
    point.edges = timing.edges;
    const bool on_device = !timing.device_ms.empty() &&
                           timing.device_ms.size() == timing.oracle_wall_ms.size() &&
                           timing.device_ms.size() == timing.wall_ms.size();
    const RatioInterval device = on_device ? device_speed(timing, seed).ratio : RatioInterval{};
    point.ratio = on_device ? device.ratio : timing.ratio;
    point.ratio_low = on_device ? device.low : timing.ratio_low;
    point.ratio_high = on_device ? device.high : timing.ratio_high;
    return point;
}

std::vector<TradeoffPoint> points_of(const Results& run) {
    if (!run.tradeoffs.empty() || !run.claims.empty()) return run.tradeoffs;
    std::vector<TradeoffPoint> points;
    for (const TimingRecord& timing : run.timings) {
        points.push_back(point_of(timing, run.manifest.seed));
    }
    return points;
}

}  // namespace

std::vector<Cloud> clouds(const Dossier& dossier) {
    std::vector<Cloud> all;
    for (size_t r = 0; r < dossier.runs->size(); ++r) {
        const std::vector<TradeoffPoint> points = points_of((*dossier.runs)[r]);
        const size_t first = all.size();
        const std::vector<Climber> settings = settings_of(points);
        std::vector<std::string> scenes;
        for (const TradeoffPoint& point : points) {
            if (std::find(scenes.begin(), scenes.end(), point.scene) == scenes.end()) {
                scenes.push_back(point.scene);
            }
        }
        if (scenes.size() > 1) {
            all.push_back(
                make_cloud(fmt::format("All {} scenes", scenes.size()), r, settings, points));
            all.back().over_scenes = true;
        }
        for (const std::string& scene : scenes) {
            std::vector<TradeoffPoint> parts;
            for (const TradeoffPoint& point : points) {
                if (point.scene == scene) parts.push_back(point);
            }
            all.push_back(make_cloud(scene, r, settings, std::move(parts)));
        }
        for (size_t i = first; i < all.size(); ++i) {
            all[i].every_answer_judged = !(*dossier.runs)[r].tradeoffs.empty();
        }
    }
    return all;
}

CloudAxis cloud_axis(const Cloud& cloud) {
    uint64_t rays = 1;
    for (const TradeoffPoint& point : cloud.points) rays = std::max(rays, point.ray_count);
    CloudAxis axis{zero_band(rays), {}};

    // Those without an error side by side, the fastest to the right.
    std::vector<size_t> clean;
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        axis.x.push_back(error_rate(cloud.points[i]));
        if (cloud.points[i].errors == 0) clean.push_back(i);
    }
    std::stable_sort(clean.begin(), clean.end(), [&](size_t a, size_t b) {
        return cloud.points[a].ratio > cloud.points[b].ratio;
    });
    for (size_t k = 0; k < clean.size(); ++k) {
        axis.x[clean[k]] = lane(axis.band, k, clean.size());
    }
    return axis;
}

std::string tradeoff_section(const Dossier& dossier) {
    const std::vector<Cloud> all = clouds(dossier);
    if (all.empty()) return {};
    const bool judged = std::all_of(all.begin(), all.end(),
                                    [](const Cloud& cloud) { return cloud.every_answer_judged; });
    std::string html = fmt::format(
        "<section id=\"tradeoff\">\n<h2>Speed against accuracy</h2>\n"
        "<p class=\"lead\">The same rays by every setting, all in random order in the same "
        "rounds{}. Up is faster, left is more often right.</p>\n",
        judged ? ", and every answer judged" : "");
    for (size_t i = 0; i < all.size(); ++i) {
        const bool several = all.back().run != all.front().run;
        html +=
            cloud_block(all[i], i, several ? device_of((*dossier.runs)[all[i].run].manifest) : "");
    }
    html += fmt::format(
        "<p class=\"note\"><em>Pareto front</em>: no other setting is at least as fast and at "
        "least as often right, and better in one. <em>Without Embree</em>: on the front of the "
        "others. <em>Ratio</em>: speed relative to <code>{}</code>; over several ray kinds or "
        "scenes the geometric mean, with errors and rays added up; a setting that one of them "
        "lacks is not in the mean. No error among N rays means a share below 1/N, and no more is "
        "known: such points lie in the strip on the left, apart only to be seen. {} Edges are "
        "right for a ray within 4 ulps, and no errors. Judge: {}.</p>\n",
        escape(all.front().points.empty() ? "" : all.front().points.front().oracle),
        judged ? "" : "Times are the device’s own where it has a timer to trust, else wall times.",
        escape((*dossier.runs)[all.front().run].manifest.judge));
    return html + "</section>\n";
}

}  // namespace onepass::report
