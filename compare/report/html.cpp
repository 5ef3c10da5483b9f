#include "compare/report/html.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

namespace onepass::report {
namespace {

std::string tag(std::string_view name, std::string_view html, std::string_view css) {
    if (css.empty()) return fmt::format("<{0}>{1}</{0}>", name, html);
    return fmt::format("<{0} class=\"{2}\">{1}</{0}>", name, html, css);
}

}  // namespace

std::string escape(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string grouped(uint64_t count) {
    std::string digits = std::to_string(count);
    for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(at, ",");
    return digits;
}

std::string significant(double value, int digits) {
    if (std::isnan(value)) return "–";
    if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
    if (value == 0.0) return "0";
    const double magnitude = std::fabs(value);
    const std::string sign = value < 0 ? "−" : "";
    if (magnitude >= 1e15 || magnitude < 1e-6) {
        return sign + fmt::format("{:.{}e}", magnitude, digits - 1);
    }

    // Decimals that leave `digits` significant ones; the place of the first is taken after
    // rounding, so that 9.996 reads 10.0.
    const auto rounded = fmt::format("{:.{}e}", magnitude, digits - 1);
    const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
    const std::string text = fmt::format("{:.{}f}", magnitude, std::max(0, digits - 1 - exponent));
    const size_t point = text.find('.');
    const uint64_t whole = std::stoull(text.substr(0, point));
    return sign + grouped(whole) + (point == std::string::npos ? "" : text.substr(point));
}

std::string exact(float value) { return fmt::format("{}", value); }
std::string exact(double value) { return fmt::format("{}", value); }

std::string percent(uint64_t count, uint64_t total) {
    if (total == 0) return "–";
    return significant(100.0 * static_cast<double>(count) / static_cast<double>(total)) + "\u00a0%";
}

std::string counted(uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

std::string byte_size(double bytes) {
    static constexpr const char* kUnits[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    size_t unit = 0;
    for (; bytes >= 1024.0 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1024.0;
    return significant(bytes) + " " + kUnits[unit];
}

std::string cell(std::string_view html, std::string_view css) { return tag("td", html, css); }
std::string heading_cell(std::string_view html, std::string_view css) {
    return tag("th", html, css);
}

std::string breakable(std::string_view html) {
    std::string out;
    for (const char c : html) {
        out += c;
        if (c == '_' || c == '/' || c == ',') out += "<wbr>";
    }
    return out;
}

std::string slug(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        out += std::isalnum(byte) ? static_cast<char>(std::tolower(byte)) : '-';
    }
    return out;
}

}  // namespace onepass::report
