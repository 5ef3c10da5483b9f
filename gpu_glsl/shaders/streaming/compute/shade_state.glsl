// Compute form: what shade reads and writes.
#include "streaming/compute/hit_state.glsl"
#include "streaming/compute/path_state.glsl"
