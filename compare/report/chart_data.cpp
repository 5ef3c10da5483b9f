// The figures behind the charts, as one JSON text. page.js draws them and computes nothing.
#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "compare/report/sections.h"
#include "compare/statistics.h"
#include "compare/tradeoff.h"
#include "compare/tuning.h"

namespace onepass::report {
namespace {

using nlohmann::json;

/// JSON has no NaN or infinity; a chart leaves null out.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json timing_json(const SceneDossier& scene, const Entry<TimingRecord>& timing) {
    return {{"scene", scene.name},
            {"rays", timing->rays},
            {"tracer", label(scene.timings, timing)},
            {"oracle", timing->tracer == timing->oracle},
            {"ratio", number(timing->ratio)},
            {"low", number(timing->ratio_low)},
            {"high", number(timing->ratio_high)},
            {"errors", timing->errors},
            {"count", timing->ray_count}};
}

json sweep_json(const Sweep& sweep) {
    // The density that takes more values is the axis; the other one tells the curves apart.
    std::set<double> tops, objects;
    for (const SweepPoint& point : sweep.points) {
        if (!is_by_density(point)) continue;
        tops.insert(point.top_density);
        objects.insert(point.object_density);
    }
    const bool by_object = objects.size() >= tops.size();
    const auto x_of = [&](const SweepPoint& point) {
        return by_object ? point.object_density : point.top_density;
    };
    const std::optional<Tuning> tuning = tuning_of(sweep.points);

    json points = json::array(), marks = json::array(), bands = json::array();
    for (size_t i = 0; i < sweep.points.size(); ++i) {
        const SweepPoint& point = sweep.points[i];
        if (!point.failure.empty() || !is_by_density(point)) continue;
        const bool modelled = tuning->model.has_value();
        points.push_back({{"x", x_of(point)},
                          {"curve", by_object ? point.top_density : point.object_density},
                          {"time", number(tuning->ns[i])},
                          {"predicted", modelled ? number(tuning->predicted_ns[i]) : json(nullptr)},
                          {"cells", number(point.cells_per_ray)},
                          {"tests", number(point.tests_per_ray)},
                          {"memory", static_cast<double>(point.bytes) / (1u << 20)},
                          {"errors", point.errors}});
    }
    const auto mark = [&](const char* name, size_t i) {
        const SweepPoint& point = sweep.points[i];
        if (!is_by_density(point)) return;
        marks.push_back({{"name", name},
                         {"x", x_of(point)},
                         {"time", number(tuning->ns[i])},
                         {"errors", point.errors}});
    };
    if (tuning) {
        mark("fastest", tuning->best);
        if (tuning->predicted) mark("the model’s best", *tuning->predicted);
        if (tuning->automatic) mark("auto", *tuning->automatic);
        mark("no finer than needed", tuning->smallest);
        for (const DensityBand& band : tuning->bands) {
            if (by_object) bands.push_back({{"low", band.low}, {"high", band.high}});
        }
    }
    return {{"axis", by_object ? "object λ, cells a triangle" : "top λ, cells an instance"},
            {"curve", by_object ? "top λ" : "object λ"},
            {"points", points},
            {"marks", marks},
            {"bands", bands}};
}

json claim_json(const ClaimRecord& claim, size_t run) {
    json points = json::array();
    for (const ClaimMeasurement& m : claim.measurements) {
        const Support support = support_of(m);
        points.push_back(
            {{"scene", m.scene},
             {"work", m.work},
             {"quantity", m.quantity},
             {"baseline", m.baseline},
             {"variant", m.variant},
             {"verdict", std::string(to_string(m.verdict))},
             {"size", m.size},
             {"ratio", number(m.failure.empty() ? m.ratio : NAN)},
             {"times", {number(median(m.baseline_samples)), number(median(m.variant_samples))}},
             {"support", number(support.value)},
             {"low", number(support.low)},
             {"high", number(support.high)}});
    }
    return {{"run", run}, {"entry", claim.entry}, {"id", claim.id}, {"points", points}};
}

json motion_json(const FrameTimingRecord& record) {
    return {{"scene", record.scene},
            {"tracer", record.tracer},
            {"update", number(median(record.update_ms))},
            {"upload", number(median(record.upload_ms))},
            {"trace", number(record.median_ms)}};
}

json band_json(const ZeroBand& band) { return {{"low", band.low}, {"high", band.high}}; }

size_t index_of(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

json ladder_json(const LadderRecord& ladder, const std::vector<std::string>& colours) {
    const LadderChart chart = ladder_chart(ladder);
    json lines = json::array();
    for (const LadderChart::Line& line : chart.lines) {
        json points = json::array();
        for (const LadderChart::Point& point : line.points) {
            points.push_back({{"x", point.x},
                              {"y", point.y},
                              {"knob", knob_text(*point.rung)},
                              {"failed", point.rung->failed()},
                              {"trials", point.rung->trials}});
        }
        lines.push_back({{"name", name_of(line.climber)},
                         {"colour", index_of(colours, family_of(line.climber.tracer))},
                         {"twin", is_twin(line.climber)},
                         {"points", points}});
    }
    json ticks = json::array();
    for (const auto& tick : chart.ticks) ticks.push_back({{"x", tick.x}, {"text", tick.text}});
    return {{"axis", axis_title(ladder)},
            {"ticks", ticks},
            {"scaled", chart.to_scale_until},
            {"band", band_json(chart.band)},
            {"trials", {chart.least_trials, chart.most_trials}},
            {"lines", lines}};
}

json cloud_json(const Cloud& cloud, const std::vector<std::string>& colours) {
    const CloudAxis axis = cloud_axis(cloud);
    json points = json::array();
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        const TradeoffPoint& point = cloud.points[i];
        const Climber setting{point.tracer, point.setting};
        points.push_back({{"number", cloud.numbers[i]},
                          {"name", name_of(setting)},
                          {"colour", index_of(colours, family_of(point.tracer))},
                          {"twin", is_twin(setting)},
                          {"x", number(axis.x[i])},
                          {"ratio", number(point.ratio)},
                          {"low", number(point.ratio_low)},
                          {"high", number(point.ratio_high)},
                          {"errors", point.errors},
                          {"count", point.ray_count},
                          {"front", static_cast<bool>(cloud.front[i])},
                          {"frontOfRest", static_cast<bool>(cloud.front_of_rest[i])}});
    }
    return {{"band", band_json(axis.band)}, {"points", points}};
}

json growth_json(const GrowthChart& chart) {
    // Bytes are drawn as MiB.
    const bool bytes = chart.curves.front().cost == GrowthCurve::Cost::bytes;
    const double scale = bytes ? 1.0 / (1u << 20) : 1.0;
    json lines = json::array();
    for (size_t c = 0; c < chart.curves.size(); ++c) {
        const GrowthCurve& curve = chart.curves[c];
        json points = json::array(), fit = json::array();
        for (size_t i = 0; i < curve.x.size(); ++i) {
            points.push_back({{"x", curve.x[i]}, {"y", number(scale * curve.y[i])}});
        }
        const auto [first, last] = std::minmax_element(curve.x.begin(), curve.x.end());
        for (const double x : {*first, *last}) {
            const double y = scale * curve.law.factor * std::pow(x, curve.law.exponent);
            fit.push_back({{"x", x}, {"y", number(y)}});
        }
        lines.push_back({{"name", chart.names[c]},
                         {"colour", chart.colours[c]},
                         {"exponent", number(curve.law.exponent)},
                         {"device", curve.by_device},
                         {"points", points},
                         {"fit", fit}});
    }
    return {{"axis", chart.curves.front().over_rays ? "rays" : "triangles"}, {"lines", lines}};
}

/// Of all ladders and clouds, so that a strategy has one colour on the page.
std::vector<std::string> colour_order(const std::vector<LadderOfRun>& ladders,
                                      const std::vector<Cloud>& all_clouds) {
    LadderRecord raced;
    for (const Cloud& cloud : all_clouds) {
        for (const TradeoffPoint& point : cloud.points) {
            raced.rungs.emplace_back().tracer = point.tracer;
        }
    }
    std::vector<const LadderRecord*> records = {&raced};
    for (const LadderOfRun& ladder : ladders) records.push_back(ladder.record);
    return families(records);
}

/// Inside a script element "<" could end it or open a comment; as an escape it means the same.
std::string script_safe(std::string text) {
    for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
        text.replace(at, 1, "\\u003c");
    }
    return text;
}

}  // namespace

