// compare_hits: every ray in exactly one class, none hidden in another.
#include "compare/hits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Hit hit_at(float t, uint32_t prim_id = 0, uint32_t inst_id = 0) {
    return {.t = t, .u = 0.25f, .v = 0.25f, .prim_id = prim_id, .inst_id = inst_id};
}

/// A t that is `ulps` floats above 1; each is 2^-23.
float one_plus_ulps(int ulps) { return 1.0f + static_cast<float>(ulps) * 0x1p-23f; }

CastResult cast_of(std::vector<Hit> hits) {
    CastResult cast;
    cast.flags.assign(hits.size(), 0);
    cast.hits = std::move(hits);
    return cast;
}

std::vector<Ray> numbered_rays(size_t count) {
    std::vector<Ray> rays(count);
    for (size_t i = 0; i < count; ++i) rays[i].org.x = static_cast<float>(i);
    return rays;
}

Verdict verdict_of(HitClass hit_class, double backward_error = 0.0, double t_error_ulps = 0.0) {
    Verdict verdict;
    verdict.hit_class = hit_class;
    verdict.backward_error = backward_error;
    verdict.t_error_ulps = t_error_ulps;
    return verdict;
}

/// Fails the test when it is asked.
FakeJudge unwanted_judge() {
    return FakeJudge([](const Ray& ray, const Hit&) {
        ADD_FAILURE() << "ray " << ray.org.x << " was judged";
        return Verdict{};
    });
}

uint64_t count(const CheckRecord& record, HitClass hit_class) {
    return record.classes[static_cast<size_t>(hit_class)].count;
}

HitCheckOptions without_sample() {
    HitCheckOptions options;
    options.agreement_sample = 0.0;
    return options;
}

/// Ray i is given class i; both tracer and oracle hit, but different triangles.
struct OneOfEachClass {
    std::vector<Ray> rays = numbered_rays(kHitClassCount);
    CastResult answers = cast_of(std::vector<Hit>(kHitClassCount, hit_at(1.0f, 1)));
    CastResult oracle = cast_of(std::vector<Hit>(kHitClassCount, hit_at(1.0f, 2)));
    FakeJudge judge{[](const Ray& ray, const Hit& answer) {
        if (answer.prim_id == 2) return verdict_of(HitClass::agree);
        return verdict_of(static_cast<HitClass>(static_cast<int>(ray.org.x)));
    }};
};

TEST(CompareHits, agrees_without_the_judge_on_equal_hits_and_on_common_misses) {
    const auto rays = numbered_rays(2);
    const CastResult same = cast_of({hit_at(1.0f), Hit{}});
    const auto [record, classes, wrong] =
        compare_hits(rays, Query::closest, same, same, unwanted_judge(), without_sample());
    EXPECT_EQ(count(record, HitClass::agree), 2u);
    EXPECT_EQ(record.judged, 0u);
    EXPECT_EQ(record.hit_count, 1u);
    EXPECT_TRUE(record.passed);
    EXPECT_EQ(classes[1], HitClass::agree);
}

TEST(CompareHits, agrees_up_to_sixteen_ulps_of_t_and_judges_beyond) {
    const auto rays = numbered_rays(2);
    const CastResult oracle = cast_of({hit_at(1.0f), hit_at(1.0f)});
    const CastResult answers = cast_of({hit_at(one_plus_ulps(16)), hit_at(one_plus_ulps(17))});
    std::vector<float> judged;
    const FakeJudge judge([&](const Ray& ray, const Hit&) {
        judged.push_back(ray.org.x);
        return verdict_of(HitClass::t_error);
    });
    const auto [record, classes, wrong] =
        compare_hits(rays, Query::closest, answers, oracle, judge, without_sample());
    EXPECT_EQ(judged, (std::vector<float>{1.0f, 1.0f})) << "both answers of ray 1, none of ray 0";
    EXPECT_EQ(classes[0], HitClass::agree);
    EXPECT_EQ(classes[1], HitClass::t_error);
    EXPECT_EQ(record.classes[0].worst->verdict.t_error_ulps, 16.0);
}

