// Climbing a ladder: who takes part, what counts as a failure, and what a stop leaves. The tracers
// are fakes, and the judge believes what an answer says of itself.
#include "compare/stress.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

/// An answer of a class: FakeJudge reads it from t, and takes the rest as the backward error.
Hit answer_of(HitClass hit_class, float backward_error = 0.0f) {
    return {.t = static_cast<float>(hit_class), .u = backward_error, .prim_id = 0, .inst_id = 0};
}

Verdict verdict_of(const Hit& answer) {
    return {.hit_class = static_cast<HitClass>(answer.t),
            .true_t = 3.5,
            .true_prim_id = 1,
            .true_inst_id = 0,
            .backward_error = answer.u};
}

/// A rung whose ray number i starts at x = i.
Rung rung_at(double knob) {
    Rung rung;
    rung.knob = knob;
    rung.make_scene = [] { return test::quad_scene(); };
    rung.make_rays = [](const Scene&, size_t count, uint64_t) {
        std::vector<Ray> rays(count);
        for (size_t i = 0; i < count; ++i) rays[i].org.x = static_cast<float>(i);
        return rays;
    };
    return rung;
}

Ladder ladder_of(std::vector<Rung> rungs) {
    return {.id = "steps",
            .title = "Steps",
            .question = "How high?",
            .knob = "height",
            .unit = "m",
            .rungs = std::move(rungs)};
}

struct Stage {
    Catalogue catalogue;
    StressSetup setup;

    Stage() {
        setup.rays = 6;
        setup.make_judge = [](ScenePtr) {
            return std::make_unique<FakeJudge>(
                [](const Ray&, const Hit& answer) { return verdict_of(answer); });
        };
    }

    /// A contestant whose tracer `prepare` has the last word on.
    void add(const std::string& name, const std::function<void(FakeTracer&)>& prepare) {
        CatalogueEntry entry;
        entry.info.name = name;
        entry.make = [=](ScenePtr, const ParamValues&) {
            auto tracer = std::make_unique<FakeTracer>(name);
            prepare(*tracer);
            return tracer;
        };
        catalogue.add(std::move(entry));
        names.push_back(name);
    }

    LadderRecord run(const Ladder& ladder, const Progress& progress = {}) {
        setup.contestants.clear();
        for (const std::string& name : names) setup.contestants.push_back({&catalogue.at(name)});
        return climb(ladder, setup, progress);
    }

    std::vector<std::string> names;
};

uint64_t count_of(const RungRecord& rung, const std::string& kind) {
    for (const FailureCount& failure : rung.failures) {
        if (failure.kind == kind) return failure.count;
    }
    return 0;
}

TEST(Stress, every_answer_is_judged_and_only_error_classes_fail) {
    Stage stage;
    stage.add("one", [](FakeTracer& tracer) {
        tracer.answer = [](const Ray& ray) {
            constexpr HitClass kClasses[] = {HitClass::agree,      HitClass::tie,
                                             HitClass::edge,       HitClass::false_miss,
                                             HitClass::false_miss, HitClass::wrong_surface};
            return answer_of(kClasses[static_cast<int>(ray.org.x)]);
        };
    });
    const LadderRecord ladder = stage.run(ladder_of({rung_at(7.0)}));
    EXPECT_EQ(ladder.id, "steps");
    EXPECT_EQ(ladder.unit, "m");
    EXPECT_EQ(ladder.judge, "fake judge");
    ASSERT_EQ(ladder.rungs.size(), 1u);
    const RungRecord& rung = ladder.rungs[0];
    EXPECT_EQ(rung.knob, 7.0);
    EXPECT_EQ(rung.trials, 6u);
    EXPECT_EQ(rung.ties, 1u);
    EXPECT_EQ(rung.edges, 1u);
    EXPECT_EQ(rung.failed(), 3u);
    EXPECT_EQ(count_of(rung, "false_miss"), 2u);
    EXPECT_EQ(count_of(rung, "wrong_surface"), 1u);
    EXPECT_EQ(rung.refusal, "");
}

