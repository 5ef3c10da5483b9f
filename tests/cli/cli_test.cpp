// The program as a user meets it: exit codes, one-sentence errors, and no output where none is due.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "compare/ablation.h"
#include "compare/npy.h"
#include "compare/results.h"
#include "core/io/load.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

/// What the program left behind, apart from its captured streams.
std::vector<std::string> leftovers(const TemporaryFolder& folder) {
    std::vector<std::string> names = folder.names();
    std::erase(names, ".stdout");
    std::erase(names, ".stderr");
    std::sort(names.begin(), names.end());
    return names;
}

/// Exit code 2, one line on stderr that starts as errors do, nothing on stdout, no file.
void expect_refused(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                    const std::string& expected_word) {
    const std::vector<std::string> before = leftovers(folder);
    const Outcome outcome = onepass_in(folder, arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("onepass: error: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(expected_word), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(leftovers(folder), before);
}

const std::vector<std::string> kSmallCheck = {"check",  "balls-1", "-s",     "embree/fast",
                                              "--size", "64x64",   "--rays", "primary",
                                              "--rays", "random"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(Help, lists_every_command) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, {"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* command :
         {"doctor", "list", "render", "check", "explain", "bench", "compare", "tune", "stress",
          "reproduce", "merge", "report", "shader", "scenes"}) {
        EXPECT_NE(outcome.out.find(std::string("\n  ") + command), std::string::npos) << command;
    }
    EXPECT_NE(outcome.out.find("Exit codes"), std::string::npos);
}

TEST(Tune, writes_sizes_that_check_takes_and_says_so_in_its_records) {
    const TemporaryFolder folder;
    const Outcome tuned =
        onepass_in(folder, {"tune", "knife", "-s", "grid/buffer/twin32", "--size", "16x16",
                            "--densities", "1,4", "--sizing", "auto", "--repetitions", "9",
                            "--warm-up", "0", "--json", "tune.json", "--sizing-out", "sizes.json"});
    ASSERT_EQ(tuned.exit_code, 0) << tuned.err;
    const Results study = read_results(folder.path() / "tune.json");
    ASSERT_EQ(study.sweeps.size(), 3u) << "two listed, and auto";
    EXPECT_EQ(study.sweeps[2].chosen, "auto");

    const std::vector<std::string> check = {"check",      "knife",   "-s",     "grid/buffer/twin32",
                                            "--size",     "16x16",   "--json", "check.json",
                                            "--no-image", "--sizing"};
    const Outcome checked = onepass_in(folder, with(check, {"sizes.json"}));
    EXPECT_EQ(checked.exit_code, 0) << checked.err;
    const Results results = read_results(folder.path() / "check.json");
    EXPECT_EQ(results.tracers[0].sizing, "sizes.json");
    const auto file = nlohmann::json::parse(read_bytes(folder.path() / "sizes.json"));
    EXPECT_EQ(results.tracers[0].params.at("density"),
              file["scenes"][0]["tracers"][0]["objects"][0]["size"]);

    std::filesystem::remove(folder.path() / "check.json");
    expect_refused(folder,
                   with({"check", "sr71a", "-s", "grid/buffer/twin32", "--sizing"}, {"sizes.json"}),
                   "hash");
    expect_refused(folder, with(check, {"none.json"}), "none.json");
    expect_refused(folder, with(with(check, {"sizes.json"}), {"--param", "density=2"}), "--sizing");
}

TEST(Help, states_defaults_and_units) {
    const TemporaryFolder folder;
    const std::string check = onepass_in(folder, {"check", "--help"}).out;
    EXPECT_NE(check.find("512x512"), std::string::npos);
    EXPECT_NE(check.find("pixels"), std::string::npos);
    EXPECT_NE(check.find("primary,random"), std::string::npos) << check;
    const std::string bench = onepass_in(folder, {"bench", "--help"}).out;
    EXPECT_NE(bench.find("ms"), std::string::npos);
    EXPECT_NE(bench.find("=11"), std::string::npos) << bench;
    EXPECT_NE(onepass_in(folder, {"tune", "--help"}).out.find("cells a triangle"),
              std::string::npos);
}

TEST(Usage, without_a_command_or_with_an_unknown_one_is_refused) {
    const TemporaryFolder folder;
    expect_refused(folder, {}, "--help");
    expect_refused(folder, {"destroy"}, "destroy");
    expect_refused(folder, {"render"}, "scene");
    expect_refused(folder, {"render", "balls-1", "--colour"}, "--colour");
    expect_refused(folder, {"--gl", "vulkan", "list"}, "vulkan");
}

const std::vector<std::string> kSmallExplain = {"explain",     "balls-1", "-s",
                                                "embree/fast", "-s",      "grid/b*/twin32"};

TEST(Explain, tells_one_ray_of_an_image_and_leaves_a_scene_that_says_the_same) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(
        folder, with(kSmallExplain,
                     {"--pixel", "32,32", "--size", "64x64", "-o", "out/ray", "--json", "e.json"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* words :
         {"exact answer", "embree/fast/threads  agree", "walk of grid/buffer/twin32",
          "grid/buffer/twin32   reproduces: yes, agree"}) {
        EXPECT_NE(outcome.out.find(words), std::string::npos) << words << "\n" << outcome.out;
    }
    const auto json = nlohmann::json::parse(read_bytes(folder.path() / "e.json"));
    EXPECT_EQ(json["tracers"].size(), 2u);

    // The files alone: the same ray, and the same t.
    const std::vector<Ray> rays = read_rays_npy(folder.path() / "out/ray/ray.npy");
    ASSERT_EQ(rays.size(), 1u);
    EXPECT_EQ(json["ray"]["dir"][0].get<float>(), rays[0].dir.x);
    EXPECT_LT(
        load_scene_file(folder.path() / "out/ray/scene.glb").scene.objects[0].triangles.size(),
        200u);
    const Outcome again =
        onepass_in(folder, {"explain", "out/ray/scene.glb", "--ray", "out/ray/ray.npy", "-s",
                            "embree/fast", "--json", "-"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    const auto small = nlohmann::json::parse(again.out);
    EXPECT_EQ(small["hits"][0]["t_digits"], json["hits"][0]["t_digits"]);
    EXPECT_EQ(small["tracers"][0]["t"], json["tracers"][0]["t"]);
    EXPECT_NE(read_bytes(folder.path() / "out/ray/README.md")
                  .find("onepass explain scene.glb --ray ray.npy -s 'embree/fast' -s "
                        "'grid/b*/twin32'\n"),
              std::string::npos);
}

TEST(Explain, takes_a_ray_by_its_numbers_and_by_the_index_that_check_prints) {
    const TemporaryFolder folder;
    const auto by_index = nlohmann::json::parse(
        onepass_in(folder, with(kSmallExplain, {"--ray", "vertex#7", "--json", "-"})).out);
    const auto by_numbers = nlohmann::json::parse(
        onepass_in(folder, with(kSmallExplain, {"--ray", by_index["ray"]["text"].get<std::string>(),
                                                "--json", "-"}))
            .out);
    EXPECT_EQ(by_index, by_numbers);
    EXPECT_FALSE(by_index["hits"].empty());
}

TEST(Explain, refuses_rays_that_are_not_there) {
    const TemporaryFolder folder;
    expect_refused(folder, {"explain", "balls-1"}, "--pixel");
    expect_refused(folder, {"explain", "balls-1", "--ray", "1,2,3,4,5,6", "--pixel", "1,1"},
                   "one of");
    expect_refused(folder, {"explain", "balls-1", "--ray", "1,2,3"}, "tmax");
    expect_refused(folder, {"explain", "balls-1", "--ray", "vertex"}, "vertex#INDEX");
    expect_refused(folder, {"explain", "balls-1", "--ray", "vertex#99999999"}, "262143");
    expect_refused(folder, {"explain", "balls-1", "--ray", "no.npy#0"}, "no.npy");
    expect_refused(folder, {"explain", "balls-1", "--ray", "straight#0"}, "straight");
    expect_refused(folder, {"explain", "balls-1", "--pixel", "64,0", "--size", "64x64"}, "64 x 64");
    expect_refused(folder, {"explain", "balls-1", "--pixel", "3"}, "X,Y");
    expect_refused(folder, {"explain", "balls-1", "--pixel", "0,0", "--camera", "9"}, "--camera");
    expect_refused(folder, {"explain", "balls-1", "--pixel", "0,0", "-s", "magic"}, "magic");
    folder.write("file", "");
    expect_refused(folder, {"explain", "balls-1", "--pixel", "0,0", "-o", "file"}, "-o file");
}

TEST(Render, refuses_a_scene_that_is_not_there) {
    const TemporaryFolder folder;
    expect_refused(folder, {"render", "no-such-scene", "-o", "a.png"}, "no-such-scene");
    expect_refused(folder, {"render", "missing.obj", "-o", "a.png"}, "missing.obj");
    expect_refused(folder, {"render", ".", "-o", "a.png"}, "directory");
}

TEST(Render, refuses_scene_files_that_are_broken) {
    const TemporaryFolder folder;
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    folder.write("empty.obj", "");
    folder.write("no_faces.obj", triangle);
    folder.write("index.obj", triangle + "f 1 2 9\n");
    folder.write("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("unknown.xyz", triangle);
    ASSERT_EQ(onepass_in(folder, {"scenes", "export", "balls-1", "-o", "whole.glb"}).exit_code, 0);
    const std::string whole = read_bytes(folder.path() / "whole.glb");
    folder.write("cut.glb", whole.substr(0, whole.size() / 2));
    folder.write("cut.gltf", R"({"asset": {"version": "2.0"}, "meshes": [{"prim)");
    for (const char* file : {"empty.obj", "no_faces.obj", "index.obj", "nan.obj", "unknown.xyz",
                             "cut.glb", "cut.gltf"}) {
        expect_refused(folder, {"render", file, "-o", "a.png"}, file);
    }
}

TEST(Render, refuses_a_scene_that_does_not_fit_the_textures) {
    const TemporaryFolder folder;
    expect_refused(folder,
                   {"render", "instances", "-s", "paper", "--param", "resolution=64x64x64",
                    "--param", "atlas=32", "-o", "a.png"},
                   "atlas");
}

TEST(Render, gives_the_same_hits_through_osmesa_and_egl) {
    const TemporaryFolder folder;
    const std::vector<std::string> both = {"osmesa", "egl"};
    for (const std::string scene : {"balls-1", "instances"}) {
        for (const std::string entry : {"fragment", "compute"}) {
            std::vector<std::string> files;
            for (const std::string& gl : both) {
                const Outcome outcome =
                    onepass_in(folder, {"--gl", gl, "render", scene, "-s",
                                        "paper/texture2d/" + entry, "--size", "128x128", "--aov",
                                        "t,u,v,prim_id,inst_id,cells,tests", "-o", gl + ".npy"});
                ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
                files.push_back(read_bytes(folder.path() / (gl + ".npy")));
            }
            EXPECT_GT(files[0].size(), 128u * 128u * 28u);
            EXPECT_TRUE(files[0] == files[1]) << scene << ", " << entry;
        }
    }
}

TEST(Render, refuses_bad_options_before_it_works) {
    const TemporaryFolder folder;
    const std::vector<std::string> render = {"render", "balls-1", "-s", "embree"};
    for (const char* size : {"0x10", "10", "x", "10x", "-1x5", "10x10x10", "99999x1", "10 x 10"}) {
        expect_refused(folder, with(render, {"-o", "a.png", "--size", size}), "--size");
    }
    expect_refused(folder, with(render, {"-o", "a.png", "--param", "density"}), "NAME=VALUE");
    expect_refused(folder, with(render, {"-o", "a.png", "--param", "warp=9"}), "warp");
    expect_refused(folder, with(render, {"-o", "a.png", "--camera", "7"}), "--camera");
    expect_refused(folder, with(render, {"-o", "a.jpeg"}), ".jpeg");
    expect_refused(folder, with(render, {"-o", "no/such/folder/a.png"}), "folder");
    expect_refused(folder, with(render, {"-o", "."}), "folder");
    expect_refused(folder, with(render, {"-o", "a.exr", "--aov", "depth"}), "depth");
    expect_refused(folder, with(render, {"-o", "a.npy", "--aov", "cells"}), "cells");
    expect_refused(folder, {"render", "balls-1", "-s", "warp-drive", "-o", "a.png"}, "warp-drive");
}

TEST(Render, writes_one_file_of_named_channels) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, {"render", "balls-1", "-s", "embree", "--size",
                                                "32x16", "-o", "a.npy", "--aov", "color,prim_id"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(leftovers(folder), std::vector<std::string>{"a.npy"});
    const std::string bytes = read_bytes(folder.path() / "a.npy");
    EXPECT_NE(bytes.find("('prim_id', '<u4')"), std::string::npos);
    EXPECT_NE(bytes.find("(16, 32)"), std::string::npos);
}

// ---- Frames of an animation ----

/// Strategies that `render --frames` must move as Embree does.
const char* const kMovingStrategies[] = {"embree/fast/threads", "paper"};

class RenderFrames : public testing::TestWithParam<const char*> {
  protected:
    std::vector<std::string> render(const std::vector<std::string>& more) const {
        return with({"render", "balls-1", "-s", GetParam(), "--size", "48x32"}, more);
    }
};
INSTANTIATE_TEST_SUITE_P(Strategies, RenderFrames, testing::ValuesIn(kMovingStrategies));

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST_P(RenderFrames, agree_with_embree_and_build_their_objects_once) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(
        folder, render({"--frames", "0..4", "--fps", "3", "-o", "f.%02d.npy", "--json", "r.json"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err << outcome.out;
    EXPECT_EQ(leftovers(folder), (std::vector<std::string>{"f.00.npy", "f.01.npy", "f.02.npy",
                                                           "f.03.npy", "f.04.npy", "r.json"}));
    EXPECT_EQ(count_of(outcome.out, " agrees\n"), 5u) << outcome.out;
    EXPECT_NE(outcome.out.find("5 of 5 frames agree"), std::string::npos) << outcome.out;

    const Results results = read_results(folder.path() / "r.json");
    ASSERT_EQ(results.images.size(), 5u);
    ASSERT_EQ(results.checks.size(), 5u);
    EXPECT_EQ(results.images[4].scene, "balls-1, frame 4");
    EXPECT_EQ(results.checks[4].ray_count, 48u * 32u);
    std::vector<double> builds;
    for (const TracerRecord& tracer : results.tracers) {
        for (const Stat& stat : tracer.stats) {
            if (stat.name == "object_builds" || stat.name == "top_builds") {
                builds.push_back(stat.value);
            }
        }
    }
    EXPECT_EQ(builds, (std::vector<double>{1, 6, 1, 6})) << "one object; one top level a frame";
}

TEST_P(RenderFrames, move_and_loop_and_start_at_the_still_image) {
    const TemporaryFolder folder;
    // Two frames a second, in a loop of 2 s: frames 0 and 4 are one.
    ASSERT_EQ(
        onepass_in(folder, render({"--frames", "0..4", "--fps", "2", "--no-check", "-o", "%d.npy"}))
            .exit_code,
        0);
    ASSERT_EQ(onepass_in(folder, render({"-o", "still.npy"})).exit_code, 0);
    const auto frame = [&](const std::string& name) {
        return read_bytes(folder.path() / (name + ".npy"));
    };
    EXPECT_TRUE(frame("0") == frame("still"));
    EXPECT_TRUE(frame("0") == frame("4"));
    EXPECT_FALSE(frame("0") == frame("1"));
    EXPECT_FALSE(frame("1") == frame("3"));
}

TEST_P(RenderFrames, resumed_leave_whole_files_alone) {
    const TemporaryFolder folder;
    folder.write("1.npy", "kept");
    const Outcome outcome =
        onepass_in(folder, render({"--frames", "0..2", "--resume", "-o", "%d.npy"}));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_bytes(folder.path() / "1.npy"), "kept");
    EXPECT_NE(outcome.out.find("1 frames were there already"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("2 of 2 frames agree"), std::string::npos) << outcome.out;
    EXPECT_EQ(leftovers(folder), (std::vector<std::string>{"0.npy", "1.npy", "2.npy"}));

    ASSERT_EQ(onepass_in(folder, render({"--frames", "0..2", "-o", "%d.npy"})).exit_code, 0);
    EXPECT_NE(read_bytes(folder.path() / "1.npy"), "kept") << "done anew without --resume";
}

TEST_P(RenderFrames, end_after_a_whole_frame_when_interrupted) {
    const TemporaryFolder folder;
    const pid_t child =
        start(folder, render({"--frames", "0..9999999", "-o", "%d.npy", "--json", "r.json"}));
    const auto third = folder.path() / "2.npy";
    for (int k = 0; k < 6000 && !std::filesystem::exists(third); ++k) usleep(10000);  // a minute
    kill(child, SIGINT);
    const Outcome outcome = finish(folder, child);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    const Results results = read_results(folder.path() / "r.json");
    EXPECT_FALSE(results.manifest.complete);
    EXPECT_EQ(leftovers(folder).size(), results.images.size() + 1)
        << "a file a frame, and the JSON";
    EXPECT_GE(results.images.size(), 3u);
    const auto size = std::filesystem::file_size(folder.path() / "0.npy");
    for (size_t k = 0; k < results.images.size(); ++k) {
        EXPECT_EQ(std::filesystem::file_size(folder.path() / fmt::format("{}.npy", k)), size);
    }
}

TEST(RenderFramesOptions, are_refused_before_anything_is_rendered) {
    const TemporaryFolder folder;
    const std::vector<std::string> render = {"render", "balls-1", "-s", "embree", "--size", "8x8"};
    const auto frames = [&](const std::vector<std::string>& more) {
        return with(with(render, {"--frames", "0..3"}), more);
    };
    for (const char* pattern : {"a.npy", "a.%d.%d.npy", "a.%5d.npy", "a.%x.npy", "a.%"}) {
        expect_refused(folder, frames({"-o", pattern}), "%04d");
    }
    expect_refused(folder, frames({"-o", "a.%d.jpeg"}), ".jpeg");
    expect_refused(folder, frames({"-o", "missing/a.%d.npy"}), "missing");
    for (const char* range : {"3..2", "a..b", "1..", "..", "0..99999999999"}) {
        expect_refused(folder, with(render, {"--frames", range, "-o", "%d.npy"}), "A..B");
    }
    expect_refused(folder, frames({"--fps", "0", "-o", "%d.npy"}), "--fps");
    expect_refused(folder, with(render, {"--resume", "-o", "a.npy"}), "--frames");
    expect_refused(folder,
                   {"render", "instances", "-s", "embree", "--frames", "0..3", "-o", "%d.npy"},
                   "nothing moves");
    expect_refused(folder, {"check", "instances", "-s", "embree/fast", "--frames", "0..3"},
                   "nothing moves");
}

TEST(CheckFrames, takes_each_frame_as_a_scene_of_its_own) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"check", "balls-1", "-s", "embree/fast", "--size", "32x32", "--frames",
                            "5..6", "--rays", "primary", "--rays", "random", "--json", "r.json"});
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1) << outcome.err;
    const Results results = read_results(folder.path() / "r.json");
    ASSERT_EQ(results.checks.size(), 8u) << "Embree's robust mode stands beside the fast one";
    EXPECT_EQ(results.checks[0].scene, "balls-1, frame 5");
    EXPECT_EQ(results.checks[7].scene, "balls-1, frame 6");
    EXPECT_NE(results.scenes[0].hash, "");
    for (const CheckRecord& check : results.checks) EXPECT_EQ(check.errors(), 0u) << check.scene;
    EXPECT_NE(outcome.out.find("balls-1, frame 6, primary rays"), std::string::npos) << outcome.out;
}

TEST(Check, prints_every_class_and_writes_results) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, with(kSmallCheck, {"--json", "run.json"}));
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1) << outcome.err;
    for (const char* word : {"agree", "tie", "edge", "false_miss", "false_hit", "wrong_surface",
                             "t_error", "exhausted", "judge: exact", "(the oracle)", "PSNR"}) {
        EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
    }
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_EQ(results.checks.size(), 4u) << "two kinds of rays, and the oracle's own rows";
    bool passed = true;
    for (const CheckRecord& check : results.checks) {
        EXPECT_EQ(check.reference, check.tracer == check.oracle);
        EXPECT_EQ(check.ray_count, 4096u);
        uint64_t classed = check.oracle_invalid;
        for (const ClassTally& tally : check.classes) classed += tally.count;
        EXPECT_EQ(classed, check.ray_count) << "every ray is in one class";
        passed &= check.passed || check.reference;
    }
    ASSERT_EQ(results.images.size(), 1u);
    EXPECT_EQ(outcome.exit_code == 0, passed && results.images[0].passed);
    for (const auto& [role, file] : results.images[0].pictures) {
        EXPECT_TRUE(std::filesystem::exists(folder.path() / file)) << role;
    }
    EXPECT_EQ(results.manifest.gl_context, "") << "no GL context for an Embree check";
}

TEST(Check, takes_one_value_for_each_repeated_option) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"check", "-s", "embree/fast", "-s", "embree/robust/1thread", "--rays",
                            "primary", "balls-1", "--size", "16x16", "--no-image", "--json", "-"});
    const Results results = results_from_json(outcome.out, "run");
    ASSERT_EQ(results.checks.size(), 3u) << outcome.err;
    EXPECT_FALSE(results.checks[0].reference) << "asked for by name: it is checked";
    EXPECT_FALSE(results.checks[1].reference);
    EXPECT_TRUE(results.checks[2].reference);
}

