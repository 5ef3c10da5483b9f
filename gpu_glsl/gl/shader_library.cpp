// Composition of shader texts, the way back from driver messages to files, and strategies().
#include "gpu_glsl/gl/shader_library.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <regex>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "gpu_glsl/gl/front_matter.h"

namespace onepass::gl {
namespace {

constexpr const char* kGeneratedBlock = "<generated>";
constexpr const char* kStrategyFolder = "strategies/";

std::string float_literal(float value) {
    // GLSL has no literal for infinities and NaNs.
    if (!std::isfinite(value)) {
        uint32_t bits = 0;
        static_assert(sizeof bits == sizeof value);
        std::memcpy(&bits, &value, sizeof bits);
        return fmt::format("uintBitsToFloat(0x{:08X}u)", bits);
    }
    std::string text = fmt::format("{}", value);  // the shortest text that reads back as `value`
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

/// Collects one stage's lines and where each comes from. File 0 is what C++ writes.
class Composition {
  public:
    Composition(const std::map<std::string, std::string>& library,
                const std::vector<ShaderConstant>& constants)
        : library_(library), constants_(constants) {}

    /// A line that C++ writes.
    void add_generated(const std::string& text) { head_.push_back({text, 0, ++generated_lines_}); }

    /// Appends a file unless it is there already. `place`: who asks for it.
    void append(const std::string& path, const std::string& place) {
        if (std::ranges::find(files_, path) != files_.end()) return;
        const auto found = library_.find(path);
        if (found == library_.end()) {
            throw Error({.where = place,
                         .got = fmt::format("no shader file \"{}\"", path),
                         .expected = "a path relative to the shader root",
                         .remedy = fmt::format("There are: {}.", fmt::join(known_files(), ", "))});
        }
        files_.push_back(path);
        append_lines(path, found->second, static_cast<uint32_t>(files_.size() - 1));
    }

    ComposedShader finish() {
        ComposedShader shader;
        for (const std::vector<Row>* part : {&head_, &body_}) {
            for (const Row& row : *part) {
                shader.text += row.text + "\n";
                shader.lines.push_back({row.file, row.line});
            }
        }
        shader.files = std::move(files_);
        shader.hash = fnv1a_hex(shader.text);
        return shader;
    }

  private:
    struct Row {
        std::string text;
        uint32_t file;
        uint32_t line;
    };

    void append_lines(const std::string& path, const std::string& text, uint32_t file) {
        static const std::regex kInclude(R"(\s*#\s*include\s+"([^"]*)\".*)");
        static const std::regex kPragmaOnce(R"(\s*#\s*pragma\s+once\b.*)");
        static const std::regex kExtension(R"(\s*#\s*extension\b.*)");
        body_.push_back({fmt::format("// ---- {}", path), file, 1});
        std::istringstream stream(text);
        uint32_t number = 0;
        Conditions conditions;
        for (std::string row; std::getline(stream, row);) {
            ++number;
            std::smatch match;
            const bool directive = row.find('#') != std::string::npos;
            const auto place = [&] { return fmt::format("{}:{}", path, number); };
            if (directive && resolve(row, place(), conditions)) continue;
            if (!conditions.empty() && !conditions.back().keeps) continue;
            if (directive && std::regex_match(row, match, kInclude)) {
                append(match[1], place());
                body_.push_back(
                    {fmt::format("// ---- {}, line {}", path, number + 1), file, number});
            } else if (directive && std::regex_match(row, kExtension)) {
                // GLSL wants these before everything but #version, which is the head's first line.
                head_.insert(head_.begin() + 1, {row, file, number});
            } else if (!directive || !std::regex_match(row, kPragmaOnce)) {
                body_.push_back({row, file, number});
            }
        }
        if (!conditions.empty()) {
            fail(conditions.back().place, "an #if without its #endif",
                 "an #endif in the same file");
        }
    }

    /// An `#if` of the file being read that is not closed yet.
    struct Condition {
        std::string place;
        bool resolved = false;  ///< a NEEDS: it does not appear in the text
        bool keeps = true;      ///< the lines of the side being read
    };
    using Conditions = std::vector<Condition>;

    /// Follows the conditions of a file. True if the line is part of a NEEDS, and so is left out.
    bool resolve(const std::string& row, const std::string& place, Conditions& conditions) const {
        static const std::regex kNeeds(R"(\s*#\s*if\s+NEEDS\(\s*(\w+)\s*\)\s*(//.*)?)");
        static const std::regex kIf(R"(\s*#\s*if.*)");
        static const std::regex kElse(R"(\s*#\s*else\b.*)");
        static const std::regex kEndif(R"(\s*#\s*endif\b.*)");
        std::smatch match;
        const bool outer = conditions.empty() || conditions.back().keeps;
        if (std::regex_match(row, match, kNeeds)) {
            conditions.push_back({place, true, outer && is_needed(match[1], place)});
            return true;
        }
        if (std::regex_match(row, kIf)) {
            conditions.push_back({place, false, outer});
            return false;
        }
        const bool is_else = std::regex_match(row, kElse);
        const bool is_endif = std::regex_match(row, kEndif);
        if (!is_else && !is_endif) return false;
        if (conditions.empty()) fail(place, "no #if that this belongs to", "one in the same file");
        const bool resolved = conditions.back().resolved;
        if (is_endif) {
            conditions.pop_back();
        } else if (resolved) {
            const bool enclosing = conditions.size() < 2 || conditions[conditions.size() - 2].keeps;
            conditions.back().keeps = enclosing && !conditions.back().keeps;
        }
        return resolved;
    }

    bool is_needed(const std::string& name, const std::string& place) const {
        const auto found = std::ranges::find(constants_, name, &ShaderConstant::name);
        if (found == constants_.end() || !std::holds_alternative<bool>(found->value)) {
            fail(place, fmt::format("NEEDS({})", name), "a constant of type bool of this variant");
        }
        return std::get<bool>(found->value);
    }

    [[noreturn]] static void fail(const std::string& place, const std::string& got,
                                  const std::string& expected) {
        throw Error({.where = place,
                     .got = got,
                     .expected = expected,
                     .remedy = "Mend the file; lib/dialect.glsl says what NEEDS is."});
    }

    std::vector<std::string> known_files() const {
        std::vector<std::string> paths;
        for (const auto& [path, text] : library_) paths.push_back(path);
        return paths;
    }

    const std::map<std::string, std::string>& library_;
    const std::vector<ShaderConstant>& constants_;
    std::vector<std::string> files_ = {kGeneratedBlock};
    std::vector<Row> head_;  ///< `#version`, `#extension` lines, constants
    std::vector<Row> body_;
    uint32_t generated_lines_ = 0;
};

/// A driver's line that names a place, taken apart.
struct DriverMessage {
    std::string place;  ///< file:line
    std::string text;
};

/// Returns false for a line that names no place in the text.
bool parse_message(const ComposedShader& shader, const std::string& line, DriverMessage& message) {
    static const std::regex kMesa(R"(0:(\d+)\(\d+\): (.*))");  // 0:12(5): error: ...
    static const std::regex kNvidia(R"(0\((\d+)\) : (.*))");   // 0(12) : error C1008: ...
    static const std::regex kAmd(R"((?:ERROR|WARNING): 0:(\d+): (.*))");  // ERROR: 0:12: ...
    std::smatch match;
    if (!std::regex_match(line, match, kMesa) && !std::regex_match(line, match, kNvidia) &&
        !std::regex_match(line, match, kAmd)) {
        return false;
    }
    const size_t number = std::stoul(match[1]);
    if (number < 1 || number > shader.lines.size()) return false;
    const ComposedShader::Line& origin = shader.lines[number - 1];
    message.place = fmt::format("{}:{}", shader.files[origin.file], origin.line);
    message.text = match[2];
    if (line.starts_with("ERROR")) message.text = "error: " + message.text;
    if (line.starts_with("WARNING")) message.text = "warning: " + message.text;
    return true;
}

}  // namespace

std::string to_glsl(const ShaderConstant& constant) {
    struct Printer {
        const ShaderConstant& constant;
        std::string operator()(bool v) const { return declared("bool", fmt::format("{}", v)); }
        std::string operator()(int32_t v) const { return declared("int", fmt::format("{}", v)); }
        std::string operator()(uint32_t v) const { return declared("uint", fmt::format("{}u", v)); }
        std::string operator()(float v) const { return declared("float", float_literal(v)); }

        std::string declared(const char* type, const std::string& value) const {
            return constant.late ? fmt::format("uniform {} {};", type, constant.name)
                                 : fmt::format("const {} {} = {};", type, constant.name, value);
        }
    };
    return std::visit(Printer{constant}, constant.value);
}

std::string fnv1a_hex(std::string_view text) {
    uint64_t hash = 0xCBF29CE484222325u;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 0x100000001B3u;
    }
    return fmt::format("{:016x}", hash);
}

ShaderLibrary ShaderLibrary::embedded() {
    if (const char* folder = std::getenv("ONEPASS_SHADER_DIR")) return from_directory(folder);
    return ShaderLibrary(embedded_shader_files());
}

ShaderLibrary ShaderLibrary::from_directory(const std::filesystem::path& root) {
    const auto unreadable = [](const std::filesystem::path& path, const std::string& expected) {
        return Error({.where = path.string(),
                      .got = "nothing that can be read",
                      .expected = expected,
                      .remedy = "Check the path (ONEPASS_SHADER_DIR) and its permissions."});
    };
    std::error_code error;
    std::filesystem::recursive_directory_iterator entries(root, error);
    if (error) throw unreadable(root, "a folder of shader files");

    std::map<std::string, std::string> files;
    for (const auto& entry : entries) {
        if (!entry.is_regular_file()) continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        std::ostringstream text;
        text << stream.rdbuf();
        if (!stream) throw unreadable(entry.path(), "a shader file");
        files[entry.path().lexically_relative(root).generic_string()] = text.str();
    }
    return ShaderLibrary(std::move(files));
}

ComposedShader ShaderLibrary::compose(const ShaderVariant& variant) const {
    Composition composition(files_, variant.constants);
    composition.add_generated(fmt::format("#version {} core", variant.glsl_version));
    for (const ShaderConstant& constant : variant.constants) {
        composition.add_generated(to_glsl(constant));
    }
    for (const std::string& path : variant.files) {
        composition.append(path, fmt::format("the {} shader", variant.stage));
    }
    ComposedShader shader = composition.finish();
    shader.stage = variant.stage;
    return shader;
}

std::vector<StrategyInfo> ShaderLibrary::strategies() const {
    std::vector<StrategyInfo> strategies;
    for (const auto& [path, text] : files_) {
        if (!path.starts_with(kStrategyFolder)) continue;
        StrategyInfo info = parse_front_matter(path, text);
        for (const std::string& storage : info.storages) {
            const std::string file = fmt::format("storage/{}/{}.glsl", info.structure, storage);
            if (files_.contains(file)) continue;
            throw Error({.where = path,
                         .got = fmt::format("the storage \"{}\", but no file {}", storage, file),
                         .expected = "a file for each storage of the strategy",
                         .remedy = "Add the file, or mend the line `//! storage:`."});
        }
        strategies.push_back(std::move(info));
    }
    std::ranges::sort(strategies, {}, &StrategyInfo::name);
    return strategies;
}

std::string map_errors(const ComposedShader& shader, const std::string& driver_log) {
    std::string mapped;
    std::istringstream stream(driver_log);
    for (std::string line; std::getline(stream, line);) {
        DriverMessage message;
        if (parse_message(shader, line, message)) {
            mapped += fmt::format("{}: {}\n", message.place, message.text);
        } else {
            mapped += line + "\n";
        }
    }
    return mapped;
}

std::string first_error_place(const ComposedShader& shader, const std::string& driver_log) {
    std::istringstream stream(driver_log);
    for (std::string line; std::getline(stream, line);) {
        DriverMessage message;
        if (parse_message(shader, line, message) && message.text.starts_with("error")) {
            return message.place;
        }
    }
    return {};
}

}  // namespace onepass::gl
