// Parses front matter: one `//! key: value` a line, before the first line of code.
#include "gpu_glsl/gl/front_matter.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"

namespace onepass::gl {
namespace {

constexpr const char* kKeys[] = {"strategy", "summary", "source", "structure",
                                 "storage",  "entries", "gl",     "twin"};
constexpr const char* kOptionalKeys[] = {"default"};
constexpr const char* kListKeys[] = {"param", "deviation"};  ///< any number of lines each
constexpr const char* kEntries[] = {"fragment", "compute"};

/// One `//!` line.
struct Line {
    std::string place;  ///< file:line
    std::string key;
    std::string value;
};

[[noreturn]] void fail(const std::string& place, const std::string& got,
                       const std::string& expected) {
    throw Error({.where = place,
                 .got = got,
                 .expected = expected,
                 .remedy = "Mend the `//!` lines at the head of the file."});
}

std::string trimmed(std::string_view text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::string> words(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> result;
    for (std::string word; stream >> word;) result.push_back(word);
    return result;
}

template <class Number>
bool is_number(const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
}

Line parse_line(const std::string& place, std::string_view text) {
    const size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        fail(place, fmt::format("\"{}\"", trimmed(text)), "`//! key: value`");
    }
    Line line{place, trimmed(text.substr(0, colon)), trimmed(text.substr(colon + 1))};
    std::vector<std::string> known(std::begin(kKeys), std::end(kKeys));
    known.insert(known.end(), std::begin(kOptionalKeys), std::end(kOptionalKeys));
    known.insert(known.end(), std::begin(kListKeys), std::end(kListKeys));
    if (std::ranges::find(known, line.key) == known.end()) {
        fail(place, fmt::format("the key \"{}\"", line.key),
             fmt::format("one of {}", fmt::join(known, ", ")));
    }
    if (line.value.empty()) fail(place, fmt::format("nothing after \"{}:\"", line.key), "a value");
    return line;
}

/// All `//!` lines; they stand before the first line that is neither blank nor a comment.
std::vector<Line> read_lines(const std::string& file, std::string_view text) {
    std::vector<Line> lines;
    std::istringstream stream{std::string(text)};
    std::string row;
    bool in_code = false;
    for (int number = 1; std::getline(stream, row); ++number) {
        const std::string content = trimmed(row);
        const std::string place = fmt::format("{}:{}", file, number);
        if (content.starts_with("//!")) {
            if (in_code) fail(place, "front matter after code", "front matter at the head only");
            lines.push_back(parse_line(place, std::string_view(content).substr(3)));
        } else if (!content.empty() && !content.starts_with("//")) {
            in_code = true;
        }
    }
    return lines;
}

/// Whether the parameter's type takes this value.
bool allows(const ParamInfo& param, const std::string& value) {
    switch (param.type) {
        case ParamInfo::Type::real:
            return is_number<double>(value);
        case ParamInfo::Type::integer:
            return is_number<long>(value);
        case ParamInfo::Type::choice:
            return std::ranges::find(param.choices, value) != param.choices.end();
        case ParamInfo::Type::text:
            return true;
    }
    return false;
}

/// NAME TYPE DEFAULT SUMMARY, with TYPE real, integer or choice(a,b,c).
ParamInfo parse_param(const Line& line) {
    constexpr const char* kForm =
        "NAME TYPE DEFAULT SUMMARY, TYPE being real, integer or choice(a,b)";
    const std::vector<std::string> parts = words(line.value);
    if (parts.size() < 4) fail(line.place, fmt::format("\"{}\"", line.value), kForm);
    const std::string& type = parts[1];
    const std::string& value = parts[2];

    ParamInfo param;
    param.name = parts[0];
    param.default_value = value;
    param.summary = fmt::format("{}", fmt::join(parts.begin() + 3, parts.end(), " "));
    if (type == "real") {
        param.type = ParamInfo::Type::real;
    } else if (type == "integer") {
        param.type = ParamInfo::Type::integer;
    } else if (type.starts_with("choice(") && type.ends_with(")")) {
        param.type = ParamInfo::Type::choice;
        std::istringstream list(type.substr(7, type.size() - 8));
        for (std::string choice; std::getline(list, choice, ',');) param.choices.push_back(choice);
    } else {
        fail(line.place, fmt::format("the type \"{}\"", type), kForm);
    }
    if (!allows(param, value)) {
        fail(line.place, fmt::format("the default \"{}\"", value),
             fmt::format("a default that the type {} allows", type));
    }
    return param;
}

/// ID PARAM=VALUE SUMMARY, of a parameter that is declared.
Deviation parse_deviation(const Line& line, const std::vector<ParamInfo>& params) {
    const std::vector<std::string> parts = words(line.value);
    const size_t equals = parts.size() < 3 ? std::string::npos : parts[1].find('=');
    if (equals == std::string::npos) {
        fail(line.place, fmt::format("\"{}\"", line.value), "ID PARAM=VALUE SUMMARY");
    }
    Deviation deviation;
    deviation.id = parts[0];
    deviation.param = parts[1].substr(0, equals);
    deviation.value = parts[1].substr(equals + 1);
    deviation.summary = fmt::format("{}", fmt::join(parts.begin() + 2, parts.end(), " "));

    const auto param = std::ranges::find(params, deviation.param, &ParamInfo::name);
    if (param == params.end()) {
        fail(line.place, fmt::format("the parameter \"{}\"", deviation.param),
             "a parameter with a line `//! param:` of its own");
    }
    if (!allows(*param, deviation.value)) {
        fail(line.place, fmt::format("the value \"{}\"", deviation.value),
             fmt::format("a value that the type of {} allows", deviation.param));
    }
    if (deviation.value == param->default_value) {
        fail(line.place, fmt::format("the value \"{}\"", deviation.value),
             fmt::format("another than the default of {}, which keeps the deviation",
                         deviation.param));
    }
    return deviation;
}

/// "3.3" -> 330.
int parse_gl_version(const Line& line) {
    const std::string& text = line.value;
    const bool digits = text.size() == 3 && text[1] == '.' && text[0] >= '3' && text[0] <= '4' &&
                        text[2] >= '0' && text[2] <= '6';
    const int version = digits ? 100 * (text[0] - '0') + 10 * (text[2] - '0') : 0;
    if (version < 330) {
        fail(line.place, fmt::format("\"{}\"", text), "an OpenGL version from 3.3 to 4.6");
    }
    return version;
}

}  // namespace

StrategyInfo parse_front_matter(const std::string& file, std::string_view text) {
    // Sort the lines: parameters and deviations in order, every other key once.
    std::map<std::string, Line> by_key;
    std::vector<Line> deviation_lines;
    StrategyInfo info;
    info.file = file;
    for (const Line& line : read_lines(file, text)) {
        if (line.key == "param") {
            ParamInfo param = parse_param(line);
            if (std::ranges::count(info.params, param.name, &ParamInfo::name) > 0) {
                fail(line.place, fmt::format("a second parameter \"{}\"", param.name),
                     "each parameter once");
            }
            info.params.push_back(std::move(param));
        } else if (line.key == "deviation") {
            deviation_lines.push_back(line);
        } else if (!by_key.emplace(line.key, line).second) {
            fail(line.place, fmt::format("a second \"{}:\"", line.key), "each key once");
        }
    }
    for (const Line& line : deviation_lines) {
        Deviation deviation = parse_deviation(line, info.params);
        if (std::ranges::count(info.deviations, deviation.id, &Deviation::id) > 0) {
            fail(line.place, fmt::format("a second deviation \"{}\"", deviation.id),
                 "each deviation once, with one switch");
        }
        info.deviations.push_back(std::move(deviation));
    }
    for (const char* key : kKeys) {
        if (!by_key.contains(key)) {
            fail(file + ":1", fmt::format("no line `//! {}: ...`", key),
                 fmt::format("the keys {}", fmt::join(kKeys, ", ")));
        }
    }

    // Plain texts. The file is named after the strategy, so no two strategies share a name.
    info.name = by_key["strategy"].value;
    info.summary = by_key["summary"].value;
    info.source = by_key["source"].value;
    info.structure = by_key["structure"].value;
    const std::string stem = std::filesystem::path(file).stem();
    if (info.name != stem) {
        fail(by_key["strategy"].place, fmt::format("the name \"{}\"", info.name),
             fmt::format("\"{}\", the name of its file", stem));
    }

    // Lists.
    info.storages = words(by_key["storage"].value);
    info.entries = words(by_key["entries"].value);
    for (const std::string& entry : info.entries) {
        if (std::ranges::find(kEntries, entry) == std::end(kEntries)) {
            fail(by_key["entries"].place, fmt::format("the entry \"{}\"", entry),
                 fmt::format("one or more of {}", fmt::join(kEntries, ", ")));
        }
    }

    // GL version and twin.
    info.gl = parse_gl_version(by_key["gl"]);
    const std::string& twin = by_key["twin"].value;
    info.twin = twin == "yes";
    if (!info.twin) {
        const bool reasoned = twin.starts_with("none ");
        if (!reasoned) {
            fail(by_key["twin"].place, fmt::format("\"{}\"", twin), "`yes` or `none REASON`");
        }
        info.no_twin_reason = trimmed(std::string_view(twin).substr(5));
    }

    // Whether a command takes it without being told.
    if (by_key.contains("default")) {
        const std::string& by_default = by_key["default"].value;
        if (by_default != "yes" && by_default != "no") {
            fail(by_key["default"].place, fmt::format("\"{}\"", by_default), "`yes` or `no`");
        }
        info.by_default = by_default == "yes";
    }
    return info;
}

}  // namespace onepass::gl