TEST(Check, goes_on_without_a_strategy_that_refuses_the_scene) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"check", "balls-1", "-s", "paper/texture2d/twin32", "-s", "embree/fast",
                            "--param", "atlas=16", "--size", "16x16", "--rays", "primary",
                            "--no-image", "--json", "r.json"});
    EXPECT_EQ(outcome.exit_code, 1) << "a refusal is no pass";
    EXPECT_NE(outcome.out.find("refused: balls-1, paper/texture2d/twin32"), std::string::npos)
        << outcome.out;
    EXPECT_EQ(read_results(folder.path() / "r.json").checks.size(), 2u);

    expect_refused(folder,
                   {"check", "balls-1", "-s", "paper/texture2d/twin32", "--param", "atlas=16",
                    "--size", "16x16", "--no-image"},
                   "atlas");
}

TEST(Check, gives_the_same_counts_for_the_same_seed) {
    const TemporaryFolder folder;
    const auto check = with(kSmallCheck, {"--no-image", "--seed", "5", "--json", "-"});
    const Results a = results_from_json(onepass_in(folder, check).out, "a");
    const Results b = results_from_json(onepass_in(folder, check).out, "b");
    EXPECT_EQ(a.checks[1].ray_hash, b.checks[1].ray_hash);
    EXPECT_EQ(a.checks[1].judged, b.checks[1].judged);
    EXPECT_TRUE(leftovers(folder).empty()) << "no JSON file, no pictures";
}

