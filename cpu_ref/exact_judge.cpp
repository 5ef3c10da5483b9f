// The exact judge: classes by core/judge.h, `edge` by a search for a witness.
//
// The truth about the given ray is exact. A witness is a moved ray of E_ray for which the answer is
// right by the double truth: many are tried, and some must pass exactly through a corner, which a
// ray of doubles cannot; the tolerance of some roundings of double stands for the real ray beside
// it. The search tries a bounded set of moves, smallest first. What it does not find it does not
// forgive: errors can be reported too often, never hidden.
#include "cpu_ref/exact_judge.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cpu_ref/double_truth.h"
#include "cpu_ref/exact_truth.h"

namespace onepass {

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// A move of a ray within its reach.
struct Move {
    dvec3 org{0.0};
    dvec3 dir{0.0};
    double size = 0.0;  ///< largest component in units of the reach, at most 1
};

double move_size(const SpreadRay& ray, const dvec3& org, const dvec3& dir) {
    return std::max(largest_component(org) / ray.org_reach, largest_component(dir) / ray.dir_reach);
}

SpreadRay moved(const SpreadRay& ray, const Move& move) {
    SpreadRay result = ray;
    result.org += move.org;
    result.dir += move.dir;
    return result;
}

/// How far past an edge, or into a triangle, a directed move goes, in units of the reach: from just
/// beyond double rounding to half of what is allowed.
constexpr std::array<double, 4> kBeyond = {0x1p-20, 0x1p-10, 0x1p-4, 0.5};

/// Triangles near the ray that directed moves are made for; more are seen only where triangles are
/// smaller than float can tell apart.
constexpr size_t kMostTriangles = 32;

/// Collects moves to try for one ray.
class Moves {
  public:
    explicit Moves(const SpreadRay& ray) : ray_(ray) {}

    bool can_reach_edge_of(const WorldTriangle& triangle) const {
        for (const Passing& p : nearest_on_edges(corners_of(triangle))) {
            if (largest_component(p.offset) <= ray_.reach(p.t)) return true;
        }
        return false;
    }

    /// The edge whose nearest point takes the least of what the ray may be moved.
    struct NearestEdge {
        uint32_t edge = 0;
        double distance = kNone;  ///< largest component of the shift
        double moves = kNone;     ///< in units of the reach there
        double t = 0.0;
    };
    NearestEdge nearest_edge_of(const WorldTriangle& triangle) const {
        NearestEdge nearest;
        const std::array<Passing, 3> passings = nearest_on_edges(corners_of(triangle));
        for (uint32_t i = 0; i < 3; ++i) {
            const double distance = largest_component(passings[i].offset);
            const double moves = distance / ray_.reach(passings[i].t);
            if (moves < nearest.moves) nearest = {i, distance, moves, passings[i].t};
        }
        return nearest;
    }

    /// The ray's crossing goes to each corner, to the nearest point of each edge, and from there
    /// towards the middle and to both sides of the edge.
    void towards(const WorldTriangle& triangle) {
        const std::array<Passing, 3> corners = corners_of(triangle);
        const std::array<Passing, 3> nearest = nearest_on_edges(corners);
        const Passing middle = between(between(corners[0], corners[1], 0.5), corners[2], 1.0 / 3.0);
        for (const Passing& p : corners) shift_crossing(p.offset, p.t);
        for (const Passing& p : nearest) aim(p, middle);
        for (int i = 0; i < 3; ++i) {
            const dvec3 edge = corners[(i + 1) % 3].offset - corners[i].offset;
            const dvec3 across = glm::cross(ray_.dir, edge);
            const double length = largest_component(across);
            if (length == 0.0) continue;
            for (const double beyond : kBeyond) {
                const dvec3 step = across * (beyond * ray_.reach(nearest[i].t) / length);
                shift_crossing(nearest[i].offset + step, nearest[i].t);
                shift_crossing(nearest[i].offset - step, nearest[i].t);
            }
        }
    }

