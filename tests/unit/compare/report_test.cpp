// The page generator, on invented results: nothing here was measured.
//
// With ONEPASS_REPORT_SAMPLE=FILE the sample page is also written there, to be looked at.
#include "compare/report/report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "compare/hash.h"
#include "compare/report/dossier.h"
#include "compare/report/html.h"
#include "compare/report/pictures.h"
#include "compare/report/sections.h"
#include "compare/tuning.h"
#include "core/error.h"

namespace onepass {
namespace {

namespace fs = std::filesystem;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// ---- Invented pictures.

std::string big_endian(uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
    const std::string body = type + data;
    const auto sum =
        crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
    return big_endian(static_cast<uint32_t>(data.size())) + body +
           big_endian(static_cast<uint32_t>(sum));
}

/// An 8-bit RGB picture of a shaded disc in one tint.
std::string disc_png(uint32_t size, const vec3& tint) {
    std::string rows;
    for (uint32_t y = 0; y < size; ++y) {
        rows += '\0';
        for (uint32_t x = 0; x < size; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size) * 2.4f - 1.2f;
            const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size) * 2.4f - 1.2f;
            const float height = std::sqrt(std::max(0.0f, 1.0f - u * u - v * v));
            const float light = std::max(0.0f, 0.8f * height - 0.4f * u - 0.4f * v);
            for (int c = 0; c < 3; ++c) rows += static_cast<char>(255.0f * tint[c] * light);
        }
    }
    uLongf length = compressBound(static_cast<uLong>(rows.size()));
    std::string packed(length, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &length,
             reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()));
    packed.resize(length);
    return "\x89PNG\r\n\x1a\n" +
           chunk("IHDR", big_endian(size) + big_endian(size) + std::string("\x08\x02\0\0\0", 5)) +
           chunk("IDAT", packed) + chunk("IEND", "");
}

