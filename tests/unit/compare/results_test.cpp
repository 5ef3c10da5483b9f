// Results: JSON both ways, tampered files, and files written whole or not at all.
#include "compare/results.h"

#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compare/atomic_file.h"
#include "compare/manifest.h"
#include "core/error.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A value in every field, none of them a default.
Results full_results() {
    Results results;
    results.manifest = {{"onepass", "check"},
                        "2024-05-06T07:08:09Z",
                        "abc123",
                        true,
                        "feed",
                        "Release",
                        "12.2.0",
                        "a CPU",
                        64,
                        "egl",
                        "a GPU",
                        "4.6",
                        true,
                        "Embree",
                        "exact",
                        0xFFFFFFFFFFFFFFFFu,
                        false};
    results.scenes = {{"bunny", 10, 9, 8, 7, "00ff", {"note \"one\"", "two\n"}}};
    results.tracers = {{"bunny",
                        "paper/x/y",
                        {{"density", "5"}},
                        "auto",
                        "GPU",
                        true,
                        true,
                        true,
                        3,
                        "beef",
                        {{"build_ms", 1.25, "wall"}},
                        {{"D11", "edge_tolerance", "1", "slack"}}}};
    CheckRecord check;
    check.scene = "bunny";
    check.rays = "primary";
    check.ray_hash = "1234";
    check.ray_count = 100;
    check.tracer = "paper/x/y";
    check.oracle = "embree";
    check.judge = "exact";
    for (size_t c = 0; c < kHitClassCount; ++c) {
        check.classes[c].count = c + 1;
        check.oracle_classes[c] = c + 10;
        check.allowed[c] = c + 20;
    }
    WorstRay worst;
    worst.index = 42;
    worst.ray = {vec3(0.1f, -0.0f, 1e-30f), 0.25f, vec3(3, 2, 1), kInfinity};
    worst.answer = {1.5f, 0.25f, 0.125f, 5, 6};
    worst.verdict = {
        HitClass::false_hit, std::numeric_limits<double>::infinity(), kNoId, kNoId, kNan, 0.5};
    check.classes[4].worst = worst;
    check.judged = 31;
    check.wrong_triangle = 32;
    check.hit_count = 33;
    check.oracle_invalid = 34;
    check.exhausted = 35;
    check.passed = true;
    check.reference = true;
    check.picture = "classes.png";
    check.attribution = {true, {{"D11", 36}, {"D10", 37}}, 38};
    results.checks = {check};
    results.images = {{"bunny",
                       "paper/x/y",
                       "embree",
                       512,
                       256,
                       0.5,
                       6.0,
                       0.75,
                       3,
                       4,
                       5,
                       0.25,
                       6,
                       "because",
                       true,
                       2.5,
                       99.0,
                       {{"image", "a.png"}, {"oracle", "b.png"}}}};
    results.timings = {{"bunny",
                        "random",
                        9,
                        "paper/x/y",
                        "embree",
                        {1.5, 2.5},
                        {0.5},
                        {3.5, 4.5},
                        2.0,
                        0.0045,
                        2.0,
                        1.5,
                        2.25,
                        7,
                        8,
                        {1.75},
                        {0.75},
                        CastCounts{1, 2, 3, 4, 5, 6}}};
    results.builds = {{"bunny", "paper/x/y", {0.5, 0.25}}};
    FrameTimingRecord frames;
    frames.scene = "bunny";
    frames.tracer = "streaming/x/y";
    frames.oracle = "embree";
    frames.setting = "steps_per_pass=1";
    frames.width = 512;
    frames.height = 256;
    frames.frames = 3;
    frames.primary_rays = 4;
    frames.secondary_rays = 5;
    frames.wall_ms = {6.5, 7.5};
    frames.device_ms = {8.5};
    frames.update_ms = {9.5};
    frames.upload_ms = {10.5};
    frames.oracle_wall_ms = {11.5};
    frames.costs = {{"passes", 12.0, "of all kinds"}};
    frames.median_ms = 13.5;
    frames.frames_per_s = 14.5;
    frames.ratio = 15.5;
    frames.ratio_low = 16.5;
    frames.ratio_high = 17.5;
    frames.differing_pixels = 18;
    frames.compared_pixels = 19;
    results.frame_timings = {frames};
    ClaimMeasurement measurement;
    measurement.scene = "bunny";
    measurement.work = "primary";
    measurement.quantity = "time";
    measurement.unit = "ms";
    measurement.baseline = "paper/x";
    measurement.variant = "paper/y";
    measurement.size = 0.5;
    measurement.baseline_samples = {1.5};
    measurement.variant_samples = {2.5};
    measurement.again_samples = {3.5};
    measurement.ratio = std::numeric_limits<double>::infinity();
    measurement.ratio_low = 5.5;
    measurement.ratio_high = 6.5;
    measurement.noise = 0.125;
    measurement.expectation = Expectation::possible;
    measurement.bound = 7.5;
    measurement.verdict = ClaimVerdict::fails;
    measurement.rays = 8;
    measurement.baseline_errors = 9;
    measurement.variant_errors = 10;
    measurement.failure = "refused";
    results.claims = {{"single-pass",
                       "fragment",
                       "it is so",
                       "section 4",
                       "10 %",
                       "by rule",
                       "11 %",
                       "onepass reproduce",
                       ClaimVerdict::depends,
                       {measurement}}};
    results.sweeps = {{"bunny",   "primary", "paper/x/y", 1.25,  5.5, "4x5x6", "2,3", "listed",
                       4096,      1,         2,           3,     4.5, 5.5,     6.5,   7,
                       "refused", {8.5},     {7.5},       {6.5}, 9.5, 10.5,    11.5}};
    RungRecord rung{.knob = 100.0,
                    .label = "-0",
                    .tracer = "paper/x/y",
                    .setting = "address=half",
                    .trials = 4096,
                    .ties = 3,
                    .edges = 2,
                    .failures = {{"leak", 5}},
                    .refusal = "too large",
                    .worst = check.classes[4].worst};
    results.ladders = {{"translation",
                        "Far away",
                        "What fails?",
                        "distance",
                        "sizes",
                        false,
                        "exact",
                        "onepass stress translation",
                        {rung}}};
    results.tradeoffs = {{.scene = "bunny",
                          .rays = "vertex",
                          .tracer = "paper/x/y",
                          .setting = "edge_tolerance=1",
                          .oracle = "embree",
                          .ray_count = 1024,
                          .errors = 7,
                          .edges = 8,
                          .wall_ms = {1.0, 2.0},
                          .oracle_wall_ms = {0.5},
                          .ratio = 0.5,
                          .ratio_low = 0.25,
                          .ratio_high = 0.75}};
    results.paces = {{"bunny", "random", 1024, 12, 600.5, 0.125, true, "a GPU",
                      ClockReading{1980.0, 2619.0, kNan}, std::nullopt}};
    results.growth_builds = {
        {"ball", 1000, "paper/x/y", "density=2", {1.5, 2.5}, 4096, 5000, 6000, "refused"}};
    results.growth_traces = {
        {"ball", 1000, "paper/x/y", "density=2", "diffuse", 512, true, {3.5}, {0.25}, 64, 3, 2}};
    results.pixel_sheets = {{"bunny", 4, 3, 12, 1, "sheet.json", "abc"}};
    results.ablations = {{"bunny",
                          "image",
                          "paper/x/y",
                          "a step",
                          "step=0",
                          256,
                          4,
                          5,
                          {1.5},
                          {0.75},
                          0.5,
                          0.25,
                          0.625,
                          "none"}};
    results.refusals = {{"bunny", "paper/x/y", "too large"}};
    results.study = {{2, 4},
                     {"bunny, primary", "bunny, random"},
                     {{"bunny, random", {{"checks", {0}}}}},
                     {{{2, 4}, results.manifest}}};
    return results;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(ResultsJson, reads_back_what_was_written) {
    const Results results = full_results();
    const std::string text = to_json(results);
    const Results again = results_from_json(text, "test");
    EXPECT_EQ(to_json(again), text);
    // Spot checks against the original, so that a field lost on both ways is seen.
    EXPECT_EQ(again.manifest.seed, 0xFFFFFFFFFFFFFFFFu);
    EXPECT_FALSE(again.manifest.complete);
    EXPECT_EQ(again.scenes[0].notes, results.scenes[0].notes);
    EXPECT_EQ(again.tracers[0].params, results.tracers[0].params);
    EXPECT_EQ(again.tracers[0].sizing, "auto");
    EXPECT_EQ(again.tracers[0].stats[0].value, 1.25);
    const CheckRecord& check = again.checks[0];
    EXPECT_EQ(check.allowed, results.checks[0].allowed);
    EXPECT_EQ(check.oracle_classes, results.checks[0].oracle_classes);
    EXPECT_FALSE(check.classes[3].worst);
    ASSERT_TRUE(check.classes[4].worst);
    const WorstRay& worst = *check.classes[4].worst;
    EXPECT_EQ(worst.ray.org, vec3(0.1f, -0.0f, 1e-30f)) << "floats survive as they are";
    EXPECT_TRUE(std::signbit(worst.ray.org.y));
    EXPECT_EQ(worst.ray.tmax, kInfinity);
    EXPECT_EQ(worst.oracle, Hit{});
    EXPECT_EQ(worst.verdict.hit_class, HitClass::false_hit);
    EXPECT_TRUE(std::isinf(worst.verdict.true_t));
    EXPECT_TRUE(std::isnan(worst.verdict.t_error_ulps));
    EXPECT_EQ(again.images[0].pictures, results.images[0].pictures);
    EXPECT_EQ(again.timings[0].oracle_wall_ms, results.timings[0].oracle_wall_ms);
    EXPECT_EQ(again.sweeps[0].failure, "refused");
    EXPECT_EQ(again.sweeps[0].sizes, "2,3");
    EXPECT_EQ(again.sweeps[0].oracle_wall_ms, (std::vector<double>{6.5}));
    ASSERT_EQ(again.tracers[0].deviations.size(), 1u);
    EXPECT_EQ(again.tracers[0].deviations[0].param, "edge_tolerance");
    EXPECT_EQ(again.tracers[0].deviations[0].summary, "slack");
    EXPECT_EQ(check.attribution.by_deviation, results.checks[0].attribution.by_deviation);
    EXPECT_EQ(again.frame_timings[0].upload_ms, (std::vector<double>{10.5}));
    EXPECT_EQ(again.frame_timings[0].costs, results.frame_timings[0].costs);
    const ClaimRecord& claim = again.claims[0];
    EXPECT_EQ(claim.verdict, ClaimVerdict::depends);
    EXPECT_EQ(claim.measurements[0].expectation, Expectation::possible);
    EXPECT_EQ(claim.measurements[0].verdict, ClaimVerdict::fails);
    EXPECT_TRUE(std::isinf(claim.measurements[0].ratio));
    EXPECT_EQ(again.paces[0].before->memory_mhz, 2619.0);
    EXPECT_FALSE(again.paces[0].after) << "clocks that could not be read stay absent";
    EXPECT_EQ(again.growth_builds[0].build_ms, (std::vector<double>{1.5, 2.5}));
    EXPECT_TRUE(again.growth_traces[0].growing_rays);
    ASSERT_TRUE(again.study);
    EXPECT_EQ(again.study->shard, (Shard{2, 4}));
    EXPECT_EQ(again.study->points[0].records[0].rows, std::vector<uint32_t>{0});
    EXPECT_EQ(again.timings[0].again_device_ms, (std::vector<double>{0.75}));
    EXPECT_EQ(again.timings[0].counts->repeated_tests, 6u);
    EXPECT_EQ(again.builds[0].build_ms, (std::vector<double>{0.5, 0.25}));
}

TEST(ResultsJson, reads_files_that_are_older_than_its_last_lists) {
    auto document = nlohmann::json::parse(to_json(full_results()));
    for (const char* name :
         {"paces", "growth_builds", "growth_traces", "refusals", "builds", "study"}) {
        document.erase(name);
    }
    for (const char* field : {"again_wall_ms", "again_device_ms", "counts"}) {
        document["timings"][0].erase(field);
    }
    const Results old = results_from_json(document.dump(), "old.json");
    EXPECT_FALSE(old.study);
    EXPECT_TRUE(old.paces.empty());
    EXPECT_EQ(old.sweeps.size(), 1u);
    EXPECT_TRUE(old.timings.at(0).again_wall_ms.empty());
    EXPECT_FALSE(old.timings[0].counts);
}

TEST(ResultsJson, holds_every_member_of_every_record) {
    const auto document = nlohmann::json::parse(to_json(full_results()));
    EXPECT_EQ(document.size(), 21u) << "the version, the members of Results and the digest";
    EXPECT_EQ(document["pixel_sheets"][0].size(), 7u);
    EXPECT_EQ(document["manifest"].size(), 17u);
    EXPECT_EQ(document["scenes"][0].size(), 7u);
    EXPECT_EQ(document["tracers"][0].size(), 12u);
    EXPECT_EQ(document["checks"][0].size(), 19u);
    EXPECT_EQ(document["checks"][0]["attribution"].size(), 3u);
    EXPECT_EQ(document["frame_timings"][0].size(), 22u);
    EXPECT_EQ(document["claims"][0].size(), 10u);
    EXPECT_EQ(document["ladders"][0].size(), 9u);
    EXPECT_EQ(document["ladders"][0]["rungs"][0].size(), 10u);
    EXPECT_EQ(document["tradeoffs"][0].size(), 13u);
    EXPECT_EQ(document["ablations"][0].size(), 14u);
    EXPECT_EQ(document["claims"][0]["measurements"][0].size(), 21u);
    EXPECT_EQ(document["images"][0].size(), 18u);
    EXPECT_EQ(document["timings"][0].size(), 18u);
    EXPECT_EQ(document["timings"][0]["counts"].size(), 6u);
    EXPECT_EQ(document["builds"][0].size(), 3u);
    EXPECT_EQ(document["sweeps"][0].size(), 23u);
    EXPECT_EQ(document["paces"][0].size(), 10u);
    EXPECT_EQ(document["paces"][0]["before"].size(), 3u);
    EXPECT_EQ(document["growth_builds"][0].size(), 9u);
    EXPECT_EQ(document["growth_traces"][0].size(), 12u);
    EXPECT_EQ(document["refusals"][0].size(), 3u);
    EXPECT_EQ(document["study"].size(), 4u);
    const auto& worst = document["checks"][0]["classes"]["false_hit"]["worst"];
    EXPECT_EQ(worst.size(), 5u);
    EXPECT_EQ(worst["ray"].size(), 4u);
    EXPECT_EQ(worst["answer"].size(), 5u);
    EXPECT_EQ(worst["verdict"].size(), 6u);
}

TEST(ResultsJson, reads_back_an_empty_run) {
    EXPECT_TRUE(results_from_json(to_json(Results{}), "test").checks.empty());
}

/// A change to a good file, and a word that the error must say.
struct Tampered {
    std::string what;
    std::string from;
    std::string to;
    std::string expected_word;
};

class TamperedJson : public testing::TestWithParam<Tampered> {};

TEST_P(TamperedJson, is_refused_with_its_place) {
    const std::string text = replaced(to_json(full_results()), GetParam().from, GetParam().to);
    try {
        results_from_json(text, "run.json");
        FAIL() << "was read";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("run.json"), std::string::npos) << message;
        EXPECT_NE(message.find(GetParam().expected_word), std::string::npos) << message;
    }
}

