// Intervals of doubles that hold the real result of every operation: the filter before exact
// arithmetic.
//
// No rounding mode is changed: each bound is moved outwards by more than the operation's rounding.
// Overflow gives infinite or NaN bounds, which decide nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace onepass {

/// All reals in [lower, upper].
struct Interval {
    double lower = 0.0;
    double upper = 0.0;

    Interval() = default;
    Interval(double exact) : lower(exact), upper(exact) {}  // NOLINT: a double is an exact interval
    Interval(double from, double to) : lower(from), upper(to) {}

    double middle() const { return 0.5 * lower + 0.5 * upper; }
};

/// Holds [lower, upper] before their rounding to nearest: half an ulp is at most 2^-53 of a normal
/// number, and half the least denormal below that.
inline Interval widened(double lower, double upper) {
    constexpr double kRounding = 0x1p-52;
    constexpr double kUnderflow = 0x1p-1074;
    return {lower - (std::abs(lower) * kRounding + kUnderflow),
            upper + (std::abs(upper) * kRounding + kUnderflow)};
}

inline Interval operator-(const Interval& a) { return {-a.upper, -a.lower}; }
inline Interval operator+(const Interval& a, const Interval& b) {
    return widened(a.lower + b.lower, a.upper + b.upper);
}
inline Interval operator-(const Interval& a, const Interval& b) {
    return widened(a.lower - b.upper, a.upper - b.lower);
}
inline Interval operator*(const Interval& a, const Interval& b) {
    const double p[4] = {a.lower * b.lower, a.lower * b.upper, a.upper * b.lower,
                         a.upper * b.upper};
    // std::min would lose a NaN, which comes of 0 * inf.
    if (std::isnan(p[0] + p[1] + p[2] + p[3])) return {-HUGE_VAL, HUGE_VAL};
    return widened(std::min({p[0], p[1], p[2], p[3]}), std::max({p[0], p[1], p[2], p[3]}));
}

/// -1, 0 or 1; nothing where the interval holds numbers of several signs.
inline std::optional<int> sign_of(const Interval& x) {
    if (x.lower > 0.0) return 1;
    if (x.upper < 0.0) return -1;
    if (x.lower == 0.0 && x.upper == 0.0) return 0;
    return {};
}

/// The quotient; `b` must not hold 0.
inline Interval operator/(const Interval& a, const Interval& b) {
    const double q[4] = {a.lower / b.lower, a.lower / b.upper, a.upper / b.lower,
                         a.upper / b.upper};
    if (std::isnan(q[0] + q[1] + q[2] + q[3])) return {-HUGE_VAL, HUGE_VAL};
    return widened(std::min({q[0], q[1], q[2], q[3]}), std::max({q[0], q[1], q[2], q[3]}));
}

}  // namespace onepass
