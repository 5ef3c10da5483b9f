// Text for the page: escaped strings and readable numbers. The sections are written with these.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace onepass::report {

/// HTML text or a quoted attribute value: & < > " ' become entities.
std::string escape(std::string_view text);

/// 262144 -> "262,144".
std::string grouped(uint64_t count);

/// `digits` significant digits, never an exponent below 1e15; "–" for NaN, "∞" for infinity.
std::string significant(double value, int digits = 3);

/// The shortest text that reads back as the same number; "inf" for infinity.
std::string exact(float value);
std::string exact(double value);

/// "0.117 %", with a space that keeps them on one line; "0 %" only for a true zero; "–" if the
/// total is 0.
std::string percent(uint64_t count, uint64_t total);

/// "1 ray", "2 rays".
std::string counted(uint64_t count, std::string_view noun);

/// 3500000 -> "3.34 MiB".
std::string byte_size(double bytes);

/// A table cell, with a class attribute if `css` is not empty. `html` is not escaped.
std::string cell(std::string_view html, std::string_view css = {});
std::string heading_cell(std::string_view html, std::string_view css = {});

/// Lets a narrow column break a name or a list after '_', '/' or ','. For escaped text.
std::string breakable(std::string_view html);

/// An id attribute's value: letters, digits and '-' only.
std::string slug(std::string_view text);

}  // namespace onepass::report
