// Long work as a user meets it: killed, stopped, sharded and merged, it ends in the same counts.
#include <csignal>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compare/results.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

using json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Fields that hold times, or what follows from them, or pictures and sheets of pixels, which are
/// named after the file. All else must not depend on who ran when: a sheet's digest among it.
bool may_differ(const std::string& name) {
    if (name == "file") return true;
    for (const char* word : {"_ms", "ratio", "mrays", "time_utc", "noise", "picture"}) {
        if (name.find(word) != std::string::npos) return true;
    }
    return false;
}

/// Takes the times out, those among a tracer's stats as well; and Embree's stats and bytes, which
/// depend on how its building threads met.
void drop_times(json& value) {
    if (value.is_object()) {
        if (value.value("is_oracle", false)) value.erase("stats");
        if (value.value("tracer", "").starts_with("embree/")) value.erase("bytes");
        for (auto field = value.begin(); field != value.end();) {
            if (may_differ(field.key())) {
                field = value.erase(field);
            } else {
                drop_times(*field++);
            }
        }
    } else if (value.is_array()) {
        json kept = json::array();
        for (json& element : value) {
            const bool stat = element.is_object() && element.contains("name") &&
                              element["name"].is_string() &&
                              may_differ(element["name"].get<std::string>());
            drop_times(element);
            if (!stat) kept.push_back(std::move(element));
        }
        value = std::move(kept);
    }
}

/// The file without times and without the manifest, which names the command line, and its digest.
std::string counts_of(const std::filesystem::path& file) {
    json document = json::parse(read_bytes(file));
    drop_times(document);
    document.erase("manifest");
    document.erase("digest");
    document["study"].erase("parts");
    return document.dump(1);
}

size_t finished_points(const std::filesystem::path& file) {
    return std::filesystem::exists(file) ? read_results(file).study->points.size() : 0;
}

/// Starts the command, and sends the signal once so many points are in its file.
Outcome interrupted(const TemporaryFolder& folder, const Words& command,
                    const std::filesystem::path& file, size_t points, int signal) {
    const pid_t child = start(folder, command);
    constexpr int kMostTicks = 60000;
    for (int tick = 0; tick < kMostTicks && finished_points(file) < points; ++tick) usleep(1000);
    kill(child, signal);
    return finish(folder, child);
}

struct LongWork {
    const char* name;
    Words command;  ///< of at least three points
};

void PrintTo(const LongWork& work, std::ostream* out) { *out << work.name; }

class Killed : public testing::TestWithParam<LongWork> {};

TEST_P(Killed, loses_only_the_point_in_flight_and_ends_as_if_it_had_not_been) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "run.json";
    const Words command = with(GetParam().command, {"--json", "run.json"});
    ASSERT_EQ(interrupted(folder, command, file, 1, SIGKILL).exit_code, -SIGKILL)
        << "it was over before it was killed";
    const Results partial = read_results(file);
    EXPECT_FALSE(partial.manifest.complete);
    ASSERT_TRUE(partial.study);
    const size_t kept = partial.study->points.size();
    EXPECT_GE(kept, 1u);
    EXPECT_LT(kept, partial.study->keys.size());

    const Outcome resumed = onepass_in(folder, command);
    EXPECT_LE(resumed.exit_code, 1) << resumed.err;
    EXPECT_NE(
        resumed.err.find(fmt::format("{} of {} points are kept", kept, partial.study->keys.size())),
        std::string::npos)
        << resumed.err;
    EXPECT_TRUE(read_results(file).manifest.complete);

    const Words again = with(GetParam().command, {"--json", "whole.json"});
    EXPECT_EQ(onepass_in(folder, again).exit_code, resumed.exit_code);
    EXPECT_EQ(counts_of(file), counts_of(folder.path() / "whole.json"));
}

