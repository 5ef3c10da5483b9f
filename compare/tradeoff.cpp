#include "compare/tradeoff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <tbb/parallel_for.h>

#include "compare/hits.h"
#include "core/error.h"

namespace onepass {
namespace {

/// By hit class, one tracer's answers.
using ClassCounts = std::array<uint64_t, kHitClassCount>;

std::vector<ClassCounts> judge_all(std::span<Tracer* const> tracers, const RaySet& rays,
                                   const Judge& judge) {
    // Answers.
    std::vector<std::vector<Hit>> answers;
    for (Tracer* tracer : tracers) {
        answers.push_back(tracer->cast(tracer->upload(rays.rays), {.query = rays.query}).hits);
        ONEPASS_CHECK_EQ(answers.back().size(), rays.rays.size());
    }

    // Verdicts, in parallel.
    std::vector<std::vector<Verdict>> verdicts(rays.rays.size());
    tbb::parallel_for(size_t{0}, rays.rays.size(), [&](size_t i) {
        std::vector<Hit> hits;
        for (const std::vector<Hit>& of_tracer : answers) hits.push_back(of_tracer[i]);
        verdicts[i] = judge_distinct(judge, rays.rays[i], rays.query, hits);
        ONEPASS_CHECK_EQ(verdicts[i].size(), hits.size());
    });

    // Counts.
    std::vector<ClassCounts> counts(tracers.size(), ClassCounts{});
    for (const std::vector<Verdict>& of_ray : verdicts) {
        for (size_t t = 0; t < tracers.size(); ++t) {
            ++counts[t][static_cast<size_t>(of_ray[t].hit_class)];
        }
    }
    return counts;
}

std::string shared(const std::string& a, const std::string& b) { return a == b ? a : ""; }

/// Two points of one setting, added up; ratios are their logarithms, intervals the squares of the
/// logarithmic distances to their ends.
void add(TradeoffPoint& sum, const TradeoffPoint& point) {
    sum.scene = shared(sum.scene, point.scene);
    sum.rays = shared(sum.rays, point.rays);
    sum.oracle = shared(sum.oracle, point.oracle);
    sum.ray_count += point.ray_count;
    sum.errors += point.errors;
    sum.edges += point.edges;
    const auto squared = [](double x) { return x * x; };
    sum.ratio += std::log(point.ratio);
    sum.ratio_low += squared(std::log(point.ratio / point.ratio_low));
    sum.ratio_high += squared(std::log(point.ratio_high / point.ratio));
}

}  // namespace

const std::vector<TradeoffSetting>& tradeoff_settings() {
    static const std::string kPaper = "paper/texture2d/";
    static const ParamValues kCareful = {
        {"edge_tolerance", "1"}, {"clip_to_cell", "0"}, {"accumulate_ts", "0"}, {"step_ties", "0"},
        {"guard_zero", "1"},     {"edge_slack", "3"},   {"local_planes", "1"}};
    static const std::vector<TradeoffSetting> kSettings = {
        {"embree/robust/threads"},
        {"embree/fast/threads"},
        {"embree/robust/1thread"},
        {"embree/fast/1thread"},
        {kPaper + "*"},
        {kPaper + "*", {{"edge_tolerance", "1"}}},
        {kPaper + "*", {{"edge_tolerance", "1"}, {"edge_slack", "3"}}},
        {kPaper + "*", {{"clip_to_cell", "0"}}},
        {kPaper + "*", kCareful},
        {kPaper + "*", {{"address", "half"}}},
        {kPaper + "*", {{"address", "float"}}},
        {kPaper + "*", {{"geometry", "half"}}},
        {"grid/buffer/*"},
        {"brute_force/texture2d/*"},
        {"brute_force/texture2d/*", {{"edge_tolerance", "1"}}},
        {kPaper + "twin32"},
        {kPaper + "twin64"},
        {kPaper + "twin32", {{"edge_tolerance", "1"}}},
        {kPaper + "twin64", {{"edge_tolerance", "1"}}},
        {"grid/buffer/twin32"},
        {"grid/buffer/twin64"},
    };
    return kSettings;
}

std::vector<TradeoffPoint> measure_tradeoff(std::span<Tracer* const> tracers, size_t oracle,
                                            const RaySet& rays, const Judge& judge,
                                            const TimingOptions& options,
                                            const Progress& progress) {
    const std::vector<ClassCounts> counts = judge_all(tracers, rays, judge);
    const std::vector<TimingRecord> timings = time_casts(tracers, oracle, rays, options, progress);
    if (timings.front().wall_ms.empty()) return {};

    std::vector<TradeoffPoint> points;
    for (size_t t = 0; t < tracers.size(); ++t) {
        const TimingRecord& timing = timings[t];
        TradeoffPoint& point = points.emplace_back();
        point.rays = rays.name;
        point.tracer = timing.tracer;
        point.oracle = timing.oracle;
        point.ray_count = timing.ray_count;
        for (size_t c = 0; c < kHitClassCount; ++c) {
            if (is_error(static_cast<HitClass>(c))) point.errors += counts[t][c];
        }
        point.edges = counts[t][static_cast<size_t>(HitClass::edge)];
        point.wall_ms = timing.wall_ms;
        point.oracle_wall_ms = timing.oracle_wall_ms;
        point.ratio = timing.ratio;
        point.ratio_low = timing.ratio_low;
        point.ratio_high = timing.ratio_high;
    }
    return points;
}

double error_rate(const TradeoffPoint& point) {
    if (point.ray_count == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(point.errors) / static_cast<double>(point.ray_count);
}

std::vector<bool> on_front(std::span<const TradeoffPoint> points) {
    // A comparison with NaN is false, so a point without figures beats none.
    const auto beats = [](const TradeoffPoint& a, const TradeoffPoint& b) {
        return a.ratio >= b.ratio && error_rate(a) <= error_rate(b) &&
               (a.ratio > b.ratio || error_rate(a) < error_rate(b));
    };
    std::vector<bool> front;
    for (const TradeoffPoint& point : points) {
        const bool measured = !std::isnan(point.ratio) && !std::isnan(error_rate(point));
        front.push_back(measured && std::none_of(points.begin(), points.end(),
                                                 [&](const auto& p) { return beats(p, point); }));
    }
    return front;
}

std::vector<TradeoffPoint> pool(std::span<const TradeoffPoint> points) {
    using Case = std::pair<std::string, std::string>;
    struct Sum {
        TradeoffPoint point;
        std::set<Case> cases;
        double measured = 0.0;  ///< points; above the number of cases where one was run twice
    };
    std::set<Case> cases;
    std::vector<Sum> sums;
    for (const TradeoffPoint& point : points) {
        cases.insert({point.scene, point.rays});
        auto sum = std::find_if(sums.begin(), sums.end(), [&](const Sum& s) {
            return s.point.tracer == point.tracer && s.point.setting == point.setting;
        });
        if (sum == sums.end()) {
            TradeoffPoint empty;
            empty.scene = point.scene;
            empty.rays = point.rays;
            empty.tracer = point.tracer;
            empty.setting = point.setting;
            empty.oracle = point.oracle;
            sum = sums.insert(sums.end(), {empty, {}});
        }
        add(sum->point, point);
        sum->cases.insert({point.scene, point.rays});
        sum->measured += 1.0;
    }

    std::vector<TradeoffPoint> pooled;
    for (const auto& [sum, of_setting, n] : sums) {
        if (of_setting != cases) continue;
        TradeoffPoint& point = pooled.emplace_back(sum);
        point.ratio = std::exp(sum.ratio / n);
        point.ratio_low = point.ratio * std::exp(-std::sqrt(sum.ratio_low) / n);
        point.ratio_high = point.ratio * std::exp(std::sqrt(sum.ratio_high) / n);
    }
    return pooled;
}

}  // namespace onepass