TEST(Check, keeps_json_on_stdout_apart_from_the_tables) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, with(kSmallCheck, {"--no-image", "--json", "-"}));
    EXPECT_TRUE(nlohmann::json::accept(outcome.out));
    EXPECT_NE(outcome.err.find("false_miss"), std::string::npos) << "the table is on stderr";
}

TEST(Check, fails_with_exit_code_1_when_a_bound_is_broken) {
    const TemporaryFolder folder;
    const auto check = with(kSmallCheck, {"--no-image", "--allow", "agree=10"});
    const Outcome outcome = onepass_in(folder, check);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.out.find("> 10"), std::string::npos) << outcome.out;
}

TEST(Check, says_where_wrong_rays_come_from_and_which_tracer_has_no_image) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"check", "instances", "-s", "paper/texture2d/fragment", "-s",
                            "brute_force", "--rays", "primary", "--size", "64x64", "--attribute"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.out.find("gone with --param edge_tolerance=1"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("  0 rays unattributed"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("brute_force/texture2d/fragment: answers rays only"),
              std::string::npos)
        << outcome.out;
    EXPECT_EQ(outcome.out.find("paper/texture2d/fragment: answers rays only"), std::string::npos);
}

TEST(Check, answers_nan_rays_and_counts_them) {
    const TemporaryFolder folder;
    std::vector<Ray> rays(5);
    for (Ray& ray : rays) ray.org.y = 50.0f;  // above all balls
    rays[1].org.x = std::numeric_limits<float>::quiet_NaN();
    rays[2].dir = vec3(std::numeric_limits<float>::quiet_NaN());
    rays[3].dir.x = kInfinity;
    write_rays_npy(folder.path() / "rays.npy", rays);
    const Outcome outcome = onepass_in(folder, {"check", "balls-1", "-s", "embree/fast", "--rays",
                                                "rays.npy", "--no-image", "--json", "run.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_results(folder.path() / "run.json").checks[0].oracle_invalid, 3u);
    EXPECT_NE(outcome.out.find("3 the oracle cannot take"), std::string::npos) << outcome.out;
}

TEST(Check, refuses_bad_rays_bounds_and_outputs) {
    const TemporaryFolder folder;
    folder.write("broken.npy", "not numpy");
    const std::vector<std::string> check = {"check", "balls-1", "-s", "embree/fast"};
    expect_refused(folder, with(check, {"--rays", "broken.npy"}), "broken.npy");
    expect_refused(folder, with(check, {"--rays", "sideways"}), "sideways");
    expect_refused(folder, with(check, {"--allow", "edge"}), "--allow");
    expect_refused(folder, with(check, {"--camera", "9"}), "camera 9");
    expect_refused(folder, with(check, {"--json", "no/such/folder/run.json"}), "folder");
    expect_refused(folder,
                   {"check", "balls-1", "no-such-scene", "-s", "embree/fast", "--size", "16x16",
                    "--json", "run.json"},
                   "no-such-scene");
}

TEST(Bench, shows_embree_four_times_with_errors_beside_the_speed) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(
        folder, {"bench", "instances", "balls-1", "-s", "embree/fast", "--size", "32x32", "--rays",
                 "primary", "--warm-up", "0", "--repetitions", "9", "--json", "run.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_EQ(results.timings.size(), 8u) << "four Embrees in two scenes, none twice";
    EXPECT_EQ(results.checks.size(), 8u);
    for (const TimingRecord& timing : results.timings) {
        EXPECT_EQ(timing.wall_ms.size(), 9u);
        EXPECT_EQ(timing.oracle, "embree/robust/threads");
    }
    EXPECT_EQ(results.timings[0].ratio, 1.0);
    EXPECT_NE(outcome.out.find("errors"), std::string::npos);
}

TEST(Bench, times_only_the_references_asked_for_and_lets_slow_ones_go) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(
        folder, {"bench", "balls-1", "-s", "embree/fast/threads", "--reference",
                 "embree/robust/1thread", "--size", "64x64", "--rays", "primary", "--warm-up", "0",
                 "--repetitions", "20", "--enough", "0", "--json", "run.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_EQ(results.timings.size(), 3u);
    EXPECT_EQ(results.timings[0].tracer, "embree/robust/threads") << "the oracle always is there";
    EXPECT_EQ(results.timings[0].wall_ms.size(), 20u);
    EXPECT_EQ(results.timings[1].tracer, "embree/robust/1thread");
    EXPECT_EQ(results.timings[1].wall_ms.size(), 9u);
    EXPECT_EQ(results.timings[2].tracer, "embree/fast/threads");
    EXPECT_TRUE(results.paces.empty()) << "no tracer here has a device timer";
}

TEST(Bench, refuses_too_few_repetitions) {
    const TemporaryFolder folder;
    expect_refused(folder,
                   {"bench", "balls-1", "-s", "embree/fast", "--size", "8x8", "--repetitions", "3"},
                   "--repetitions");
}

TEST(Bench, of_settings_judges_every_answer_and_marks_the_front) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"bench", "knife", "--settings", "--size", "16x16", "--rays", "vertex",
                            "--warm-up", "0", "--repetitions", "9", "--json", "run.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_FALSE(results.tradeoffs.empty());
    EXPECT_EQ(results.tradeoffs[0].tracer, "embree/robust/threads");
    EXPECT_EQ(results.tradeoffs[0].ratio, 1.0);
    uint64_t slack = 0;
    for (const TradeoffPoint& point : results.tradeoffs) {
        EXPECT_EQ(point.scene, "knife");
        EXPECT_EQ(point.rays, "vertex");
        EXPECT_EQ(point.ray_count, 256u);
        EXPECT_EQ(point.wall_ms.size(), 9u);
        if (point.setting == "geometry=half") slack = point.errors;
    }
    EXPECT_GT(slack, 0u) << "triangles in 16 bits leave holes";
    EXPECT_NE(outcome.out.find("* on the Pareto front"), std::string::npos);
    EXPECT_NE(outcome.out.find("geometry=half"), std::string::npos);
}

TEST(Bench, of_a_strategys_steps_times_it_as_it_is_and_without_each_of_them) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"bench", "knife", "--ablate", "grid/buffer/compute", "--rays", "shadow",
                            "--rays", "image", "--size", "32x32", "--warm-up", "0", "--repetitions",
                            "9", "--json", "run.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_GE(results.ablations.size(), 4u);
    EXPECT_EQ(results.ablations[0].setting, "");
    EXPECT_EQ(results.ablations[0].ratio, 1.0);
    EXPECT_EQ(results.ablations[1].setting, "") << "the same again, to see what can be told apart";
    std::map<std::string, uint64_t> errors;
    for (const AblationRecord& record : results.ablations) {
        EXPECT_EQ(record.failure, "") << record.setting;
        EXPECT_EQ(record.wall_ms.size(), 9u) << record.setting;
        errors[record.setting] += record.errors;
    }
    EXPECT_EQ(errors.size(), 1 + ablation_steps("grid").size());
    for (const char* clean : {"", "skip_empty=0", "any_hit=0", "specialise=0", "ssbo"}) {
        ASSERT_TRUE(errors.contains(clean)) << clean;
        EXPECT_EQ(errors[clean], 0u) << clean;
    }
    EXPECT_NE(outcome.out.find("as it is, again"), std::string::npos) << outcome.out;
    expect_refused(folder, {"bench", "knife", "--ablate", "paper"}, "paper");
    expect_refused(folder, {"bench", "knife", "--ablate", "grid", "-s", "paper"}, "--ablate");
}

TEST(Bench, refuses_to_choose_strategies_for_its_settings) {
    const TemporaryFolder folder;
    expect_refused(folder, {"bench", "knife", "--settings", "-s", "paper"}, "--settings");
    expect_refused(folder, {"bench", "knife", "--entry", "compute"}, "--settings");
}

const std::vector<std::string> kSmallGrowth = {"grow",
                                               "-s",
                                               "grid/buffer/twin32",
                                               "-s",
                                               "embree/fast/threads",
                                               "--triangles",
                                               "1e3,2e3,4e3",
                                               "--ray-counts",
                                               "64,256",
                                               "--fixed-rays",
                                               "256",
                                               "--fixed-triangles",
                                               "1000",
                                               "--repetitions",
                                               "9",
                                               "--judged",
                                               "64",
                                               "-o",
                                               "out"};

TEST(Grow, measures_every_size_fits_exponents_and_draws_them) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, kSmallGrowth);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Results results = read_results(folder.path() / "out/growth.json");
    EXPECT_EQ(results.growth_builds.size(), 3u * 3u) << "three sizes by three tracers";
    EXPECT_EQ(results.growth_traces.size(), 5u * 3u * 3u) << "five steps, three kinds of rays";
    for (const GrowthTrace& trace : results.growth_traces) {
        EXPECT_EQ(trace.wall_ms.size(), 9u);
        EXPECT_GT(trace.judged, 0u);
        if (trace.tracer.starts_with("grid/")) {
            EXPECT_EQ(trace.errors, 0u) << trace.rays;
        }
    }
    EXPECT_NE(outcome.out.find("time over rays, random, grid/buffer/twin32"), std::string::npos)
        << outcome.out;
    const std::string page = read_bytes(folder.path() / "out/growth.html");
    EXPECT_NE(page.find("How cost grows"), std::string::npos);
}

