// Does `report --check` notice that a file was edited? Each test edits the JSON text as a person
// would, and none may pass unseen.
#include "compare/audit.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "compare/ablation.h"
#include "compare/claims.h"
#include "compare/frame_timing.h"
#include "compare/hash.h"
#include "compare/results.h"
#include "compare/timing.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

constexpr uint64_t kSeed = 7;

/// Eleven rounds without two equal ones. The second is their median, the last the slowest.
std::vector<double> rounds(double middle) {
    return {middle,       middle + 0.2, middle - 4.0, middle + 0.4, middle - 0.2, middle + 0.6,
            middle - 0.4, middle + 0.8, middle - 0.6, middle + 1.0, middle + 5.0};
}

CheckRecord sample_check() {
    CheckRecord check;
    check.scene = "bunny";
    check.rays = "primary";
    check.tracer = "paper/texture2d/fragment";
    check.ray_count = 1000;
    check.classes[static_cast<size_t>(HitClass::agree)] = {990, WorstRay{}};
    check.classes[static_cast<size_t>(HitClass::edge)] = {1, WorstRay{}};
    check.classes[static_cast<size_t>(HitClass::wrong_surface)] = {8, WorstRay{}};
    check.oracle_invalid = 1;
    check.oracle_classes[static_cast<size_t>(HitClass::agree)] = 30;
    check.judged = 30;
    check.allowed = {1000, 1000, 1, 0, 0, 0, 0};
    check.passed = false;
    check.attribution = {true, {{"D11", 6}}, 2};
    return check;
}

/// A record of every kind that holds a derived figure, as the commands would have left it.
Results sample_results() {
    Results results;
    results.manifest.seed = kSeed;
    results.checks.push_back(sample_check());

    ImageRecord image;
    image.rmse = 0.01;
    image.psnr_db = 40.0;
    image.differing_pixels = 3;
    image.allowed_pixels = 5;
    image.passed = true;
    results.images.push_back(image);

    TimingRecord timing;
    timing.scene = "bunny";
    timing.rays = "primary";
    timing.tracer = "paper/texture2d/fragment";
    timing.ray_count = 1000;
    timing.wall_ms = rounds(20.0);
    timing.oracle_wall_ms = rounds(10.0);
    timing.errors = 8;
    timing.edges = 1;
    summarise(timing, kSeed);
    results.timings.push_back(timing);

    FrameTimingRecord frames;
    frames.wall_ms = rounds(30.0);
    frames.oracle_wall_ms = rounds(10.0);
    summarise(frames, kSeed);
    results.frame_timings.push_back(frames);

    const Claim& known = paper_claims().front();
    ClaimRecord claim;
    claim.id = known.id;
    ClaimMeasurement m;
    m.quantity = "time";
    m.expectation = Expectation::above;
    m.baseline_samples = m.again_samples = rounds(20.0);
    m.variant_samples = rounds(60.0);
    m.rays = 1000;
    summarise(m, kSeed);
    claim.measurements = {m};
    claim.verdict = verdict_of(claim.measurements, known.reading);
    claim.now = finding_of(known, claim.measurements);
    results.claims.push_back(claim);

    TradeoffPoint point;
    point.wall_ms = timing.wall_ms;
    point.oracle_wall_ms = timing.oracle_wall_ms;
    point.ratio = timing.ratio;
    point.ratio_low = timing.ratio_low;
    point.ratio_high = timing.ratio_high;
    results.tradeoffs.push_back(point);

    SweepPoint size;
    size.wall_ms = timing.wall_ms;
    size.oracle_wall_ms = timing.oracle_wall_ms;
    size.ratio = timing.ratio;
    size.ratio_low = timing.ratio_low;
    size.ratio_high = timing.ratio_high;
    results.sweeps.push_back(size);

    AblationRecord full, without;
    full.wall_ms = rounds(20.0);
    without.wall_ms = rounds(25.0);
    results.ablations = {full, without};
    compare_ablations(results.ablations, kSeed);
    return results;
}

