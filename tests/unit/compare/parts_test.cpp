// Parts of a long run: kept, found again, and not taken for what they are not.
#include "compare/parts.h"

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

Results part() {
    Results results;
    results.manifest.arguments = {"onepass", "reproduce", "--claim", "x"};
    results.manifest.commit = "abc";
    results.manifest.program_hash = "123";
    results.manifest.gl_renderer = "a GPU";
    results.manifest.cpu = "a CPU";
    results.manifest.judge = "fair";
    results.claims.resize(1);
    return results;
}

TEST(PartStore, finds_a_part_of_the_same_origin_again) {
    const TemporaryFolder folder;
    const PartStore store(folder.path() / "out" / "parts");
    EXPECT_FALSE(store.find("step", part().manifest).results);
    EXPECT_EQ(store.find("step", part().manifest).why_not, "") << "nothing there";
    store.save("step", part());
    Manifest now = part().manifest;
    now.time_utc = "later";
    const FoundPart found = store.find("step", now);
    ASSERT_TRUE(found.results);
    EXPECT_EQ(found.results->claims.size(), 1u);
    EXPECT_FALSE(store.find("other", now).results);
}

TEST(PartStore, says_why_a_part_cannot_stand_for_a_new_run) {
    const TemporaryFolder folder;
    const PartStore store(folder.path());
    store.save("step", part());
    const auto why_not = [&](auto&& change) {
        Manifest now = part().manifest;
        change(now);
        const FoundPart found = store.find("step", now);
        EXPECT_FALSE(found.results);
        return found.why_not;
    };
    EXPECT_TRUE(test::contains(why_not([](Manifest& m) { m.commit = "def"; }), "commit"));
    EXPECT_TRUE(test::contains(why_not([](Manifest& m) { m.program_hash = "9"; }), "build"));
    EXPECT_TRUE(test::contains(why_not([](Manifest& m) { m.gl_renderer = "b"; }), "GL device"));
    EXPECT_TRUE(test::contains(why_not([](Manifest& m) { m.cores = 9; }), "CPU"));
    EXPECT_TRUE(test::contains(why_not([](Manifest& m) { m.seed = 9; }), "options"));
    EXPECT_TRUE(
        test::contains(why_not([](Manifest& m) { m.arguments.push_back("-x"); }), "options"));
    folder.write("step.json", "{ cut short");
    EXPECT_TRUE(test::contains(why_not([](Manifest&) {}), "read"));
}

TEST(AppendResults, joins_parts_and_takes_over_the_judge) {
    Results all;
    append_results(all, part());
    append_results(all, part());
    EXPECT_EQ(all.claims.size(), 2u);
    EXPECT_EQ(all.manifest.judge, "fair");
    EXPECT_EQ(all.manifest.commit, "") << "the caller's";
}

}  // namespace
}  // namespace onepass
