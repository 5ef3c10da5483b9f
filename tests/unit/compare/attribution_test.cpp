// attribute_errors: every wrong ray is counted once, under the first switch that mends it.
#include "compare/attribution.h"

#include <map>
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

/// A suspect mends the rays of its numbers into `mended_class` and leaves the others wrong; two at
/// once mend those that `pairs` says as well.
struct Mender {
    std::vector<std::set<int>> mends;
    std::map<std::pair<size_t, size_t>, std::set<int>> pairs = {};
    HitClass mended_class = HitClass::agree;
    std::vector<std::vector<int>>* asked = nullptr;  ///< the rays of each cast

    Suspects suspects() const {
        Suspects result;
        for (size_t s = 0; s < mends.size(); ++s) {
            result.deviations.push_back({std::string(1, static_cast<char>('A' + s)), "", "", ""});
        }
        result.cast_without = [mender = *this](std::span<const size_t> off,
                                               std::span<const Ray> rays, Query) {
            std::set<int> mended;
            for (const size_t s : off)
                mended.insert(mender.mends[s].begin(), mender.mends[s].end());
            if (off.size() == 2) {
                const auto pair = mender.pairs.find({off[0], off[1]});
                if (pair != mender.pairs.end()) {
                    mended.insert(pair->second.begin(), pair->second.end());
                }
            }
            CastResult answers;
            std::vector<int> numbers;
            for (const Ray& ray : rays) {
                numbers.push_back(static_cast<int>(ray.org.x));
                const bool is_mended = mended.contains(numbers.back());
                answers.hits.push_back(
                    answer_of_class(is_mended ? mender.mended_class : HitClass::wrong_surface));
            }
            if (mender.asked != nullptr) mender.asked->push_back(numbers);
            return answers;
        };
        return result;
    }
};

Attribution attribute(size_t count, const Mender& mender) {
    return attribute_errors(wrong_rays(count), Query::closest, judge_by_answer(),
                            mender.suspects());
}

std::vector<std::string> culprit_ids(const Attribution& attribution) {
    std::vector<std::string> ids;
    for (const Culprit& culprit : attribution.culprits) ids.push_back(culprit.id());
    return ids;
}

using Counts = std::vector<std::pair<std::string, uint64_t>>;

TEST(Attribution, counts_each_wrong_ray_under_the_first_switch_that_mends_it) {
    const Attribution attribution = attribute(6, {.mends = {{0, 2}, {1, 2, 3}, {}}});
    EXPECT_TRUE(attribution.record.asked);
    EXPECT_EQ(attribution.record.by_deviation, (Counts{{"A", 2}, {"B", 2}, {"C", 0}}));
    EXPECT_EQ(attribution.record.unattributed, 2u);
    EXPECT_EQ(culprit_ids(attribution), (std::vector<std::string>{"A", "B", "A", "B", "", ""}));
}

TEST(Attribution, tries_two_switches_together_only_where_none_mends_alone) {
    const Attribution attribution =
        attribute(5, {.mends = {{0}, {1}, {}}, .pairs = {{{0, 2}, {1, 2}}, {{1, 2}, {2, 3}}}});
    EXPECT_EQ(attribution.record.by_deviation,
              (Counts{{"A", 1}, {"B", 1}, {"C", 0}, {"A+C", 1}, {"B+C", 1}}));
    EXPECT_EQ(attribution.record.unattributed, 1u);
    EXPECT_EQ(culprit_ids(attribution), (std::vector<std::string>{"A", "B", "A+C", "B+C", ""}));
    EXPECT_EQ(attribution.culprits[2].off.size(), 2u);
}

TEST(Attribution, keeps_the_worst_ray_that_nothing_mends) {
    const Attribution attribution = attribute(7, {.mends = {{2, 5}}});
    ASSERT_TRUE(attribution.worst_unattributed);
    EXPECT_EQ(attribution.worst_unattributed->index, 101u) << "rays 1 and 4 are the worst left";
    EXPECT_FALSE(attribute(2, {.mends = {{0, 1}}}).worst_unattributed);
}

TEST(Attribution, takes_agreement_ties_and_edges_for_right_and_nothing_else) {
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const HitClass hit_class = static_cast<HitClass>(c);
        const Attribution attribution = attribute(1, {.mends = {{0}}, .mended_class = hit_class});
        EXPECT_EQ(attribution.record.unattributed, is_error(hit_class) ? 1u : 0u)
            << to_string(hit_class);
    }
}

TEST(Attribution, casts_only_the_rays_that_are_still_unexplained) {
    std::vector<std::vector<int>> asked;
    attribute(3, {.mends = {{0, 2}, {1}, {}}, .asked = &asked});
    EXPECT_EQ(asked, (std::vector<std::vector<int>>{{0, 1, 2}, {1}}));
}

TEST(Attribution, leaves_everything_unattributed_without_suspects) {
    const Attribution attribution = attribute(4, {});
    EXPECT_EQ(attribution.record.unattributed, 4u);
    EXPECT_TRUE(attribution.record.by_deviation.empty());
}

TEST(Attribution, asks_the_query_that_was_wrong) {
    Query asked = Query::closest;
    Suspects suspects;
    suspects.deviations = {{"A", "", "", ""}};
    suspects.cast_without = [&](std::span<const size_t>, std::span<const Ray> rays, Query query) {
        asked = query;
        CastResult result;
        result.hits.resize(rays.size());
        return result;
    };
    attribute_errors(wrong_rays(1), Query::any, judge_by_answer(), suspects);
    EXPECT_EQ(asked, Query::any);
}

TEST(Attribution, suspects_are_the_deviations_left_on_and_switched_off_as_asked) {
    std::vector<ParamValues> made;
    CatalogueEntry entry;
    entry.info.deviations = {{"D1", "slack", "1", ""}, {"D2", "clip", "0", ""}};
    entry.make = [&](const ScenePtr&, const ParamValues& params) {
        made.push_back(params);
        return std::make_unique<FakeTracer>("fake");
    };
    const std::vector<Ray> rays(3);
    const Suspects suspects = suspects_of(entry, nullptr, {{"density", "4"}});
    for (const std::vector<size_t>& off : {std::vector<size_t>{0}, {1}, {0, 1}}) {
        EXPECT_EQ(suspects.cast_without(off, rays, Query::closest).hits.size(), 3u);
    }
    EXPECT_EQ(made, (std::vector<ParamValues>{{{"density", "4"}, {"slack", "1"}},
                                              {{"clip", "0"}, {"density", "4"}},
                                              {{"clip", "0"}, {"density", "4"}, {"slack", "1"}}}));
    const Suspects left = suspects_of(entry, nullptr, {{"slack", "1"}});
    ASSERT_EQ(left.deviations.size(), 1u);
    EXPECT_EQ(left.deviations[0].id, "D2");
}

}  // namespace
}  // namespace onepass
