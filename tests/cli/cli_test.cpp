// The program as a user meets it: exit codes, one-sentence errors, and no output where none is due.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "compare/npy.h"
#include "compare/results.h"
#include "core/io/load.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

struct Outcome {
    int exit_code = -1;
    std::string out;
    std::string err;
};

/// Starts the program in `folder` with stdout and stderr in files there.
pid_t start(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {ONEPASS_BINARY};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = folder.path() / ".stdout";
    const std::string err = folder.path() / ".stderr";
    const std::string where = folder.path();

    const pid_t child = fork();
    if (child != 0) return child;
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    dup2(open(out.c_str(), flags, 0644), STDOUT_FILENO);
    dup2(open(err.c_str(), flags, 0644), STDERR_FILENO);
    if (chdir(where.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
}

Outcome finish(const TemporaryFolder& folder, pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
            read_bytes(folder.path() / ".stdout"), read_bytes(folder.path() / ".stderr")};
}

Outcome onepass_in(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
    return finish(folder, start(folder, arguments));
}

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
         {"doctor", "list", "render", "check", "bench", "tune", "report", "shader", "scenes"}) {
        EXPECT_NE(outcome.out.find(std::string("\n  ") + command), std::string::npos) << command;
    }
    EXPECT_NE(outcome.out.find("Exit codes"), std::string::npos);
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
    EXPECT_NE(onepass_in(folder, {"tune", "--help"}).out.find("[0.5,1,2,4,8,16,32]"),
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

TEST(Check, prints_every_class_and_writes_results) {
    const TemporaryFolder folder;
    const Outcome outcome = onepass_in(folder, with(kSmallCheck, {"--json", "run.json"}));
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 1) << outcome.err;
    for (const char* word : {"agree", "tie", "edge", "false_miss", "false_hit", "wrong_surface",
                             "t_error", "exhausted", "judge: double precision", "PSNR"}) {
        EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
    }
    const Results results = read_results(folder.path() / "run.json");
    ASSERT_EQ(results.checks.size(), 2u);
    bool passed = true;
    for (const CheckRecord& check : results.checks) {
        EXPECT_EQ(check.ray_count, 4096u);
        uint64_t classed = check.oracle_invalid;
        for (const ClassTally& tally : check.classes) classed += tally.count;
        EXPECT_EQ(classed, check.ray_count) << "every ray is in one class";
        passed &= check.passed;
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
    EXPECT_EQ(results_from_json(outcome.out, "run").checks.size(), 2u) << outcome.err;
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

TEST(Bench, refuses_too_few_repetitions) {
    const TemporaryFolder folder;
    expect_refused(folder,
                   {"bench", "balls-1", "-s", "embree/fast", "--size", "8x8", "--repetitions", "3"},
                   "--repetitions");
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

TEST(Report, refuses_what_is_no_result) {
    const TemporaryFolder folder;
    folder.write("bad.json", "{\"schema_version\": 1");
    expect_refused(folder, {"report", "bad.json", "-o", "page.html"}, "bad.json");
    expect_refused(folder, {"report", "missing.json", "-o", "page.html"}, "missing.json");
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