    /// The ray's crossing goes to where the triangle has this t, or comes nearest to it: of the
    /// line of such points the nearest one, and on towards the line's other end. Seen at a grazing
    /// angle, a triangle has many t within the reach, and a move that minds only the position gets
    /// another one.
    void towards_at(const WorldTriangle& triangle, double t) {
        const std::array<Passing, 3> corners = corners_of(triangle);
        const double within = std::clamp(t, std::min({corners[0].t, corners[1].t, corners[2].t}),
                                         std::max({corners[0].t, corners[1].t, corners[2].t}));
        std::vector<Passing> ends;
        for (int i = 0; i < 3; ++i) {
            const Passing& a = corners[i];
            const Passing& b = corners[(i + 1) % 3];
            if (a.t == b.t || (a.t - within) * (b.t - within) > 0.0) continue;
            ends.push_back(between(a, b, (within - a.t) / (b.t - a.t)));
        }
        for (size_t i = 0; i < ends.size(); ++i) {
            const Passing& next = ends[(i + 1) % ends.size()];
            aim(nearest_on(ends[i], next), next);
        }
    }

    /// Corners, edges and sides of the box of moves, at full and at half size: among them are those
    /// that push the ray straight off a surface, and its t past the end of the interval.
    void box() {
        for (const double size : {0.5, 1.0}) {
            for (int x = -1; x <= 1; ++x) {
                for (int y = -1; y <= 1; ++y) {
                    for (int z = -1; z <= 1; ++z) {
                        if (x == 0 && y == 0 && z == 0) continue;
                        const dvec3 signs(size * x, size * y, size * z);
                        add(signs * ray_.org_reach, signs * ray_.dir_reach);
                    }
                }
            }
        }
    }

    const std::vector<Move>& list() const { return moves_; }

  private:
    /// Where the ray passes a point: at t, with the point at `offset` from the ray, at right
    /// angles.
    struct Passing {
        dvec3 offset{0.0};
        double t = 0.0;
    };

    std::array<Passing, 3> corners_of(const WorldTriangle& triangle) const {
        std::array<Passing, 3> corners;
        for (int i = 0; i < 3; ++i) {
            const dvec3 relative = triangle[i] - ray_.org;
            const double t = glm::dot(relative, ray_.dir) / glm::dot(ray_.dir, ray_.dir);
            corners[i] = {relative - t * ray_.dir, t};
        }
        return corners;
    }

    static Passing between(const Passing& a, const Passing& b, double share) {
        return {a.offset + share * (b.offset - a.offset), a.t + share * (b.t - a.t)};
    }

    /// The point of the edge that passes nearest.
    static Passing nearest_on(const Passing& a, const Passing& b) {
        const dvec3 edge = b.offset - a.offset;
        const double square = glm::dot(edge, edge);
        if (square == 0.0) return a;
        return between(a, b, std::clamp(-glm::dot(a.offset, edge) / square, 0.0, 1.0));
    }

    static std::array<Passing, 3> nearest_on_edges(const std::array<Passing, 3>& corners) {
        return {nearest_on(corners[0], corners[1]), nearest_on(corners[1], corners[2]),
                nearest_on(corners[2], corners[0])};
    }

    /// To a point and from there towards another.
    void aim(const Passing& at, const Passing& towards) {
        shift_crossing(at.offset, at.t);
        const double way = largest_component(towards.offset - at.offset);
        if (way == 0.0) return;
        for (const double beyond : kBeyond) {
            const Passing p = between(at, towards, std::min(1.0, beyond * ray_.reach(at.t) / way));
            shift_crossing(p.offset, p.t);
        }
    }

    /// Shares the crossing's offset between origin and direction so that the larger part, in units
    /// of its reach, is least; drops it if it is out of reach.
    void shift_crossing(const dvec3& offset, double t) {
        const double reach = ray_.reach(t);
        if (largest_component(offset) > reach) return;
        const double dir_share = t > 0.0 ? ray_.dir_reach / reach : 0.0;
        add(offset * (ray_.org_reach / reach), offset * dir_share);
    }