INSTANTIATE_TEST_SUITE_P(
    ResultsJson, TamperedJson,
    testing::Values(
        Tampered{"version", "\"schema_version\": 3", "\"schema_version\": 1", "schema_version"},
        Tampered{"no_version", "\"schema_version\": 3,", "", "schema_version"},
        Tampered{"unknown_record", "\"schema_version\": 3,", "\"schema_version\": 3, \"extra\": 2,",
                 "extra"},
        Tampered{"missing_field", "\"commit\": \"abc123\",", "", "manifest.commit"},
        Tampered{"unknown_field", "\"dirty\":", "\"dirt\": 1, \"dirty\":", "dirt"},
        Tampered{"string_for_number", "\"ray_count\": 100", "\"ray_count\": \"100\"",
                 "checks[0].ray_count"},
        Tampered{"negative_count", "\"judged\": 31", "\"judged\": -31", "checks[0].judged"},
        Tampered{"fraction_for_count", "\"judged\": 31", "\"judged\": 31.5", "checks[0].judged"},
        Tampered{"too_large", "\"width\": 512", "\"width\": 5120000000", "images[0].width"},
        Tampered{"number_for_bool", "\"dirty\": true", "\"dirty\": 1", "manifest.dirty"},
        Tampered{"unknown_class", "\"hit_class\": \"false_hit\"", "\"hit_class\": \"fine\"",
                 "verdict.hit_class"},
        Tampered{"unknown_verdict", "\"verdict\": \"depends\"", "\"verdict\": \"maybe\"",
                 "claims[0].verdict"},
        Tampered{"unknown_expectation", "\"expectation\": \"possible\"",
                 "\"expectation\": \"better\"", "measurements[0].expectation"},
        Tampered{"class_left_out", "\"false_hit\": 14,", "", "oracle_classes.false_hit"},
        Tampered{"word_for_number", "\"rmse\": 0.5", "\"rmse\": \"small\"", "images[0].rmse"},
        Tampered{"object_for_list", "\"sweeps\": [", "\"sweeps\": {}, \"x\": [", "sweeps"},
        Tampered{"cut_short", "\"timings\"", "", "JSON"}),
    [](const auto& test) { return test.param.what; });

