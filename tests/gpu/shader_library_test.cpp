// The shader library without a GL context: composing, mapping errors, front matter.
#include "gpu_glsl/gl/shader_library.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"

namespace onepass::gl {
namespace {

using Files = std::map<std::string, std::string>;

/// A strategy's front matter with one line replaced, and the storage file it names.
Files strategy_files(const std::string& key = "", const std::string& replacement = "") {
    std::string text;
    for (const std::string line :
         {"strategy: demo", "summary: a demonstration: of front matter", "source: none",
          "structure: grid", "storage: flat", "entries: fragment compute", "gl: 4.3", "twin: yes",
          "param: slack real 1.004 upper bound of la + lb", "param: mode choice(a,b) b which way",
          "deviation: D1 slack=1 edges are loose", "deviation: D2 mode=a goes the wrong way"}) {
        const bool replaced = !key.empty() && line.starts_with(key + ":");
        if (replaced && replacement.empty()) continue;
        text += "//! " + (replaced ? replacement : line) + "\n";
    }
    return {{"strategies/demo.glsl", text + "\n// Prose.\nfloat one() { return 1.0; }\n"},
            {"storage/grid/flat.glsl", ""}};
}

/// The Error that strategies() throws.
Error::Parts strategy_error(const Files& files) {
    try {
        ShaderLibrary(files).strategies();
    } catch (const Error& error) {
        return error.parts();
    }
    ADD_FAILURE() << "strategies() did not throw";
    return {};
}

std::string compose_text(const Files& files, const std::vector<std::string>& roots) {
    return ShaderLibrary(files).compose({.stage = "fragment", .files = roots}).text;
}

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

// Composing --------------------------------------------------------------------------------------

TEST(ShaderLibrary, a_composed_text_is_version_constants_and_files_and_knows_each_lines_place) {
    const ShaderLibrary library(Files{{"a.glsl", "int a;\n#include \"lib/b.glsl\"\nint c;\n"},
                                      {"lib/b.glsl", "#pragma once\nint b;\n"}});
    const ComposedShader shader = library.compose({.glsl_version = 430,
                                                   .stage = "compute",
                                                   .files = {"a.glsl"},
                                                   .constants = {{"light_count", 2}}});
    EXPECT_EQ(shader.stage, "compute");
    EXPECT_EQ(shader.text,
              "#version 430 core\n"
              "const int light_count = 2;\n"
              "// ---- a.glsl\n"
              "int a;\n"
              "// ---- lib/b.glsl\n"
              "int b;\n"
              "// ---- a.glsl, line 3\n"
              "int c;\n");
    std::string places;
    for (const ComposedShader::Line& line : shader.lines) {
        places += shader.files[line.file] + ":" + std::to_string(line.line) + " ";
    }
    EXPECT_EQ(places,
              "<generated>:1 <generated>:2 a.glsl:1 a.glsl:1 lib/b.glsl:1 lib/b.glsl:2 a.glsl:2 "
              "a.glsl:3 ");
}

TEST(ShaderLibrary, a_file_included_twice_or_also_named_as_a_root_appears_once) {
    const Files files = {{"a.glsl", "#include \"m.glsl\"\n#include \"b.glsl\"\n"},
                         {"b.glsl", "#include \"m.glsl\"\n"},
                         {"m.glsl", "float marker;\n"}};
    EXPECT_EQ(count_of(compose_text(files, {"a.glsl", "b.glsl", "m.glsl"}), "marker"), 1u);
}

TEST(ShaderLibrary, files_that_include_each_other_end_and_appear_once) {
    const Files files = {{"a.glsl", "#include \"b.glsl\"\nint in_a;\n"},
                         {"b.glsl", "#include \"a.glsl\"\nint in_b;\n"}};
    const std::string text = compose_text(files, {"a.glsl"});
    EXPECT_EQ(count_of(text, "in_a"), 1u);
    EXPECT_EQ(count_of(text, "in_b"), 1u);
    EXPECT_LT(text.find("in_b"), text.find("in_a"));
}

TEST(ShaderLibrary, an_include_of_a_missing_file_names_file_and_line) {
    const Files files = {{"a.glsl", "int a;\n\n  # include \"lib/missing.glsl\"  // why\n"}};
    try {
        compose_text(files, {"a.glsl"});
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.parts().where, "a.glsl:3");
        EXPECT_NE(error.parts().got.find("lib/missing.glsl"), std::string::npos);
    }
}

TEST(ShaderLibrary, an_include_in_a_comment_is_left_alone) {
    const std::string text =
        compose_text({{"a.glsl", "// #include \"missing.glsl\"\n"}}, {"a.glsl"});
    EXPECT_NE(text.find("// #include"), std::string::npos);
}

TEST(ShaderLibrary, of_what_a_variant_needs_one_side_stays_with_its_places_and_includes) {
    const ShaderLibrary library(Files{{"a.glsl",
                                       "#if NEEDS(deep)  // why\n"
                                       "#include \"deep.glsl\"\n"
                                       "#ifdef ONE\n"
                                       "int one;\n"
                                       "#else\n"
                                       "#if NEEDS(wide)\n"
                                       "int deep_and_wide;\n"
                                       "#endif\n"
                                       "#endif\n"
                                       "#else\n"
                                       "int shallow;\n"
                                       "#endif\n"
                                       "int last;\n"},
                                      {"deep.glsl", "int deep_file;\n"}});
    const auto text = [&](bool deep, bool wide) {
        return library
            .compose({.stage = "fragment",
                      .files = {"a.glsl"},
                      .constants = {{"deep", deep}, {"wide", wide}}})
            .text;
    };
    const std::string head = "#version 330 core\nconst bool deep = ";
    EXPECT_EQ(text(false, true),
              head + "false;\nconst bool wide = true;\n// ---- a.glsl\nint shallow;\nint last;\n");
    EXPECT_EQ(text(true, false), head +
                                     "true;\nconst bool wide = false;\n// ---- a.glsl\n"
                                     "// ---- deep.glsl\nint deep_file;\n// ---- a.glsl, line 3\n"
                                     "#ifdef ONE\nint one;\n#else\n#endif\nint last;\n");
    EXPECT_EQ(count_of(text(true, true), "deep_and_wide"), 1u);
    const ComposedShader shader = library.compose(
        {.stage = "fragment", .files = {"a.glsl"}, .constants = {{"deep", false}, {"wide", true}}});
    EXPECT_EQ(shader.lines.back().line, 13u);
}

TEST(ShaderLibrary, a_need_that_is_no_bool_constant_or_does_not_end_names_file_and_line) {
    const auto place_of = [](const std::string& text) -> std::string {
        try {
            ShaderLibrary({{"a.glsl", text}})
                .compose({.stage = "fragment",
                          .files = {"a.glsl"},
                          .constants = {{"deep", true}, {"count", 2}}});
        } catch (const Error& error) {
            return error.parts().where;
        }
        return "nothing thrown";
    };
    EXPECT_EQ(place_of("int a;\n#if NEEDS(dep)\n#endif\n"), "a.glsl:2");
    EXPECT_EQ(place_of("#if NEEDS(count)\n#endif\n"), "a.glsl:1");
    EXPECT_EQ(place_of("int a;\n\n#if NEEDS(deep)\nint b;\n"), "a.glsl:3");
    EXPECT_EQ(place_of("int a;\n#endif\n"), "a.glsl:2");
    EXPECT_EQ(place_of("#if NEEDS(deep)\n#endif\n"), "nothing thrown");
}

TEST(ShaderLibrary, a_late_constant_is_a_uniform) {
    EXPECT_EQ(to_glsl({"light_count", 2, true}), "uniform int light_count;");
    EXPECT_EQ(to_glsl({"shadows", true, true}), "uniform bool shadows;");
    EXPECT_EQ(to_glsl({"shadows", true}), "const bool shadows = true;");
}

TEST(ShaderLibrary, extension_lines_move_before_the_constants_and_keep_their_place) {
    const ShaderLibrary library(
        Files{{"a.glsl", "int a;\n#extension GL_KHR_shader_subgroup_basic : enable\nint b;\n"}});
    const ComposedShader shader =
        library.compose({.stage = "fragment", .files = {"a.glsl"}, .constants = {{"flag", true}}});
    EXPECT_EQ(shader.text,
              "#version 330 core\n"
              "#extension GL_KHR_shader_subgroup_basic : enable\n"
              "const bool flag = true;\n"
              "// ---- a.glsl\n"
              "int a;\n"
              "int b;\n");
    EXPECT_EQ(shader.lines[1].file, 1u);
    EXPECT_EQ(shader.lines[1].line, 2u);
    EXPECT_EQ(shader.lines.back().line, 3u);
}

TEST(ShaderLibrary, the_hash_is_stable_and_changes_with_file_or_constant) {
    const auto hash = [](const std::string& text, float value) {
        const ShaderLibrary library(Files{{"a.glsl", text}});
        return library
            .compose({.stage = "fragment", .files = {"a.glsl"}, .constants = {{"k", value}}})
            .hash;
    };
    EXPECT_EQ(hash("int a;\n", 1.0f), hash("int a;\n", 1.0f));
    EXPECT_NE(hash("int a;\n", 1.0f), hash("int b;\n", 1.0f));
    EXPECT_NE(hash("int a;\n", 1.0f), hash("int a;\n", 1.004f));
    // Published FNV-1a test values.
    EXPECT_EQ(fnv1a_hex(""), "cbf29ce484222325");
    EXPECT_EQ(fnv1a_hex("a"), "af63dc4c8601ec8c");
    EXPECT_EQ(fnv1a_hex("foobar"), "85944171f73967e8");
}

TEST(ShaderLibrary, constants_are_typed_and_floats_read_back_to_the_same_bits) {
    EXPECT_EQ(to_glsl({"n", -3}), "const int n = -3;");
    EXPECT_EQ(to_glsl({"n", 3u}), "const uint n = 3u;");
    EXPECT_EQ(to_glsl({"n", false}), "const bool n = false;");
    EXPECT_EQ(to_glsl({"n", 1.0f}), "const float n = 1.0;");
    EXPECT_EQ(to_glsl({"n", std::numeric_limits<float>::infinity()}),
              "const float n = uintBitsToFloat(0x7F800000u);");
    for (const float value : {1.004f, 0.1f, 1.0f / 3.0f, 16777216.0f, 3.0e-12f, 1.17549435e-38f,
                              3.40282347e38f, -2.5f, 1e10f}) {
        const std::string text = to_glsl({"n", value});
        const std::string literal = text.substr(text.find('=') + 2);
        EXPECT_EQ(std::strtof(literal.c_str(), nullptr), value) << text;
        EXPECT_NE(literal.find_first_of(".e"), std::string::npos) << text << " is no float literal";
    }
}

// Where files come from --------------------------------------------------------------------------

TEST(ShaderLibrary, the_embedded_files_are_those_of_the_shader_folder) {
    const ShaderLibrary folder =
        ShaderLibrary::from_directory(ONEPASS_SOURCE_DIR "/gpu_glsl/shaders");
    EXPECT_EQ(ShaderLibrary(embedded_shader_files()).files(), folder.files());
    EXPECT_FALSE(folder.files().empty());
}

TEST(ShaderLibrary, an_environment_variable_replaces_the_embedded_files) {
    setenv("ONEPASS_SHADER_DIR", ONEPASS_SOURCE_DIR "/tests/gpu/shaders", 1);
    const ShaderLibrary library = ShaderLibrary::embedded();
    unsetenv("ONEPASS_SHADER_DIR");
    EXPECT_TRUE(library.files().contains("lib/place.glsl"));
    EXPECT_FALSE(ShaderLibrary::embedded().files().contains("lib/place.glsl"));
}

TEST(ShaderLibrary, a_missing_shader_folder_is_an_error_that_names_it) {
    try {
        ShaderLibrary::from_directory("/no/such/folder");
        FAIL() << "did not throw";
    } catch (const Error& error) {
        EXPECT_EQ(error.parts().where, "/no/such/folder");
    }
}

// Driver messages --------------------------------------------------------------------------------

/// A shader of three lines: generated line 1, a.glsl line 40, lib/b.glsl line 7.
ComposedShader three_lines() {
    ComposedShader shader;
    shader.files = {"<generated>", "a.glsl", "lib/b.glsl"};
    shader.lines = {{0, 1}, {1, 40}, {2, 7}};
    return shader;
}

TEST(ShaderErrors, messages_of_every_driver_are_mapped_to_file_and_line) {
    const ComposedShader shader = three_lines();
    EXPECT_EQ(map_errors(shader, "0:2(5): error: `x' undeclared\n"),
              "a.glsl:40: error: `x' undeclared\n");
    EXPECT_EQ(map_errors(shader, "0(3) : error C1503: undefined variable \"x\"\n"),
              "lib/b.glsl:7: error C1503: undefined variable \"x\"\n");
    EXPECT_EQ(map_errors(shader, "ERROR: 0:3: 'x' : undeclared identifier\n"),
              "lib/b.glsl:7: error: 'x' : undeclared identifier\n");
    EXPECT_EQ(map_errors(shader, "0:1(1): warning: odd\n3 errors\n"),
              "<generated>:1: warning: odd\n3 errors\n");
    EXPECT_EQ(map_errors(shader, "0:99(5): error: beyond the text\n"),
              "0:99(5): error: beyond the text\n");
}

TEST(ShaderErrors, the_place_of_an_error_is_the_first_errors_not_a_warnings) {
    const ComposedShader shader = three_lines();
    const std::string log = "0:1(1): warning: w\n0:2(1): error: first\n0:3(1): error: second\n";
    EXPECT_EQ(first_error_place(shader, log), "a.glsl:40");
    EXPECT_EQ(first_error_place(shader, "0:1(1): warning: w\n"), "");
}

// Front matter -----------------------------------------------------------------------------------

TEST(FrontMatter, every_line_is_read) {
    const std::vector<StrategyInfo> strategies = ShaderLibrary(strategy_files()).strategies();
    ASSERT_EQ(strategies.size(), 1u);
    const StrategyInfo& info = strategies[0];
    EXPECT_EQ(info.name, "demo");
    EXPECT_EQ(info.file, "strategies/demo.glsl");
    EXPECT_EQ(info.summary, "a demonstration: of front matter");
    EXPECT_EQ(info.structure, "grid");
    EXPECT_EQ(info.storages, std::vector<std::string>{"flat"});
    EXPECT_EQ(info.entries, (std::vector<std::string>{"fragment", "compute"}));
    EXPECT_EQ(info.gl, 430);
    EXPECT_TRUE(info.twin);
    ASSERT_EQ(info.params.size(), 2u);
    EXPECT_EQ(info.params[0],
              (ParamInfo{"slack", ParamInfo::Type::real, "1.004", "upper bound of la + lb", {}}));
    EXPECT_EQ(info.params[1],
              (ParamInfo{"mode", ParamInfo::Type::choice, "b", "which way", {"a", "b"}}));
    ASSERT_EQ(info.deviations.size(), 2u);
    EXPECT_EQ(info.deviations[0].id, "D1");
    EXPECT_EQ(info.deviations[0].param, "slack");
    EXPECT_EQ(info.deviations[0].value, "1");
    EXPECT_EQ(info.deviations[0].summary, "edges are loose");
    EXPECT_EQ(info.deviations[1].id, "D2");
    EXPECT_TRUE(info.by_default);
}

TEST(FrontMatter, a_strategy_can_be_for_named_use_only) {
    Files files = strategy_files();
    files["strategies/demo.glsl"] = "//! default: no\n" + files["strategies/demo.glsl"];
    EXPECT_FALSE(ShaderLibrary(files).strategies().at(0).by_default);
}

TEST(FrontMatter, a_strategy_without_a_twin_gives_the_reason) {
    const Files files = strategy_files("twin", "twin: none it shares memory between lanes");
    const StrategyInfo info = ShaderLibrary(files).strategies().at(0);
    EXPECT_FALSE(info.twin);
    EXPECT_EQ(info.no_twin_reason, "it shares memory between lanes");
}

TEST(FrontMatter, strategies_are_sorted_by_name) {
    Files files = strategy_files();
    std::string text = files["strategies/demo.glsl"];
    files["strategies/another.glsl"] = text.replace(text.find("demo"), 4, "another");
    const std::vector<StrategyInfo> strategies = ShaderLibrary(files).strategies();
    ASSERT_EQ(strategies.size(), 2u);
    EXPECT_EQ(strategies[0].name, "another");
    EXPECT_EQ(strategies[1].name, "demo");
}

struct BadLine {
    std::string key;
    std::string replacement;
    std::string where;
    std::string got;
};

TEST(FrontMatter, each_bad_line_is_an_error_with_its_place_and_what_was_got) {
    const std::string file = "strategies/demo.glsl";
    const BadLine bad_lines[] = {
        {"summary", "", file + ":1", "no line `//! summary: ...`"},
        {"summary", "summary:", file + ":2", "nothing after \"summary:\""},
        {"summary", "sumary: x", file + ":2", "the key \"sumary\""},
        {"summary", "no colon", file + ":2", "\"no colon\""},
        {"summary", "source: twice", file + ":3", "a second \"source:\""},
        {"strategy", "strategy: other", file + ":1", "the name \"other\""},
        {"entries", "entries: fragment mesh", file + ":6", "the entry \"mesh\""},
        {"gl", "gl: 2.1", file + ":7", "\"2.1\""},
        {"gl", "gl: 3.2", file + ":7", "\"3.2\""},
        {"twin", "twin: none", file + ":8", "\"none\""},
        {"twin", "twin: maybe", file + ":8", "\"maybe\""},
        {"param", "param: slack real", file + ":9", "\"slack real\""},
        {"param", "param: slack float 1 s", file + ":9", "the type \"float\""},
        {"param", "param: slack real 1x s", file + ":9", "the default \"1x\""},
        {"param", "param: slack integer 1.5 s", file + ":9", "the default \"1.5\""},
        {"param", "param: slack choice(a,b) c s", file + ":9", "the default \"c\""},
        {"param", "param: slack real 1 s", file + ":10", "a second parameter \"slack\""},
        {"storage", "storage: flat tall", file, "the storage \"tall\", but no file"},
        {"deviation", "deviation: D1 slack=1", file + ":11", "\"D1 slack=1\""},
        {"deviation", "deviation: D1 slack 1 loose", file + ":11", "\"D1 slack 1 loose\""},
        {"deviation", "deviation: D1 slak=1 loose", file + ":11", "the parameter \"slak\""},
        {"deviation", "deviation: D1 slack=one loose", file + ":11", "the value \"one\""},
        {"deviation", "deviation: D1 mode=c loose", file + ":11", "the value \"c\""},
        {"deviation", "deviation: D1 slack=1.004 loose", file + ":11", "the value \"1.004\""},
        {"deviation", "deviation: D1 slack=1 loose", file + ":12", "a second deviation \"D1\""},
    };
    for (const BadLine& bad : bad_lines) {
        SCOPED_TRACE(bad.replacement.empty() ? "without " + bad.key : bad.replacement);
        const Error::Parts parts = strategy_error(strategy_files(bad.key, bad.replacement));
        EXPECT_EQ(parts.where, bad.where);
        EXPECT_TRUE(parts.got.starts_with(bad.got)) << parts.got;
        EXPECT_FALSE(parts.expected.empty());
        EXPECT_FALSE(parts.remedy.empty());
    }
}

TEST(FrontMatter, a_line_after_code_is_an_error) {
    Files files = strategy_files();
    files["strategies/demo.glsl"] += "//! gl: 4.5\n";
    EXPECT_EQ(strategy_error(files).got, "front matter after code");
}

}  // namespace
}  // namespace onepass::gl
