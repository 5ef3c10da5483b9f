// Raster form: what shade reads and writes of its own. generate writes the same.
#include "streaming/path.glsl"
#include "streaming/raster/own_state.glsl"

layout(location = 0) out vec4 out_path0;
layout(location = 1) out vec4 out_path1;
layout(location = 2) out vec4 out_path2;
layout(location = 3) out vec4 out_path3;
layout(location = 4) out vec4 out_path4;
layout(location = 5) out vec4 out_path5;
layout(location = 6) out uvec4 out_ids;

CONSTANT(bool, over_all_rays)  // generate: nothing is stored yet, and the path goes to side 0

PathTexels load_path() {
    return PathTexels(FETCH2D(own0, HERE), FETCH2D(own1, HERE), FETCH2D(own2, HERE),
                      FETCH2D(own3, HERE), FETCH2D(own4, HERE), FETCH2D(own5, HERE),
                      FETCH2D(own_ids, HERE));
}

void store_path(PathTexels texels) {
    out_path0 = texels.a;
    out_path1 = texels.b;
    out_path2 = texels.c;
    out_path3 = texels.d;
    out_path4 = texels.e;
    out_path5 = texels.f;
    out_ids = texels.ids;
}

void store_control(uint control) {
    out_control = over_all_rays ? control : moved(control, kPathSide);
}