void write_file(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

// ---- Invented results.

constexpr uint64_t kRays = 262144;
const std::string kFragment = "paper/texture2d/fragment";
const std::string kCompute = "paper/texture2d/compute";
const std::string kRobust = "embree/robust/1";

CheckRecord sample_check(const std::string& scene, const std::string& tracer,
                         const std::string& rays, uint64_t wrong) {
    CheckRecord check;
    check.scene = scene;
    check.rays = rays;
    check.ray_hash = scene + rays;
    check.ray_count = kRays;
    check.tracer = tracer;
    check.oracle = kRobust;
    check.judge = "double precision (stand-in until the exact judge exists)";
    check.classes[0].count = kRays - wrong - 6;
    check.classes[1].count = 5;
    check.classes[2].count = 1;
    check.classes[static_cast<size_t>(HitClass::wrong_surface)].count = wrong;
    check.oracle_classes = {wrong + 1, 5, 0, 0, 0, 0, 0};
    check.allowed[2] = 263;
    check.judged = 2621 + wrong + 6;
    check.wrong_triangle = wrong + 5;
    check.hit_count = 60000;
    check.passed = wrong == 0;
    if (wrong > 0) {
        WorstRay worst;
        worst.index = 88213;
        worst.ray.org = vec3(0.1f, 1.0f / 3.0f, 2.5f);
        worst.ray.dir = vec3(0.0625f, -0.25f, -1.0f);
        worst.answer = {2.25f, 0.25f, 0.5f, 1234, 0};
        worst.oracle = {2.5f, 0.125f, 0.5f, 1240, 0};
        worst.verdict = {
            HitClass::wrong_surface, 2.5, 1240, 0, 1.5e5, std::numeric_limits<double>::infinity()};
        check.classes[static_cast<size_t>(HitClass::wrong_surface)].worst = worst;
    }
    return check;
}

TracerRecord sample_tracer(const std::string& scene, const std::string& name) {
    TracerRecord tracer;
    tracer.scene = scene;
    tracer.name = name;
    tracer.is_oracle = name == kRobust;
    tracer.software_renderer = !tracer.is_oracle;
    tracer.device = tracer.is_oracle ? "Embree 3.13.5" : "llvmpipe (LLVM 15.0.6, 256 bits)";
    tracer.threads = tracer.is_oracle ? 1 : 0;
    if (!tracer.is_oracle) {
        tracer.params = {{"edge_tolerance", "1.004"}, {"density", "5"}, {"top_density", "1.2"}};
        tracer.shader_hash = "5be0cd19137e2179";
        tracer.stats = {{"cells", 352000, ""},
                        {"references", 240512, "entries of all cells' lists"},
                        {"grid_bytes", 3.5e6, "cells and references on the device"},
                        {"build_ms", 41.7, ""}};
    } else {
        tracer.stats = {{"build_ms", 28.25, "commit at medium quality"}};
    }
    return tracer;
}

ImageRecord sample_image(const std::string& scene, const std::string& tracer) {
    ImageRecord image;
    image.scene = scene;
    image.tracer = tracer;
    image.oracle = kRobust;
    image.width = image.height = 256;
    image.rmse = 0.0021;
    image.psnr_db = 53.6;
    image.max_difference = 0.71;
    image.max_x = 118;
    image.max_y = 97;
    image.differing_pixels = 129;
    image.tolerance = 1.0 / 255.0;
    image.allowed_pixels = 328;
    image.reason = "an invented reason for an invented bound";
    image.passed = true;
    image.rays_per_pixel = 1.52;
    image.cells_full_scale = 212;
    image.pictures = {{"image", "image.png"},
                      {"oracle", "oracle.png"},
                      {"difference", "difference.png"},
                      {"cells", "cells.png"}};
    return image;
}

TimingRecord sample_timing(const std::string& scene, const std::string& tracer, double ratio) {
    TimingRecord timing;
    timing.scene = scene;
    timing.rays = "primary";
    timing.ray_count = kRays;
    timing.tracer = tracer;
    timing.oracle = kRobust;
    for (int i = 0; i < 9; ++i) timing.wall_ms.push_back(120.0 / ratio + 0.5 * i);
    timing.median_ms = timing.wall_ms[4];
    timing.mrays_per_s = static_cast<double>(kRays) / timing.median_ms / 1e3;
    timing.ratio = ratio;
    timing.ratio_low = ratio * 0.96;
    timing.ratio_high = ratio * 1.03;
    timing.errors = tracer == kRobust ? 0 : 308;
    timing.edges = 1;
    return timing;
}

Manifest sample_manifest(const std::string& command) {
    Manifest manifest;
    manifest.arguments = {"onepass", command, "bunny", "--json", "results/local/it's here.json"};
    manifest.time_utc = "2000-01-01T00:00:00Z";
    manifest.commit = "0123456789ab";
    manifest.dirty = true;
    manifest.build_type = "RelWithDebInfo";
    manifest.compiler = "GNU 12.2.0";
    manifest.cpu = "An invented CPU";
    manifest.cores = 2;
    manifest.gl_context = "osmesa";
    manifest.gl_renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
    manifest.gl_version = "4.5 (Core Profile) Mesa 22.3.6";
    manifest.software_renderer = true;
    manifest.embree = "3.13.5, with assertions";
    manifest.judge = "double precision (stand-in until the exact judge exists)";
    manifest.seed = 1;
    return manifest;
}

Results sample_check_run() {
    Results run;
    run.manifest = sample_manifest("check");
    const std::vector<std::pair<std::string, uint64_t>> scenes = {
        {"bunny", 308}, {"balls-1", 0}, {"big-small", 12}};
    for (const auto& [scene, wrong] : scenes) {
        run.scenes.push_back(
            {scene,
             69666,
             scene == "balls-1" ? 3120u : 69666u,
             scene == "balls-1" ? 10u : 1u,
             2,
             "c0ffee" + scene,
             {"No camera in the file: an automatic one looks at the whole scene"}});
        for (const std::string& tracer : {kFragment, kCompute}) {
            run.tracers.push_back(sample_tracer(scene, tracer));
            run.checks.push_back(sample_check(scene, tracer, "primary", wrong));
            run.checks.push_back(sample_check(scene, tracer, "random", wrong / 60));
            run.images.push_back(sample_image(scene, tracer));
        }
        run.checks[run.checks.size() - 4].picture = "classes.png";
        run.tracers.push_back(sample_tracer(scene, kRobust));
    }
    return run;
}

Results sample_bench_run() {
    Results run;
    run.manifest = sample_manifest("bench");
    double ratio = 0.22;
    for (const std::string scene : {"bunny", "balls-1", "big-small"}) {
        for (const std::string& tracer : {kRobust, kFragment, kCompute}) {
            run.tracers.push_back(sample_tracer(scene, tracer));
            run.timings.push_back(sample_timing(scene, tracer, tracer == kRobust ? 1.0 : ratio));
            ratio += 0.03;
        }
    }
    return run;
}

Results sample_tune_run() {
    Results run;
    run.manifest = sample_manifest("tune");
    run.tracers.push_back(sample_tracer("bunny", kFragment));
    for (const double top : {1.2, 4.0}) {
        for (const double density : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
            SweepPoint point;
            point.scene = "bunny";
            point.rays = "primary";
            point.tracer = kFragment;
            point.top_density = top;
            point.object_density = density;
            point.cells = static_cast<uint64_t>(69666 * density);
            point.references = static_cast<uint64_t>(160000 * std::cbrt(density));
            point.bytes = point.cells * 4 + point.references * 4;
            point.build_ms = 20.0 + 4.0 * density;
            point.cells_per_ray = 9.0 * std::cbrt(density) + top;
            point.tests_per_ray = 14.0 / std::cbrt(density);
            const double time = 20.0 * (point.cells_per_ray + 2.0 * point.tests_per_ray);
            for (int i = 0; i < 9; ++i) point.wall_ms.push_back(time + i);
            point.errors = density > 4.0 ? 310 : 308;
            point.ratio = 120.0 / time;
            point.ratio_low = 118.0 / time;
            point.ratio_high = 122.0 / time;
            run.sweeps.push_back(point);
        }
    }
    SweepPoint refused;
    refused.scene = "bunny";
    refused.rays = "primary";
    refused.tracer = kFragment;
    refused.top_density = 1.2;
    refused.object_density = 4096.0;
    refused.failure = "paper: got 2,900 blocks, expected at most 4096 <of 16^3>";
    run.sweeps.push_back(refused);
    return run;
}

ClaimMeasurement sample_measurement(Expectation expectation, double ratio, ClaimVerdict verdict) {
    ClaimMeasurement m;
    m.scene = "balls-1";
    m.work = "primary";
    m.quantity = "time";
    m.unit = "ms";
    m.baseline = "paper/texture2d";
    m.variant = "streaming/texture2d (steps_per_pass=1)";
    m.baseline_samples = m.again_samples = std::vector<double>(9, 36.5);
    m.variant_samples = std::vector<double>(9, 36.5 * ratio);
    m.ratio = ratio;
    m.ratio_low = ratio * 0.96;
    m.ratio_high = ratio * 1.04;
    m.noise = 0.02;
    m.expectation = expectation;
    m.verdict = verdict;
    m.rays = 65536;
    m.baseline_errors = 181;
    return m;
}

ClaimRecord sample_claim(const std::string& id, const std::string& entry, ClaimVerdict verdict) {
    return {id,
            entry,
            "An <invented> claim of " + id,
            "section 4",
            "10 % on ATI",
            "by an invented rule",
            "b against a: time × 3",
            "onepass reproduce --claim " + id,
            verdict,
            {sample_measurement(Expectation::above, 3.0, verdict)}};
}

Results sample_paper_run() {
    Results run;
    run.manifest = sample_manifest("reproduce");
    using enum ClaimVerdict;
    for (const std::string entry : {"fragment", "compute"}) {
        run.claims.push_back(sample_claim("single-pass", entry, holds));
        run.claims.push_back(sample_claim("early-out", entry, fails));
        run.claims.push_back(sample_claim("two-levels", entry, depends));
        run.claims.push_back(sample_claim("vectors-4d", entry, not_measured));
    }
    ClaimMeasurement& missing = run.claims.back().measurements.front();
    missing.failure = "no tracer of that name";
    missing.verdict = not_measured;

    run.scenes.push_back({"balls-1", 31200, 3120, 10, 2, "c0ffee", {}});
    run.scenes.push_back({"knife", 1600, 1600, 1, 1, "decade", {}});
    TracerRecord tracer = sample_tracer("balls-1", kFragment);
    tracer.deviations = {{"D11", "edge_tolerance", "1", "0.4 % of slack on one edge"},
                         {"D10", "clip_to_cell", "0", "a hit counts only inside its cell"}};
    run.tracers = {tracer, sample_tracer("balls-1", kRobust)};
    for (const char* rays : {"primary", "shadow", "reflection"}) {
        CheckRecord check = sample_check("balls-1", kFragment, rays, 40);
        check.attribution = {true, {{"D11", 33}, {"D10", 6}}, 1};
        run.checks.push_back(check);
        run.timings.push_back(sample_timing("balls-1", kFragment, 0.25));
        run.timings.back().rays = rays;
    }
    ImageRecord image = sample_image("balls-1", kFragment);
    image.pictures.pop_back();
    run.images.push_back(image);

    FrameTimingRecord frames;
    frames.scene = "balls-1";
    frames.tracer = kFragment;
    frames.oracle = kRobust;
    frames.width = frames.height = 512;
    frames.frames = 1;
    frames.primary_rays = kRays;
    frames.secondary_rays = kRays;
    frames.wall_ms = std::vector<double>(9, 320.0);
    frames.median_ms = 320.0;
    frames.frames_per_s = 3.125;
    frames.ratio = 0.25;
    frames.compared_pixels = kRays;
    frames.differing_pixels = 77;
    run.frame_timings.push_back(frames);
    frames.tracer = "streaming/texture2d/fragment";
    frames.setting = "steps_per_pass=1";
    frames.costs = {{"passes", 1234.0, ""},
                    {"state_bytes_read", 3.0 * 1048576.0, ""},
                    {"state_bytes_written", 2.0 * 1048576.0, ""},
                    {"copy_ms", 200.0, ""}};
    run.frame_timings.push_back(frames);
    frames = run.frame_timings.front();
    frames.frames = 16;
    frames.update_ms = std::vector<double>(16, 0.75);
    frames.upload_ms = std::vector<double>(16, 0.25);
    run.frame_timings.push_back(frames);
    return run;
}

Results sample_growth_run() {
    Results run;
    run.manifest = sample_manifest("grow");
    for (const std::string& tracer : {kRobust, kCompute}) {
        const double slowness = tracer == kRobust ? 3.0 : 1.0;
        for (const uint64_t n : {10'000u, 100'000u, 1'000'000u}) {
            const double x = static_cast<double>(n);
            run.growth_builds.push_back(
                {"ball", n, tracer, "", {slowness * 1e-3 * x}, 80 * n, 5 * n, 6 * n, ""});
            run.growth_traces.push_back({"ball",
                                         n,
                                         tracer,
                                         "",
                                         "random",
                                         65536,
                                         false,
                                         std::vector<double>(9, slowness * std::pow(x, 0.25)),
                                         {},
                                         4096,
                                         tracer == kRobust ? 2u : 0u,
                                         1});
        }
    }
    GrowthBuild refused = run.growth_builds.back();
    refused.triangles = 10'000'000;
    refused.build_ms.clear();
    refused.failure = "more <cells> than fit";
    run.growth_builds.push_back(refused);
    return run;
}

// ---- The tests.

Results sample_ablation_run() {
    Results run;
    run.manifest = sample_manifest("bench");
    AblationRecord full;
    full.scene = "bunny";
    full.work = "shadow";
    full.tracer = "grid/buffer/compute";
    full.rays = 2000;
    full.wall_ms = std::vector<double>(9, 2.0);
    full.ratio = full.ratio_low = full.ratio_high = 1.0;
    AblationRecord without = full;
    without.without = "a step that <pays>";
    without.setting = "step=0";
    without.ratio = 0.625;
    without.errors = 3;
    AblationRecord refused = without;
    refused.failure = "does not fit";
    AblationRecord other_work = full;
    other_work.work = "image";
    run.ablations = {full, full, without, refused, other_work};
    return run;
}

class Report : public testing::Test {
  protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::temp_directory_path() / (std::string("onepass_report_") + test->name());
        fs::create_directories(folder_);
        write_file(folder_ / "image.png", disc_png(256, vec3(1.0f, 0.8f, 0.6f)));
        write_file(folder_ / "oracle.png", disc_png(256, vec3(1.0f, 0.8f, 0.601f)));
        write_file(folder_ / "difference.png", disc_png(256, vec3(0.1f, 0.0f, 0.2f)));
        write_file(folder_ / "cells.png", disc_png(256, vec3(0.9f, 0.6f, 0.0f)));
        write_file(folder_ / "classes.png", disc_png(256, vec3(0.8f, 0.2f, 0.0f)));
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string render(const std::vector<Results>& runs) const {
        return render_report(runs, std::vector<fs::path>(runs.size(), folder_));
    }

    std::string sample_page() const {
        return render({sample_check_run(), sample_bench_run(), sample_tune_run()});
    }

    fs::path folder_;
};

/// The page without Chart.js and its own script: what a reader sees.
std::string visible(const std::string& page) {
    const size_t scripts = page.find("<script");
    return page.substr(0, scripts);
}

/// As it is copied: <wbr> only says where a line may end.
std::string without_breaks(const std::string& page) {
    return std::regex_replace(page, std::regex("<wbr>"), "");
}

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++count;
    }
    return count;
}