TEST(CompareHits, keeps_every_class_apart) {
    const OneOfEachClass setup;
    const auto [record, classes, wrong] =
        compare_hits(setup.rays, Query::closest, setup.answers, setup.oracle, setup.judge);
    for (size_t c = 0; c < kHitClassCount; ++c) {
        EXPECT_EQ(record.classes[c].count, 1u) << to_string(static_cast<HitClass>(c));
        EXPECT_EQ(classes[c], static_cast<HitClass>(c));
        ASSERT_TRUE(record.classes[c].worst);
        EXPECT_EQ(record.classes[c].worst->index, c);
    }
    EXPECT_EQ(record.errors(), 4u);
    EXPECT_EQ(record.oracle_classes[0], kHitClassCount) << "the oracle is judged as well";
    EXPECT_EQ(record.wrong_triangle, kHitClassCount);
}

TEST(CompareHits, fails_for_a_single_ray_of_each_error_class) {
    for (const HitClass bad :
         {HitClass::false_miss, HitClass::false_hit, HitClass::wrong_surface, HitClass::t_error}) {
        const auto rays = numbered_rays(1000);
        CastResult answers = cast_of(std::vector<Hit>(1000, hit_at(1.0f)));
        const CastResult oracle = answers;
        answers.hits[500] = hit_at(2.0f, 7);
        const FakeJudge judge([&](const Ray&, const Hit&) { return verdict_of(bad); });
        const HitCheckOptions options = without_sample();
        const auto comparison = compare_hits(rays, Query::closest, answers, oracle, judge, options);
        EXPECT_FALSE(comparison.record.passed) << to_string(bad);
        EXPECT_EQ(comparison.record.errors(), 1u);
    }
}

TEST(CompareHits, passes_ties_without_bound_and_edges_within_their_budget) {
    const auto rays = numbered_rays(2000);
    const CastResult oracle = cast_of(std::vector<Hit>(2000, hit_at(1.0f)));
    const auto passes = [&](HitClass hit_class, size_t how_many) {
        CastResult answers = oracle;
        for (size_t i = 0; i < how_many; ++i) answers.hits[i].prim_id = 9;
        const FakeJudge judge([&](const Ray&, const Hit&) { return verdict_of(hit_class); });
        return compare_hits(rays, Query::closest, answers, oracle, judge, without_sample())
            .record.passed;
    };
    EXPECT_EQ(edge_budget(2000), 2u);
    EXPECT_TRUE(passes(HitClass::tie, 2000));
    EXPECT_TRUE(passes(HitClass::edge, 2));
    EXPECT_FALSE(passes(HitClass::edge, 3));
}

TEST(CompareHits, takes_allowances_as_bounds) {
    const OneOfEachClass setup;
    HitCheckOptions options;
    const auto passed = [&] {
        return compare_hits(setup.rays, Query::closest, setup.answers, setup.oracle, setup.judge,
                            options)
            .record.passed;
    };
    options.allowed = {{HitClass::false_miss, 1},
                       {HitClass::false_hit, 1},
                       {HitClass::wrong_surface, 1},
                       {HitClass::t_error, 1}};
    EXPECT_TRUE(passed());
    options.allowed[HitClass::wrong_surface] = 0;
    EXPECT_FALSE(passed());
    options.allowed[HitClass::wrong_surface] = 1;
    options.allowed[HitClass::tie] = 0;
    EXPECT_FALSE(passed());
}

TEST(CompareHits, never_agrees_with_a_t_that_is_not_a_number) {
    const auto rays = numbered_rays(1);
    const FakeJudge judge(
        [](const Ray&, const Hit&) { return verdict_of(HitClass::t_error, kInfinity, kNan); });
    const auto comparison = compare_hits(rays, Query::closest, cast_of({hit_at(kNan)}),
                                         cast_of({hit_at(1.0f)}), judge, without_sample());
    EXPECT_EQ(count(comparison.record, HitClass::t_error), 1u);
    EXPECT_FALSE(comparison.record.passed);
}