Audit audit_of(const std::string& text) { return audit(text, "run.json", "."); }

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    const size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old << " is not in the file";
    return at == std::string::npos ? text : text.replace(at, old.size(), with);
}

/// The file with an edit of its data and the digest that fits it: a forger who knows of digests.
std::string forged(const std::function<void(Results&)>& edit) {
    Results results = sample_results();
    edit(results);
    return to_json(results);
}

std::vector<std::string> places(const Audit& found) {
    std::vector<std::string> all;
    for (const Discrepancy& d : found.discrepancies) all.push_back(d.place);
    return all;
}

TEST(Audit, passes_a_file_that_nobody_touched) {
    const Audit found = audit_of(to_json(sample_results()));
    EXPECT_TRUE(found.passed()) << testing::PrintToString(places(found));
    EXPECT_TRUE(found.sealed && found.intact);
    EXPECT_GT(found.derived, 40u);
}

TEST(Audit, finds_a_sample_that_changes_a_headline_even_under_a_fitting_digest) {
    const Audit found = audit_of(forged([](Results& r) { r.timings[0].wall_ms[1] = 20.3; }));
    EXPECT_FALSE(found.passed());
    EXPECT_TRUE(found.intact);
    const std::vector<std::string> where = places(found);
    EXPECT_NE(std::find(where.begin(), where.end(), "timings[0].median_ms"), where.end())
        << testing::PrintToString(where);
}

TEST(Audit, finds_by_the_digest_a_sample_that_changes_no_headline) {
    // The slowest round a little slower: median, rate and interval stay.
    const std::string text = to_json(sample_results());
    const std::string edited = replaced(text, "25.0", "25.5");
    const Audit found = audit_of(edited);
    EXPECT_TRUE(found.discrepancies.empty()) << testing::PrintToString(places(found));
    EXPECT_TRUE(found.sealed);
    EXPECT_FALSE(found.intact);
    EXPECT_FALSE(found.passed());
}

TEST(Audit, does_not_mind_another_layout_of_the_same_data) {
    std::string text = to_json(sample_results());
    text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
    EXPECT_TRUE(audit_of(text).passed());
}

TEST(Audit, says_that_an_older_file_holds_no_digest_and_derives_its_figures) {
    const std::string text = to_json(sample_results());
    const size_t digest = text.find(",\n \"digest\"");
    ASSERT_NE(digest, std::string::npos);
    const Audit found = audit_of(text.substr(0, digest) + "}");
    EXPECT_FALSE(found.sealed);
    EXPECT_TRUE(found.passed());
    EXPECT_GT(found.derived, 40u);
}

TEST(Audit, finds_a_sample_that_is_left_out) {
    const Audit found = audit_of(forged([](Results& r) { r.timings[0].wall_ms.pop_back(); }));
    EXPECT_EQ(places(found), std::vector<std::string>{"timings[0].samples of wall_ms"});
}

TEST(Audit, counts_the_sizes_of_older_files_as_underived) {
    const Audit found = audit_of(forged([](Results& r) { r.sweeps[0].oracle_wall_ms.clear(); }));
    EXPECT_TRUE(found.passed()) << testing::PrintToString(places(found));
    EXPECT_EQ(found.underived, 3u);
}

struct Forgery {
    std::string name;
    std::string place;
    std::function<void(Results&)> edit;
};
class Forged : public testing::TestWithParam<Forgery> {};

TEST_P(Forged, is_found_where_it_is) {
    const Audit found = audit_of(forged(GetParam().edit));
    const std::vector<std::string> where = places(found);
    EXPECT_NE(std::find(where.begin(), where.end(), GetParam().place), where.end())
        << testing::PrintToString(where);
}

