// A given ray and its answer as storage buffers hold them.
#pragma once

struct RayRecord {
    vec4 origin;     // org, tmin
    vec4 direction;  // dir, tmax
};
struct HitRecord {
    vec4 hit;   // t, u, v
    uvec4 ids;  // prim_id, inst_id, flags; of `streaming` also bytes of the grid read
};
