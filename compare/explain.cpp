// From truth and walks to reasons: which of a true triangle's cells were visited, whether it was
// tested, and by how much the answered one is passed.
#include "compare/explain.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

const Meeting* find_meeting(const std::vector<Meeting>& meetings, const Hit& hit) {
    const auto found = std::find_if(meetings.begin(), meetings.end(), [&](const Meeting& m) {
        return m.inst_id == hit.inst_id && m.prim_id == hit.prim_id;
    });
    return found == meetings.end() ? nullptr : &*found;
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof(Hit)) == 0; }

// ---- Words -------------------------------------------------------------------------------------

std::string triangle_text(const Meeting& m) {
    return fmt::format("triangle {} of instance {}", m.prim_id, m.inst_id);
}

std::string cell_text(const ivec3& cell) {
    return fmt::format("({}, {}, {})", cell.x, cell.y, cell.z);
}

/// The first of them, and how many more there are.
std::string cells_text(const std::vector<ivec3>& cells) {
    constexpr size_t kShown = 6;
    std::string text;
    for (size_t i = 0; i < std::min(cells.size(), kShown); ++i) {
        text += (i > 0 ? ", " : "") + cell_text(cells[i]);
    }
    if (cells.size() > kShown) text += fmt::format(" and {} more", cells.size() - kShown);
    return text;
}

std::string edge_text(const Meeting& m) {
    return fmt::format("edge v{}-v{}", m.edge, (m.edge + 1) % 3);
}

// ---- What a walk did with a triangle -----------------------------------------------------------

struct Handling {
    bool entered = false;         ///< a cell of its instance's grid was visited
    std::vector<ivec3> visited;   ///< cells that hold it and were visited
    std::vector<ivec3> missed;    ///< cells that hold it and were not
    std::vector<ivec3> rejected;  ///< cells where it was tested in vain
    std::vector<ivec3> accepted;
    double accepted_t = 0.0;
};

Handling handling_of(Tracer& tracer, const RayWalk& walk, uint32_t inst_id, uint32_t prim_id) {
    Handling handling;
    const std::vector<ivec3> cells = tracer.cells_of(inst_id, prim_id);
    std::vector<ivec3> seen;
    for (const WalkStep& step : walk.steps) {
        if (step.inst_id != inst_id) continue;
        handling.entered = true;
        seen.push_back(step.cell);
        for (const WalkTest& test : step.tests) {
            if (test.prim_id != prim_id) continue;
            (test.accepted ? handling.accepted : handling.rejected).push_back(step.cell);
            if (test.accepted) handling.accepted_t = test.t;
        }
    }
    for (const ivec3& cell : cells) {
        const bool was_seen = std::find(seen.begin(), seen.end(), cell) != seen.end();
        (was_seen ? handling.visited : handling.missed).push_back(cell);
    }
    return handling;
}

/// Where the walk was at its end.
std::string end_text(const RayWalk& walk) {
    if (walk.steps.empty()) return "the walk entered no grid";
    const auto last_top = std::find_if(walk.steps.rbegin(), walk.steps.rend(),
                                       [](const WalkStep& s) { return s.inst_id == kNoId; });
    const std::string place =
        last_top == walk.steps.rend() ? "" : " in top-level cell " + cell_text(last_top->cell);
    if (walk.flags & kFlagExhausted) return "the walk ran out of its budget" + place;
    return "the walk ended" + place + (walk.hit.is_hit() ? ", with a hit" : ", without a hit");
}

/// What became of the triangle that would have been right.
std::string fate_of_the_right(Tracer& tracer, const RayWalk& walk, const Meeting& right) {
    const Handling h = handling_of(tracer, walk, right.inst_id, right.prim_id);
    const std::string name = "the true " + triangle_text(right);
    if (!h.accepted.empty()) {
        return fmt::format("{} was accepted in cell {} at t {:.9g}, and another one after it", name,
                           cells_text(h.accepted), h.accepted_t);
    }
    if (!h.rejected.empty()) {
        return fmt::format("{} was tested in {} {} and rejected", name,
                           h.rejected.size() == 1 ? "cell" : "cells", cells_text(h.rejected));
    }
    if (!h.entered) {
        return fmt::format("{} was never tested: no cell of its instance was visited; {}", name,
                           end_text(walk));
    }
    std::string where = h.missed.empty()
                            ? "no cell's list holds it"
                            : fmt::format("it lies in {}, not visited", cells_text(h.missed));
    if (!h.visited.empty()) {
        where += fmt::format("; its cell {} was visited, but its list was not tested to the end",
                             cells_text(h.visited));
    }
    return fmt::format("{} was never tested: {}; {}", name, where, end_text(walk));
}

