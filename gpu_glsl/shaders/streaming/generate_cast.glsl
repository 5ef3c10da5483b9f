// Kernel: makes given rays wait for their first pass. Runs once, before all others.
#include "streaming/state.glsl"

void main() {
    bool has_ray = open_state();
    if (has_ray) store_control(with_new_ray(0u, kSurfaceRay, 0));
    close_state(has_ray, kTurnTraverse);
}