    /// Every move made here is within reach but for the rounding of its size.
    void add(const dvec3& org, const dvec3& dir) {
        moves_.push_back({org, dir, std::min(1.0, move_size(ray_, org, dir))});
    }

    const SpreadRay& ray_;
    std::vector<Move> moves_;
};

/// The triangles that the ray, or a ray moved within its reach, passes through; nearest boxes
/// first.
std::vector<WorldTriangle> triangles_near(const DoubleTruth& truth, const SpreadRay& ray,
                                          const Moves& moves) {
    std::vector<WorldTriangle> triangles;
    truth.candidates().visit(ray, [&](uint32_t inst_id, uint32_t prim_id) {
        const WorldTriangle triangle = truth.triangle(inst_id, prim_id);
        const bool is_near =
            moves.can_reach_edge_of(triangle) || truth.crossing(ray, inst_id, prim_id).has_value();
        if (is_near) triangles.push_back(triangle);
        return triangles.size() < kMostTriangles ? ray.tmax : -kNone;
    });
    return triangles;
}

/// False for ids that name no triangle.
bool names_triangle(const Scene& scene, const Hit& answer) {
    if (answer.inst_id >= scene.instances.size()) return false;
    const Object& object = scene.objects[scene.instances[answer.inst_id].object];
    return answer.prim_id < object.triangles.size();
}

enum class Grade { agree, tie, wrong_t, wrong };

/// Judges the answers to one ray.
class RayJudge {
  public:
    RayJudge(const ExactTruth& exact, const DoubleTruth& moved_truth, const Ray& ray, Query query)
        : exact_(exact),
          moved_truth_(moved_truth),
          ray_(e_ray(ray, moved_truth.candidates().magnitude())),
          query_(query),
          truth_(exact.find(ray_)) {}

    Verdict judge(const Hit& answer) {
        Verdict verdict;
        if (truth_.nearest) {
            verdict.true_t = truth_.nearest->crossing.t;
            verdict.true_prim_id = truth_.nearest->prim_id;
            verdict.true_inst_id = truth_.nearest->inst_id;
        } else {
            verdict.true_t = kNone;
        }
        verdict.t_error_ulps = t_error_ulps(answer);

        const Grade grade = this->grade(truth_, ray_, answer);
        if (grade == Grade::agree || grade == Grade::tie) {
            verdict.hit_class = grade == Grade::agree ? HitClass::agree : HitClass::tie;
            return verdict;
        }
        const Findings findings = search(answer);
        verdict.backward_error = findings.witness_size;
        verdict.hit_class =
            findings.witness_size <= 1.0 ? HitClass::edge : error_class(answer, findings);
        return verdict;
    }

  private:
    /// How an answer stands to the truth about a ray: the given one or a moved one.
    Grade grade(const Truth& truth, const SpreadRay& ray, const Hit& answer) const {
        if (!answer.is_hit()) {
            if (!truth.nearest) return Grade::agree;
            return truth.miss_is_right ? Grade::tie : Grade::wrong;
        }
        if (query_ == Query::any) {
            if (truth.nearest) return Grade::agree;
            return truth.right.empty() ? Grade::wrong : Grade::tie;
        }
        if (!names_triangle(moved_truth_.scene(), answer)) return Grade::wrong;
        const Surface* surface = truth.find(answer.inst_id, answer.prim_id);
        if (surface == nullptr) return Grade::wrong;
        const Crossing& crossing = surface->crossing;
        const double t_bound = kTUlps * float_ulp(crossing.t) + crossing.t_tolerance;
        const bool is_inside = answer.t >= ray.tmin && answer.t <= ray.tmax;
        if (!(std::abs(answer.t - crossing.t) <= t_bound)) return Grade::wrong_t;
        if (!is_inside && !surface->optional) return Grade::wrong_t;
        const bool is_canonical = truth.nearest && truth.nearest->inst_id == answer.inst_id &&
                                  truth.nearest->prim_id == answer.prim_id;
        return is_canonical ? Grade::agree : Grade::tie;
    }