TEST_P(Killed, and_split_into_shards_gives_the_same_counts_merged) {
    const TemporaryFolder folder;
    Words merge = {"merge", "-o", "merged.json"};
    for (const char* shard : {"3", "1", "2"}) {
        const std::string file = fmt::format("shard{}.json", shard);
        onepass_in(folder, with(GetParam().command,
                                {"--json", file, "--shard", fmt::format("{}/3", shard)}));
        EXPECT_GE(finished_points(folder.path() / file), 1u);
        merge.push_back(file);
    }
    ASSERT_EQ(onepass_in(folder, merge).exit_code, 0);
    onepass_in(folder, with(GetParam().command, {"--json", "whole.json"}));
    EXPECT_EQ(counts_of(folder.path() / "merged.json"), counts_of(folder.path() / "whole.json"));
}

INSTANTIATE_TEST_SUITE_P(
    Study, Killed,
    testing::Values(
        LongWork{"bench",
                 {"bench", "balls-1", "instances", "-s", "grid/buffer/twin32", "--reference",
                  "embree/fast/threads", "--size", "32x32", "--warm-up", "100", "--enough", "0"}},
        LongWork{"check",
                 {"check", "balls-1", "instances", "big-small", "-s", "grid/buffer/twin32",
                  "--size", "48x48"}},
        LongWork{"tune",
                 {"tune", "balls-1", "instances", "-s", "grid/buffer/twin32", "--densities",
                  "1,2,4,8", "--size", "32x32", "--warm-up", "50"}},
        LongWork{"grow",
                 {"grow", "--triangles", "1e3,2e3", "--ray-counts", "64", "--fixed-rays", "256",
                  "--fixed-triangles", "1000", "-s", "grid/buffer/twin32", "--rays", "primary",
                  "--repetitions", "9", "--judged", "64"}}),
    [](const auto& work) { return std::string(work.param.name); });

const Words kSmallBench = {"bench", "balls-1",   "-s", "embree/fast", "--size",
                           "32x32", "--warm-up", "0",  "--enough",    "0"};

TEST(Stopped, says_how_to_go_on_and_goes_on) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "run.json";
    Words command = {"bench",     "balls-1", "instances", "-s", "embree/fast", "--size",  "32x32",
                     "--warm-up", "1000",    "--enough",  "0",  "--json",      "run.json"};
    const Outcome stopped = interrupted(folder, command, file, 1, SIGINT);
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("of 4 points are finished; the same command goes on from there"),
              std::string::npos)
        << stopped.err;
    EXPECT_FALSE(read_results(file).manifest.complete);

    // Another command is not the same.
    const std::string before = read_bytes(file);
    Words other = command;
    other[6] = "16x16";
    const Outcome refused = onepass_in(folder, other);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.err.find("--size 32x32"), std::string::npos) << refused.err;
    EXPECT_EQ(read_bytes(file), before);
}

TEST(Merge, says_which_shards_are_missing_and_writes_nothing) {
    const TemporaryFolder folder;
    onepass_in(folder, with(kSmallBench, {"--shard", "1/2", "--json", "1.json"}));
    const Outcome outcome = onepass_in(folder, {"merge", "1.json", "-o", "all.json"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("shard 2/2; 'balls-1, random'"), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "all.json"));
    EXPECT_EQ(onepass_in(folder, {"merge", "1.json", "-o", "all.json", "--partial"}).exit_code, 0);
    EXPECT_FALSE(read_results(folder.path() / "all.json").manifest.complete);
}

TEST(Merge, refuses_a_shard_that_was_edited) {
    const TemporaryFolder folder;
    onepass_in(folder, with(kSmallBench, {"--rays", "primary", "--json", "1.json"}));
    ASSERT_EQ(onepass_in(folder, {"merge", "1.json", "-o", "all.json"}).exit_code, 0);
    std::string text = read_bytes(folder.path() / "1.json");
    const std::string count = "\"ray_count\": 1024";
    const size_t at = text.find(count);
    ASSERT_NE(at, std::string::npos);
    folder.write("1.json", text.replace(at, count.size(), "\"ray_count\": 1023"));
    const Outcome outcome = onepass_in(folder, {"merge", "1.json", "-o", "all.json"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("it was edited"), std::string::npos) << outcome.err;
}

TEST(Shard, that_is_none_is_refused) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, with(kSmallBench, {"--shard", "3/2"}));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("--shard"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace onepass
