// What is asked of the ray in flight: its nearest hit, or whether it has any.
//
// One procedure answers both, as the paper's does: any_hit_suffices tells closest_hit() that it may
// end at the first hit it is sure of. A strategy that does not look answers with the nearest, which
// is as right. A second procedure would double the shader, and in one warp the rays of one kind
// would wait for those of the other.
#pragma once
#include "lib/dialect.glsl"

CONSTANT(bool, any_query)         // of all given rays
CONSTANT(bool, any_shadow_query)  // of an image's shadow rays (lib/trace_pixel.glsl)
bool any_hit_suffices = any_query;
