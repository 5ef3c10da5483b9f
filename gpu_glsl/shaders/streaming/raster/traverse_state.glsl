// Raster form: what traverse reads and writes of its own.
#include "streaming/raster/own_state.glsl"

layout(location = 0) out vec4 out_walk0;
layout(location = 1) out vec4 out_walk1;
layout(location = 2) out vec4 out_walk2;
layout(location = 3) out vec4 out_walk3;
layout(location = 4) out vec4 out_walk4;
layout(location = 5) out vec4 out_walk5;
layout(location = 6) out uvec4 out_work;

WalkTexels load_walks() {
    return WalkTexels(FETCH2D(own0, HERE), FETCH2D(own1, HERE), FETCH2D(own2, HERE),
                      FETCH2D(own3, HERE), FETCH2D(own4, HERE), FETCH2D(own5, HERE));
}

void store_walks(WalkTexels texels) {
    out_walk0 = texels.a;
    out_walk1 = texels.b;
    out_walk2 = texels.c;
    out_walk3 = texels.d;
    out_walk4 = texels.e;
    out_walk5 = texels.f;
}

void store_work(uvec4 done) {
    out_work = uvec4(0u);
    if (count_work) out_work = FETCH2D(own_work, HERE) + done;
}

void store_control(uint control) { out_control = moved(control, kWalkSide); }
