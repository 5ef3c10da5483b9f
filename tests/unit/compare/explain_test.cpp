// Explanations of one ray over a judge and tracers whose words are written down here.
#include "compare/explain.h"

#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

Hit hit(float t, uint32_t prim_id) {
    return {.t = t, .u = 0.25f, .v = 0.5f, .prim_id = prim_id, .inst_id = 0};
}

/// Triangle 0 is hit and right, triangle 1 is passed by.
FakeJudge judge_of(HitClass hit_class) {
    FakeJudge judge([hit_class](const Ray&, const Hit&) {
        Verdict verdict;
        verdict.hit_class = hit_class;
        verdict.t_error_ulps = 3.0;
        verdict.backward_error = 0.5;
        return verdict;
    });
    Meeting right;
    right.inst_id = 0;
    right.prim_id = 0;
    right.crosses = right.is_right = true;
    right.t = 0.5;
    right.t_digits = "0.5";
    right.edge_moves = 0.25;
    right.edge = 2;
    Meeting beside = right;
    beside.prim_id = 1;
    beside.crosses = beside.is_right = false;
    beside.u = -0.125;
    beside.v = 0.5;
    beside.edge_moves = 40.0;
    judge.truth.hits = {right};
    judge.truth.passed = {beside};
    judge.truth.miss_is_right = false;
    return judge;
}

/// A tracer that walks two cells and answers `answer`.
FakeTracer walker(const Hit& answer, std::vector<WalkTest> tests) {
    FakeTracer tracer("fake/grid/twin32");
    tracer.answer = [answer](const Ray&) { return answer; };
    tracer.abilities.walks = true;
    tracer.cells = {ivec3(4, 5, 6), ivec3(4, 5, 7)};
    RayWalk walk;
    walk.steps = {{kNoId, ivec3(0), {}}, {0, ivec3(4, 5, 6), std::move(tests)}};
    walk.hit = answer;
    walk.counters = {.cells = 2, .tests = 1, .references = 0, .rays = 1};
    tracer.way = walk;
    return tracer;
}

std::string reasons_of(const Statement& statement) {
    std::string all;
    for (const std::string& reason : statement.reasons) all += reason + "\n";
    return all;
}

std::string explained(const FakeJudge& judge, FakeTracer& tracer) {
    Tracer* const tracers[] = {&tracer};
    return reasons_of(explain_ray(Ray{}, judge, tracers).statements[0]);
}

#define EXPECT_SAYS(text, words) EXPECT_NE((text).find(words), std::string::npos) << (text)
#define EXPECT_SILENT(text, words) EXPECT_EQ((text).find(words), std::string::npos) << (text)

TEST(RayText, reads_back_bit_by_bit) {
    Ray ray;
    ray.org = {0.1f, -0.0f, 1e-45f};
    ray.dir = {-3.4028235e38f, 1.0f / 3.0f, 0x1.fffffep-127f};
    for (const float tmax : {kInfinity, 0.3f}) {
        ray.tmax = tmax;
        const Ray read = parse_ray(ray_text(ray));
        EXPECT_EQ(std::memcmp(&read, &ray, sizeof(ray)), 0) << ray_text(ray);
    }
    ray.tmax = kInfinity;
    EXPECT_EQ(std::count(ray_text(ray).begin(), ray_text(ray).end(), ','), 5);
    EXPECT_EQ(parse_ray("0x1.8p1,0,0,inf,0,nan,0.5,1").org.x, 3.0f);
}

TEST(RayText, of_another_form_is_refused) {
    for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,3,4,5,6,7,8,9",
                             "1,2,3,4,5,x", "1,2,3,4,5,6,", "1, 2,3,4,5,6;", "1,2,3,4,5,6 7"}) {
        EXPECT_THROW(parse_ray(text), Error) << text;
    }
}

TEST(Explain, a_right_answer_needs_no_reason) {
    FakeTracer tracer = walker(hit(0.5f, 0), {{0, true, 0.5}});
    EXPECT_EQ(explained(judge_of(HitClass::agree), tracer), "");
}

TEST(Explain, a_triangle_that_was_never_tested_names_its_cells) {
    FakeTracer tracer = walker(Hit{}, {});
    const std::string reasons = explained(judge_of(HitClass::false_miss), tracer);
    EXPECT_SAYS(reasons, "the true triangle 0 of instance 0 was never tested");
    EXPECT_SAYS(reasons, "it lies in (4, 5, 7), not visited");
    EXPECT_SAYS(reasons, "its cell (4, 5, 6) was visited");
    EXPECT_SAYS(reasons, "ended in top-level cell (0, 0, 0), without a hit");

    tracer.way->steps.pop_back();
    EXPECT_SAYS(explained(judge_of(HitClass::false_miss), tracer),
                "no cell of its instance was visited");
    tracer.way->flags = kFlagExhausted;
    EXPECT_SAYS(explained(judge_of(HitClass::false_miss), tracer), "ran out of its budget");
}

TEST(Explain, a_triangle_that_was_tested_is_said_to_be_rejected_or_overtaken) {
    FakeTracer rejecting = walker(Hit{}, {{7}, {0, false}});
    const std::string rejected = explained(judge_of(HitClass::false_miss), rejecting);
    EXPECT_SAYS(rejected,
                "the true triangle 0 of instance 0 was tested in cell (4, 5, 6) and "
                "rejected");
    EXPECT_SILENT(rejected, "never");

    FakeTracer overtaken = walker(hit(0.25f, 1), {{0, true, 0.5}, {1, true, 0.25}});
    const std::string text = explained(judge_of(HitClass::wrong_surface), overtaken);
    EXPECT_SAYS(text, "was accepted in cell (4, 5, 6) at t 0.5, and another one after it");
}