    bool is_right(const SpreadRay& ray, const Hit& answer) const {
        const Grade g = grade(moved_truth_.find(ray), ray, answer);
        return g == Grade::agree || g == Grade::tie;
    }

    /// What the rays of E_ray that were tried have shown about an answer.
    struct Findings {
        double witness_size = kNone;   ///< of the smallest move for which the answer is right
        bool hits_anything = false;    ///< some ray hits something
        bool hits_the_answer = false;  ///< the answered triangle is nearest for some ray

        void note(Grade grade, const Truth& truth) {
            hits_anything |= truth.nearest.has_value();
            hits_the_answer |= grade == Grade::wrong_t;
        }
    };

    Findings search(const Hit& answer) {
        Findings findings;
        findings.note(grade(truth_, ray_, answer), truth_);
        if (answer.is_hit() && query_ == Query::closest) {
            // The interval is not moved, so an answer outside of it is right for no ray.
            if (!names_triangle(moved_truth_.scene(), answer)) return findings;
            if (!(answer.t >= ray_.tmin && answer.t <= ray_.tmax)) return findings;
            findings.witness_size = size_at_t(Move{}, answer);
        }
        for (const Move& move : moves_for(answer)) {
            if (findings.witness_size <= 1.0) break;
            const SpreadRay ray = moved(ray_, move);
            const Truth truth = moved_truth_.find(ray);
            const Grade grade = this->grade(truth, ray, answer);
            findings.note(grade, truth);
            if (grade == Grade::agree || grade == Grade::tie) findings.witness_size = move.size;
            if (grade == Grade::wrong_t) findings.witness_size = size_at_t(move, answer);
        }
        return findings;
    }

    /// Moves on along the normal of the answered triangle until its plane is met near enough to the
    /// answered t; the whole move's size if the answer is right there, else +inf.
    double size_at_t(const Move& move, const Hit& answer) const {
        const WorldTriangle triangle = moved_truth_.triangle(answer.inst_id, answer.prim_id);
        const dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
        const SpreadRay start = moved(ray_, move);
        const double t = answer.t;

        // The way that is left after the ulps that t may be off anyway, in units of the reach.
        constexpr double kShareOfUlps = 0.99;
        const double distance = glm::dot(normal, triangle[0] - start.org - t * start.dir);
        const double allowed =
            kShareOfUlps * kTUlps * float_ulp(t) * std::abs(glm::dot(normal, start.dir));
        const dvec3 size = glm::abs(normal);
        const double gain = (size.x + size.y + size.z) * ray_.reach(t);
        const double way = std::max(0.0, std::abs(distance) - allowed) / gain;
        if (!(way <= 2.0)) return kNone;

        const dvec3 step = glm::sign(normal) * std::copysign(way, distance);
        Move whole{move.org + step * ray_.org_reach, move.dir + step * ray_.dir_reach, 0.0};
        whole.size = move_size(ray_, whole.org, whole.dir);
        return whole.size <= 1.0 && is_right(moved(ray_, whole), answer) ? whole.size : kNone;
    }

    /// Smallest first.
    std::vector<Move> moves_for(const Hit& answer) {
        Moves own(ray_);
        if (answer.is_hit() && query_ == Query::closest) {
            const WorldTriangle triangle = moved_truth_.triangle(answer.inst_id, answer.prim_id);
            const double allowed = 0.5 * kTUlps * float_ulp(answer.t);
            for (const double step : {-allowed, 0.0, allowed}) {
                own.towards_at(triangle, answer.t + step);
            }
        }
        std::vector<Move> moves = own.list();
        moves.insert(moves.end(), shared_moves().begin(), shared_moves().end());
        std::sort(moves.begin(), moves.end(),
                  [](const Move& a, const Move& b) { return a.size < b.size; });
        return moves;
    }

