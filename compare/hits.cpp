#include "compare/hits.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

/// Distance of two t in ulps of `reference`. NaN if either is.
double t_distance_ulps(float t, float reference) {
    const float magnitude = std::abs(reference);
    const double ulp = double{std::nextafter(magnitude, kInfinity)} - double{magnitude};
    return std::abs(double{t} - double{reference}) / ulp;
}

/// A comparison with NaN is false, so a NaN t never agrees.
bool agree_without_judge(const Hit& answer, const Hit& oracle) {
    if (!answer.is_hit() || !oracle.is_hit()) return answer.is_hit() == oracle.is_hit();
    return answer.prim_id == oracle.prim_id && answer.inst_id == oracle.inst_id &&
           t_distance_ulps(answer.t, oracle.t) <= kTUlps;
}

Verdict unjudged_agreement(const Hit& answer, const Hit& oracle) {
    Verdict verdict;
    verdict.true_t = oracle.t;
    verdict.true_prim_id = oracle.prim_id;
    verdict.true_inst_id = oracle.inst_id;
    verdict.t_error_ulps = oracle.is_hit() ? t_distance_ulps(answer.t, oracle.t)
                                           : std::numeric_limits<double>::quiet_NaN();
    return verdict;
}

/// One ray's verdicts: of each tracer's answer, and last of the oracle's.
struct Judgement {
    size_t ray = 0;
    std::vector<Verdict> verdicts;
};

/// The rays that the judge has to see, in order.
std::vector<Judgement> rays_to_judge(std::span<const CastResult> answers, const CastResult& oracle,
                                     const HitCheckOptions& options) {
    Random random(options.seed);
    std::vector<Judgement> judgements;
    for (size_t i = 0; i < oracle.hits.size(); ++i) {
        bool wanted = random.unit() < options.agreement_sample;
        if (oracle.flags[i] & kFlagOracleInvalid) continue;
        for (const CastResult& cast : answers) {
            wanted |= !agree_without_judge(cast.hits[i], oracle.hits[i]);
        }
        if (wanted) judgements.push_back({i, {}});
    }
    return judgements;
}

std::vector<Judgement> judged(std::span<const Ray> rays, Query query,
                              std::span<const CastResult> answers, const CastResult& oracle,
                              const Judge& judge, const HitCheckOptions& options) {
    std::vector<Judgement> judgements = rays_to_judge(answers, oracle, options);
    tbb::parallel_for(size_t{0}, judgements.size(), [&](size_t j) {
        const size_t i = judgements[j].ray;
        std::vector<Hit> hits;
        for (const CastResult& cast : answers) hits.push_back(cast.hits[i]);
        hits.push_back(oracle.hits[i]);
        judgements[j].verdicts = judge_distinct(judge, rays[i], query, hits);
    });
    return judgements;
}

std::pair<double, double> badness(const Verdict& verdict) {
    const auto or_least = [](double x) { return std::isnan(x) ? -1.0 : x; };
    return {or_least(verdict.backward_error), or_least(verdict.t_error_ulps)};
}

void tally(CheckRecord& record, const WorstRay& candidate) {
    ClassTally& tally = record.classes[static_cast<size_t>(candidate.verdict.hit_class)];
    ++tally.count;
    if (!tally.worst || is_worse(candidate.verdict, tally.worst->verdict)) tally.worst = candidate;
}

std::array<uint64_t, kHitClassCount> bounds_of(uint64_t ray_count,
                                               const std::map<HitClass, uint64_t>& allowed) {
    std::array<uint64_t, kHitClassCount> bounds{};
    bounds[static_cast<size_t>(HitClass::agree)] = ray_count;
    bounds[static_cast<size_t>(HitClass::tie)] = ray_count;
    bounds[static_cast<size_t>(HitClass::edge)] = edge_budget(ray_count);
    for (const auto& [hit_class, bound] : allowed) bounds[static_cast<size_t>(hit_class)] = bound;
    return bounds;
}

bool within_bounds(const CheckRecord& record) {
    for (size_t c = 0; c < kHitClassCount; ++c) {
        if (record.classes[c].count > record.allowed[c]) return false;
    }
    return true;
}