size_t timed_sizes(const Results& run) {
    return static_cast<size_t>(
        std::count_if(run.sweeps.begin(), run.sweeps.end(),
                      [](const SweepPoint& p) { return p.failure.empty(); }));
}

/// Of all charts of speed against accuracy.
size_t cloud_points(const std::vector<Results>& runs) {
    const std::vector<fs::path> folders(runs.size());
    size_t points = 0;
    for (const report::Cloud& cloud : report::clouds(report::gather(runs, folders))) {
        points += cloud.points.size();
    }
    return points;
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
    std::vector<std::string> all;
    const std::regex regex(pattern);
    for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) {
        all.push_back(at->str());
    }
    return all;
}

TEST_F(Report, an_ablation_has_a_table_a_work_with_the_strategy_as_it_is_first) {
    const std::string page = render({sample_ablation_run()});
    const size_t section = page.find("<section id=\"ablations\">");
    ASSERT_NE(section, std::string::npos);
    const std::string html = page.substr(section, page.find("</section>", section) - section);
    const auto at = [&](const std::string& part) {
        const size_t found = html.find(part);
        EXPECT_NE(found, std::string::npos) << part;
        return found;
    };
    EXPECT_LT(at("bunny, shadow rays, grid/buffer/compute"), at("as it is<"));
    EXPECT_LT(at("as it is<"), at("as it is, again<"));
    EXPECT_LT(at("as it is, again<"), at("a step that &lt;pays&gt;"));
    EXPECT_LT(at("0.625"), at("does not fit"));
    EXPECT_LT(at("does not fit"), at("bunny, the whole image, grid/buffer/compute"));
    EXPECT_NE(html.find("errors bad"), std::string::npos);
    EXPECT_EQ(html.find("aria-label=\"Ablations, bunny, shadow rays, grid/buffer/compute <"),
              std::string::npos);
    EXPECT_EQ(render({sample_growth_run()}).find("id=\"ablations\""), std::string::npos);
}