TEST(CompareHits, judges_a_miss_against_a_hit_and_a_hit_against_a_miss) {
    const auto rays = numbered_rays(2);
    const FakeJudge judge([](const Ray&, const Hit& answer) {
        return verdict_of(answer.is_hit() ? HitClass::false_hit : HitClass::false_miss);
    });
    const auto comparison = compare_hits(rays, Query::closest, cast_of({Hit{}, hit_at(1.0f)}),
                                         cast_of({hit_at(1.0f), Hit{}}), judge, without_sample());
    EXPECT_EQ(count(comparison.record, HitClass::false_miss), 1u);
    EXPECT_EQ(count(comparison.record, HitClass::false_hit), 1u);
    EXPECT_EQ(comparison.record.wrong_triangle, 0u) << "only one of the two hits";
}

TEST(CompareHits, tells_instances_apart) {
    const auto rays = numbered_rays(1);
    const FakeJudge judge(
        [](const Ray&, const Hit&) { return verdict_of(HitClass::wrong_surface); });
    const auto comparison = compare_hits(rays, Query::closest, cast_of({hit_at(1.0f, 3, 0)}),
                                         cast_of({hit_at(1.0f, 3, 1)}), judge, without_sample());
    EXPECT_EQ(comparison.record.wrong_triangle, 1u);
    EXPECT_EQ(count(comparison.record, HitClass::wrong_surface), 1u);
}

TEST(CompareHits, asks_for_no_ids_where_any_hit_will_do) {
    const auto rays = numbered_rays(1);
    const FakeJudge judge([](const Ray&, const Hit&) { return verdict_of(HitClass::agree); });
    const auto comparison = compare_hits(rays, Query::any, cast_of({hit_at(0.5f, 3)}),
                                         cast_of({hit_at(1.0f, 4)}), judge, without_sample());
    EXPECT_EQ(comparison.record.wrong_triangle, 0u);
}

TEST(CompareHits, counts_rays_the_oracle_cannot_take_in_no_class) {
    const auto rays = numbered_rays(3);
    const CastResult answers = cast_of({hit_at(1.0f), hit_at(5.0f, 5), hit_at(1.0f)});
    CastResult oracle = cast_of({hit_at(1.0f), Hit{}, hit_at(1.0f)});
    oracle.flags[1] = kFlagOracleInvalid;
    const auto [record, classes, wrong] =
        compare_hits(rays, Query::closest, answers, oracle, unwanted_judge(), without_sample());
    EXPECT_EQ(record.oracle_invalid, 1u);
    EXPECT_EQ(count(record, HitClass::agree), 2u);
    EXPECT_FALSE(classes[1].has_value());
    EXPECT_TRUE(record.passed);
}

TEST(CompareHits, counts_rays_that_ran_out_of_their_budget) {
    const auto rays = numbered_rays(2);
    CastResult answers = cast_of({Hit{}, Hit{}});
    const CastResult oracle = answers;
    answers.flags[1] = kFlagExhausted;
    const auto comparison =
        compare_hits(rays, Query::closest, answers, oracle, unwanted_judge(), without_sample());
    EXPECT_EQ(comparison.record.exhausted, 1u);
}

TEST(CompareHits, names_the_worst_ray_by_backward_error_then_by_t_error) {
    const auto rays = numbered_rays(5);
    CastResult answers = cast_of(std::vector<Hit>(5, hit_at(1.0f, 1)));
    const CastResult oracle = cast_of(std::vector<Hit>(5, hit_at(1.0f, 2)));
    const double backward[] = {0.2, 0.9, 0.9, 0.9, 0.1};
    const double t_error[] = {99.0, kNan, 5.0, 5.0, 99.0};
    const FakeJudge judge([&](const Ray& ray, const Hit&) {
        const int i = static_cast<int>(ray.org.x);
        return verdict_of(HitClass::edge, backward[i], t_error[i]);
    });
    const auto comparison = compare_hits(rays, Query::closest, answers, oracle, judge);
    const auto& worst = comparison.record.classes[static_cast<size_t>(HitClass::edge)].worst;
    ASSERT_TRUE(worst);
    EXPECT_EQ(worst->index, 2u) << "the first of equals";
    EXPECT_EQ(worst->answer.prim_id, 1u);
    EXPECT_EQ(worst->oracle.prim_id, 2u);
    EXPECT_EQ(worst->ray.org.x, 2.0f);
}