/// Tallies one tracer, in the order of the rays.
HitComparison tallied(std::span<const Ray> rays, Query query, std::span<const CastResult> all,
                      size_t tracer, const CastResult& oracle,
                      std::span<const Judgement> judgements, const HitCheckOptions& options) {
    const CastResult& answers = all[tracer];
    HitComparison comparison;
    comparison.classes.resize(rays.size());
    CheckRecord& record = comparison.record;
    record.ray_count = rays.size();
    record.judged = judgements.size();
    auto next_judged = judgements.begin();
    for (size_t i = 0; i < rays.size(); ++i) {
        const Hit& answer = answers.hits[i];
        const Hit& truth = oracle.hits[i];
        record.exhausted += (answers.flags[i] & kFlagExhausted) != 0;
        if (oracle.flags[i] & kFlagOracleInvalid) {
            ++record.oracle_invalid;
            continue;
        }
        record.hit_count += truth.is_hit();
        record.wrong_triangle +=
            query == Query::closest && answer.is_hit() && truth.is_hit() &&
            std::tie(answer.prim_id, answer.inst_id) != std::tie(truth.prim_id, truth.inst_id);

        Verdict verdict = unjudged_agreement(answer, truth);
        if (next_judged != judgements.end() && next_judged->ray == i) {
            verdict = next_judged->verdicts[tracer];
            ++record.oracle_classes[static_cast<size_t>(next_judged->verdicts.back().hit_class)];
            ++next_judged;
        }
        comparison.classes[i] = verdict.hit_class;
        const WorstRay row{i, rays[i], answer, truth, verdict};
        tally(record, row);
        if (is_error(verdict.hit_class)) comparison.wrong.push_back(row);
    }
    record.allowed = bounds_of(rays.size(), options.allowed);
    record.passed = within_bounds(record);
    return comparison;
}

}  // namespace

bool is_worse(const Verdict& a, const Verdict& b) { return badness(a) > badness(b); }

uint64_t edge_budget(uint64_t ray_count) {
    return static_cast<uint64_t>(std::ceil(kEdgeShare * static_cast<double>(ray_count)));
}

std::vector<Verdict> judge_distinct(const Judge& judge, const Ray& ray, Query query,
                                    std::span<const Hit> answers) {
    // Bits, so that a NaN is equal to itself.
    const auto same = [](const Hit& a, const Hit& b) {
        using Bits = std::array<uint32_t, 5>;
        return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
    };
    std::vector<Hit> distinct;
    std::vector<size_t> place_of;
    for (const Hit& answer : answers) {
        const auto known = std::find_if(distinct.begin(), distinct.end(),
                                        [&](const Hit& d) { return same(d, answer); });
        place_of.push_back(static_cast<size_t>(known - distinct.begin()));
        if (known == distinct.end()) distinct.push_back(answer);
    }
    const std::vector<Verdict> verdicts = judge.judge(ray, query, distinct);
    ONEPASS_CHECK_EQ(verdicts.size(), distinct.size());
    std::vector<Verdict> result;
    for (const size_t place : place_of) result.push_back(verdicts[place]);
    return result;
}

std::vector<HitComparison> compare_hits(std::span<const Ray> rays, Query query,
                                        std::span<const CastResult> answers,
                                        const CastResult& oracle, const Judge& judge,
                                        const HitCheckOptions& options) {
    ONEPASS_CHECK_EQ(oracle.hits.size(), rays.size());
    ONEPASS_CHECK_EQ(oracle.flags.size(), rays.size());
    for (const CastResult& cast : answers) {
        ONEPASS_CHECK_EQ(cast.hits.size(), rays.size());
        ONEPASS_CHECK_EQ(cast.flags.size(), rays.size());
    }
    const std::vector<Judgement> judgements = judged(rays, query, answers, oracle, judge, options);
    std::vector<HitComparison> comparisons;
    for (size_t tracer = 0; tracer < answers.size(); ++tracer) {
        comparisons.push_back(tallied(rays, query, answers, tracer, oracle, judgements, options));
        comparisons.back().record.judge = judge.name();
    }
    return comparisons;
}

HitComparison compare_hits(std::span<const Ray> rays, Query query, const CastResult& answers,
                           const CastResult& oracle, const Judge& judge,
                           const HitCheckOptions& options) {
    const std::span<const CastResult> one(&answers, 1);
    return std::move(compare_hits(rays, query, one, oracle, judge, options).front());
}

std::pair<HitClass, uint64_t> parse_allowance(const std::string& text) {
    const size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::string names;
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const HitClass hit_class = static_cast<HitClass>(c);
        names += fmt::format("{}{}", c ? ", " : "", to_string(hit_class));
        if (name != to_string(hit_class) || equals == std::string::npos) continue;
        uint64_t bound = 0;
        const char* end = text.data() + text.size();
        const auto [stop, failure] = std::from_chars(text.data() + equals + 1, end, bound);
        if (failure == std::errc() && stop == end) return {hit_class, bound};
    }
    throw Error({"--allow", fmt::format("'{}'", text),
                 "CLASS=N with N a whole number and CLASS one of " + names,
                 "For example --allow wrong_surface=300."});
}

}  // namespace onepass
