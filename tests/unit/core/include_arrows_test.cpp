// The include arrows of the architecture, enforced: which module may include which.
//
//     tests -> all      compare/{cli,bench} -> all
//     gpu_glsl -> core      cpu_ref -> core      compare -> core      scenes -> core
//
// Besides, GL headers belong to gpu_glsl and Embree's to cpu_ref. The rules are one pure function
// over (file, include) pairs, so that a made-up pair shows that each rule can fail.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace onepass {
namespace {

struct Include {
    std::string file;  ///< path from the source root
    std::string path;  ///< as written between the quotes or brackets
    bool quoted = true;
};

/// A module and the modules it may include besides itself; "all" lifts every rule.
const std::map<std::string, std::set<std::string>> kArrows = {
    {"core", {}},          {"gpu_glsl", {"core"}},   {"cpu_ref", {"core"}},
    {"compare", {"core"}}, {"compare/cli", {"all"}}, {"compare/bench", {"all"}},
    {"scenes", {"core"}},  {"tests", {"all"}},
};

std::string first_folder(const std::string& path) { return path.substr(0, path.find('/')); }

/// The module of a file: its longest matching prefix in kArrows.
std::string module_of(const std::string& file) {
    std::string module = first_folder(file);
    for (const auto& [name, allowed] : kArrows) {
        if (file.starts_with(name + "/") && name.size() > module.size()) module = name;
    }
    return module;
}

/// The module that owns a third-party header; empty if anyone may include it.
std::string owner_of_library(const std::string& include) {
    static const std::set<std::string> kGlFolders = {"GL", "GLES2", "GLES3", "EGL", "KHR", "glad"};
    static const std::set<std::string> kEmbreeFolders = {"embree3", "embree4"};
    if (kGlFolders.contains(first_folder(include))) return "gpu_glsl";
    if (kEmbreeFolders.contains(first_folder(include))) return "cpu_ref";
    return "";
}

/// What is wrong with one include; empty if nothing is.
std::string violation(const Include& include) {
    const std::string module = module_of(include.file);
    const std::set<std::string>& allowed = kArrows.at(module);
    if (allowed.contains("all")) return "";
    const auto says = [&](const std::string& reason) {
        return include.file + " includes " + include.path + ": " + reason;
    };

    const std::string owner = owner_of_library(include.path);
    if (!owner.empty()) {
        return owner == module ? "" : says("this library belongs to " + owner);
    }
    if (!include.quoted) return "";
    const std::string target = module_of(include.path);
    if (!kArrows.contains(target)) {
        // Shaders (and their twins) include by paths relative to gpu_glsl/shaders.
        return module == "gpu_glsl" ? "" : says("not a path from the source root");
    }
    if (target == module || allowed.contains(target)) return "";
    return says(module + " may not include " + target);
}

std::vector<std::string> violations(const std::vector<Include>& includes) {
    std::vector<std::string> result;
    for (const Include& include : includes) {
        const std::string text = violation(include);
        if (!text.empty()) result.push_back(text);
    }
    return result;
}

std::vector<Include> includes_of(const std::filesystem::path& root,
                                 const std::filesystem::path& file) {
    static const std::regex kInclude(R"(^\s*#\s*include\s*(["<])([^">]+)[">].*)");
    std::vector<Include> includes;
    std::ifstream in(root / file);
    EXPECT_TRUE(in) << file;
    for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, kInclude)) continue;
        includes.push_back({file.generic_string(), match[2], match[1] == "\""});
    }
    return includes;
}

/// Every include of every source and shader below the top-level folders.
std::vector<Include> scan(const std::filesystem::path& root) {
    static const std::set<std::string> kExtensions = {".h", ".cpp", ".glsl"};
    std::vector<Include> includes;
    for (const char* folder : {"core", "gpu_glsl", "cpu_ref", "compare", "scenes", "tests"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
            if (!kExtensions.contains(entry.path().extension().string())) continue;
            const auto found = includes_of(root, std::filesystem::relative(entry.path(), root));
            includes.insert(includes.end(), found.begin(), found.end());
        }
    }
    return includes;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += "\n  " + line;
    return text;
}

TEST(IncludeArrows, point_downwards_in_the_whole_source) {
    const std::vector<Include> includes = scan(ONEPASS_SOURCE_DIR);
    EXPECT_GT(includes.size(), 50u) << "the scan found next to nothing: " << ONEPASS_SOURCE_DIR;
    const std::vector<std::string> found = violations(includes);
    EXPECT_TRUE(found.empty()) << joined(found);
}