TEST(ResultsJson, reads_files_from_before_there_were_ladders) {
    Results results = full_results();
    for (CheckRecord& check : results.checks) check.reference = false;
    results.ladders.clear();
    results.tradeoffs.clear();
    nlohmann::ordered_json old = nlohmann::ordered_json::parse(to_json(results));
    old["schema_version"] = 2;
    old.erase("ladders");
    old.erase("tradeoffs");
    for (auto& check : old["checks"]) check.erase("reference");
    EXPECT_EQ(to_json(results_from_json(old.dump(), "run.json")), to_json(results));
}

TEST(LadderRecord, breaks_where_a_trial_first_failed_and_not_where_it_was_refused) {
    LadderRecord ladder;
    ladder.rungs = {{.knob = 1.0, .tracer = "a", .trials = 9},
                    {.knob = 1.0, .tracer = "b", .trials = 9, .failures = {{"leak", 2}}},
                    {.knob = 2.0, .tracer = "a", .refusal = "too large"},
                    {.knob = 3.0, .tracer = "a", .setting = "k=1", .failures = {{"leak", 1}}},
                    {.knob = 4.0, .tracer = "a", .failures = {{"leak", 1}, {"changed", 2}}}};
    ASSERT_NE(breaks_at(ladder, "a", ""), nullptr);
    EXPECT_EQ(breaks_at(ladder, "a", "")->knob, 4.0);
    EXPECT_EQ(breaks_at(ladder, "a", "")->failed(), 3u);
    EXPECT_EQ(breaks_at(ladder, "a", "k=1")->knob, 3.0);
    EXPECT_EQ(breaks_at(ladder, "b", "")->knob, 1.0);
    EXPECT_EQ(breaks_at(ladder, "c", ""), nullptr);
}

