// Shards come together into what one run would have written, and what does not belong together is
// refused with its reason.
#include "compare/merge.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compare/report/report.h"
#include "compare/study.h"
#include "tests/support/errors.h"

namespace onepass {
namespace {

const std::vector<std::string> kKeys = {"a, x", "a, y", "b, x", "b, y", "c, x", "c, y", "d, x"};

/// A shard's file, measured on a machine of its own.
ShardFile shard(uint32_t index, uint32_t count, const std::string& cpu = "a CPU") {
    StudyRequest request{kKeys, {index, count}, {}, ""};
    const std::string name = fmt::format("{}.json", index);
    request.manifest.arguments = {
        "onepass", "bench", "a b c d", "--shard", to_string(request.shard), "--json", name};
    request.manifest.commit = "abc";
    request.manifest.cpu = cpu;
    request.manifest.cores = 2;
    request.manifest.time_utc = fmt::format("time {}", index);
    Study study(request);
    for (const std::string& key : kKeys) {
        if (!study.needs(key)) continue;
        Results point;
        point.manifest.judge = "fair";
        point.scenes.resize(1);
        point.scenes[0].name = point.scenes[0].hash = key.substr(0, 1);
        point.tracers.resize(1);
        point.tracers[0].scene = key.substr(0, 1);
        point.checks.resize(1);
        point.checks[0].scene = key.substr(0, 1);
        point.checks[0].rays = key.substr(3);
        study.add(key, point);
    }
    return {name, study.results()};
}

/// But for who measured it.
std::string data_of(Results results) {
    results.manifest = {};
    results.study->parts.clear();
    results.study->shard = {};
    return to_json(results);
}

TEST(Merge, of_all_shards_is_what_one_run_writes) {
    const std::string whole = data_of(shard(1, 1).results);
    for (uint32_t count = 1; count <= kKeys.size() + 1; ++count) {
        std::vector<ShardFile> files;
        for (uint32_t index = 1; index <= count; ++index) files.push_back(shard(index, count));
        const Results all = merge_shards(files, false);
        EXPECT_EQ(data_of(all), whole) << count << " shards";
        EXPECT_TRUE(all.manifest.complete);
        EXPECT_EQ(all.manifest.judge, "fair");
        EXPECT_EQ(all.manifest.arguments,
                  (std::vector<std::string>{"onepass", "bench", "a b c d"}));
        EXPECT_EQ(all.study->parts.size(), count) << "every manifest is kept";
    }
}

TEST(Merge, gives_the_same_bytes_whatever_the_order_of_the_files_and_of_merging) {
    std::vector<ShardFile> files = {shard(1, 3, "B"), shard(2, 3, "A"), shard(3, 3, "B")};
    const std::string bytes = to_json(merge_shards(files, false));
    std::vector<size_t> order = {0, 1, 2};
    while (std::next_permutation(order.begin(), order.end())) {
        std::vector<ShardFile> shuffled;
        for (const size_t i : order) shuffled.push_back(files[i]);
        EXPECT_EQ(to_json(merge_shards(shuffled, false)), bytes);
    }
    const ShardFile some{"some.json", merge_shards({files[2], files[0]}, true)};
    EXPECT_EQ(to_json(merge_shards({some, files[1]}, false)), bytes);
}

TEST(Merge, names_the_points_that_are_missing_and_whose_they_are) {
    const std::vector<ShardFile> files = {shard(1, 3), shard(3, 3)};
    const Error error = test::error_of([&] { merge_shards(files, false); });
    EXPECT_TRUE(test::is_clear(error));
    EXPECT_TRUE(test::contains(error.what(), "2 of 7 points"));
    EXPECT_TRUE(test::contains(error.what(), "shard 2/3; 'a, y'; 'c, x'"));

    const Results some = merge_shards(files, true);
    EXPECT_FALSE(some.manifest.complete);
    EXPECT_EQ(some.checks.size(), 5u);
}

TEST(Merge, refuses_what_does_not_belong_together) {
    const auto refusal = [](auto&& change) -> std::string {
        std::vector<ShardFile> files = {shard(1, 2), shard(2, 2)};
        change(files[1]);
        const Error error = test::error_of([&] { merge_shards(files, true); });
        EXPECT_TRUE(test::is_clear(error));
        return error.what();
    };
    EXPECT_TRUE(test::contains(refusal([](ShardFile& f) { f.results.study.reset(); }), "--shard"));
    EXPECT_TRUE(test::contains(
        refusal([](ShardFile& f) { f.results.manifest.arguments.push_back("-x"); }), "-x"));
    EXPECT_TRUE(
        test::contains(refusal([](ShardFile& f) { f.results.manifest.seed = 9; }), "seed 9"));
    EXPECT_TRUE(
        test::contains(refusal([](ShardFile& f) { f.results.manifest.commit = "d"; }), "commit d"));
    EXPECT_TRUE(test::contains(refusal([](ShardFile& f) {
                                   f.results.manifest.dirty = true;
                                   f.results.manifest.program_hash = "other";
                               }),
                               "uncommitted"));
    EXPECT_TRUE(test::contains(refusal([](ShardFile& f) { f = shard(1, 2); }), "point 'a, x'"));
    EXPECT_TRUE(test::contains(refusal([](ShardFile& f) { f.results.scenes[0].hash = "other"; }),
                               "hash other"));
    EXPECT_TRUE(
        test::contains(refusal([](ShardFile& f) { f.results.study->keys[0] = "?"; }), "points"));
}

TEST(Merge, does_not_pretend_that_two_machines_are_one) {
    const Results all = merge_shards({shard(1, 2, "one CPU"), shard(2, 2, "other CPU")}, false);
    EXPECT_EQ(all.manifest.cpu, "one CPU | other CPU");
    EXPECT_EQ(all.manifest.time_utc, "time 2") << "the last";
    EXPECT_FALSE(like_machines(all.study->parts[0].manifest, all.study->parts[1].manifest));
    const std::string page = render_report({all}, {"."});
    EXPECT_TRUE(test::contains(page, "Measured on unlike machines"));
    EXPECT_TRUE(test::contains(page, "other CPU"));

    const Results alike = merge_shards({shard(1, 2), shard(2, 2)}, false);
    EXPECT_EQ(alike.manifest.cpu, "a CPU");
    EXPECT_EQ(render_report({alike}, {"."}).find("Measured on unlike machines"), std::string::npos);
}

TEST(Merge, finds_the_pictures_from_its_own_folder) {
    Results results;
    results.checks.resize(2);
    results.checks[0].picture = "p/a.png";
    results.images.resize(1);
    results.images[0].pictures = {{"image", "b.png"}};
    results.pixel_sheets.emplace_back().file = "c.json";
    move_pictures(results, "shards/one", "out");
    EXPECT_EQ(results.checks[0].picture, "../shards/one/p/a.png");
    EXPECT_EQ(results.checks[1].picture, "") << "there is none";
    EXPECT_EQ(results.images[0].pictures[0].second, "../shards/one/b.png");
    EXPECT_EQ(results.pixel_sheets[0].file, "../shards/one/c.json");
    move_pictures(results, "out", "");
    EXPECT_EQ(results.images[0].pictures[0].second, "shards/one/b.png");
}

}  // namespace
}  // namespace onepass
