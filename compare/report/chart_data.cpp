// The figures behind the charts, as one JSON text. page.js draws them and computes nothing.
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "compare/report/sections.h"
#include "compare/statistics.h"

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
            {"mrays", number(timing->mrays_per_s)},
            {"errors", timing->errors},
            {"count", timing->ray_count}};
}

json sweep_json(const Sweep& sweep) {
    // The density that takes more values is the axis; the other one tells the curves apart.
    std::set<double> tops, objects;
    for (const SweepPoint& point : sweep.points) {
        tops.insert(point.top_density);
        objects.insert(point.object_density);
    }
    const bool by_object = objects.size() >= tops.size();

    json points = json::array();
    for (const SweepPoint& point : sweep.points) {
        if (!point.failure.empty()) continue;
        points.push_back({{"x", by_object ? point.object_density : point.top_density},
                          {"curve", by_object ? point.top_density : point.object_density},
                          {"time", number(median(point.wall_ms))},
                          {"cells", number(point.cells_per_ray)},
                          {"tests", number(point.tests_per_ray)},
                          {"memory", static_cast<double>(point.bytes) / (1u << 20)},
                          {"errors", point.errors}});
    }
    return {{"axis", by_object ? "object λ, cells a triangle" : "top λ, cells an instance"},
            {"curve", by_object ? "top λ" : "object λ"},
            {"points", points}};
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
    const json data = {
        {"timings", timings}, {"sweeps", plots}, {"claims", claims}, {"motion", motion}};
    // Text from files need not be UTF-8; a chart label shows a replacement character then.
    return script_safe(data.dump(-1, ' ', false, json::error_handler_t::replace));
}

}  // namespace onepass::report