TEST(ResultsJson, refuses_json_that_is_something_else) {
    for (const char* text : {"", "[]", "null", "3", "{}", "\"text\""}) {
        EXPECT_THROW(results_from_json(text, "run.json"), Error) << text;
    }
}

TEST(ResultsFile, is_read_back_from_disk) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "run.json";
    write_results(full_results(), path);
    EXPECT_EQ(to_json(read_results(path)), to_json(full_results()));
    EXPECT_EQ(folder.names(), std::vector<std::string>{"run.json"}) << "no temporary file is left";
    EXPECT_THROW(read_results(folder.path()), Error);
    EXPECT_THROW(read_results(folder.path() / "missing.json"), Error);
}

TEST(WriteAtomically, leaves_the_old_file_and_nothing_else_when_writing_fails) {
    const TemporaryFolder folder;
    const auto path = folder.write("data.txt", "old");
    const auto failing = [](const std::filesystem::path& temporary) {
        std::ofstream(temporary) << "half of the new";
        throw Error({"writer", "trouble", "none", "Try again."});
    };
    EXPECT_THROW(write_atomically(path, failing), Error);
    EXPECT_EQ(read_bytes(path), "old");
    EXPECT_EQ(folder.names(), std::vector<std::string>{"data.txt"});
}

TEST(WriteAtomically, replaces_a_file_whole_and_keeps_its_extension_on_the_way) {
    const TemporaryFolder folder;
    const auto path = folder.write("data.png", "old");
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        EXPECT_EQ(temporary.extension(), ".png");
        EXPECT_EQ(temporary.parent_path(), path.parent_path()) << "rename needs one file system";
        EXPECT_EQ(read_bytes(path), "old") << "the target is untouched while writing";
        std::ofstream(temporary) << "new";
    });
    EXPECT_EQ(read_bytes(path), "new");
}