TEST(Explain, an_answer_beside_the_ray_is_said_to_be_so) {
    FakeTracer tracer = walker(hit(0.5f, 1), {{1, true, 0.5}});
    const std::string reasons = explained(judge_of(HitClass::wrong_surface), tracer);
    EXPECT_SAYS(reasons, "the ray passes its triangle 1 of instance 0 by, beside edge v2-v0 at 40");
    EXPECT_SAYS(reasons, "least barycentric coordinate -0.125");
    EXPECT_SAYS(reasons, "triangle 1 of instance 0 was tested in cell (4, 5, 6) and accepted");
    EXPECT_SAYS(explained(judge_of(HitClass::edge), tracer), "moved by 0.5 of E_ray: no error");
}

TEST(Explain, a_shader_is_explained_by_its_twin_only_if_both_say_the_same) {
    FakeTracer twin = walker(Hit{}, {});
    FakeTracer same("fake/grid/fragment");
    FakeTracer other("fake/grid/compute");
    other.answer = [](const Ray&) { return hit(0.5f, 1); };
    FakeTracer stranger("fake/buffer/fragment");
    Tracer* const tracers[] = {&same, &other, &stranger, &twin};
    const FakeJudge judge = judge_of(HitClass::false_miss);
    const Explanation e = explain_ray(Ray{}, judge, tracers);
    EXPECT_SAYS(reasons_of(e.statements[0]), "never tested");
    EXPECT_SILENT(reasons_of(e.statements[1]), "never tested");
    EXPECT_SILENT(reasons_of(e.statements[2]), "never tested");
    EXPECT_SAYS(reasons_of(e.statements[2]), "it lost the true triangle 0");
    EXPECT_FALSE(e.statements[0].walk.has_value());
    EXPECT_TRUE(e.statements[3].walk.has_value());
}

TEST(Explain, the_text_tells_ray_truth_tracers_and_walk) {
    FakeTracer tracer = walker(hit(0.5f, 1), {{7}, {1, true, 0.5}});
    Tracer* const tracers[] = {&tracer};
    const Ray ray{.org = {0.1f, 2, 3}, .tmin = 0, .dir = {0, 0, -1}, .tmax = kInfinity};
    const Explanation e = explain_ray(ray, judge_of(HitClass::wrong_surface), tracers);
    const std::string text = explanation_text(e, test::quad_scene());
    EXPECT_SAYS(text, "--ray \"0.1,2,3,0,0,-1\"");
    EXPECT_SAYS(text, "0x1.99999ap-4");
    EXPECT_SAYS(text, " 1* t 0.5 instance 0 triangle 0 (quad/lower)");
    EXPECT_SAYS(text, "instance 0 triangle 1 (quad/upper): 40 of E_ray");
    EXPECT_SAYS(text, "a miss is wrong");
    EXPECT_SAYS(text, "fake/grid/twin32  wrong_surface");
    EXPECT_SAYS(text, "t off by 3 ulps");
    EXPECT_SAYS(text,
                "top level (0, 0, 0)\n      into instance 0\n"
                "        (4, 5, 6): 7 1 [accepted at t 0.5, the answer]");
    EXPECT_SAYS(text, "ended with t 0.5 instance 0 triangle 1");
}

TEST(Explain, runs_of_empty_cells_are_one_line_and_equal_walks_are_told_once) {
    FakeTracer first = walker(Hit{}, {});
    for (int x = 5; x < 9; ++x) first.way->steps.push_back({0, ivec3(x, 5, 6), {}});
    FakeTracer second = first;
    Tracer* const tracers[] = {&first, &second};
    const Explanation e = explain_ray(Ray{}, judge_of(HitClass::false_miss), tracers);
    const std::string text = explanation_text(e, test::quad_scene());
    EXPECT_SAYS(text, "(4, 5, 6) .. (8, 5, 6): 5 cells without a triangle");
    EXPECT_SAYS(text, "2 cells, 1 tests, as fake/grid/twin32");
    EXPECT_EQ(text.find("5 cells without"), text.rfind("5 cells without"));
}

TEST(Explain, the_json_document_holds_the_same) {
    FakeTracer tracer = walker(hit(0.5f, 1), {{7}, {1, true, 0.5}});
    Tracer* const tracers[] = {&tracer};
    const Ray ray{.org = {0.1f, 2, 3}, .tmin = 0, .dir = {0, 0, -1}, .tmax = kInfinity};
    const Explanation e = explain_ray(ray, judge_of(HitClass::wrong_surface), tracers);
    const auto json = nlohmann::json::parse(explanation_json(e, test::quad_scene()));
    EXPECT_EQ(json["ray"]["org"][0].get<float>(), 0.1f);
    EXPECT_EQ(json["ray"]["tmax"], "inf");
    EXPECT_EQ(json["hits"][0]["t_digits"], "0.5");
    EXPECT_EQ(json["hits"][0]["gap_ulps"], "inf");
    EXPECT_TRUE(json["hits"][0]["u"].is_null());
    EXPECT_EQ(json["passed"][0]["edge_moves"], 40.0);
    EXPECT_EQ(json["tracers"][0]["class"], "wrong_surface");
    EXPECT_TRUE(json["tracers"][0]["walk"]["steps"][0]["inst_id"].is_null());
    EXPECT_EQ(json["tracers"][0]["walk"]["steps"][1]["tests"][1]["t"], 0.5);
    EXPECT_EQ(json["tracers"][0]["reasons"].size(), e.statements[0].reasons.size());
}

}  // namespace
}  // namespace onepass
