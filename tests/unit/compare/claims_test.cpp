// The claims as data, the rules of their verdicts, and experiments run on fake tracers.
#include "compare/claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "compare/experiments.h"
#include "core/error.h"
#include "tests/support/errors.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

// ---- Verdicts.

ClaimMeasurement measured(Expectation expectation, double bound, double low, double high,
                          double noise = 0.0) {
    ClaimMeasurement m;
    m.expectation = expectation;
    m.bound = bound;
    m.ratio = 0.5 * (low + high);
    m.ratio_low = low;
    m.ratio_high = high;
    m.noise = noise;
    m.baseline_samples = m.variant_samples = {1.0};
    return m;
}

TEST(Verdict, holds_or_fails_only_when_the_interval_excludes_the_bound) {
    using enum Expectation;
    EXPECT_EQ(verdict_of(measured(above, 1.0, 1.1, 1.3)), ClaimVerdict::holds);
    EXPECT_EQ(verdict_of(measured(above, 1.0, 0.9, 1.3)), ClaimVerdict::depends);
    EXPECT_EQ(verdict_of(measured(above, 1.0, 0.7, 0.9)), ClaimVerdict::fails);
    EXPECT_EQ(verdict_of(measured(below, 2.0, 1.1, 1.3)), ClaimVerdict::holds);
    EXPECT_EQ(verdict_of(measured(below, 2.0, 1.9, 2.1)), ClaimVerdict::depends);
    EXPECT_EQ(verdict_of(measured(below, 2.0, 2.1, 2.3)), ClaimVerdict::fails);
}

TEST(Verdict, widens_the_interval_by_the_noise_on_both_sides) {
    using enum Expectation;
    EXPECT_EQ(verdict_of(measured(above, 1.0, 1.1, 1.3, 0.09)), ClaimVerdict::holds);
    EXPECT_EQ(verdict_of(measured(above, 1.0, 1.1, 1.3, 0.11)), ClaimVerdict::depends);
    EXPECT_EQ(verdict_of(measured(above, 1.0, 0.7, 0.9, 0.1)), ClaimVerdict::fails);
    EXPECT_EQ(verdict_of(measured(above, 1.0, 0.7, 0.9, 0.12)), ClaimVerdict::depends);
    EXPECT_EQ(verdict_of(measured(below, 1.0, 0.7, 0.9, 0.12)), ClaimVerdict::depends);
}

TEST(Verdict, of_counts_is_sharp_and_equality_does_not_pass) {
    using enum Expectation;
    EXPECT_EQ(verdict_of(measured(above, 1.0, 1.0, 1.0)), ClaimVerdict::fails);
    EXPECT_EQ(verdict_of(measured(below, 1.0, 1.0, 1.0)), ClaimVerdict::fails);
    EXPECT_EQ(verdict_of(measured(below, kLittle, 1.0, 1.0)), ClaimVerdict::holds);
}

TEST(Verdict, needs_samples_of_both_sides_and_a_ratio) {
    ClaimMeasurement m = measured(Expectation::above, 1.0, 2.0, 2.0);
    m.variant_samples.clear();
    EXPECT_EQ(verdict_of(m), ClaimVerdict::not_measured);
    m = measured(Expectation::above, 1.0, 2.0, 2.0);
    m.ratio = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(verdict_of(m), ClaimVerdict::not_measured);
    EXPECT_EQ(verdict_of(measured(Expectation::none, 1.0, 2.0, 2.0)), ClaimVerdict::not_measured);
}

ClaimMeasurement decided(const std::string& scene, ClaimVerdict verdict) {
    ClaimMeasurement m;
    m.scene = scene;
    m.verdict = verdict;
    return m;
}

TEST(ClaimVerdict, depends_when_measurements_disagree_and_leaves_out_what_was_not_measured) {
    using enum ClaimVerdict;
    const auto of = [](const std::vector<ClaimVerdict>& verdicts) {
        std::vector<ClaimMeasurement> all;
        for (const ClaimVerdict verdict : verdicts) all.push_back(decided("a", verdict));
        return verdict_of(all, Reading::each);
    };
    EXPECT_EQ(of({holds, holds, not_measured}), holds);
    EXPECT_EQ(of({fails, not_measured, fails}), fails);
    EXPECT_EQ(of({holds, fails}), depends);
    EXPECT_EQ(of({holds, depends}), depends);
    EXPECT_EQ(of({not_measured}), not_measured);
    EXPECT_EQ(of({}), not_measured);
}

