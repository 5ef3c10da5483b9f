// Raster form: the part of the state that the running kernel owns, on the side it may read, and
// what every kernel writes beside it.
//
// Locations: texels of floats from 0 on, then integers; work 6, control word 7.
#pragma once
#include "streaming/raster/state.glsl"

TEXTURE2D(own0)
TEXTURE2D(own1)
TEXTURE2D(own2)
TEXTURE2D(own3)
TEXTURE2D(own4)
TEXTURE2D(own5)
uniform usampler2D own_ids;
uniform usampler2D own_work;

layout(location = 7) out uint out_control;

// The control word of a ray whose part of `side` has been written anew. A copy leaves all as it is.
uint moved(uint control, uint side) { return copy_only ? control : control ^ side; }