std::string chart_data(const Dossier& dossier) {
    json timings = json::array();
    for (const SceneDossier& scene : dossier.scenes) {
        for (const auto& timing : scene.timings) timings.push_back(timing_json(scene, timing));
    }
    json plots = json::array();
    for (const Sweep& sweep : sweeps(dossier)) plots.push_back(sweep_json(sweep));
    json claims = json::array();
    const std::vector<Results>& runs = *dossier.runs;
    for (size_t r = 0; r < runs.size(); ++r) {
        for (const ClaimRecord& claim : runs[r].claims) claims.push_back(claim_json(claim, r));
    }
    json motion = json::array();
    for (const auto& record : animations(dossier)) motion.push_back(motion_json(*record.record));
    const std::vector<LadderOfRun> ladders = ladders_of(dossier);
    const std::vector<Cloud> all_clouds = clouds(dossier);
    const std::vector<std::string> colours = colour_order(ladders, all_clouds);
    json climbs = json::array(), tradeoffs = json::array();
    for (const LadderOfRun& ladder : ladders) {
        climbs.push_back(ladder_json(*ladder.record, colours));
    }
    for (const Cloud& cloud : all_clouds) tradeoffs.push_back(cloud_json(cloud, colours));
    json growth = json::array();
    for (const GrowthChart& chart : growth_charts(dossier)) growth.push_back(growth_json(chart));
    const json data = {{"timings", timings}, {"sweeps", plots},
                       {"claims", claims},   {"motion", motion},
                       {"ladders", climbs},  {"tradeoffs", tradeoffs},
                       {"growth", growth},   {"closer", json::parse(closer_data(dossier))}};
    // Text from files need not be UTF-8; a chart label shows a replacement character then.
    return script_safe(data.dump(-1, ' ', false, json::error_handler_t::replace));
}

}  // namespace onepass::report
