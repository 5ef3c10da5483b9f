// Invented results with ladders and trade-offs, for tests of the page: nothing here was measured.
// They hold what a page can trip over: rates of 0, refusals whole and in part, knobs that are no
// numbers, axes that are not logarithmic, worst rays, and texts that try to be HTML.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "compare/results.h"

namespace onepass {

inline const std::string kHostileText = "<script>alert('&\"')</script>";

inline WorstRay invented_worst_ray() {
    WorstRay worst;
    worst.index = 17;
    worst.ray.org = vec3(0.1f, 1.0f / 3.0f, 2.5f);
    worst.ray.dir = vec3(0.0625f, -0.25f, -1.0f);
    worst.answer = {2.25f, 0.25f, 0.5f, 1234, 0};
    worst.verdict = {
        HitClass::wrong_surface, 2.5, 1240, 0, 1.5e5, std::numeric_limits<double>::infinity()};
    return worst;
}

/// `failed` of 4,096 trials.
inline RungRecord invented_rung(double knob, const std::string& tracer, uint64_t failed) {
    RungRecord rung{.knob = knob, .tracer = tracer, .trials = 4096, .ties = 3, .edges = 1};
    if (failed > 0) {
        rung.failures = {{"wrong_surface", failed}};
        rung.worst = invented_worst_ray();
    }
    return rung;
}

/// Failures by rung of the tracers of most ladders.
struct InventedClimb {
    std::string tracer;
    std::vector<uint64_t> failed;
};

inline LadderRecord invented_ladder(const std::string& id, const std::string& title,
                                    const std::vector<double>& knobs,
                                    const std::vector<InventedClimb>& climbs) {
    LadderRecord ladder;
    ladder.id = id;
    ladder.title = title;
    ladder.question =
        "An invented question: what happens to the digits of a coordinate when the whole scene is "
        "moved away from the origin, so that fewer of them are left for its shape?";
    ladder.knob = "distance from the origin";
    ladder.unit = "scene sizes";
    ladder.judge = "exact (intervals of doubles, then exact numbers)";
    ladder.command = "onepass stress " + id;
    for (size_t i = 0; i < knobs.size(); ++i) {
        for (const auto& [tracer, failed] : climbs) {
            ladder.rungs.push_back(invented_rung(knobs[i], tracer, failed[i]));
        }
    }
    return ladder;
}

inline std::vector<LadderRecord> invented_ladders() {
    std::vector<LadderRecord> ladders;

    // All fail, grid last, the double twin never.
    ladders.push_back(
        invented_ladder("translation", "Far from the origin", {1, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e7},
                        {{"embree/robust/threads", {0, 0, 0, 0, 2, 40, 800, 4000}},
                         {"embree/fast/threads", {0, 0, 0, 1, 9, 130, 1200, 4090}},
                         {"paper/texture2d/fragment", {12, 12, 15, 90, 700, 3000, 4096, 4096}},
                         {"paper/texture2d/twin32", {12, 12, 15, 90, 700, 3000, 4096, 4096}},
                         {"paper/texture2d/twin64", {12, 12, 12, 12, 12, 12, 12, 12}},
                         {"grid/buffer/fragment", {0, 0, 0, 0, 0, 0, 300, 2500}},
                         {"grid/buffer/twin32", {0, 0, 0, 0, 0, 0, 300, 2500}},
                         {"grid/buffer/twin64", {0, 0, 0, 0, 0, 0, 0, 0}}}));

    // The knob falls, and ends in what has no logarithm; one tracer leaves rungs out.
    ladders.push_back(invented_ladder("direction", "A direction component near zero",
                                      {1e-2, 1e-4, 1e-8, 1e-20, 0.0, 0.0, std::nan("")},
                                      {{"paper/texture2d/fragment", {0, 0, 3, 60, 4096, 4096, 9}},
                                       {"grid/buffer/fragment", {0, 0, 0, 0, 0, 0, 0}},
                                       {"embree/fast/threads", {0, 0, 0, 0, 0, 0, 0}},
                                       {"embree/robust/threads", {0, 0, 0, 0, 0, 0, 0}}}));
    ladders.back().knob = "direction component";
    ladders.back().unit = "";
    for (size_t i = 0; i < ladders.back().rungs.size(); ++i) {
        RungRecord& rung = ladders.back().rungs[i];
        if (i / 4 == 5) rung.label = "-0";
        if (i / 4 == 6) rung.label = "NaN";
        if (i / 4 == 6 && rung.tracer.starts_with("embree")) {
            rung = {.knob = rung.knob, .label = "NaN", .tracer = rung.tracer};
            rung.refusal = "4,096 rays that Embree cannot take";
        }
    }

    // Few rungs, a linear axis, settings beside defaults, a refusal of all; grid fails first.
    ladders.push_back(invented_ladder(
        "resolution", "Grid resolution", {1, 2, 3, 4},
        {{"paper/texture2d/fragment", {0, 0, 0, 2}}, {"grid/buffer/fragment", {0, 1, 0, 2}}}));
    ladders.back().log_axis = false;
    ladders.back().knob = "cells a side";
    ladders.back().unit = "";
    ladders.back().judge = "";
    for (const double knob : {1.0, 2.0, 3.0, 4.0}) {
        RungRecord refused{.knob = knob, .tracer = "paper/texture2d/fragment"};
        refused.setting = "address=half";
        refused.refusal =
            "packing: got 90,000 triangles, expected at most 65,536. Use address=float.";
        ladders.back().rungs.push_back(refused);
    }
    return ladders;
}

/// A ladder every text of which tries to be HTML, and whose one tracer fails.
inline LadderRecord hostile_ladder() {
    LadderRecord ladder;
    for (std::string* text : {&ladder.id, &ladder.title, &ladder.question, &ladder.knob,
                              &ladder.unit, &ladder.judge, &ladder.command}) {
        *text = kHostileText;
    }
    RungRecord rung = invented_rung(1.0, kHostileText, 1);
    rung.label = rung.setting = rung.refusal = rung.failures[0].kind = kHostileText;
    ladder.rungs = {rung};
    return ladder;
}

inline TradeoffPoint invented_point(const std::string& scene, const std::string& rays,
                                    const std::string& tracer, const std::string& setting,
                                    double ratio, uint64_t errors) {
    TradeoffPoint point;
    point.scene = scene;
    point.rays = rays;
    point.tracer = tracer;
    point.setting = setting;
    point.oracle = "embree/robust/threads";
    point.ray_count = 16384;
    point.errors = errors;
    point.edges = errors / 3;
    point.wall_ms = std::vector<double>(9, 2.0 / ratio);
    point.oracle_wall_ms = std::vector<double>(9, 2.0);
    point.ratio = ratio;
    point.ratio_low = 0.93 * ratio;
    point.ratio_high = 1.05 * ratio;
    return point;
}

inline std::vector<TradeoffPoint> invented_tradeoffs() {
    struct Invented {
        std::string tracer, setting;
        double ratio;
        uint64_t errors;
    };
    const std::vector<Invented> settings = {
        {"embree/robust/threads", "", 1.0, 0},
        {"embree/fast/threads", "", 1.16, 24},
        {"embree/robust/1thread", "", 0.52, 0},
        {"embree/fast/1thread", "", 0.59, 24},
        {"paper/texture2d/fragment", "", 0.14, 99},
        {"paper/texture2d/fragment", "edge_tolerance=1", 0.143, 55},
        {"paper/texture2d/fragment", "address=half", 0.152, 99},
        {"paper/texture2d/fragment", "geometry=half", 0.16, 8130},
        {"paper/texture2d/fragment",
         "accumulate_ts=0, clip_to_cell=0, edge_slack=3, edge_tolerance=1, guard_zero=1", 0.11, 0},
        {"grid/buffer/fragment", "", 0.12, 0},
        {"brute_force/texture2d/fragment", "edge_tolerance=1", 0.02, 8},
        {"paper/texture2d/twin32", "", 0.07, 99},
        {"paper/texture2d/twin64", "", 0.05, 43},
        {"grid/buffer/twin32", "", 0.069, 0},
        {"grid/buffer/twin64", "", 0.055, 0},
    };
    std::vector<TradeoffPoint> points;
    for (const std::string scene : {"cornell", "bunny"}) {
        for (const std::string rays : {"primary", "vertex", "random"}) {
            const double easier = scene == "cornell" ? 1.3 : 1.0;
            for (const auto& [tracer, setting, ratio, errors] : settings) {
                if (scene == "bunny" && tracer.starts_with("brute_force")) continue;
                points.push_back(invented_point(scene, rays, tracer, setting,
                                                ratio == 1.0 ? 1.0 : ratio * easier,
                                                rays == "vertex" ? errors : errors / 40));
            }
        }
    }
    return points;
}

}  // namespace onepass