TEST(WriteAtomically, refuses_a_folder_and_a_folder_that_is_not_there) {
    const TemporaryFolder folder;
    EXPECT_THROW(write_bytes_atomically(folder.path(), "x"), Error);
    EXPECT_THROW(write_bytes_atomically(folder.path() / "no" / "file", "x"), Error);
    EXPECT_THROW(write_bytes_atomically("", "x"), Error);
    EXPECT_TRUE(folder.names().empty());
}

TEST(CheckRecord, adds_up_its_errors_and_nothing_else) {
    CheckRecord record;
    for (size_t c = 0; c < kHitClassCount; ++c) record.classes[c].count = uint64_t{1} << (8 * c);
    EXPECT_EQ(record.errors(), 0x01010101000000u);
}

TEST(Manifest, names_this_build_and_this_machine) {
    const Manifest manifest = make_manifest({"onepass", "check"}, 17);
    EXPECT_EQ(manifest.seed, 17u);
    EXPECT_GE(manifest.cores, 1u);
    EXPECT_EQ(manifest.time_utc.size(), 20u) << manifest.time_utc;
    EXPECT_EQ(manifest.time_utc.back(), 'Z');
    EXPECT_TRUE(manifest.commit == "unknown" || manifest.commit.size() == 40) << manifest.commit;
    EXPECT_TRUE(manifest.complete);
}

