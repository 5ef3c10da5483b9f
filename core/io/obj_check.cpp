#include "core/io/obj_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "core/io/import.h"

namespace onepass {
namespace {

constexpr const char* kRemedy = "Mend the line, or export the mesh again.";

/// The elements that a face can refer to: v, vt, vn, in the order of "v/vt/vn".
struct ElementKind {
    const char* name;
    int64_t count = 0;
    int64_t largest_used = 0;  ///< 1-based, as in the file
    size_t largest_used_line = 0;
};

struct Check {
    std::array<ElementKind, 3> kinds{{{"vertex"}, {"texture coordinate"}, {"normal"}}};
    uint64_t faces = 0;
    size_t line = 1;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\\' || c == '\n'; }

/// The next word of `rest`, which is shortened by it; empty at the end.
std::string_view next_word(std::string_view& rest) {
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    size_t length = 0;
    while (length < rest.size() && !is_blank(rest[length])) ++length;
    const std::string_view word = rest.substr(0, length);
    rest.remove_prefix(length);
    return word;
}

/// A line and those it goes on to by a backslash at its end; `line_count` of them.
std::string_view next_line(std::string_view& text, size_t& line_count) {
    size_t end = 0;
    line_count = 1;
    for (;;) {
        end = std::min(text.find('\n', end), text.size());
        const size_t last = end > 0 && text[end - 1] == '\r' ? end - 1 : end;
        const bool goes_on = last > 0 && text[last - 1] == '\\' && end < text.size();
        if (!goes_on) break;
        ++line_count;
        ++end;
    }
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

/// True if a float begins here that is finite; what follows it is left to Assimp.
bool starts_with_finite_float(std::string_view word) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    float value = 0.0f;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range) {
        // Too large or too small: a number below 1 has a negative exponent.
        return word.find("e-") != word.npos || word.find("E-") != word.npos;
    }
    return error == std::errc() && std::isfinite(value);
}

void check_vertex(const Check& check, std::string_view rest) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = next_word(rest);
        if (starts_with_finite_float(word)) continue;
        throw Error({fmt::format("line {}", check.line),
                     word.empty() ? fmt::format("a vertex of {} numbers", axis)
                                  : fmt::format("'{}' in a vertex", clean_text(word.substr(0, 40))),
                     "three finite numbers", kRemedy});
    }
}

void check_index(Check& check, ElementKind& kind, std::string_view word) {
    int64_t index = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    const bool is_number = error == std::errc() && end == word.data() + word.size();
    // Negative indices count back from the last element so far.
    if (!is_number || index == 0 || index < -kind.count) {
        throw Error({fmt::format("line {}", check.line),
                     fmt::format("{} index '{}'", kind.name, clean_text(word.substr(0, 40))),
                     kind.count == 0 ? fmt::format("an earlier {}", kind.name)
                                     : fmt::format("an index from 1 to {}, or from -{} to -1",
                                                   kind.count, kind.count),
                     kRemedy});
    }
    if (index > kind.largest_used) {
        kind.largest_used = index;
        kind.largest_used_line = check.line;
    }
}

void check_face(Check& check, std::string_view rest) {
    ++check.faces;
    int corners = 0;
    for (std::string_view corner = next_word(rest); !corner.empty(); corner = next_word(rest)) {
        if (corner.front() == '#') break;
        ++corners;
        for (ElementKind& kind : check.kinds) {
            const size_t slash = std::min(corner.find('/'), corner.size());
            const std::string_view index = corner.substr(0, slash);
            const bool required = &kind == &check.kinds.front();
            if (required || !index.empty()) check_index(check, kind, index);
            if (slash == corner.size()) break;
            corner.remove_prefix(slash + 1);
        }
    }
    if (corners < 3) {
        throw Error({fmt::format("line {}", check.line),
                     fmt::format("a face of {} corners", corners), "3 or more", kRemedy});
    }
}

}  // namespace

void check_obj_text(std::string_view text) {
    if (text.find('\0') != text.npos || text.starts_with("\xFF\xFE") ||
        text.starts_with("\xFE\xFF")) {
        throw Error({"", "16-bit or binary text", "OBJ text in ASCII or UTF-8",
                     "Convert the file to UTF-8."});
    }

    Check check;
    size_t line_count = 0;
    for (std::string_view rest = text; !rest.empty(); check.line += line_count) {
        std::string_view line = next_line(rest, line_count);
        const std::string_view keyword = next_word(line);
        if (keyword == "v") {
            check_vertex(check, line);
            ++check.kinds[0].count;
        } else if (keyword == "vt") {
            ++check.kinds[1].count;
        } else if (keyword == "vn") {
            check_vertex(check, line);
            ++check.kinds[2].count;
        } else if (keyword == "f") {
            check_face(check, line);
        }
    }

    // Positive indices may point forward, so the end of the file decides.
    for (const ElementKind& kind : check.kinds) {
        if (kind.largest_used <= kind.count) continue;
        throw Error({fmt::format("line {}", kind.largest_used_line),
                     fmt::format("{} index {}", kind.name, kind.largest_used),
                     fmt::format("at most {}, the number in the file", kind.count), kRemedy});
    }
    if (check.faces == 0) {
        throw Error({"", "no faces", "at least one triangle", "Check that it is the right file."});
    }
}

}  // namespace onepass