TEST(Grow, stopped_keeps_the_sizes_it_finished_and_goes_on_from_there) {
    const TemporaryFolder folder;
    std::vector<std::string> grow = kSmallGrowth;
    grow[6] = "1e3,2e3,5e5";
    const pid_t child = start(folder, grow);
    const auto part = folder.path() / "out/parts/triangles-1000.json";
    for (int tick = 0; tick < 6000 && !std::filesystem::exists(part); ++tick) usleep(10000);
    kill(child, SIGINT);
    const Outcome stopped = finish(folder, child);
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("of 5 sizes are kept"), std::string::npos) << stopped.err;
    const Results partial = read_results(folder.path() / "out/growth.json");
    EXPECT_FALSE(partial.manifest.complete);
    EXPECT_GE(partial.growth_builds.size(), 3u);

    const Outcome resumed = onepass_in(folder, kSmallGrowth);
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("triangles-1000: kept"), std::string::npos)
        << "another list of sizes, the same size: " << resumed.err;
    EXPECT_EQ(read_results(folder.path() / "out/growth.json").growth_builds.size(), 9u);
}

TEST(Grow, refuses_numbers_that_are_no_counts) {
    const TemporaryFolder folder;
    expect_refused(folder, {"grow", "--triangles", "1.5"}, "--triangles");
    expect_refused(folder, {"grow", "--ray-counts", "1e20"}, "--ray-counts");
    expect_refused(folder, {"grow", "--triangles", "4", "-s", "embree/fast/threads"}, "lumpy");
    expect_refused(folder, {"grow", "--repetitions", "3"}, "--repetitions");
}

