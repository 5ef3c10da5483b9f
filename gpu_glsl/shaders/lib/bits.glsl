// The few values that are made from bit patterns in GLSL, with their form in the twin.
#pragma once

#ifdef ONEPASS_TWIN
float infinity() { return std::numeric_limits<float>::infinity(); }
// 2^s + 1, where s is half the digits of a number, rounded up.
float splitter() { return float((1ull << ((std::numeric_limits<float>::digits + 1) / 2)) + 1); }
#else
float infinity() { return uintBitsToFloat(0x7F800000u); }
float splitter() { return 4097.0; }
#endif
