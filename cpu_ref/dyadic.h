// Exact numbers m * 2^e: what sums and products of floats are. No division, and so no fractions to
// reduce, which makes them many times faster than rational numbers.
#pragma once

#include <cmath>
#include <optional>

#include <boost/multiprecision/cpp_int.hpp>

namespace onepass {

struct Dyadic {
    boost::multiprecision::cpp_int mantissa;
    int exponent = 0;

    Dyadic() = default;
    /// Every finite double, exactly.
    explicit Dyadic(double x) {
        constexpr int kMantissaBits = 53;
        int exponent_of_x = 0;
        // cppcheck-suppress useInitializationList
        mantissa = static_cast<long long>(std::ldexp(std::frexp(x, &exponent_of_x), kMantissaBits));
        exponent = mantissa.is_zero() ? 0 : exponent_of_x - kMantissaBits;
    }
    Dyadic(boost::multiprecision::cpp_int m, int e) : mantissa(std::move(m)), exponent(e) {}
};

inline Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    return {a.mantissa * b.mantissa, a.exponent + b.exponent};
}
inline Dyadic operator-(const Dyadic& a) { return {-a.mantissa, a.exponent}; }
inline Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.mantissa.is_zero()) return b;
    if (b.mantissa.is_zero()) return a;
    if (a.exponent < b.exponent) return b + a;
    return {(a.mantissa << (a.exponent - b.exponent)) + b.mantissa, b.exponent};
}
inline Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + (-b); }

inline std::optional<int> sign_of(const Dyadic& x) { return x.mantissa.sign(); }

}  // namespace onepass
