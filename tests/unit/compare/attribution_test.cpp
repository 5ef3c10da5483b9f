// attribute_errors: every wrong ray is counted once, under the first switch that mends it.
#include "compare/attribution.h"

#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"

namespace onepass {
namespace {

/// Ray i has origin x = i. An answer's prim_id says which class the judge gives it.
Hit answer_of_class(HitClass hit_class) {
    return {.t = 1.0f, .prim_id = static_cast<uint32_t>(hit_class), .inst_id = 0};
}

FakeJudge judge_by_answer() {
    return FakeJudge([](const Ray&, const Hit& answer) {
        Verdict verdict;
        verdict.hit_class = static_cast<HitClass>(answer.prim_id);
        return verdict;
    });
}

std::vector<WorstRay> wrong_rays(size_t count) {
    std::vector<WorstRay> wrong(count);
    for (size_t i = 0; i < count; ++i) {
        wrong[i].index = 100 + i;
        wrong[i].ray.org.x = static_cast<float>(i);
        wrong[i].verdict.hit_class = HitClass::wrong_surface;
        wrong[i].verdict.backward_error = static_cast<double>(i % 3);
    }
    return wrong;
}

/// Mends the rays of that number with that class, leaves the others wrong, and notes what it was
/// asked.
Suspect mender(const std::string& id, std::set<int> mended, HitClass into = HitClass::agree,
               std::vector<std::vector<int>>* asked = nullptr) {
    return {id, [=](std::span<const Ray> rays, Query) {
                CastResult result;
                std::vector<int> numbers;
                for (const Ray& ray : rays) {
                    const int number = static_cast<int>(ray.org.x);
                    numbers.push_back(number);
                    result.hits.push_back(
                        answer_of_class(mended.contains(number) ? into : HitClass::wrong_surface));
                }
                if (asked != nullptr) asked->push_back(numbers);
                return result;
            }};
}

using Counts = std::vector<std::pair<std::string, uint64_t>>;

TEST(Attribution, counts_each_wrong_ray_under_the_first_switch_that_mends_it) {
    const std::vector<Suspect> suspects = {mender("A", {0, 2}), mender("B", {1, 2, 3}),
                                           mender("C", {})};
    const Attribution attribution =
        attribute_errors(wrong_rays(6), Query::closest, judge_by_answer(), suspects);
    EXPECT_TRUE(attribution.record.asked);
    EXPECT_EQ(attribution.record.by_deviation, (Counts{{"A", 2}, {"B", 2}, {"C", 0}}));
    EXPECT_EQ(attribution.record.unattributed, 2u);
    EXPECT_EQ(attribution.culprits, (std::vector<std::string>{"A", "B", "A", "B", "", ""}));
}

TEST(Attribution, keeps_the_worst_ray_that_no_switch_mends) {
    const Attribution attribution = attribute_errors(
        wrong_rays(7), Query::closest, judge_by_answer(), std::vector{mender("A", {2, 5})});
    ASSERT_TRUE(attribution.worst_unattributed);
    EXPECT_EQ(attribution.worst_unattributed->index, 101u) << "rays 1 and 4 are the worst left";
}

TEST(Attribution, takes_agreement_ties_and_edges_for_right_and_nothing_else) {
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const HitClass hit_class = static_cast<HitClass>(c);
        const Attribution attribution =
            attribute_errors(wrong_rays(1), Query::closest, judge_by_answer(),
                             std::vector{mender("A", {0}, hit_class)});
        EXPECT_EQ(attribution.record.unattributed, is_error(hit_class) ? 1u : 0u)
            << to_string(hit_class);
    }
}

TEST(Attribution, casts_only_the_rays_that_are_still_unexplained) {
    std::vector<std::vector<int>> asked;
    const std::vector<Suspect> suspects = {mender("A", {0, 2}, HitClass::agree, &asked),
                                           mender("B", {1}, HitClass::agree, &asked),
                                           mender("C", {}, HitClass::agree, &asked)};
    attribute_errors(wrong_rays(3), Query::closest, judge_by_answer(), suspects);
    EXPECT_EQ(asked, (std::vector<std::vector<int>>{{0, 1, 2}, {1}}));
}

TEST(Attribution, leaves_everything_unattributed_without_suspects) {
    const Attribution attribution =
        attribute_errors(wrong_rays(4), Query::closest, judge_by_answer(), {});
    EXPECT_EQ(attribution.record.unattributed, 4u);
    EXPECT_TRUE(attribution.record.by_deviation.empty());
}

TEST(Attribution, asks_the_query_that_was_wrong) {
    Query asked = Query::closest;
    const Suspect suspect = {"A", [&](std::span<const Ray> rays, Query query) {
                                 asked = query;
                                 CastResult result;
                                 result.hits.resize(rays.size());
                                 return result;
                             }};
    attribute_errors(wrong_rays(1), Query::any, judge_by_answer(), std::vector{suspect});
    EXPECT_EQ(asked, Query::any);
}

TEST(Attribution, suspects_are_the_deviations_left_on_each_off_alone) {
    std::vector<ParamValues> made;
    CatalogueEntry entry;
    entry.info.deviations = {{"D1", "slack", "1", ""}, {"D2", "clip", "0", ""}};
    entry.make = [&](const ScenePtr&, const ParamValues& params) {
        made.push_back(params);
        return std::make_unique<FakeTracer>("fake");
    };
    const std::vector<Ray> rays(3);
    for (const Suspect& suspect : suspects_of(entry, nullptr, {{"density", "4"}})) {
        EXPECT_EQ(suspect.cast_without(rays, Query::closest).hits.size(), 3u);
    }
    EXPECT_EQ(made, (std::vector<ParamValues>{{{"density", "4"}, {"slack", "1"}},
                                              {{"clip", "0"}, {"density", "4"}}}));
    const auto left = suspects_of(entry, nullptr, {{"slack", "1"}});
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].id, "D2");
}

}  // namespace
}  // namespace onepass