TEST(Tune, refuses_a_strategy_without_grids) {
    const TemporaryFolder folder;
    expect_refused(folder, {"tune", "balls-1", "-s", "embree/fast"}, "density");
}

TEST(Report, makes_a_page_from_results) {
    const TemporaryFolder folder;
    onepass_in(folder, with(kSmallCheck, {"--json", "run.json"}));
    const Outcome outcome = onepass_in(folder, {"report", "run.json", "-o", "page.html"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(read_bytes(folder.path() / "page.html").find("balls-1"), std::string::npos);
}

TEST(Report, check_passes_what_a_run_wrote_and_fails_what_somebody_edited) {
    const TemporaryFolder folder;
    onepass_in(folder, with(kSmallCheck, {"--json", "run.json"}));
    const std::vector<std::string> check = {"report", "--check", "run.json"};
    const Outcome untouched = onepass_in(folder, check);
    EXPECT_EQ(untouched.exit_code, 0) << untouched.out;
    EXPECT_NE(untouched.out.find("the digest is right"), std::string::npos) << untouched.out;

    const std::string text = read_bytes(folder.path() / "run.json");
    const size_t at = text.find("\"seed\": 1");
    ASSERT_NE(at, std::string::npos);
    folder.write("run.json", std::string(text).replace(at, 9, "\"seed\": 2"));
    const Outcome edited = onepass_in(folder, check);
    EXPECT_EQ(edited.exit_code, 1);
    EXPECT_NE(edited.out.find("FAILED"), std::string::npos) << edited.out;
    EXPECT_NE(edited.out.find("DIGEST"), std::string::npos) << edited.out;
}

TEST(Report, leaves_figures_in_a_folder_and_wants_to_know_what_to_make) {
    const TemporaryFolder folder;
    onepass_in(folder, with(kSmallCheck, {"--json", "run.json"}));
    const Outcome outcome = onepass_in(folder, {"report", "run.json", "--figures", "it's new"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "it's new" / "checks.csv"));
    expect_refused(folder, {"report", "run.json"}, "--figures");
}

// ---- Stress ----

TEST(Stress, prints_where_each_method_breaks_and_passes_whatever_fails) {
    const TemporaryFolder folder;
    const Outcome outcome =
        onepass_in(folder, {"stress", "vertices", "there-and-back", "-s", "embree/fast/threads",
                            "-s", "grid/buffer/twin32", "--rays", "64", "--json", "a.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("breaks at"), std::string::npos) << outcome.out;
    const Results results = read_results(folder.path() / "a.json");
    ASSERT_EQ(results.ladders.size(), 2u);
    const LadderRecord& ladder = results.ladders[1];
    EXPECT_EQ(ladder.id, "there-and-back");
    EXPECT_EQ(ladder.rungs.size(), 14u);
    EXPECT_NE(ladder.command.find("onepass stress there-and-back -s embree/fast/threads"),
              std::string::npos)
        << ladder.command;
    EXPECT_NE(breaks_at(ladder, "embree/fast/threads", ""), nullptr);
    EXPECT_EQ(breaks_at(ladder, "grid/buffer/twin32", ""), nullptr);
    EXPECT_NE(outcome.out.find("embree/fast/threads at"), std::string::npos) << "its worst ray";
}

TEST(Stress, keeps_finished_ladders_and_writes_the_page_beside_the_data) {
    const TemporaryFolder folder;
    const std::vector<std::string> stress = {
        "stress", "grazing", "mirror", "-s", "embree/robust/threads", "--rays", "32", "-o", "out"};
    const Outcome first = onepass_in(folder, stress);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const auto out = folder.path() / "out";
    EXPECT_EQ(read_results(out / "partial.json").ladders.size(), 2u);
    EXPECT_TRUE(std::filesystem::exists(out / "partial.html"));

    std::filesystem::remove(out / "parts/mirror.json");
    const Outcome second = onepass_in(folder, stress);
    EXPECT_NE(second.err.find("grazing: kept"), std::string::npos) << second.err;
    EXPECT_EQ(second.err.find("mirror: kept"), std::string::npos) << second.err;
    EXPECT_EQ(second.out, first.out) << "the same seed, the same answers";

    const Outcome other = onepass_in(folder, with(stress, {"--seed", "9"}));
    EXPECT_NE(other.err.find("made again: it was made with other options"), std::string::npos);
}

TEST(Stress, refuses_what_it_does_not_know_and_lists_what_it_does) {
    const TemporaryFolder folder;
    expect_refused(folder, {"stress", "stairs"}, "stairs");
    expect_refused(folder, {"stress", "grazing", "-s", "warp-drive"}, "warp-drive");
    expect_refused(folder, {"stress", "grazing", "--rays", "0"}, "--rays");
    expect_refused(folder, {"stress", "grazing", "--json", "no/such/folder/a.json"}, "folder");
    const Outcome list = onepass_in(folder, {"stress", "--list"});
    EXPECT_EQ(list.exit_code, 0);
    for (const char* id : {"translation", "needles", "lattice", "singular", "resolution"}) {
        EXPECT_NE(list.out.find(id), std::string::npos) << id;
    }
}

TEST(Stress, stopped_says_so_and_goes_on_from_there) {
    const TemporaryFolder folder;
    const std::vector<std::string> stress = {
        "stress", "mirror", "shear", "needles", "-s", "embree/fast/threads",
        "--rays", "160",    "-o",    "out"};
    const pid_t child = start(folder, stress);
    const auto part = folder.path() / "out/parts/mirror.json";
    for (int tick = 0; tick < 6000 && !std::filesystem::exists(part); ++tick) usleep(10000);
    kill(child, SIGINT);
    const Outcome stopped = finish(folder, child);
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("of 3 ladders are kept"), std::string::npos) << stopped.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/partial.json"));

    const Outcome resumed = onepass_in(folder, stress);
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("mirror: kept"), std::string::npos) << resumed.err;
    EXPECT_EQ(read_results(folder.path() / "out/partial.json").ladders.size(), 3u);
}

TEST(Reproduce, makes_data_and_page_keeps_its_parts_and_takes_up_where_it_was) {
    const TemporaryFolder folder;
    const std::vector<std::string> reproduce = {"reproduce", "-o",      "out/paper", "--quick",
                                                "--scene",   "balls-1", "--claim",   "cpu-tracer"};
    const Outcome first = onepass_in(folder, reproduce);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    EXPECT_NE(first.out.find("cpu-tracer"), std::string::npos) << first.out;
    const auto out = folder.path() / "out/paper";
    const Results results = read_results(out / "partial.json");
    ASSERT_EQ(results.claims.size(), 1u);
    EXPECT_FALSE(results.claims[0].measurements.empty());
    EXPECT_EQ(results.timings.size(), 6u) << "three kinds of rays, by two tracers";
    EXPECT_NE(read_bytes(out / "partial.html").find("id=\"claims\""), std::string::npos);

    // The page alone, from the data.
    const Outcome page =
        onepass_in(folder, {"report", "out/paper/partial.json", "-o", "again.html"});
    EXPECT_EQ(page.exit_code, 0) << page.err;

    // A part that is gone is made again, the other one is kept.
    std::filesystem::remove(out / "parts/claim-cpu-tracer.json");
    const Outcome second = onepass_in(folder, reproduce);
    EXPECT_NE(second.err.find("scene-balls-1: kept"), std::string::npos) << second.err;
    EXPECT_EQ(second.err.find("claim-cpu-tracer: kept"), std::string::npos) << second.err;
    EXPECT_EQ(read_results(out / "partial.json").timings[0].wall_ms, results.timings[0].wall_ms);

    // Other options make another run.
    const Outcome third = onepass_in(folder, with(reproduce, {"--seed", "7"}));
    EXPECT_NE(third.err.find("made again: it was made with other options"), std::string::npos);
    const Outcome fresh = onepass_in(folder, with(reproduce, {"--seed", "7", "--fresh"}));
    EXPECT_EQ(fresh.err.find("kept"), std::string::npos) << fresh.err;
}

TEST(Reproduce, stopped_keeps_what_was_finished_and_goes_on_from_there) {
    const TemporaryFolder folder;
    std::vector<std::string> reproduce = {"reproduce", "-o", "out", "--quick"};
    for (const char* scene : {"balls-1", "instances", "big-small"}) {
        reproduce = with(reproduce, {"--scene", scene});
    }
    const pid_t child = start(folder, reproduce);
    const auto part = folder.path() / "out/parts/scene-balls-1.json";
    for (int tick = 0; tick < 6000 && !std::filesystem::exists(part); ++tick) usleep(10000);
    kill(child, SIGINT);
    const Outcome stopped = finish(folder, child);
    EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("of 3 steps"), std::string::npos) << stopped.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out/partial.json"));

    const Outcome resumed = onepass_in(folder, reproduce);
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_NE(resumed.err.find("scene-balls-1: kept"), std::string::npos) << resumed.err;
    EXPECT_EQ(read_results(folder.path() / "out/partial.json").scenes.size(), 3u);
}

TEST(Reproduce, refuses_what_it_does_not_know_and_lists_what_it_does) {
    const TemporaryFolder folder;
    expect_refused(folder, {"reproduce"}, "-o DIR");
    expect_refused(folder, {"reproduce", "--claim", "world-peace"}, "world-peace");
    expect_refused(folder, {"reproduce", "-o", "out", "--entry", "vertex"}, "vertex");
    const Outcome list = onepass_in(folder, {"reproduce", "--list"});
    EXPECT_EQ(list.exit_code, 0);
    for (const char* id : {"single-pass", "early-out", "brute-force", "moving-objects"}) {
        EXPECT_NE(list.out.find(id), std::string::npos) << id;
    }
}

TEST(Report, refuses_what_is_no_result) {
    const TemporaryFolder folder;
    folder.write("bad.json", "{\"schema_version\": 1");
    expect_refused(folder, {"report", "bad.json", "-o", "page.html"}, "bad.json");
    expect_refused(folder, {"report", "missing.json", "-o", "page.html"}, "missing.json");
}

TEST(Scenes, exported_are_benched_through_the_same_camera) {
    const TemporaryFolder folder;
    ASSERT_EQ(onepass_in(folder, {"scenes", "export", "knife", "-o", "knife.glb"}).exit_code, 0);
    for (const char* scene : {"knife", "knife.glb"}) {
        const Outcome outcome = onepass_in(
            folder, {"bench",         scene,     "-s",        "embree/fast/threads",
                     "--camera",      "0",       "--rays",    "primary",
                     "--rays",        "diffuse", "--rays",    "random",
                     "--size",        "32x32",   "--warm-up", "0",
                     "--repetitions", "9",       "--json",    std::string(scene) + ".json"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    const Results named = read_results(folder.path() / "knife.json");
    const Results exported = read_results(folder.path() / "knife.glb.json");
    ASSERT_EQ(named.checks.size(), exported.checks.size());
    for (size_t i = 0; i < named.checks.size(); ++i) {
        EXPECT_EQ(named.checks[i].ray_hash, exported.checks[i].ray_hash) << named.checks[i].rays;
    }
    expect_refused(folder, {"bench", "knife.glb", "--camera", "1", "--rays", "primary"},
                   "camera 1");
}

TEST(Scenes, exports_gltf_that_renders_again) {
    const TemporaryFolder folder;
    EXPECT_EQ(onepass_in(folder, {"scenes", "export", "balls-1", "-o", "balls.glb"}).exit_code, 0);
    EXPECT_EQ(onepass_in(folder,
                         {"render", "balls.glb", "-s", "embree", "--size", "16x16", "-o", "a.npy"})
                  .exit_code,
              0);
    expect_refused(folder, {"scenes", "export", "balls-1", "-o", "balls.obj"}, ".obj");
}

TEST(List, shows_strategies_with_parameters_and_scenes_with_counts) {
    const TemporaryFolder folder;
    EXPECT_NE(onepass_in(folder, {"list"}).out.find("embree/robust/threads"), std::string::npos);
    const std::string scenes = onepass_in(folder, {"list", "scenes"}).out;
    EXPECT_NE(scenes.find("balls-1"), std::string::npos);
    EXPECT_NE(scenes.find("31200"), std::string::npos);
    EXPECT_NE(scenes.find("are not public"), std::string::npos);
}

TEST(ScenesExport, writes_a_scene_flat_or_with_a_mesh_for_each_instance) {
    const TemporaryFolder folder;
    const auto exported = [&](const std::string& form) {
        EXPECT_EQ(
            onepass_in(folder, {"scenes", "export", "balls-1", form, "-o", "balls.glb"}).exit_code,
            0);
        return load_scene_file(folder.path() / "balls.glb").scene;
    };
    const Scene flat = exported("--flat");
    EXPECT_EQ(flat.instances.size(), 1u);
    EXPECT_EQ(instanced_triangle_count(flat), 31200u);
    const Scene copies = exported("--unshared");
    EXPECT_EQ(copies.objects.size(), 10u);
    EXPECT_EQ(copies.instances.size(), 10u);
    expect_refused(folder, {"scenes", "export", "balls-1", "--flat", "--unshared", "-o", "a.glb"},
                   "--unshared");
}

TEST(Interrupt, ends_a_long_run_with_whole_results_that_say_so) {
    const TemporaryFolder folder;
    const pid_t child =
        start(folder, {"bench", "balls-1", "-s", "embree/fast", "--size", "64x64", "--warm-up", "0",
                       "--repetitions", "1000000", "--json", "run.json"});
    // Rounds are under way once the checks are done; there is no sign of it from outside.
    sleep(3);
    kill(child, SIGINT);
    const Outcome outcome = finish(folder, child);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    const Results results = read_results(folder.path() / "run.json");
    EXPECT_FALSE(results.manifest.complete);
    EXPECT_EQ(leftovers(folder), std::vector<std::string>{"run.json"});
}

}  // namespace
}  // namespace onepass