TEST_F(Report, shows_every_class_of_every_check) {
    const std::string page = without_breaks(visible(sample_page()));
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const std::string name(to_string(static_cast<HitClass>(c)));
        EXPECT_NE(page.find(">" + name + "</th>"), std::string::npos) << name;
    }
    for (const std::string name : {"wrong triangle", "exhausted", "oracle-invalid", "judged"}) {
        EXPECT_NE(page.find("<th>" + name + "</th>"), std::string::npos) << name;
    }
    EXPECT_EQ(count_of(page, "<tr class=\"oracle\">"), sample_check_run().checks.size());
}

TEST_F(Report, shows_no_speed_without_its_errors) {
    const std::string page = visible(sample_page());
    size_t speeds = 0;
    for (size_t at = page.find("<tr"); at != std::string::npos; at = page.find("<tr", at + 1)) {
        const std::string row = page.substr(at, page.find("</tr>", at) - at);
        if (row.find("class=\"speed\"") == std::string::npos) continue;
        ++speeds;
        EXPECT_NE(row.find("class=\"errors"), std::string::npos) << row;
    }
    EXPECT_EQ(speeds, sample_bench_run().timings.size() + timed_sizes(sample_tune_run()) +
                          cloud_points({sample_check_run(), sample_bench_run()}));
    EXPECT_NE(page.find("<td class=\"errors bad\">308<small>0.117\u00a0%"), std::string::npos);
}

TEST_F(Report, gives_charts_no_speed_without_its_errors) {
    const std::string page = sample_page();
    const size_t open = page.find("id=\"onepass-data\">");
    const std::string data = page.substr(open, page.find("</script>", open) - open);
    EXPECT_EQ(count_of(data, "\"oracle\":"), sample_bench_run().timings.size());
    EXPECT_EQ(count_of(data, "\"predicted\":"), timed_sizes(sample_tune_run()));
    EXPECT_EQ(count_of(data, "\"frontOfRest\":"),
              cloud_points({sample_check_run(), sample_bench_run()}));
    EXPECT_EQ(count_of(data, "\"errors\":"), count_of(data, "\"oracle\":") +
                                                 count_of(data, "\"time\":") +
                                                 count_of(data, "\"frontOfRest\":"))
        << "the sizes that stand out have times and errors of their own";
}