/// How far the answer is from being a hit at all.
std::string passing_text(const Meeting& m) {
    if (m.crosses) {
        return fmt::format("its {} is crossed at t {}, outside of [tmin, tmax]", triangle_text(m),
                           m.t_digits);
    }
    std::string text = fmt::format("the ray passes its {} by, beside {} at {:.3g} of E_ray",
                                   triangle_text(m), edge_text(m), m.edge_moves);
    const double least = std::min({m.u, m.v, 1.0 - m.u - m.v});
    if (!std::isnan(least)) {
        text += fmt::format(" (least barycentric coordinate {:.3g})", least);
    }
    return text;
}

/// `walk`, if any, is that of `walker`, and ended with the same answer.
std::vector<std::string> reasons_for(const RayTruth& truth, const Statement& statement,
                                     Tracer* walker, const RayWalk* walk) {
    const Verdict& verdict = statement.verdict;
    const Hit& hit = statement.hit;
    std::vector<std::string> reasons;
    if (verdict.hit_class == HitClass::agree) return reasons;
    if (!truth.traceable) return {"the ray is not finite or its interval is empty: a miss by rule"};

    // The answer.
    const Meeting* hit_meeting = find_meeting(truth.hits, hit);
    const Meeting* passed = find_meeting(truth.passed, hit);
    if (verdict.hit_class == HitClass::tie) {
        size_t as_near = 0;
        for (const Meeting& m : truth.hits) as_near += m.is_right ? 1 : 0;
        reasons.push_back(
            as_near > 1 ? fmt::format("{} triangles are right, at equal t or at an end of the "
                                      "interval; by rule the one with the lowest ids is named",
                                      as_near)
                        : "a hit at an end of the interval may count or not");
    } else if (hit_meeting != nullptr && hit_meeting->is_right) {
        reasons.push_back(fmt::format("the triangle is right, its t is off by {:.3g} ulps",
                                      verdict.t_error_ulps));
    } else if (hit_meeting != nullptr) {
        reasons.push_back(fmt::format("its {} is hit, but number {} from the origin",
                                      triangle_text(*hit_meeting),
                                      hit_meeting - truth.hits.data() + 1));
    } else if (passed != nullptr) {
        reasons.push_back(passing_text(*passed));
    } else if (hit.is_hit()) {
        reasons.push_back("its ids name no triangle");
    }
    const Meeting* answered = hit_meeting ? hit_meeting : passed;
    if (walk != nullptr && answered != nullptr && !answered->is_right) {
        const Handling h = handling_of(*walker, *walk, hit.inst_id, hit.prim_id);
        if (!h.accepted.empty()) {
            reasons.push_back(fmt::format("{} was tested in cell {} and accepted at t {:.9g}",
                                          triangle_text(*answered), cells_text(h.accepted),
                                          h.accepted_t));
        }
    }

    // The truth.
    const auto right = std::find_if(truth.hits.begin(), truth.hits.end(),
                                    [](const Meeting& m) { return m.is_right; });
    const bool names_a_right_one = answered != nullptr && answered->is_right;
    if (right != truth.hits.end() && !names_a_right_one) {
        reasons.push_back(walk != nullptr
                              ? fate_of_the_right(*walker, *walk, *right)
                              : fmt::format("truly hit is {}, {:.3g} of E_ray from its {}",
                                            triangle_text(*right), right->edge_moves,
                                            edge_text(*right)));
    }
    if (verdict.hit_class == HitClass::edge) {
        reasons.push_back(fmt::format("right for a ray moved by {:.3g} of E_ray: no error",
                                      verdict.backward_error));
    }
    return reasons;
}

