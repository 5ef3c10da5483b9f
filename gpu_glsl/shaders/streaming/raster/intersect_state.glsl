// Raster form: what intersect reads and writes of its own.
#include "streaming/raster/own_state.glsl"

layout(location = 0) out vec4 out_hit;
layout(location = 1) out uvec2 out_ids;
layout(location = 6) out uvec4 out_work;

HitState load_own_hit(uint control) {
    return unpack_hit(control, FETCH2D(own0, HERE), FETCH2D(own_ids, HERE).xy);
}

void store_hit(vec4 texel, uvec2 ids) {
    out_hit = texel;
    out_ids = ids;
}

void store_work(uvec4 done) {
    out_work = uvec4(0u);
    if (count_work) out_work = FETCH2D(own_work, HERE) + done;
}

void store_control(uint control) { out_control = moved(control, kHitSide); }