TEST(ClaimVerdict, of_a_sweep_is_the_worst_of_each_scene) {
    using enum ClaimVerdict;
    const std::vector<ClaimMeasurement> beaten_everywhere = {
        decided("a", holds), decided("a", fails), decided("b", fails), decided("b", depends)};
    EXPECT_EQ(verdict_of(beaten_everywhere, Reading::worst), fails);
    EXPECT_EQ(verdict_of(beaten_everywhere, Reading::each), depends);
    EXPECT_EQ(verdict_of({decided("a", fails), decided("b", holds)}, Reading::worst), depends);
}

TEST(Finding, gives_ratios_by_quantity_the_crossing_and_what_is_missing) {
    Claim claim;
    claim.compares = "b against a";
    claim.reading = Reading::series;
    std::vector<ClaimMeasurement> all;
    for (const auto& [size, ratio, verdict] :
         {std::tuple{16.0, 0.5, ClaimVerdict::fails}, std::tuple{64.0, 1.0, ClaimVerdict::depends},
          std::tuple{256.0, 4.0, ClaimVerdict::holds}}) {
        ClaimMeasurement m = measured(Expectation::above, 1.0, ratio, ratio);
        m.quantity = "time";
        m.size = size;
        m.verdict = verdict;
        all.push_back(m);
    }
    all.push_back(decided("c", ClaimVerdict::not_measured));
    all.back().expectation = Expectation::above;
    const std::string text = finding_of(claim, all);
    for (const char* part : {"b against a: time × 0.5 to 4", "up to 16", "from 256",
                             "1 of 4 within the noise", "1 of 4 could not"}) {
        EXPECT_TRUE(test::contains(text, part));
    }
}

TEST(FetchedBytes, counts_texels_by_their_size) {
    // 3 cells of 4 channels, 5 references of 2; 4 of them lead to tests of 3 texels, 1 to an
    // instance of 4 texels and its grid of 4.
    const std::vector<RayCounters> one = {{.cells = 3, .tests = 4, .references = 5, .rays = 1}};
    EXPECT_EQ(fetched_bytes(one, 32.0), (12 + 10) * 4 + (12 + 8) * 16);
    EXPECT_EQ(fetched_bytes(one, 16.0), (12 + 10) * 2 + (12 + 8) * 16);
}

// ---- The list.

TEST(PaperClaims, are_told_apart_and_complete) {
    std::set<std::string> ids;
    for (const Claim& claim : paper_claims()) {
        EXPECT_TRUE(ids.insert(claim.id).second) << claim.id;
        for (const std::string& text :
             {claim.claim, claim.source, claim.then, claim.compares, claim.rule}) {
            EXPECT_FALSE(text.empty()) << claim.id;
        }
        EXPECT_FALSE(claim.experiments.empty()) << claim.id;
        for (const Experiment& experiment : claim.experiments) {
            EXPECT_FALSE(experiment.scene.empty()) << claim.id;
            EXPECT_FALSE(experiment.variants.empty()) << claim.id;
            EXPECT_FALSE(experiment.probes.empty()) << claim.id;
        }
    }
    EXPECT_THROW(find_claim("no-such-claim"), Error);
    EXPECT_EQ(find_claim("single-pass").id, "single-pass");
}

TEST(Setting, is_named_by_what_sets_it_apart) {
    EXPECT_EQ(label_of({"paper/texture2d/*"}), "paper/texture2d");
    EXPECT_EQ(label_of({"paper/texture2d/*", {{"address", "half"}, {"density", "2"}}}),
              "paper/texture2d (address=half, density=2)");
    EXPECT_EQ(label_of({"embree/fast/threads", {}, SceneForm::flattened}),
              "embree/fast/threads, one flat grid");
}

// ---- Experiments.

/// Fakes by strategy: parameter "ms" sets how long a cast takes, "fail" makes it refuse.
class Experiments : public testing::Test {
  protected:
    Experiments() {
        for (const char* name : {"grid/x/fragment", "grid/x/compute", "truth/x/y"}) {
            TracerInfo info;
            info.name = name;
            info.params = {{"ms", ParamInfo::Type::real, "2", "", {}},
                           {"fail", ParamInfo::Type::integer, "0", "", {}},
                           {"bytes", ParamInfo::Type::real, "1048576", "", {}},
                           {"misses", ParamInfo::Type::integer, "0", "", {}}};
            catalogue.add({info, [info](ScenePtr, const ParamValues& values) {
                               return make(info, Params(info.name, info.params, values));
                           }});
        }
        workshop.catalogue = &catalogue;
        workshop.scene = [this](const std::string& name, SceneForm form) {
            if (name != "quad") throw Error({name, "no scene", "one", "None."});
            forms.push_back(form);
            return std::make_shared<const Scene>(test::quad_scene());
        };
        workshop.referees = [this](const ScenePtr& scene) {
            return Referees{catalogue.at("truth/x/y").make(scene, {}),
                            std::make_unique<FakeJudge>([](const Ray&, const Hit& hit) {
                                Verdict verdict;
                                if (!hit.is_hit()) verdict.hit_class = HitClass::false_miss;
                                return verdict;
                            })};
        };
        workshop.poses = [](const Scene&, uint32_t frames) {
            return std::vector<std::vector<Affine>>(frames, {affine_identity()});
        };
        workshop.timing = {.repetitions = 9, .warm_up_rounds = 0, .warm_up_ms = 0.0, .seed = 1};
        workshop.frames = 3;
    }

