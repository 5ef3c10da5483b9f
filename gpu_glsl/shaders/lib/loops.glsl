// Whether the driver ended a loop that had not come to its end.
//
// llvmpipe of Mesa 22.3 (not of 25) ends all loops of an invocation, and of those that run with it,
// after 65,535 turns. What such a loop computed does not tell: compilers know on which conditions a
// loop ends and take them for met. But from then on every loop ends after its first turn, and so
// one of two turns can tell.
#pragma once
#include "lib/ray.glsl"
#include "lib/renderer.glsl"

#if NEEDS(is_software)
bool is_cut(Ray ray) {
    // An array at a place that compilers do not know: what is there they have to look up.
    uint turns[2];
    turns[0] = 0u;
    turns[1] = 0u;
    uint place = floatBitsToUint(ray.tmin) >> 31u;
    do {
        ++turns[place];
    } while (turns[place] < 2u);
    return turns[place] < 2u;
}
#else
bool is_cut(Ray ray) { return false; }
#endif