    /// The moves that do not depend on the answer; made when the first answer needs them.
    const std::vector<Move>& shared_moves() {
        if (shared_moves_.empty()) {
            Moves moves(ray_);
            for (const WorldTriangle& t : triangles_near(moved_truth_, ray_, moves)) {
                moves.towards(t);
            }
            moves.box();
            shared_moves_ = moves.list();
        }
        return shared_moves_;
    }

    static HitClass error_class(const Hit& answer, const Findings& findings) {
        if (!answer.is_hit()) return HitClass::false_miss;
        if (findings.hits_the_answer) return HitClass::t_error;
        return findings.hits_anything ? HitClass::wrong_surface : HitClass::false_hit;
    }

    double t_error_ulps(const Hit& answer) const {
        constexpr double kNoSuchT = std::numeric_limits<double>::quiet_NaN();
        if (!answer.is_hit() || query_ == Query::any) return kNoSuchT;
        if (!names_triangle(moved_truth_.scene(), answer)) return kNoSuchT;
        const auto hit = exact_.crossing(ray_, answer.inst_id, answer.prim_id);
        if (!hit) return kNoSuchT;
        return std::abs(answer.t - hit->t_rounded) / float_ulp(hit->t_rounded);
    }

    const ExactTruth& exact_;
    const DoubleTruth& moved_truth_;
    SpreadRay ray_;
    Query query_;
    Truth truth_;
    std::vector<Move> shared_moves_;
};

/// Tells the whole truth about one ray.
class RayReader {
  public:
    RayReader(const ExactTruth& exact, const DoubleTruth& doubles, const Ray& ray)
        : exact_(exact),
          doubles_(doubles),
          ray_(e_ray(ray, doubles.candidates().magnitude())),
          moves_(ray_),
          truth_(exact.find(ray_)) {}

    RayTruth read(std::span<const Hit> answers) const {
        RayTruth told;
        told.miss_is_right = truth_.miss_is_right;
        told.org_reach = ray_.org_reach;
        told.dir_reach = ray_.dir_reach;
        told.hits = hits();
        told.passed = passed(told.hits, answers);
        return told;
    }

  private:
    Meeting meeting(uint32_t inst_id, uint32_t prim_id) const {
        Meeting m;
        m.inst_id = inst_id;
        m.prim_id = prim_id;
        const ExactDetail detail = exact_.detail(ray_, inst_id, prim_id);
        if (detail.has_t) {
            m.t = detail.t;
            m.t_digits = detail.t_digits;
            m.u = detail.u;
            m.v = detail.v;
        }
        m.crosses = detail.crosses;
        m.on_edge = detail.on_edge;
        m.close_side = detail.close;
        m.is_right = truth_.find(inst_id, prim_id) != nullptr;

        const WorldTriangle triangle = doubles_.triangle(inst_id, prim_id);
        const dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
        const double lengths = glm::length(normal) * glm::length(ray_.dir);
        if (lengths > 0.0) m.incidence = std::abs(glm::dot(normal, ray_.dir)) / lengths;

        const Moves::NearestEdge nearest = moves_.nearest_edge_of(triangle);
        m.edge = nearest.edge;
        m.edge_distance = detail.on_edge ? 0.0 : nearest.distance;
        m.edge_moves = detail.on_edge ? 0.0 : nearest.moves;
        return m;
    }