TEST(CompareHits, judges_a_sample_of_the_agreements) {
    const size_t n = 10000;
    const auto rays = numbered_rays(n);
    const CastResult same = cast_of(std::vector<Hit>(n, hit_at(1.0f)));
    const FakeJudge judge(
        [](const Ray&, const Hit&) { return verdict_of(HitClass::wrong_surface); });
    HitCheckOptions options;
    options.agreement_sample = 0.1;
    const CheckRecord record =
        compare_hits(rays, Query::closest, same, same, judge, options).record;
    // Six standard deviations of a binomial count with n = 10000, p = 0.1: 6 * 30.
    EXPECT_NEAR(static_cast<double>(record.judged), 1000.0, 180.0);
    EXPECT_EQ(count(record, HitClass::wrong_surface), record.judged) << "wrong together is wrong";
    EXPECT_EQ(record.oracle_classes[static_cast<size_t>(HitClass::wrong_surface)], record.judged);
    EXPECT_FALSE(record.passed);
    options.seed = 1;
    EXPECT_NE(compare_hits(rays, Query::closest, same, same, judge, options)
                  .record.classes[static_cast<size_t>(HitClass::wrong_surface)]
                  .worst->index,
              record.classes[static_cast<size_t>(HitClass::wrong_surface)].worst->index);
}

TEST(CompareHits, judges_a_ray_once_for_all_tracers_and_the_oracle_with_them) {
    const auto rays = numbered_rays(3);
    const CastResult oracle = cast_of(std::vector<Hit>(3, hit_at(1.0f, 1)));
    CastResult one = oracle;
    one.hits[0] = hit_at(1.0f, 7);
    CastResult other = oracle;
    other.hits[2] = Hit{};
    std::mutex guard;
    std::vector<float> judged;
    const FakeJudge judge([&](const Ray& ray, const Hit& answer) {
        const std::lock_guard lock(guard);
        judged.push_back(ray.org.x);
        if (!answer.is_hit()) return verdict_of(HitClass::false_miss);
        // On ray 2 it is the oracle that is wrong, and who agrees with it.
        if (answer.prim_id == 7 || ray.org.x == 2.0f) return verdict_of(HitClass::wrong_surface);
        return verdict_of(HitClass::agree);
    });
    const std::vector<CastResult> answers = {one, other, oracle};
    const auto rows = compare_hits(rays, Query::closest, answers, oracle, judge, without_sample());
    ASSERT_EQ(rows.size(), 3u);
    std::sort(judged.begin(), judged.end());
    EXPECT_EQ(judged, (std::vector<float>{0.0f, 0.0f, 2.0f, 2.0f}))
        << "two rays, each with its two different answers";
    EXPECT_EQ(count(rows[0].record, HitClass::wrong_surface), 2u);
    EXPECT_EQ(count(rows[1].record, HitClass::false_miss), 1u);
    EXPECT_EQ(count(rows[1].record, HitClass::wrong_surface), 0u);
    EXPECT_EQ(count(rows[2].record, HitClass::wrong_surface), 1u) << "the oracle's own row";
    for (const HitComparison& row : rows) {
        EXPECT_EQ(row.record.judged, 2u);
        EXPECT_EQ(row.record.oracle_classes[static_cast<size_t>(HitClass::wrong_surface)], 1u);
    }
}

TEST(CompareHits, accepts_an_empty_ray_set) {
    const CheckRecord record =
        compare_hits({}, Query::closest, cast_of({}), cast_of({}), unwanted_judge()).record;
    EXPECT_EQ(record.ray_count, 0u);
    EXPECT_TRUE(record.passed);
}

TEST(ParseAllowance, reads_a_class_and_a_bound) {
    EXPECT_EQ(parse_allowance("wrong_surface=300"),
              std::pair(HitClass::wrong_surface, uint64_t{300}));
}

TEST(ParseAllowance, refuses_other_forms) {
    for (const char* text : {"", "edge", "edge=", "=3", "edge=-1", "edge=3x", "nonsense=3"}) {
        EXPECT_THROW(parse_allowance(text), Error) << text;
    }
}

}  // namespace
}  // namespace onepass