TEST_F(Report, says_first_who_is_right_who_is_wrong_and_who_is_fast) {
    const std::string page = visible(sample_page());
    const size_t findings = page.find("class=\"findings\"");
    ASSERT_NE(findings, std::string::npos);
    EXPECT_LT(findings, page.find("<table"));
    const std::string text = page.substr(findings, page.find("</ul>", findings) - findings);
    EXPECT_EQ(text.find("Right."), std::string::npos) << "nobody passes every check: " << text;
    EXPECT_NE(text.find("paper/texture2d/{compute, fragment}</code> failed a check"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("paper/texture2d/compute</code> is the fastest of all"), std::string::npos)
        << text;
}

TEST_F(Report, says_first_which_grid_size_was_the_fastest_with_its_errors) {
    const Results run = sample_tune_run();
    const std::string page = visible(render_report({{run}}, {{folder_}}));
    const size_t findings = page.find("class=\"findings\"");
    ASSERT_NE(findings, std::string::npos);
    const std::string text = page.substr(findings, page.find("</ul>", findings) - findings);
    const std::optional<Tuning> tuning = tuning_of(run.sweeps);
    ASSERT_TRUE(tuning);
    const SweepPoint& best = run.sweeps[tuning->best];
    EXPECT_NE(text.find(fmt::format("fastest at {} cells a triangle",
                                    report::significant(best.object_density))),
              std::string::npos)
        << text;
    EXPECT_NE(text.find(fmt::format("{} error", best.errors)), std::string::npos) << text;
}

TEST_F(Report, draws_timings_as_speed_against_accuracy_with_a_front) {
    Results run;
    run.timings = {sample_timing("bunny", kRobust, 1.0), sample_timing("bunny", kFragment, 0.5),
                   sample_timing("bunny", kCompute, 0.25)};
    run.timings[2].errors = 0;
    run.timings[1].device_ms = run.timings[1].wall_ms;
    for (double& ms : run.timings[1].device_ms) ms /= 8.0;
    run.timings[1].oracle_wall_ms = run.timings[0].wall_ms;
    const std::vector<Results> runs = {run};
    const std::vector<fs::path> folders = {folder_};
    const std::vector<report::Cloud> all = report::clouds(report::gather(runs, folders));
    ASSERT_EQ(all.size(), 1u);
    EXPECT_FALSE(all[0].every_answer_judged);
    EXPECT_GT(all[0].points[1].ratio, 1.0);
    EXPECT_EQ(all[0].front, (std::vector<bool>{true, true, false}));
    EXPECT_EQ(all[0].front_of_rest, (std::vector<bool>{false, true, true}));
}

TEST_F(Report, embeds_a_sheet_of_pixels_and_refuses_an_edited_one) {
    Results run = sample_check_run();
    const std::string sheet = R"({"pixels":[7],"columns":[["</script>"]],"tracers":[]})";
    write_file(folder_ / "sheet.json", sheet);
    run.pixel_sheets.push_back({"bunny", 256, 256, 1, 12, "sheet.json", sha256_text(sheet)});
    const std::string page = render({run});
    EXPECT_NE(page.find(R"("left_out":12)"), std::string::npos);
    EXPECT_NE(page.find(R"("pixels":[7])"), std::string::npos);
    EXPECT_EQ(count_of(page, "</script>"), 3u) << "a sheet cannot end the script";
    EXPECT_EQ(count_of(page, "<template class=\"layers\">"), run.scenes.size());

    write_file(folder_ / "sheet.json", sheet + " ");
    EXPECT_THROW(render({run}), Error);
    fs::remove(folder_ / "sheet.json");
    EXPECT_THROW(render({run}), Error);
}

TEST_F(Report, says_in_one_sentence_a_scene_what_came_out) {
    const std::string page = visible(sample_page());
    EXPECT_NE(page.find("<code>paper/texture2d/fragment</code> errs on 308 of 262,144 primary rays "
                        "(0.117\u00a0%)"),
              std::string::npos);
    EXPECT_NE(page.find("No error in 1,048,576 rays; 2 pictures agree"), std::string::npos);
}

TEST_F(Report, adds_up_the_classes_of_each_tracer_over_all_scenes) {
    constexpr auto kWrongSurface = static_cast<size_t>(HitClass::wrong_surface);
    const Results run = sample_check_run();
    const std::string page = visible(render({run}));
    const size_t table = page.find("<h3>All scenes together</h3>");
    ASSERT_NE(table, std::string::npos);
    for (const std::string& tracer : {kFragment, kCompute}) {
        uint64_t rays = 0, wrong = 0, scenes_with_wrong = 0;
        for (const CheckRecord& check : run.checks) {
            if (check.tracer != tracer) continue;
            rays += check.ray_count;
            wrong += check.classes[kWrongSurface].count;
            scenes_with_wrong += check.classes[kWrongSurface].count > 0 ? 1 : 0;
        }
        ASSERT_GT(scenes_with_wrong, 1u) << "else there is nothing to add up";
        const size_t row = page.find("<th scope=\"row\">" + tracer + "</th><td>" +
                                         report::grouped(run.scenes.size()) + "</td><td>" +
                                         report::grouped(rays) + "</td>",
                                     table);
        ASSERT_NE(row, std::string::npos) << tracer;
        EXPECT_LT(page.find("<td class=\"bad\">" + report::grouped(wrong) + "</td>", row),
                  page.find("</tr>", row))
            << tracer;
    }
}

TEST_F(Report, needs_no_sum_for_one_scene) {
    Results run = sample_check_run();
    run.scenes.resize(1);
    const auto elsewhere = [&](const auto& record) { return record.scene != run.scenes[0].name; };
    std::erase_if(run.tracers, elsewhere);
    std::erase_if(run.checks, elsewhere);
    std::erase_if(run.images, elsewhere);
    EXPECT_EQ(visible(render({run})).find("All scenes together"), std::string::npos);
}

TEST_F(Report, explains_the_slack_of_the_paper_with_the_figures_of_the_data) {
    const std::string page = visible(sample_page());
    EXPECT_NE(page.find("names another triangle than the oracle for 313 of 262,144 (0.119\u00a0%)"),
              std::string::npos);
    EXPECT_EQ(count_of(page, "at most 1.004 instead of 1"), 1u);
    EXPECT_NE(
        page.find("names another triangle than the oracle for 17 of 262,144 (0.00648\u00a0%)"),
        std::string::npos);
}

TEST_F(Report, does_not_explain_a_slack_that_is_switched_off) {
    Results run = sample_check_run();
    for (TracerRecord& tracer : run.tracers) {
        if (!tracer.is_oracle) tracer.params["edge_tolerance"] = "1.0";
    }
    EXPECT_EQ(visible(render({run})).find("class=\"why\""), std::string::npos);
}

TEST_F(Report, blames_no_slack_for_ties) {
    const std::string page = visible(sample_page());
    const size_t balls = page.find("<section id=\"scene-balls-1\"");
    EXPECT_EQ(page.substr(balls, page.find("</section>", balls) - balls).find("class=\"why\""),
              std::string::npos);
}

TEST_F(Report, tells_tracers_of_one_name_apart_by_their_parameters) {
    Results strict = sample_check_run();
    for (TracerRecord& tracer : strict.tracers) {
        if (!tracer.is_oracle) tracer.params["edge_tolerance"] = "1.0";
    }
    for (CheckRecord& check : strict.checks) check.wrong_triangle = 6;
    const std::string page = visible(render({sample_check_run(), strict}));
    EXPECT_NE(page.find("paper/texture2d/fragment (edge_tolerance = 1.004)"), std::string::npos);
    EXPECT_NE(page.find("paper/texture2d/fragment (edge_tolerance = 1.0)"), std::string::npos);
    EXPECT_NE(page.find("the same rays give 6 of 262,144 (0.00229\u00a0%)"), std::string::npos);
}

TEST_F(Report, lists_a_check_that_two_runs_share_once) {
    const std::string once = visible(render({sample_check_run()}));
    const std::string twice = visible(render({sample_check_run(), sample_check_run()}));
    EXPECT_EQ(count_of(once, "<tr class=\"oracle\">"), count_of(twice, "<tr class=\"oracle\">"));
}

TEST_F(Report, sets_a_check_on_fewer_rays_apart_but_still_counts_its_verdict) {
    Results bench = sample_bench_run();
    bench.checks = {sample_check("balls-1", kFragment, "primary", 0)};
    bench.checks[0].ray_hash = "others";
    bench.checks[0].ray_count /= 4;
    bench.checks[0].passed = false;
    const std::string page = visible(render({sample_check_run(), bench}));
    EXPECT_NE(page.find("1 more check of the same tracers"), std::string::npos);
    EXPECT_NE(page.find("<span class=\"badge fail\">Fail</span><a href=\"#scene-balls-1\">"),
              std::string::npos);
    EXPECT_NE(page.find("; 1 check on fewer rays failed"), std::string::npos);
}

TEST_F(Report, escapes_every_text_of_the_data) {
    Results run = sample_check_run();
    const std::string evil = "<script>alert('&\"')</script>";
    run.manifest.arguments.push_back(evil);
    for (std::string* text : {&run.manifest.cpu, &run.manifest.embree, &run.manifest.judge,
                              &run.manifest.commit, &run.manifest.gl_renderer}) {
        *text = evil;
    }
    for (SceneRecord& scene : run.scenes) scene.name = scene.hash = scene.notes[0] = evil;
    for (TracerRecord& tracer : run.tracers) {
        tracer.scene = tracer.device = tracer.shader_hash = evil;
        tracer.params[evil] = evil;
        tracer.stats[0].name = tracer.stats[0].note = evil;
    }
    for (CheckRecord& check : run.checks) {
        check.scene = check.tracer = check.rays = check.oracle = check.judge = evil;
    }
    for (ImageRecord& image : run.images) {
        image.scene = image.tracer = image.oracle = image.reason = evil;
        image.pictures[0].first = evil;
    }
    run.timings = sample_bench_run().timings;
    for (TimingRecord& timing : run.timings) {
        timing.scene = timing.tracer = timing.rays = evil;
    }
    const std::string page = render({run});
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    EXPECT_EQ(count_of(page, "</script>"), 3u);
    EXPECT_NE(page.find("&lt;script&gt;alert(&#39;&amp;&quot;&#39;)&lt;/script&gt;"),
              std::string::npos);
}

TEST_F(Report, loads_nothing_from_the_network) {
    const std::string page = sample_page();
    for (const std::string& address : matches(visible(page), "(src|href)=\"[^\"]{0,5}")) {
        const std::string value = address.substr(address.find('"') + 1);
        EXPECT_TRUE(value.starts_with("#") || value.starts_with("data:")) << address;
    }
    EXPECT_EQ(page.find("<script src"), std::string::npos);
    EXPECT_EQ(page.find("@import"), std::string::npos);
    EXPECT_EQ(page.find("url("), std::string::npos);
}

TEST_F(Report, embeds_each_picture_once_a_scene) {
    const std::string page = visible(sample_page());
    const std::string uri = report::data_uri(report::read_png(folder_ / "difference.png"));
    EXPECT_EQ(count_of(page, uri), sample_check_run().scenes.size());
    EXPECT_EQ(count_of(page, "Classes of the primary rays</strong>"),
              sample_check_run().scenes.size());
}

TEST_F(Report, says_which_picture_is_the_same_as_one_that_is_shown) {
    std::filesystem::copy_file(folder_ / "image.png", folder_ / "oracle.png",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_NE(visible(sample_page()).find("byte for byte the picture of "), std::string::npos);
}

TEST_F(Report, shows_a_grid_size_that_could_not_be_built_with_its_reason) {
    const std::string page = visible(sample_page());
    EXPECT_NE(page.find("expected at most 4096 &lt;of 16^3&gt;"), std::string::npos);
    EXPECT_NE(
        page.find("1 could not be built. Best, by errors and then by speed: object λ 4.00, top λ "
                  "1.20."),
        std::string::npos);
}

TEST_F(Report, names_a_picture_that_is_missing) {
    fs::remove(folder_ / "difference.png");
    try {
        sample_page();
        FAIL() << "a page without its picture";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("difference.png"), std::string::npos);
        EXPECT_FALSE(error.parts().remedy.empty());
    }
}

TEST_F(Report, refuses_a_picture_that_is_no_png) {
    write_file(folder_ / "difference.png", "GIF89a, and long enough for a header");
    EXPECT_THROW(sample_page(), Error);
}

TEST_F(Report, stays_below_its_size_bound_or_says_so) {
    EXPECT_LT(sample_page().size(), kReportMaxBytes);

    std::string heavy = disc_png(16, vec3(1.0f));
    heavy.resize(kReportMaxBytes);
    write_file(folder_ / "difference.png", heavy);
    EXPECT_THROW(sample_page(), Error);
}

TEST_F(Report, flags_a_software_renderer) {
    EXPECT_NE(visible(sample_page()).find("<strong>Software renderer.</strong>"),
              std::string::npos);
    Results run = sample_check_run();
    run.manifest.software_renderer = false;
    for (TracerRecord& tracer : run.tracers) tracer.software_renderer = false;
    EXPECT_EQ(visible(render({run})).find("<strong>Software renderer.</strong>"),
              std::string::npos);
}

TEST_F(Report, gives_the_command_that_remakes_a_run_quoted_for_a_shell) {
    EXPECT_NE(visible(sample_page())
                  .find("onepass check bunny --json &#39;results/local/it&#39;\\&#39;&#39;s "
                        "here.json&#39;</code>"),
              std::string::npos);
}

TEST_F(Report, gives_the_worst_ray_as_text_that_reads_back_bit_equal) {
    EXPECT_NE(without_breaks(visible(sample_page()))
                  .find("--ray 0.1,0.33333334,2.5,0.0625,-0.25,-1,0,inf</code>"),
              std::string::npos);
}

TEST_F(Report, needs_at_least_one_run) { EXPECT_THROW(render_report({}, {}), Error); }

TEST_F(Report, stands_a_run_without_any_record) {
    const std::string page = render({Results{}});
    EXPECT_NE(page.find("id=\"environment\""), std::string::npos);
    EXPECT_EQ(page.find("id=\"speed\""), std::string::npos);
}

TEST_F(Report, writes_the_sample_page_where_asked) {
    const std::string page = sample_page();
    if (const char* path = std::getenv("ONEPASS_REPORT_SAMPLE")) write_file(path, page);
    EXPECT_TRUE(page.starts_with("<!doctype html>"));
    EXPECT_EQ(page.find("{{title}}"), std::string::npos);
}

TEST_F(Report, draws_growth_on_log_axes_with_its_exponents_and_errors) {
    const std::string page = render({sample_growth_run()});
    const std::string seen = without_breaks(visible(page));
    EXPECT_EQ(count_of(seen, "data-chart=\"growth\""), 3u) << "build, memory, random rays";
    EXPECT_NE(seen.find("<td class=\"speed\">0.250<small>± 0.000</small>"), std::string::npos)
        << "the exponent";
    EXPECT_NE(seen.find("2<small>of 4,096</small>"), std::string::npos) << "errors of a sample";
    EXPECT_NE(seen.find("more &lt;cells&gt; than fit"), std::string::npos);
    EXPECT_NE(page.find("\"exponent\":0.25"), std::string::npos) << "for the chart";
    EXPECT_EQ(render({sample_bench_run()}).find("id=\"growth\""), std::string::npos);

    Results casts_only = sample_growth_run();
    casts_only.growth_builds.clear();
    const std::string part = render({casts_only});
    EXPECT_NE(page.find("<h4>Builds</h4>"), std::string::npos);
    EXPECT_EQ(part.find("<h4>Builds</h4>"), std::string::npos);
    EXPECT_NE(part.find("<h4>Casts</h4>"), std::string::npos);
}

TEST_F(Report, shows_the_devices_own_rate_and_whether_it_held_its_pace) {
    Results run = sample_bench_run();
    TimingRecord& timing = run.timings[2];
    ASSERT_EQ(timing.tracer, kCompute);
    timing.oracle_wall_ms.assign(9, 100.0);
    timing.device_ms.assign(9, 0.25);
    timing.ray_count = 1'000'000;
    run.paces = {{"bunny", "primary", 1'000'000, 321, 1500.0, 0.004, true, "An invented GPU",
                  ClockReading{1980, 2619, 41}, ClockReading{1965, 2619, 55}},
                 {"balls-1", "primary", 1'000'000, 321, 20000.0, 0.04, false, "not known: a reason",
                  std::nullopt, std::nullopt}};
    const std::string seen = visible(render({run}));
    EXPECT_NE(seen.find("0.2500<small>4,000 Mrays/s</small><small>400 ×"), std::string::npos);
    EXPECT_NE(seen.find("1,980 MHz<small>memory 2,619 MHz, 41 °C</small>"), std::string::npos);
    EXPECT_NE(seen.find("1,965 MHz"), std::string::npos);
    EXPECT_NE(seen.find("not known: a reason"), std::string::npos);
    EXPECT_EQ(count_of(seen, "not steady"), 1u);
    EXPECT_EQ(visible(render({sample_bench_run()})).find("Pace of the device"), std::string::npos);
}

TEST(ReportNumbers, keep_significant_digits_and_never_an_exponent) {
    EXPECT_EQ(report::significant(0.0), "0");
    EXPECT_EQ(report::significant(9.996), "10.0");
    EXPECT_EQ(report::significant(0.000123456), "0.000123");
    EXPECT_EQ(report::significant(1234567.0), "1,234,567");
    EXPECT_EQ(report::significant(-2.5), "−2.50");
    EXPECT_EQ(report::significant(kNaN), "–");
    EXPECT_EQ(report::significant(INFINITY), "∞");
    EXPECT_EQ(report::grouped(999), "999");
    EXPECT_EQ(report::grouped(1000), "1,000");
    EXPECT_EQ(report::percent(308, 262144), "0.117\u00a0%");
    EXPECT_EQ(report::percent(0, 10), "0\u00a0%");
    EXPECT_EQ(report::percent(0, 0), "–");
}

TEST(ReportNumbers, never_round_a_share_of_rays_to_zero) {
    EXPECT_NE(report::percent(1, 1u << 30), "0\u00a0%");
}

TEST(ReportPictures, are_base64_as_rfc_4648_has_it) {
    EXPECT_EQ(report::base64(""), "");
    EXPECT_EQ(report::base64("f"), "Zg==");
    EXPECT_EQ(report::base64("fo"), "Zm8=");
    EXPECT_EQ(report::base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(report::base64(std::string("\xff\xfe\xfd", 3)), "//79");
}

// ---- The paper, reproduced.

TEST_F(Report, of_a_reproduction_opens_with_the_claims_and_their_verdicts_in_words) {
    const std::string page = visible(render({sample_paper_run()}));
    const size_t claims = page.find("id=\"claims\"");
    ASSERT_NE(claims, std::string::npos);
    EXPECT_LT(claims, page.find("id=\"tables\""));
    EXPECT_LT(page.find("id=\"tables\""), page.find("id=\"summary\""));
    for (const char* word :
         {"badge pass\">Holds", "badge fail\">Fails", "badge depends\">Depends",
          "badge\">Not measured", "10 % on ATI", "by an invented rule", "b against a: time × 3",
          "onepass reproduce --claim early-out", "no tracer of that name", "not public"}) {
        EXPECT_NE(page.find(word), std::string::npos) << word;
    }
    EXPECT_NE(page.find("An &lt;invented&gt; claim"), std::string::npos) << "escaped";
    EXPECT_NE(page.find("By fragment shaders"), std::string::npos);
    EXPECT_NE(page.find("By compute shaders"), std::string::npos) << "fragment and compute apart";
}

TEST_F(Report, without_claims_says_nothing_of_the_paper) {
    const std::string page = visible(sample_page());
    for (const char* id : {"claims", "tables", "figures", "motion", "streaming"}) {
        EXPECT_EQ(page.find(std::string("<section id=\"") + id + "\""), std::string::npos) << id;
    }
}

TEST_F(Report, lists_deviations_only_where_wrong_rays_were_attributed_to_them) {
    const auto lists_deviations = [&](const Results& run) {
        return visible(render({run})).find("id=\"deviations\"") != std::string::npos;
    };
    Results run = sample_check_run();
    run.tracers.front().deviations = {{"D11", "edge_tolerance", "1", "0.4 % of slack"}};
    EXPECT_FALSE(lists_deviations(run));
    run.checks.front().attribution = {true, {{"D11", 33}}, 0};
    EXPECT_TRUE(lists_deviations(run));
}

TEST_F(Report, sets_the_papers_tables_beside_ours) {
    const std::string page = visible(render({sample_paper_run()}));
    const std::string tables = page.substr(page.find("id=\"tables\""));
    EXPECT_NE(tables.find("<td>31,200</td><td>31,200</td>"), std::string::npos) << "as published";
    EXPECT_NE(tables.find("<td>1,676</td><td class=\"bad\">1,600</td>"), std::string::npos)
        << "a count that is off is marked";
    EXPECT_NE(tables.find("<td>5.80</td>"), std::string::npos) << "frames/s then";
    EXPECT_NE(tables.find("<td>1.52</td>"), std::string::npos) << "Mrays/s then";
    EXPECT_NE(tables.find("3.12<small>0.250 × Embree"), std::string::npos) << "frames/s now";
    EXPECT_EQ(count_of(tables.substr(0, tables.find("</section>")), "errors bad"), 3u)
        << "errors beside each of the three speeds";
    EXPECT_NE(tables.find("not measured"), std::string::npos) << "the other scenes";
}

TEST_F(Report, shows_the_figures_once) {
    const std::string page = visible(render({sample_paper_run()}));
    EXPECT_EQ(count_of(page, "data:image/png"), 3u) << "image, oracle, difference";
    EXPECT_NE(page.find("two mirrors that reflect each other"), std::string::npos);
}

TEST_F(Report, shows_passes_bytes_and_the_copy_of_a_streaming_tracer) {
    const std::string page = visible(render({sample_paper_run()}));
    const std::string part = page.substr(page.find("id=\"streaming\""));
    for (const char* figure :
         {"1,234", "3.00 MiB", "2.00 MiB", "steps_per_pass=1", "<td>200</td>", "<td>1.60</td>"}) {
        EXPECT_NE(part.find(figure), std::string::npos) << figure;
    }
}

TEST_F(Report, shows_what_moving_objects_costs) {
    const std::string page = visible(render({sample_paper_run()}));
    const std::string part = page.substr(page.find("id=\"motion\""));
    EXPECT_NE(part.find("<td>0.750</td><td>0.250</td>"), std::string::npos);
    EXPECT_NE(part.find("0.31 %"), std::string::npos) << "1 ms of 320";
}

TEST_F(Report, counts_wrong_rays_by_deviation_over_all_checks) {
    const std::string page = visible(render({sample_paper_run()}));
    const std::string part = page.substr(page.find("id=\"deviations\""));
    EXPECT_NE(part.find("<code>edge_tolerance=1</code></td><td>99</td>"), std::string::npos);
    EXPECT_NE(part.find("<code>clip_to_cell=0</code></td><td>18</td>"), std::string::npos);
    EXPECT_NE(part.find("Unattributed</th><td></td><td></td><td class=\"bad\">3</td>"),
              std::string::npos);
    EXPECT_NE(part.find("<td>120</td>"), std::string::npos) << "all wrong rays";
}

TEST(Support, is_above_1_for_what_speaks_for_the_claim) {
    using report::support_of;
    const auto above = support_of(sample_measurement(Expectation::above, 3.0, {}));
    EXPECT_EQ(above.value, 3.0);
    EXPECT_DOUBLE_EQ(above.low, 3.0 * 0.96 / 1.02) << "widened by the noise";
    EXPECT_DOUBLE_EQ(above.high, 3.0 * 1.04 * 1.02);
    const auto below = support_of(sample_measurement(Expectation::below, 4.0, {}));
    EXPECT_EQ(below.value, 0.25);
    EXPECT_LT(below.low, below.high);
    EXPECT_TRUE(std::isnan(support_of(sample_measurement(Expectation::none, 4.0, {})).value));
}

}  // namespace
}  // namespace onepass