    std::vector<Meeting> hits() const {
        const std::vector<ExactHit> found = exact_.find_all(ray_);
        const auto holds = [](const Interval& t, double x) { return t.lower <= x && x <= t.upper; };
        std::vector<Meeting> hits;
        for (size_t i = 0; i < found.size(); ++i) {
            const ExactHit& hit = found[i];
            Meeting m = meeting(hit.inst_id, hit.prim_id);
            m.at_interval_end = hit.at_interval_end;
            m.close_order = holds(hit.t, ray_.tmin) || holds(hit.t, ray_.tmax);
            if (i > 0) m.close_order |= found[i - 1].t.upper >= hit.t.lower;
            if (i + 1 < found.size()) {
                m.close_order |= hit.t.upper >= found[i + 1].t.lower;
                m.gap_ulps = exact_.distance(ray_, hit, found[i + 1]) / float_ulp(m.t);
            }
            hits.push_back(std::move(m));
        }
        return hits;
    }

    /// What E_ray may reach, and what was asked about.
    std::vector<Meeting> passed(const std::vector<Meeting>& hits,
                                std::span<const Hit> answers) const {
        std::vector<Meeting> passed;
        const auto add = [&](uint32_t inst_id, uint32_t prim_id) {
            const auto is_it = [&](const Meeting& m) {
                return m.inst_id == inst_id && m.prim_id == prim_id;
            };
            if (std::any_of(hits.begin(), hits.end(), is_it)) return;
            if (std::any_of(passed.begin(), passed.end(), is_it)) return;
            passed.push_back(meeting(inst_id, prim_id));
        };
        doubles_.candidates().visit(ray_, [&](uint32_t inst_id, uint32_t prim_id) {
            const auto nearest = moves_.nearest_edge_of(doubles_.triangle(inst_id, prim_id));
            const bool in_interval = nearest.t >= ray_.tmin && nearest.t <= ray_.tmax;
            if (nearest.moves <= 1.0 && in_interval) add(inst_id, prim_id);
            return ray_.tmax;
        });
        for (const Hit& answer : answers) {
            if (names_triangle(doubles_.scene(), answer)) add(answer.inst_id, answer.prim_id);
        }
        std::stable_sort(passed.begin(), passed.end(), [](const Meeting& a, const Meeting& b) {
            return a.edge_moves < b.edge_moves;
        });
        return passed;
    }

    const ExactTruth& exact_;
    const DoubleTruth& doubles_;
    SpreadRay ray_;
    Moves moves_;  // of ray_
    Truth truth_;
};

/// The verdict on a ray that is a miss by definition (see is_traceable).
Verdict judge_untraceable(const Hit& answer) {
    Verdict verdict;
    verdict.true_t = kNone;
    verdict.t_error_ulps = std::numeric_limits<double>::quiet_NaN();
    if (answer.is_hit()) {
        verdict.hit_class = HitClass::false_hit;
        verdict.backward_error = kNone;
    }
    return verdict;
}

class ExactJudge final : public Judge {
  public:
    explicit ExactJudge(ScenePtr scene)
        : moved_truth_(std::move(scene)), exact_(moved_truth_.candidates()) {}

    std::string_view name() const override {
        return "exact (intervals of doubles, then exact numbers)";
    }

    std::vector<Verdict> judge(const Ray& ray, Query query,
                               std::span<const Hit> answers) const override {
        std::vector<Verdict> verdicts;
        verdicts.reserve(answers.size());
        if (!is_traceable(ray)) {
            for (const Hit& answer : answers) verdicts.push_back(judge_untraceable(answer));
            return verdicts;
        }
        RayJudge ray_judge(exact_, moved_truth_, ray, query);
        for (const Hit& answer : answers) verdicts.push_back(ray_judge.judge(answer));
        return verdicts;
    }

    RayTruth explain(const Ray& ray, std::span<const Hit> answers) const override {
        if (is_traceable(ray)) return RayReader(exact_, moved_truth_, ray).read(answers);
        RayTruth told;
        told.traceable = false;
        return told;
    }

  private:
    DoubleTruth moved_truth_;
    ExactTruth exact_;  // searches in moved_truth_'s candidates
};

}  // namespace

std::unique_ptr<Judge> make_exact_judge(ScenePtr scene) {
    return std::make_unique<ExactJudge>(std::move(scene));
}

}  // namespace onepass