    static std::unique_ptr<Tracer> make(const TracerInfo& info, const Params& params) {
        if (params.integer("fail")) throw Error({info.name, "too much", "less", "Give less."});
        auto tracer = std::make_unique<FakeTracer>(info.name);
        tracer->cast_ms = params.real("ms");
        tracer->frame_ms = params.real("ms");
        tracer->update_times = {0.125, 0.0625};
        tracer->figures = {{"device_bytes", params.real("bytes"), ""}};
        const bool misses = params.integer("misses") != 0;
        tracer->answer = [misses](const Ray&) { return misses ? Hit{} : Hit{5, 0, 0, 0, 0}; };
        return tracer;
    }

    ClaimRecord run(Experiment experiment, Reading reading = Reading::each) {
        Claim claim;
        claim.id = "test";
        claim.reading = reading;
        claim.experiments = {std::move(experiment)};
        EXPECT_TRUE(run_claim(claim, "fragment", workshop, {}, results));
        EXPECT_EQ(results.claims.size(), 1u);
        return results.claims.front();
    }

    static Experiment experiment(Setting variant, Probe probe) {
        return {"quad", "primary", 16, {"grid/x/*"}, {std::move(variant)}, {probe}};
    }

    Catalogue catalogue;
    Workshop workshop;
    std::vector<SceneForm> forms;
    Results results;
};

TEST_F(Experiments, time_both_sides_and_the_baseline_twice) {
    const ClaimRecord claim =
        run(experiment({"grid/x/*", {{"ms", "6"}}}, {Quantity::time, Expectation::above, 1.0}));
    ASSERT_EQ(claim.measurements.size(), 1u);
    const ClaimMeasurement& m = claim.measurements[0];
    EXPECT_EQ(m.failure, "");
    EXPECT_EQ(m.baseline_samples, std::vector<double>(9, 2.0));
    EXPECT_EQ(m.variant_samples, std::vector<double>(9, 6.0));
    EXPECT_EQ(m.again_samples, std::vector<double>(9, 2.0));
    EXPECT_EQ(m.ratio, 3.0);
    EXPECT_EQ(m.noise, 0.0);
    EXPECT_EQ(m.rays, 256u);
    EXPECT_EQ(m.variant, "grid/x (ms=6)");
    EXPECT_EQ(claim.verdict, ClaimVerdict::holds);
    EXPECT_EQ(claim.entry, "fragment");
    EXPECT_TRUE(test::contains(claim.command, "--claim test --entry fragment"));
}

TEST_F(Experiments, give_the_errors_of_both_sides_on_the_rays) {
    const ClaimRecord claim = run(
        experiment({"grid/x/*", {{"misses", "1"}}}, {Quantity::errors, Expectation::above, 1.0}));
    const ClaimMeasurement& m = claim.measurements[0];
    EXPECT_EQ(m.baseline_errors, 0u);
    EXPECT_EQ(m.variant_errors, 256u);
    EXPECT_TRUE(std::isinf(m.ratio)) << "from none to some";
    EXPECT_EQ(claim.verdict, ClaimVerdict::holds);
}

TEST_F(Experiments, cast_more_rays_in_a_large_workshop_unless_their_number_is_fixed) {
    Experiment e = experiment({"grid/x/*"}, {Quantity::memory, Expectation::above, 1.0});
    workshop.grow = 4;
    EXPECT_EQ(image_side(workshop, e), 64u);
    e.fixed_side = true;
    EXPECT_EQ(image_side(workshop, e), 16u);
    e.side = 512;
    workshop.shrink = 8;
    EXPECT_EQ(image_side(workshop, e), 64u);
    workshop.shrink = 512;
    EXPECT_EQ(image_side(workshop, e), kLeastSide);
}

