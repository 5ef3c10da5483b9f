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
    if (index == 3) return NEWEST(path3, kPathSide);
    if (index == 4) return NEWEST(path4, kPathSide);
    return NEWEST(path5, kPathSide);
}
uvec4 load_path_ids(uint control) { return NEWEST(path_ids, kPathSide); }
uvec4 load_walk_work(uint control) {
    return count_work ? NEWEST(walk_work, kWalkSide) : uvec4(0u);
}
uvec4 load_hit_work(uint control) { return count_work ? NEWEST(hit_work, kHitSide) : uvec4(0u); }
