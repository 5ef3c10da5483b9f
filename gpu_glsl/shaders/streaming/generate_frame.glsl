// Kernel: the primary ray of every pixel. Runs once, before all others.
#include "streaming/path.glsl"

void main() {
    bool has_ray = open_state();
    if (has_ray) {
        store_path(pack_path(begin_path_state(primary_ray(pixel_of_ray()))));
        store_control(with_new_ray(0u, kSurfaceRay, 0));
    }
    close_state(has_ray, kTurnTraverse);
}