TEST(Stress, the_truth_about_a_ray_is_asked_for_once_with_each_distinct_answer) {
    struct CountingJudge final : Judge {
        std::atomic<size_t>* calls;
        std::atomic<size_t>* answers;
        std::string_view name() const override { return "counting"; }
        std::vector<Verdict> judge(const Ray&, Query, std::span<const Hit> hits) const override {
            ++*calls;
            *answers += hits.size();
            std::vector<Verdict> verdicts;
            for (const Hit& hit : hits) verdicts.push_back(verdict_of(hit));
            return verdicts;
        }
        RayTruth explain(const Ray&, std::span<const Hit>) const override { return {}; }
    };
    std::atomic<size_t> calls = 0;
    std::atomic<size_t> answers = 0;
    Stage stage;
    stage.setup.make_judge = [&](ScenePtr) {
        auto judge = std::make_unique<CountingJudge>();
        judge->calls = &calls;
        judge->answers = &answers;
        return judge;
    };
    const auto always = [](const Hit& hit) {
        return [=](FakeTracer& tracer) { tracer.answer = [=](const Ray&) { return hit; }; };
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    stage.add("right", always(answer_of(HitClass::agree)));
    stage.add("its twin", always(answer_of(HitClass::agree)));
    stage.add("wrong", always(answer_of(HitClass::t_error)));
    stage.add("odd", always({.t = 0.0f, .u = nan, .prim_id = 0, .inst_id = 0}));
    stage.add("as odd", always({.t = 0.0f, .u = nan, .prim_id = 0, .inst_id = 0}));
    const LadderRecord ladder = stage.run(ladder_of({rung_at(1.0)}));
    EXPECT_EQ(calls, 6u);
    EXPECT_EQ(answers, 18u) << "NaN is equal to itself here";
    ASSERT_EQ(ladder.rungs.size(), 5u);
    EXPECT_EQ(ladder.rungs[0].failed(), 0u);
    EXPECT_EQ(ladder.rungs[1].failed(), 0u);
    EXPECT_EQ(ladder.rungs[2].failed(), 6u);
}

TEST(Stress, an_exhausted_ray_fails_once_and_by_that_name) {
    Stage stage;
    stage.add("tired", [](FakeTracer& tracer) {
        tracer.answer = [](const Ray& ray) {
            return answer_of(ray.org.x < 2.0f ? HitClass::false_miss : HitClass::agree);
        };
        tracer.flag = [](const Ray& ray) { return ray.org.x < 3.0f ? kFlagExhausted : 0u; };
    });
    const RungRecord rung = stage.run(ladder_of({rung_at(1.0)})).rungs.at(0);
    EXPECT_EQ(count_of(rung, "exhausted"), 3u);
    EXPECT_EQ(rung.failed(), 3u);
}

TEST(Stress, rays_that_a_tracer_cannot_take_are_neither_trials_nor_failures) {
    Stage stage;
    const auto takes_from = [](float x) {
        return [=](FakeTracer& tracer) {
            tracer.answer = [](const Ray&) { return answer_of(HitClass::false_miss); };
            tracer.flag = [=](const Ray& ray) { return ray.org.x < x ? kFlagOracleInvalid : 0u; };
        };
    };
    stage.add("some", takes_from(4.0f));
    stage.add("none", takes_from(99.0f));
    const LadderRecord ladder = stage.run(ladder_of({rung_at(1.0)}));
    EXPECT_EQ(ladder.rungs[0].trials, 2u);
    EXPECT_EQ(ladder.rungs[0].failed(), 2u);
    EXPECT_EQ(ladder.rungs[0].refusal, "takes 2 of 6 rays");
    EXPECT_EQ(ladder.rungs[1].trials, 0u);
    EXPECT_EQ(ladder.rungs[1].failed(), 0u);
    EXPECT_EQ(ladder.rungs[1].refusal, "takes 0 of 6 rays");
}

TEST(Stress, who_cannot_be_made_refuses_and_who_gives_up_later_fails_and_the_others_go_on) {
    Stage stage;
    stage.add("throws", [](FakeTracer&) {
        throw Error({"texture 'cells'", "9 texels", "8", "Make it smaller."});
    });
    stage.add("throws late", [](FakeTracer& tracer) {
        tracer.answer = [](const Ray&) -> Hit { throw Error({"fetch", "texel 9", "8", ""}); };
    });
    stage.add("sound", [](FakeTracer& tracer) {
        tracer.answer = [](const Ray&) { return answer_of(HitClass::agree); };
    });
    const LadderRecord ladder = stage.run(ladder_of({rung_at(1.0)}));
    ASSERT_EQ(ladder.rungs.size(), 3u);
    EXPECT_EQ(ladder.rungs[0].refusal, "texture 'cells': 9 texels");
    EXPECT_EQ(ladder.rungs[1].refusal, "");
    EXPECT_EQ(ladder.rungs[1].trials, 6u);
    EXPECT_EQ(count_of(ladder.rungs[1], "gave_up"), 6u);
    EXPECT_EQ(ladder.rungs[2].refusal, "");
    EXPECT_EQ(ladder.rungs[2].trials, 6u);
    EXPECT_EQ(breaks_at(ladder, "throws", ""), nullptr);
}

TEST(Stress, a_rungs_parameter_goes_to_those_who_have_it_and_the_others_sit_it_out) {
    Stage stage;
    stage.add("without", [](FakeTracer&) {});
    std::vector<ParamValues> given;
    CatalogueEntry with;
    with.info.name = "with";
    with.info.params.resize(2);
    with.info.params[0].name = "size";
    with.info.params[1].name = "colour";
    with.make = [&](ScenePtr, const ParamValues& values) {
        given.push_back(values);
        auto tracer = std::make_unique<FakeTracer>("with");
        tracer->answer = [](const Ray&) { return answer_of(HitClass::agree); };
        return tracer;
    };
    stage.catalogue.add(std::move(with));
    Rung plain = rung_at(1.0);
    Rung sized = rung_at(2.0);
    sized.params = {{"size", "4"}, {"taste", "sweet"}};
    stage.setup.contestants = {{&stage.catalogue.at("without")},
                               {&stage.catalogue.at("with"), {{"colour", "red"}}}};
    const LadderRecord ladder = climb(ladder_of({plain, sized}), stage.setup);
    ASSERT_EQ(ladder.rungs.size(), 3u);
    EXPECT_EQ(ladder.rungs[0].tracer, "without");
    EXPECT_EQ(ladder.rungs[2].tracer, "with");
    EXPECT_EQ(ladder.rungs[2].setting, "colour=red") << "the same on every rung";
    EXPECT_EQ(given[0], (ParamValues{{"colour", "red"}}));
    EXPECT_EQ(given[1], (ParamValues{{"colour", "red"}, {"size", "4"}}));
}

TEST(Stress, the_worst_failure_is_kept_with_its_ray_and_the_truth) {
    Stage stage;
    stage.add("one", [](FakeTracer& tracer) {
        tracer.answer = [](const Ray& ray) {
            if (ray.org.x == 5.0f) return answer_of(HitClass::edge, 9.0f);
            return answer_of(HitClass::t_error, ray.org.x == 2.0f ? 8.0f : 1.0f);
        };
    });
    const RungRecord rung = stage.run(ladder_of({rung_at(1.0)})).rungs.at(0);
    ASSERT_TRUE(rung.worst.has_value());
    EXPECT_EQ(rung.worst->index, 2u) << "an edge is no failure";
    EXPECT_EQ(rung.worst->ray.org.x, 2.0f);
    EXPECT_EQ(rung.worst->answer, answer_of(HitClass::t_error, 8.0f));
    EXPECT_EQ(rung.worst->oracle.t, 3.5f);
    EXPECT_EQ(rung.worst->oracle.prim_id, 1u);
}

TEST(Stress, stopped_it_returns_the_rungs_that_were_finished) {
    Stage stage;
    stage.add("one", [](FakeTracer&) {});
    stage.add("two", [](FakeTracer&) {});
    double last = -1.0;
    const LadderRecord ladder =
        stage.run(ladder_of({rung_at(1.0), rung_at(2.0), rung_at(3.0)}), [&](double done) {
            EXPECT_GE(done, last);
            last = done;
            return done < 0.5;
        });
    ASSERT_EQ(ladder.rungs.size(), 2u) << "half of the second rung";
    EXPECT_EQ(ladder.rungs[1].knob, 1.0);
}

TEST(Stress, a_rung_can_name_a_kind_of_ray_instead_of_making_its_own) {
    Stage stage;
    std::vector<Ray> seen;
    std::mutex lock;
    stage.add("one", [&](FakeTracer& tracer) {
        tracer.answer = [&](const Ray& ray) {
            const std::scoped_lock guard(lock);
            seen.push_back(ray);
            return answer_of(HitClass::agree);
        };
    });
    stage.setup.make_oracle = [](ScenePtr) { return std::make_unique<FakeTracer>("oracle"); };
    Rung rung = rung_at(1.0);
    rung.ray_kind = "vertex";
    EXPECT_EQ(stage.run(ladder_of({rung})).rungs.at(0).trials, 6u);
    for (const Ray& ray : seen) {
        const vec3 target = ray.org + ray.dir;
        EXPECT_NEAR(std::abs(target.x), 1.0f, 1e-5f) << "a corner of the quad";
    }
}

TEST(Stress, those_who_outlast_a_tracer_take_part_where_it_fails_and_have_not_failed_yet) {
    const auto rung = [](double knob, const char* tracer, uint64_t failures, uint64_t trials = 9) {
        RungRecord record{.knob = knob, .tracer = tracer, .trials = trials};
        if (failures > 0) record.failures = {{"leak", failures}};
        return record;
    };
    LadderRecord ladder;
    ladder.rungs = {rung(1, "early", 2), rung(1, "middle", 0), rung(1, "equal", 0),
                    rung(1, "late", 0),  rung(1, "never", 0),  rung(1, "gone", 0),
                    rung(2, "early", 0), rung(2, "middle", 1), rung(2, "equal", 1),
                    rung(2, "late", 0),  rung(2, "never", 0),  rung(2, "gone", 0, 0),
                    rung(3, "early", 1), rung(3, "late", 4),   rung(3, "never", 0)};
    const auto names = [&](const char* tracer) {
        std::vector<std::string> found;
        for (const RungRecord* r : outlasting(ladder, tracer, "")) found.push_back(r->tracer);
        return found;
    };
    EXPECT_EQ(names("middle"), (std::vector<std::string>{"late", "never"}));
    EXPECT_EQ(names("late"), (std::vector<std::string>{"never"}));
    EXPECT_EQ(names("never"), (std::vector<std::string>{}));
}

}  // namespace
}  // namespace onepass
