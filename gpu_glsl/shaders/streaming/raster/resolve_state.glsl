// Raster form: all that a finished ray left behind, each part on its newest side.
#include "streaming/raster/state.glsl"

TEXTURE2D(path3_0)
TEXTURE2D(path3_1)
TEXTURE2D(path4_0)
TEXTURE2D(path4_1)
TEXTURE2D(path5_0)
TEXTURE2D(path5_1)
uniform usampler2D path_ids_0;
uniform usampler2D path_ids_1;
uniform usampler2D walk_work_0;
uniform usampler2D walk_work_1;
uniform usampler2D hit_work_0;
uniform usampler2D hit_work_1;

vec4 load_path_texel(uint control, int index) {
    if (index == 3) return newest(control, kPathSide, path3_0, path3_1);
    if (index == 4) return newest(control, kPathSide, path4_0, path4_1);
    return newest(control, kPathSide, path5_0, path5_1);
}
uvec4 load_path_ids(uint control) { return newest(control, kPathSide, path_ids_0, path_ids_1); }
uvec4 load_walk_work(uint control) {
    return count_work ? newest(control, kWalkSide, walk_work_0, walk_work_1) : uvec4(0u);
}
uvec4 load_hit_work(uint control) {
    return count_work ? newest(control, kHitSide, hit_work_0, hit_work_1) : uvec4(0u);
}
