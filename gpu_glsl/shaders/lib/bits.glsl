// The few values that are made from bit patterns in GLSL, with their form in the twin.
#pragma once

#ifdef ONEPASS_TWIN
float infinity() { return std::numeric_limits<float>::infinity(); }
// The most that rounding to nearest is wrong by, beside 1: 2^-24 in GLSL.
float half_ulp() { return float(0.5) * std::numeric_limits<float>::epsilon(); }
bool is_number(float x) { return !std::isnan(x); }
bool is_finite(float x) { return std::isfinite(x); }
#else
float infinity() { return uintBitsToFloat(0x7F800000u); }
float half_ulp() { return 5.9604644775390625e-8; }
// Drivers turn comparisons round as if there were no NaN; bits they leave alone.
bool is_number(float x) { return (floatBitsToUint(x) & 0x7FFFFFFFu) <= 0x7F800000u; }
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7F800000u) != 0x7F800000u; }
#endif
