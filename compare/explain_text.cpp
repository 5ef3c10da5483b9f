// An explanation in words, for a terminal, and as JSON. Decides nothing.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/explain.h"

namespace onepass {
namespace {

using nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 57.29577951308232;

// ---- The ray -----------------------------------------------------------------------------------

std::string numbers_text(const vec3& v) { return fmt::format("{}, {}, {}", v.x, v.y, v.z); }
std::string hex_text(const vec3& v) { return fmt::format("{:a}, {:a}, {:a}", v.x, v.y, v.z); }

std::string ray_section(const Explanation& e) {
    return fmt::format(
        "ray: --ray \"{}\"\n  org  {}\n       {}\n  dir  {}\n       {}\n  t    [{}, {}]\n",
        ray_text(e.ray), numbers_text(e.ray.org), hex_text(e.ray.org), numbers_text(e.ray.dir),
        hex_text(e.ray.dir), e.ray.tmin, e.ray.tmax);
}

// ---- The truth ---------------------------------------------------------------------------------

/// "object/group" of a triangle, or what of it has a name.
std::string group_name(const Scene& scene, const Meeting& m) {
    const Object& object = scene.objects[scene.instances[m.inst_id].object];
    const TriangleGroup& group = object.groups[group_of_triangle(object, m.prim_id)];
    std::string name = object.name;
    if (!group.name.empty() && group.name != name) name += (name.empty() ? "" : "/") + group.name;
    return name;
}

std::string triangle_text(const Scene& scene, const Meeting& m) {
    const std::string group = group_name(scene, m);
    return fmt::format("instance {} triangle {}{}", m.inst_id, m.prim_id,
                       group.empty() ? "" : fmt::format(" ({})", group));
}

std::string conditioning_text(const Meeting& m) {
    const std::string edge =
        m.on_edge ? "exactly on an edge or corner"
                  : fmt::format("{:.3g} of E_ray ({:.3g}) from edge v{}-v{}", m.edge_moves,
                                m.edge_distance, m.edge, (m.edge + 1) % 3);
    std::string text =
        fmt::format("{}; {:.3g} degrees to the surface (|d.n| {:.3g})", edge,
                    std::asin(std::min(m.incidence, 1.0)) * kDegreesPerRadian, m.incidence);
    if (m.gap_ulps == 0.0) {
        text += "; the next hit is exactly as near: a tie";
    } else if (std::isfinite(m.gap_ulps)) {
        text += fmt::format("; next hit {:.3g} ulps further", m.gap_ulps);
    }
    if (m.at_interval_end) text += "; t is exactly an end of the interval";
    if (m.close_side || m.close_order) {
        text += fmt::format(
            "; exact numbers decided {}",
            m.close_side ? (m.close_order ? "side and order" : "the side") : "the order");
    }
    return text;
}

std::string hit_lines(const Scene& scene, size_t number, const Meeting& m) {
    return fmt::format("  {:>2}{} t {} {}, u {} v {}\n        {}\n", number, m.is_right ? "*" : " ",
                       m.t_digits, triangle_text(scene, m), m.u, m.v, conditioning_text(m));
}

bool is_answered(const Explanation& e, const Meeting& m) {
    for (const Statement& s : e.statements) {
        if (s.hit.inst_id == m.inst_id && s.hit.prim_id == m.prim_id) return true;
    }
    return false;
}

/// Those near the origin, and beyond them what is right or was answered.
constexpr size_t kShown = 8;

std::string truth_section(const Explanation& e, const Scene& scene) {
    const RayTruth& truth = e.truth;
    std::string text = fmt::format("exact answer, by the judge: {}\n", e.judge);
    if (!truth.traceable) {
        return text + "  a miss by rule: the ray is not finite, or its interval is empty\n";
    }
    text += fmt::format("  E_ray: origin moved by up to {:.3g} and direction by up to {:.3g}\n",
                        truth.org_reach, truth.dir_reach);
    size_t left_out = 0;
    for (size_t i = 0; i < truth.hits.size(); ++i) {
        const Meeting& m = truth.hits[i];
        if (i < kShown || m.is_right || is_answered(e, m)) {
            text += hit_lines(scene, i + 1, m);
        } else {
            ++left_out;
        }
    }
    if (left_out > 0) text += fmt::format("  {} more hits, further on\n", left_out);
    if (truth.hits.empty()) text += "  no hit\n";
    text += truth.miss_is_right ? "  * marks right answers; a miss is right as well\n"
                                : "  * marks right answers; a miss is wrong\n";

    left_out = 0;
    std::string passed;
    for (size_t i = 0; i < truth.passed.size(); ++i) {
        const Meeting& m = truth.passed[i];
        if (i >= kShown && !is_answered(e, m)) {
            ++left_out;
            continue;
        }
        passed +=
            fmt::format("     {}: {}{}\n", triangle_text(scene, m),
                        m.crosses ? "crossed outside of the interval; " : "", conditioning_text(m));
    }
    if (!passed.empty()) text += "  passed by, within E_ray or answered:\n" + passed;
    if (left_out > 0) text += fmt::format("     {} more within E_ray\n", left_out);
    return text;
}

// ---- The tracers -------------------------------------------------------------------------------

std::string tracer_section(const Explanation& e) {
    size_t width = 0;
    for (const Statement& s : e.statements) width = std::max(width, s.tracer.size());
    std::string text = "tracers\n";
    for (const Statement& s : e.statements) {
        text += fmt::format("  {:<{}}  {:<13}  {}", s.tracer, width, to_string(s.verdict.hit_class),
                            answer_text(s.hit));
        if (s.hit.is_hit()) text += fmt::format(", u {} v {}", s.hit.u, s.hit.v);
        if (!std::isnan(s.verdict.t_error_ulps)) {
            text += fmt::format("; t off by {:.3g} ulps", s.verdict.t_error_ulps);
        }
        if (s.flags & kFlagExhausted) text += "; ran out of a loop budget";
        if (s.flags & kFlagOracleInvalid) text += "; cannot take this ray";
        text += "\n";
        for (const std::string& reason : s.reasons) text += fmt::format("    - {}\n", reason);
    }
    return text;
}

// ---- The walks ---------------------------------------------------------------------------------

std::string cell_text(const ivec3& cell) {
    return fmt::format("({}, {}, {})", cell.x, cell.y, cell.z);
}

std::string tests_text(const WalkStep& step, const Hit& hit) {
    std::string text;
    for (const WalkTest& test : step.tests) {
        text += fmt::format(" {}", test.prim_id);
        const bool is_answer = test.prim_id == hit.prim_id && step.inst_id == hit.inst_id;
        if (test.accepted) {
            text += fmt::format(" [accepted at t {}{}]", test.t, is_answer ? ", the answer" : "");
        }
    }
    return text;
}

/// A run of cells without a test is one line.
std::string walk_lines(const RayWalk& walk) {
    std::string text;
    for (size_t i = 0; i < walk.steps.size();) {
        const WalkStep& step = walk.steps[i];
        if (step.inst_id == kNoId) {
            text += fmt::format("    top level {}\n", cell_text(step.cell));
            ++i;
            continue;
        }
        const bool begins = walk.steps[i == 0 ? 0 : i - 1].inst_id != step.inst_id;
        if (begins) text += fmt::format("      into instance {}\n", step.inst_id);
        size_t end = i + 1;
        if (step.tests.empty()) {
            while (end < walk.steps.size() && walk.steps[end].inst_id == step.inst_id &&
                   walk.steps[end].tests.empty()) {
                ++end;
            }
        }
        if (end - i > 1) {
            text += fmt::format("        {} .. {}: {} cells without a triangle\n",
                                cell_text(step.cell), cell_text(walk.steps[end - 1].cell), end - i);
        } else {
            text += fmt::format("        {}:{}\n", cell_text(step.cell),
                                step.tests.empty() ? " no triangle" : tests_text(step, walk.hit));
        }
        i = end;
    }
    return text;
}

std::string walk_section(const Explanation& e) {
    std::string text;
    std::vector<const Statement*> shown;
    for (const Statement& s : e.statements) {
        if (!s.walk) continue;
        text += fmt::format("walk of {}: {} cells, {} tests", s.tracer, s.walk->counters.cells,
                            s.walk->counters.tests);
        const Statement* same = nullptr;
        for (const Statement* other : shown) {
            if (!same && other->walk->steps == s.walk->steps) same = other;
        }
        if (same) {
            text += fmt::format(", as {}\n", same->tracer);
            continue;
        }
        shown.push_back(&s);
        text += ", in order\n" + walk_lines(*s.walk);
        text += fmt::format("    ended {}\n", s.walk->flags & kFlagExhausted ? "by its budget"
                                              : s.walk->hit.is_hit() ? "with " + answer_text(s.hit)
                                                                     : "without a hit");
    }
    return text;
}

// ---- JSON --------------------------------------------------------------------------------------

/// As in results files: NaN is null, infinities are texts.
ordered_json number(double x) {
    if (std::isnan(x)) return nullptr;
    if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
    return x;
}

ordered_json vector_json(const vec3& v) { return {number(v.x), number(v.y), number(v.z)}; }

ordered_json id_json(uint32_t id) { return id == kNoId ? ordered_json(nullptr) : ordered_json(id); }

ordered_json meeting_json(const Scene& scene, const Meeting& m) {
    return {{"inst_id", m.inst_id},
            {"prim_id", m.prim_id},
            {"group", group_name(scene, m)},
            {"crosses", m.crosses},
            {"right", m.is_right},
            {"t", number(m.t)},
            {"t_digits", m.t_digits},
            {"u", number(m.u)},
            {"v", number(m.v)},
            {"incidence", number(m.incidence)},
            {"edge", m.edge},
            {"edge_distance", number(m.edge_distance)},
            {"edge_moves", number(m.edge_moves)},
            {"on_edge", m.on_edge},
            {"gap_ulps", number(m.gap_ulps)},
            {"at_interval_end", m.at_interval_end},
            {"exact_side", m.close_side},
            {"exact_order", m.close_order}};
}

ordered_json meetings_json(const Scene& scene, const std::vector<Meeting>& meetings) {
    ordered_json list = ordered_json::array();
    for (const Meeting& m : meetings) list.push_back(meeting_json(scene, m));
    return list;
}

ordered_json walk_json(const RayWalk& walk) {
    ordered_json steps = ordered_json::array();
    for (const WalkStep& step : walk.steps) {
        ordered_json tests = ordered_json::array();
        for (const WalkTest& test : step.tests) {
            ordered_json entry = {{"prim_id", test.prim_id}, {"accepted", test.accepted}};
            if (test.accepted) entry["t"] = number(test.t);
            tests.push_back(std::move(entry));
        }
        steps.push_back({{"inst_id", id_json(step.inst_id)},
                         {"cell", {step.cell.x, step.cell.y, step.cell.z}},
                         {"tests", std::move(tests)}});
    }
    return {{"cells", walk.counters.cells}, {"tests", walk.counters.tests}, {"steps", steps}};
}

ordered_json statement_json(const Statement& s) {
    ordered_json entry = {{"tracer", s.tracer},
                          {"class", to_string(s.verdict.hit_class)},
                          {"hit", s.hit.is_hit()},
                          {"t", number(s.hit.t)},
                          {"u", number(s.hit.u)},
                          {"v", number(s.hit.v)},
                          {"inst_id", id_json(s.hit.inst_id)},
                          {"prim_id", id_json(s.hit.prim_id)},
                          {"flags", s.flags},
                          {"t_error_ulps", number(s.verdict.t_error_ulps)},
                          {"backward_error", number(s.verdict.backward_error)},
                          {"reasons", s.reasons}};
    if (s.walk) entry["walk"] = walk_json(*s.walk);
    return entry;
}

}  // namespace

std::string explanation_text(const Explanation& explanation, const Scene& scene) {
    return ray_section(explanation) + truth_section(explanation, scene) +
           tracer_section(explanation) + walk_section(explanation);
}

std::string explanation_json(const Explanation& explanation, const Scene& scene) {
    const Ray& ray = explanation.ray;
    const RayTruth& truth = explanation.truth;
    ordered_json statements = ordered_json::array();
    for (const Statement& s : explanation.statements) statements.push_back(statement_json(s));
    const ordered_json document = {{"scene", scene.name},
                                   {"ray",
                                    {{"text", ray_text(ray)},
                                     {"org", vector_json(ray.org)},
                                     {"dir", vector_json(ray.dir)},
                                     {"tmin", number(ray.tmin)},
                                     {"tmax", number(ray.tmax)}}},
                                   {"judge", explanation.judge},
                                   {"traceable", truth.traceable},
                                   {"miss_is_right", truth.miss_is_right},
                                   {"org_reach", number(truth.org_reach)},
                                   {"dir_reach", number(truth.dir_reach)},
                                   {"hits", meetings_json(scene, truth.hits)},
                                   {"passed", meetings_json(scene, truth.passed)},
                                   {"tracers", std::move(statements)}};
    return document.dump(2) + "\n";
}

}  // namespace onepass
