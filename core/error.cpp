#include "core/error.h"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace onepass {
namespace {

std::string one_sentence(const Error::Parts& parts) {
    return fmt::format("{}: got {}, expected {}. {}", parts.where, parts.got, parts.expected,
                       parts.remedy);
}

}  // namespace

Error::Error(Parts parts, Kind kind)
    : std::runtime_error(one_sentence(parts)), parts_(std::move(parts)), kind_(kind) {}

namespace detail {

void check_failed(const char* file, int line, const std::string& message) {
    std::fprintf(stderr, "%s:%d: internal check failed: %s\n", file, line, message.c_str());
    std::abort();
}

std::string check_text(double value) { return fmt::format("{}", value); }
std::string check_text(long long value) { return fmt::format("{}", value); }
std::string check_text(unsigned long long value) { return fmt::format("{}", value); }

}  // namespace detail
}  // namespace onepass
