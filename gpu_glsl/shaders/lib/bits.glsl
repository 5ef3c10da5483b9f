// The few values that are made from bit patterns in GLSL, with their form in the twin.
#pragma once

#ifdef ONEPASS_TWIN
float infinity() { return std::numeric_limits<float>::infinity(); }
// The most that rounding to nearest is wrong by, beside 1: 2^-24 in GLSL.
float half_ulp() { return float(0.5) * std::numeric_limits<float>::epsilon(); }
bool is_number(float x) { return !std::isnan(x); }
bool is_finite(float x) { return std::isfinite(x); }
bool is_finite(vec3 v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }
bool has_sign(float x) { return std::signbit(x); }
double power_of_two_above(double x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    return std::ldexp(1.0, exponent);
}
double inverse_of_power(double power) { return 1.0 / power; }
float bias() { return float(1.0) / std::numeric_limits<float>::epsilon(); }
float biased(uint n) { return bias() + float(n); }
int biased_bits(float number) { return static_cast<int>(number - bias()); }
int kBitsOfBias = 0;
#else
float infinity() { return uintBitsToFloat(0x7F800000u); }
float half_ulp() { return 5.9604644775390625e-8; }
// Drivers turn comparisons round as if there were no NaN; bits they leave alone.
bool is_number(float x) { return (floatBitsToUint(x) & 0x7FFFFFFFu) <= 0x7F800000u; }
bool is_finite(float x) { return (floatBitsToUint(x) & 0x7F800000u) != 0x7F800000u; }
bool is_finite(vec3 v) {
    uvec3 size = floatBitsToUint(v) & 0x7FFFFFFFu;
    return max(size.x, max(size.y, size.z)) < 0x7F800000u;
}
bool has_sign(float x) { return floatBitsToInt(x) < 0; }  // of -0 as well
// The least power of two above a positive normal number.
double power_of_two_above(double x) {
    uint exponent = unpackDouble2x32(x).y & 0x7FF00000u;
    return packDouble2x32(uvec2(0u, exponent + 0x00100000u));
}
double inverse_of_power(double power) {
    return packDouble2x32(uvec2(0u, 0x7FE00000u - unpackDouble2x32(power).y));
}

// Biased numbers: whole numbers n, up to a million, as the floats bias() + n. Their bits are n as
// an integer, but for a constant: no conversion, for which a GPU has few units.
float bias() { return 8388608.0; }  // 2^23
float biased(uint n) { return uintBitsToFloat(0x4B000000u + n); }
int biased_bits(float number) { return floatBitsToInt(number); }  // kBitsOfBias + n
const int kBitsOfBias = 0x4B000000;
#endif