TEST(IncludeArrows, fail_when_one_is_reversed) {
    const std::vector<std::string> modules = {"core", "gpu_glsl", "cpu_ref", "compare", "scenes"};
    for (const std::string& from : modules) {
        for (const std::string& to : modules) {
            const bool allowed = from == to || to == "core";
            const std::vector<Include> made_up = {{from + "/made_up.cpp", to + "/header.h"}};
            EXPECT_EQ(violations(made_up).size(), allowed ? 0u : 1u) << from << " -> " << to;
        }
        const std::vector<Include> of_tests = {{from + "/made_up.cpp", "tests/support/header.h"}};
        EXPECT_EQ(violations(of_tests).size(), 1u) << from << " -> tests";
        const std::vector<Include> of_bench = {{from + "/made_up.cpp", "compare/bench/header.h"}};
        EXPECT_EQ(violations(of_bench).size(), 1u) << from << " -> compare/bench";
    }
}

TEST(IncludeArrows, let_the_joining_programs_and_tests_include_all) {
    const std::vector<std::string> joining = {"compare/cli", "compare/bench", "tests/unit/core"};
    for (const std::string& from : joining) {
        for (const auto& [to, allowed] : kArrows) {
            EXPECT_TRUE(violations({{from + "/made_up.cpp", to + "/header.h"}}).empty())
                << from << " -> " << to;
        }
    }
    // Only the folders of those names, not files that begin alike.
    EXPECT_EQ(violations({{"compare/cli_helper.cpp", "gpu_glsl/header.h"}}).size(), 1u);
}

TEST(IncludeArrows, keep_gl_and_embree_headers_with_their_owners) {
    EXPECT_EQ(violations({{"core/made_up.h", "glad/gl.h", false}}).size(), 1u);
    EXPECT_EQ(violations({{"core/made_up.h", "EGL/egl.h", false}}).size(), 1u);
    EXPECT_EQ(violations({{"core/made_up.h", "embree3/rtcore.h", false}}).size(), 1u);
    EXPECT_EQ(violations({{"core/made_up.h", "embree3/rtcore.h", true}}).size(), 1u);
    EXPECT_EQ(violations({{"gpu_glsl/made_up.cpp", "embree3/rtcore.h", false}}).size(), 1u);
    EXPECT_EQ(violations({{"cpu_ref/made_up.cpp", "GL/osmesa.h", false}}).size(), 1u);
    EXPECT_TRUE(violations({{"gpu_glsl/made_up.cpp", "glad/gl.h", false}}).empty());
    EXPECT_TRUE(violations({{"cpu_ref/made_up.cpp", "embree3/rtcore.h", false}}).empty());
    EXPECT_TRUE(violations({{"core/made_up.cpp", "vector", false}}).empty());
}

TEST(IncludeArrows, treat_shader_paths_as_inside_gpu_glsl) {
    const std::string shader = "gpu_glsl/shaders/strategies/made_up.glsl";
    EXPECT_TRUE(violations({{shader, "lib/dda.glsl"}}).empty());
    EXPECT_TRUE(violations({{shader, "storage/paper/texture2d.glsl"}}).empty());
    EXPECT_TRUE(violations({{"gpu_glsl/twin/made_up.cpp", "strategies/made_up.glsl"}}).empty());
    EXPECT_EQ(violations({{shader, "cpu_ref/header.h"}}).size(), 1u);
    EXPECT_EQ(violations({{"core/made_up.cpp", "lib/dda.glsl"}}).size(), 1u);
    EXPECT_EQ(violations({{"core/made_up.cpp", "error.h"}}).size(), 1u);
}

TEST(IncludeArrows, are_read_from_the_text_of_a_file) {
    const std::filesystem::path root = testing::TempDir();
    std::ofstream(root / "include_arrows_sample.cpp")
        << "#pragma once\n  #  include \"core/types.h\"  // why\n#include <vector>\n"
        << "// #include \"gpu_glsl/never.h\"\nconst char* s = \"#include\";\n";
    const std::vector<Include> found = includes_of(root, "include_arrows_sample.cpp");
    std::filesystem::remove(root / "include_arrows_sample.cpp");
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].path, "core/types.h");
    EXPECT_TRUE(found[0].quoted);
    EXPECT_EQ(found[1].path, "vector");
    EXPECT_FALSE(found[1].quoted);
}

}  // namespace
}  // namespace onepass
