// A study is taken up where it was stopped, by its own command only, and its file does not tell how
// often.
#include "compare/study.h"

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

const std::vector<std::string> kKeys = {"a, x", "a, y", "b, x", "b, y", "c, x"};

StudyRequest request(const std::filesystem::path& file, Shard shard = {}) {
    StudyRequest request{kKeys, shard, {}, file};
    request.manifest.arguments = {"onepass", "bench", "a", "b", "--json", "f.json"};
    request.manifest.commit = "abc";
    request.manifest.program_hash = "123";
    request.manifest.cpu = "a CPU";
    request.manifest.seed = 7;
    return request;
}

/// What a process measures for the key "SCENE, RAYS": the build time tells which process it was.
Results point(const std::string& key, double build_ms = 1.0) {
    const std::string scene = key.substr(0, 1), rays = key.substr(3);
    Results results;
    results.manifest.judge = "fair";
    results.scenes.resize(1);
    results.scenes[0].name = scene;
    results.scenes[0].hash = "hash of " + scene;
    for (const char* name : {"oracle", "grid"}) {
        results.tracers.emplace_back();
        results.tracers.back().scene = scene;
        results.tracers.back().name = name;
        results.tracers.back().stats = {{"build_ms", build_ms, ""}};
        results.timings.emplace_back();
        results.timings.back().scene = scene;
        results.timings.back().rays = rays;
        results.timings.back().tracer = name;
    }
    return results;
}

void do_all(Study& study, double build_ms = 1.0) {
    for (const std::string& key : kKeys) {
        if (study.needs(key)) study.add(key, point(key, build_ms));
    }
}

Results uninterrupted() {
    Study study(request(""));
    do_all(study);
    return study.results();
}

TEST(Study, holds_what_points_share_once_and_knows_whose_each_record_is) {
    const Results all = uninterrupted();
    EXPECT_TRUE(all.manifest.complete);
    EXPECT_EQ(all.manifest.judge, "fair");
    EXPECT_EQ(all.scenes.size(), 3u);
    EXPECT_EQ(all.tracers.size(), 6u);
    EXPECT_EQ(all.timings.size(), 10u);
    ASSERT_TRUE(all.study);
    EXPECT_EQ(all.study->keys, kKeys);

    const auto points = split_points(all, "file");
    ASSERT_EQ(points.size(), 5u);
    const Results& one = points.at("b, y");
    ASSERT_EQ(one.timings.size(), 2u);
    EXPECT_EQ(one.timings[1].scene + one.timings[1].rays + one.timings[1].tracer, "bygrid");
    EXPECT_EQ(one.scenes[0].name, "b");
    EXPECT_EQ(one.tracers.size(), 2u);
    EXPECT_EQ(to_json(join_points(kKeys, points)), [&] {
        Results without_manifest = all;
        without_manifest.manifest = {};
        without_manifest.manifest.judge = "fair";
        return to_json(without_manifest);
    }());
}

TEST(Study, orders_its_records_by_the_request_and_not_by_the_clock) {
    Study study(request(""));
    for (auto key = kKeys.rbegin(); key != kKeys.rend(); ++key) study.add(*key, point(*key));
    EXPECT_EQ(to_json(study.results()), to_json(uninterrupted()));
}

TEST(Study, killed_after_any_point_is_taken_up_there_and_ends_as_if_it_had_not_been) {
    for (size_t stop = 1; stop < kKeys.size(); ++stop) {
        const TemporaryFolder folder;
        const auto file = folder.path() / "f.json";
        {
            Study study(request(file));
            for (size_t k = 0; k < stop; ++k) study.add(kKeys[k], point(kKeys[k]));
            EXPECT_FALSE(read_results(file).manifest.complete);
        }  // the process dies here
        Study again(request(file));
        EXPECT_EQ(again.kept(), stop);
        EXPECT_FALSE(again.needs(kKeys[stop - 1]));
        EXPECT_TRUE(again.needs(kKeys[stop]));
        do_all(again);
        EXPECT_EQ(read_bytes(file), to_json(uninterrupted())) << "stopped after " << stop;
        EXPECT_EQ(folder.names().size(), 1u) << "no temporary file is left";
    }
}

TEST(Study, keeps_the_tracers_as_its_first_points_had_them) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "f.json";
    {
        Study study(request(file));
        study.add(kKeys[0], point(kKeys[0], 1.0));
    }
    Study again(request(file));
    do_all(again, 2.0);
    const Results all = again.results();
    EXPECT_EQ(all.tracers[0].stats[0].value, 1.0) << "built before the interruption";
    EXPECT_EQ(all.tracers[2].stats[0].value, 2.0);
}

TEST(Study, makes_a_complete_file_and_one_that_is_no_study_anew) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "f.json";
    Study first(request(file));
    do_all(first);
    EXPECT_EQ(Study(request(file)).kept(), 0u);
    Results other;
    other.manifest.complete = false;
    write_results(other, file);
    EXPECT_EQ(Study(request(file)).kept(), 0u) << "made of no points";
    folder.write("f.json", "");
    EXPECT_EQ(Study(request(file)).kept(), 0u) << "empty";
}