TEST_F(Experiments, grant_no_speed_to_a_tracer_that_is_wrong) {
    const ClaimRecord claim = run(experiment({"grid/x/*", {{"misses", "1"}, {"ms", "1"}}},
                                             {Quantity::time, Expectation::below, 1.0}));
    EXPECT_EQ(claim.verdict, ClaimVerdict::not_measured);
    EXPECT_TRUE(test::contains(claim.measurements[0].failure, "errs on 256 of 256 rays"));
}

TEST_F(Experiments, count_memory_once_and_exactly) {
    const ClaimRecord claim = run(experiment({"grid/x/*", {{"bytes", "3145728"}}},
                                             {Quantity::memory, Expectation::below, 2.0}));
    const ClaimMeasurement& m = claim.measurements[0];
    EXPECT_EQ(m.baseline_samples, std::vector<double>{1.0}) << "MiB";
    EXPECT_EQ(m.ratio, 3.0);
    EXPECT_EQ(m.ratio_low, 3.0);
    EXPECT_EQ(claim.verdict, ClaimVerdict::fails);
}

TEST_F(Experiments, hand_each_setting_the_scene_in_its_form) {
    run(experiment({"grid/x/*", {}, SceneForm::flattened},
                   {Quantity::memory, Expectation::above, 1.0}));
    EXPECT_EQ(forms, (std::vector<SceneForm>{SceneForm::as_is, SceneForm::flattened}));
}

TEST_F(Experiments, leave_unmeasured_what_is_not_there_and_say_why) {
    for (const auto& [variant, word] :
         {std::pair{Setting{"gone/x/*"}, "gone"},
          std::pair{Setting{"grid/x/*", {{"no", "1"}}}, "no"},
          std::pair{Setting{"grid/x/*", {{"fail", "1"}}}, "too much"}}) {
        results = {};
        const ClaimRecord claim =
            run(experiment(variant, {Quantity::time, Expectation::above, 1.0}));
        EXPECT_EQ(claim.verdict, ClaimVerdict::not_measured);
        EXPECT_TRUE(test::contains(claim.measurements.at(0).failure, word));
        EXPECT_TRUE(test::contains(claim.now, "1 of 1"));
    }
    Experiment elsewhere = experiment({"grid/x/*"}, {Quantity::time, Expectation::above, 1.0});
    elsewhere.scene = "nowhere";
    results = {};
    EXPECT_TRUE(test::contains(run(elsewhere).measurements.at(0).failure, "nowhere"));
}

TEST_F(Experiments, tell_a_refusal_from_what_does_not_exist) {
    const Probe possible{Quantity::errors, Expectation::possible, 1.0};
    EXPECT_EQ(run(experiment({"grid/x/*", {{"fail", "1"}}}, possible)).verdict,
              ClaimVerdict::fails);
    results = {};
    EXPECT_EQ(run(experiment({"gone/x/*"}, possible)).verdict, ClaimVerdict::not_measured);
    results = {};
    EXPECT_EQ(run(experiment({"grid/x/*"}, possible)).verdict, ClaimVerdict::holds);
}

TEST_F(Experiments, set_an_animations_update_against_its_tracing) {
    Experiment moving{"quad",
                      "animation",
                      16,
                      {"grid/x/*"},
                      {{"grid/x/*"}, {"truth/x/y"}},
                      {{Quantity::update, Expectation::below, 0.1}}};
    const ClaimRecord claim = run(moving);
    ASSERT_EQ(claim.measurements.size(), 2u);
    EXPECT_EQ(claim.measurements[0].ratio, 0.09375) << "0.1875 ms of 2 ms";
    EXPECT_EQ(claim.measurements[0].verdict, ClaimVerdict::holds);
    EXPECT_EQ(claim.measurements[1].expectation, Expectation::none) << "shown beside";
    EXPECT_EQ(claim.verdict, ClaimVerdict::holds);
    ASSERT_EQ(results.frame_timings.size(), 2u);
    EXPECT_EQ(results.frame_timings[0].tracer, "grid/x/fragment");
    EXPECT_EQ(results.frame_timings[1].tracer, "truth/x/y");
    EXPECT_EQ(results.frame_timings[0].scene, "quad");
}

TEST_F(Experiments, leave_nothing_behind_when_stopped) {
    Claim claim;
    claim.experiments = {experiment({"grid/x/*"}, {Quantity::time, Expectation::above, 1.0})};
    int calls = 0;
    EXPECT_FALSE(run_claim(
        claim, "fragment", workshop, [&](double) { return ++calls < 4; }, results));
    EXPECT_TRUE(results.claims.empty());
}

}  // namespace
}  // namespace onepass
