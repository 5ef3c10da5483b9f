// The one exception type of the project, and the assertion macros.
//
// Bad input, a bad shader or a missing device throws Error. A programmer's mistake fails an
// ONEPASS_CHECK, which prints and aborts. Nothing below `main` prints or exits for any other
// reason.
#pragma once

#include <stdexcept>
#include <string>

namespace onepass {

/// Something the user can mend: bad input, an unusable device, a shader that does not compile.
///
/// what() reads "where: got GOT, expected EXPECTED. REMEDY" in one sentence or two.
class Error : public std::runtime_error {
  public:
    /// `input`: bad input or usage (exit code 2). `device`: no usable device (exit code 3).
    enum class Kind { input, device };

    struct Parts {
        std::string where;     ///< file:line, scene node, option or call
        std::string got;       ///< what was found there
        std::string expected;  ///< what would have been right
        std::string remedy;    ///< what the user can do about it
    };

    explicit Error(Parts parts, Kind kind = Kind::input);

    const Parts& parts() const { return parts_; }
    Kind kind() const { return kind_; }

  private:
    Parts parts_;
    Kind kind_;
};

namespace detail {
[[noreturn]] void check_failed(const char* file, int line, const std::string& message);
std::string check_text(double value);
std::string check_text(long long value);
std::string check_text(unsigned long long value);
inline std::string check_text(int value) { return check_text(static_cast<long long>(value)); }
inline std::string check_text(long value) { return check_text(static_cast<long long>(value)); }
inline std::string check_text(unsigned value) {
    return check_text(static_cast<unsigned long long>(value));
}
inline std::string check_text(unsigned long value) {
    return check_text(static_cast<unsigned long long>(value));
}
}  // namespace detail
}  // namespace onepass

/// Assertions stay on in every build. They cost a compare; keep them out of inner loops.
#define ONEPASS_CHECK(condition)        \
    ((condition) ? static_cast<void>(0) \
                 : ::onepass::detail::check_failed(__FILE__, __LINE__, #condition))

#define ONEPASS_CHECK_OP_(a, op, b)                                                                \
    (((a)op(b)) ? static_cast<void>(0)                                                             \
                : ::onepass::detail::check_failed(__FILE__, __LINE__,                              \
                                                  std::string(#a " " #op " " #b " with values ") + \
                                                      ::onepass::detail::check_text(a) + " and " + \
                                                      ::onepass::detail::check_text(b)))
#define ONEPASS_CHECK_EQ(a, b) ONEPASS_CHECK_OP_(a, ==, b)
#define ONEPASS_CHECK_LE(a, b) ONEPASS_CHECK_OP_(a, <=, b)
#define ONEPASS_CHECK_LT(a, b) ONEPASS_CHECK_OP_(a, <, b)