TEST(Study, refuses_the_unfinished_file_of_another_request_and_says_what_differs) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "f.json";
    Study begun(request(file));
    begun.add(kKeys[0], point(kKeys[0]));
    const std::string before = read_bytes(file);
    const auto why_not = [&](auto&& change) -> std::string {
        StudyRequest now = request(file);
        change(now);
        const Error error = test::error_of([&] { Study{now}; });
        EXPECT_TRUE(test::is_clear(error));
        return error.parts().got;
    };
    using R = StudyRequest;
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.manifest.arguments.push_back("-x"); }),
                               "'onepass bench a b --json f.json'"));
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.manifest.seed = 8; }), "--seed 7"));
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.manifest.commit = "d"; }), "another commit"));
    EXPECT_TRUE(
        test::contains(why_not([](R& r) { r.manifest.program_hash = "d"; }), "another build"));
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.manifest.cpu = "other"; }), "another CPU"));
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.shard = {1, 2}; }), "shard 1/1, not 1/2"));
    EXPECT_TRUE(test::contains(why_not([](R& r) { r.keys.pop_back(); }), "points"));
    EXPECT_EQ(read_bytes(file), before) << "a refusal touches nothing";

    StudyRequest moved = request(file);
    moved.manifest.arguments.back() = "elsewhere/f.json";
    moved.manifest.time_utc = "later";
    EXPECT_EQ(Study(moved).kept(), 1u) << "neither the place nor the time matters";
}

TEST(Study, does_not_seal_an_edit_of_its_unfinished_file) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "f.json";
    Study begun(request(file));
    begun.add(kKeys[0], point(kKeys[0], 1.5));
    std::string text = read_bytes(file);
    ASSERT_EQ(Study(request(file)).kept(), 1u);
    const size_t figure = text.find("1.5");
    ASSERT_NE(figure, std::string::npos);
    text.replace(figure, 3, "1.4");
    folder.write("f.json", text);
    const Error error = test::error_of([&] { Study{request(file)}; });
    EXPECT_TRUE(test::is_clear(error));
    EXPECT_TRUE(test::contains(error.parts().got, "edited"));
}

TEST(Study, refuses_to_go_on_in_a_scene_whose_file_has_changed) {
    Study study(request(""));
    study.add(kKeys[0], point(kKeys[0]));
    SceneRecord scene = point(kKeys[1]).scenes[0];
    study.check_scene(scene);
    scene.hash = "other";
    const Error error = test::error_of([&] { study.check_scene(scene); });
    EXPECT_TRUE(test::is_clear(error));
    EXPECT_TRUE(test::contains(error.what(), "scene 'a'"));
    scene.name = "another";
    study.check_scene(scene);
}

TEST(Study, counts_a_repeated_point_once) {
    StudyRequest twice = request("");
    twice.keys = {"a, x", "a, x", "a, y"};
    EXPECT_EQ(Study(twice).total(), 2u);
}

TEST(Study, refuses_a_file_whose_rows_are_not_there) {
    Results broken = uninterrupted();
    broken.study->points[0].records[0].rows = {99};
    EXPECT_TRUE(
        test::contains(test::error_of([&] { split_points(broken, "x.json"); }).what(), "row 99"));
    broken = uninterrupted();
    broken.study->points[0].records[0].list = "wishes";
    EXPECT_TRUE(
        test::contains(test::error_of([&] { split_points(broken, "x.json"); }).what(), "wishes"));
    broken = uninterrupted();
    broken.study->points[0].key = "d, z";
    EXPECT_TRUE(
        test::contains(test::error_of([&] { split_points(broken, "x.json"); }).what(), "d, z"));
}

TEST(Shard, of_a_study_take_each_point_once) {
    for (uint32_t count = 1; count <= kKeys.size() + 1; ++count) {
        std::vector<int> takers(kKeys.size());
        for (uint32_t index = 1; index <= count; ++index) {
            const Study study(request("", {index, count}));
            for (size_t k = 0; k < kKeys.size(); ++k) takers[k] += study.needs(kKeys[k]);
            EXPECT_LE(study.total(), kKeys.size() / count + 1) << "even shares";
        }
        EXPECT_EQ(takers, std::vector<int>(kKeys.size(), 1)) << count << " shards";
    }
}

TEST(Shard, is_read_from_1_on) {
    EXPECT_EQ(parse_shard("2/4"), (Shard{2, 4}));
    EXPECT_EQ(to_string(parse_shard("12/12")), "12/12");
    for (const char* wrong : {"", "2", "0/4", "5/4", "1/0", "-1/2", "1/2x", "a/b", "/", "1/ 2"}) {
        EXPECT_TRUE(test::is_clear(test::error_of([&] { parse_shard(wrong); }))) << wrong;
    }
}

TEST(Request, is_the_command_line_but_for_its_shard_and_its_file) {
    using Words = std::vector<std::string>;
    const Words plain = {"onepass", "tune", "bunny", "--size", "64x64"};
    EXPECT_EQ(request_of(plain), plain);
    EXPECT_EQ(request_of(
                  {"onepass", "tune", "--json", "a", "bunny", "--shard", "1/2", "--size", "64x64"}),
              plain);
    EXPECT_EQ(
        request_of({"onepass", "tune", "bunny", "--shard=1/2", "--size", "64x64", "--json=-"}),
        plain);
    EXPECT_EQ(request_of({"onepass", "--json"}), Words{"onepass"});
}

}  // namespace
}  // namespace onepass
