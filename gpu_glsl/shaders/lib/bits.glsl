// The few values that are made from bit patterns in GLSL, with their form in the twin.
#pragma once

#ifdef ONEPASS_TWIN
float infinity() { return std::numeric_limits<float>::infinity(); }
#else
float infinity() { return uintBitsToFloat(0x7F800000u); }
#endif