TEST(Manifest, records_the_command_line_without_the_folder_of_the_program) {
    using Words = std::vector<std::string>;
    const auto recorded = [](Words words) { return make_manifest(std::move(words), 1).arguments; };
    EXPECT_EQ(recorded({"/opt/onepass/bin/onepass", "check", "models/a.obj"}),
              (Words{"onepass", "check", "models/a.obj"}));
    EXPECT_EQ(recorded({"onepass", "doctor"}), (Words{"onepass", "doctor"}));
    EXPECT_EQ(recorded({}), Words{});
}

TEST(Manifest, reads_the_cpu_model) {
    std::istringstream cpuinfo("processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nflags\t: x\n");
    EXPECT_EQ(cpu_model(cpuinfo), "Some CPU @ 2 GHz");
    std::istringstream other("Processor: 0\n");
    EXPECT_EQ(cpu_model(other), "unknown");
}

TEST(TracerRecord, records_defaults_and_the_shader_hash) {
    FakeTracer tracer("paper/x/y");
    tracer.figures = {{"cells", 8.0, ""}};
    tracer.abilities.shader_hash = "beef";
    TracerInfo info;
    info.name = tracer.name();
    info.params = {{"density", ParamInfo::Type::real, "5", "", {}},
                   {"tolerance", ParamInfo::Type::real, "1.004", "", {}}};
    const TracerRecord record = make_tracer_record("bunny", tracer, info, {{"tolerance", "1.0"}});
    EXPECT_EQ(record.params, (ParamValues{{"density", "5"}, {"tolerance", "1.0"}}));
    EXPECT_EQ(record.shader_hash, "beef");
    ASSERT_EQ(record.stats.size(), 1u);
    EXPECT_EQ(stat_value(record.stats, "cells"), 8.0);
    EXPECT_EQ(stat_value(record.stats, "nothing"), 0.0);
}

}  // namespace
}  // namespace onepass