/// "paper/texture2d/" of "paper/texture2d/fragment".
std::string family_of(const std::string& tracer) { return tracer.substr(0, tracer.rfind('/') + 1); }

/// The tracer whose walk stands for a statement: its own, or its twin's; npos if there is none.
size_t walker_of(const std::vector<Statement>& statements, size_t of) {
    if (statements[of].walk) return of;
    for (size_t i = 0; i < statements.size(); ++i) {
        const Statement& other = statements[i];
        if (other.walk && family_of(other.tracer) == family_of(statements[of].tracer) &&
            same_bits(other.hit, statements[of].hit)) {
            return i;
        }
    }
    return std::string::npos;
}

}  // namespace

Ray parse_ray(const std::string& text) {
    constexpr const char* kForm = "ox,oy,oz,dx,dy,dz or ox,oy,oz,dx,dy,dz,tmin,tmax";
    std::vector<float> numbers;
    for (const char* at = text.c_str();;) {
        char* end = nullptr;
        numbers.push_back(std::strtof(at, &end));
        if (end == at || (*end != ',' && *end != '\0')) {
            throw Error({"--ray", fmt::format("'{}'", text), kForm,
                         "Separate the numbers by commas, without blanks in between."});
        }
        if (*end == '\0') break;
        at = end + 1;
    }
    if (numbers.size() != 6 && numbers.size() != 8) {
        throw Error({"--ray", fmt::format("{} numbers", numbers.size()), kForm,
                     "Give origin and direction, and the interval or nothing."});
    }
    Ray ray;
    ray.org = {numbers[0], numbers[1], numbers[2]};
    ray.dir = {numbers[3], numbers[4], numbers[5]};
    if (numbers.size() == 8) {
        ray.tmin = numbers[6];
        ray.tmax = numbers[7];
    }
    return ray;
}

std::string ray_text(const Ray& ray) {
    std::string text = fmt::format("{},{},{},{},{},{}", ray.org.x, ray.org.y, ray.org.z, ray.dir.x,
                                   ray.dir.y, ray.dir.z);
    const bool plain = ray.tmin == 0.0f && !std::signbit(ray.tmin) && ray.tmax == kInfinity;
    return plain ? text : text + fmt::format(",{},{}", ray.tmin, ray.tmax);
}

std::string answer_text(const Hit& hit) {
    if (!hit.is_hit()) return "miss";
    return fmt::format("t {} instance {} triangle {}", hit.t, hit.inst_id, hit.prim_id);
}

Explanation explain_ray(const Ray& ray, const Judge& judge, std::span<Tracer* const> tracers) {
    // The answers.
    Explanation explanation;
    explanation.ray = ray;
    explanation.judge = judge.name();
    std::vector<Hit> answers;
    for (Tracer* tracer : tracers) {
        const CastResult cast = tracer->cast(tracer->upload(std::span(&ray, 1)), {});
        Statement statement;
        statement.tracer = tracer->name();
        statement.hit = cast.hits.at(0);
        statement.flags = cast.flags.at(0);
        if (tracer->capabilities().walks) statement.walk = tracer->walk(ray);
        answers.push_back(statement.hit);
        explanation.statements.push_back(std::move(statement));
    }

    // The truth.
    explanation.truth = judge.explain(ray, answers);
    const std::vector<Verdict> verdicts = judge.judge(ray, Query::closest, answers);
    for (size_t i = 0; i < verdicts.size(); ++i) explanation.statements[i].verdict = verdicts[i];

    // Where they part.
    for (size_t i = 0; i < explanation.statements.size(); ++i) {
        Statement& statement = explanation.statements[i];
        const size_t walker = walker_of(explanation.statements, i);
        const bool known = walker != std::string::npos;
        statement.reasons =
            reasons_for(explanation.truth, statement, known ? tracers[walker] : nullptr,
                        known ? &*explanation.statements[walker].walk : nullptr);
    }
    return explanation;
}

}  // namespace onepass