INSTANTIATE_TEST_SUITE_P(
    Headlines, Forged,
    testing::Values(
        Forgery{"rate", "timings[0].mrays_per_s",
                [](Results& r) { r.timings[0].mrays_per_s *= 2; }},
        Forgery{"ratio", "timings[0].ratio", [](Results& r) { r.timings[0].ratio *= 1.001; }},
        Forgery{"interval", "timings[0].ratio_high",
                [](Results& r) { r.timings[0].ratio_high += 0.01; }},
        Forgery{"errors_of_a_speed", "timings[0].errors",
                [](Results& r) { r.timings[0].errors = 0; }},
        Forgery{"frame_rate", "frame_timings[0].frames_per_s",
                [](Results& r) { r.frame_timings[0].frames_per_s = 60.0; }},
        Forgery{"verdict", "checks[0].passed", [](Results& r) { r.checks[0].passed = true; }},
        Forgery{"class", "checks[0].ray_count, by the classes",
                [](Results& r) { --r.checks[0].classes[5].count; }},
        Forgery{"attribution", "checks[0].attribution, summed up",
                [](Results& r) { r.checks[0].attribution.unattributed = 0; }},
        Forgery{"image", "images[0].passed", [](Results& r) { r.images[0].allowed_pixels = 2; }},
        Forgery{"psnr", "images[0].psnr_db", [](Results& r) { r.images[0].psnr_db = 60.0; }},
        Forgery{"claim", "claims[0].verdict",
                [](Results& r) { r.claims[0].verdict = ClaimVerdict::depends; }},
        Forgery{"finding", "claims[0].now", [](Results& r) { r.claims[0].now = "all is well"; }},
        Forgery{"measurement", "claims[0].measurements[0].ratio",
                [](Results& r) { r.claims[0].measurements[0].variant_samples[1] += 0.1; }},
        Forgery{"tradeoff", "tradeoffs[0].ratio_low",
                [](Results& r) { r.tradeoffs[0].ratio_low = 0.4; }},
        Forgery{"size", "sweeps[0].ratio", [](Results& r) { r.sweeps[0].wall_ms[1] -= 0.1; }},
        Forgery{"ablation", "ablations[1].ratio",
                [](Results& r) { r.ablations[1].wall_ms[1] = 25.3; }}),
    [](const auto& forgery) { return forgery.param.name; });

TEST(Audit, finds_a_sheet_of_pixels_that_was_edited_or_is_gone) {
    const TemporaryFolder folder;
    Results results;
    results.pixel_sheets.push_back({"bunny", 2, 2, 4, 0, "sheet.json", sha256_text("[1]")});
    folder.write("sheet.json", "[1]");
    EXPECT_TRUE(audit(to_json(results), "run.json", folder.path()).passed());
    folder.write("sheet.json", "[2]");
    EXPECT_FALSE(audit(to_json(results), "run.json", folder.path()).passed());
    std::filesystem::remove(folder.path() / "sheet.json");
    EXPECT_FALSE(audit(to_json(results), "run.json", folder.path()).passed());
}

TEST(Audit, refuses_what_is_no_result_file) {
    EXPECT_THROW(audit_of("no JSON"), Error);
    EXPECT_THROW(audit_of("[]"), Error);
}

TEST(Audit, derives_every_headline_of_the_published_result_sets) {
    size_t files = 0;
    const std::filesystem::path published = std::filesystem::path(ONEPASS_SOURCE_DIR) / "results";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(published)) {
        const std::filesystem::path& path = entry.path();
        if (path.extension() != ".json" || path.string().find("/local/") != std::string::npos ||
            path.stem().string().ends_with("_pixels")) {
            continue;
        }
        const Audit found = audit(read_bytes(path), path.string(), path.parent_path());
        EXPECT_TRUE(found.passed()) << path << testing::PrintToString(places(found));
        ++files;
    }
    EXPECT_GT(files, 0u);
}

TEST(Sha256, is_that_of_the_standard) {
    // FIPS 180-4, the example of one block.
    EXPECT_EQ(sha256_text("abc"),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace onepass
