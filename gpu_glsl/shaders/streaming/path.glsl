// The path of a pixel between two rays, as shade stores it: lib/shading.glsl's Path without what
// can be made again from it.
#pragma once
#include "lib/shading.glsl"
#include "streaming/state.glsl"

struct PathState {
    vec3 org;         // of the ray in flight
    vec3 dir;
    vec3 seen_along;  // the direction in which the surface was met whose light is being gathered
    Hit surface;      // on which triangle, and where; t is not kept
    vec3 direct;
    float weight;
    vec3 color;
    Hit primary;
};

struct PathTexels {
    vec4 a;
    vec4 b;
    vec4 c;
    vec4 d;
    vec4 e;
    vec4 f;
    uvec4 ids;
};

PathTexels pack_path(PathState s) {
    return PathTexels(
        vec4(s.org, s.weight), vec4(s.dir, 0.0), vec4(s.surface.u, s.surface.v, 0.0, 0.0),
        vec4(s.seen_along, s.primary.t), vec4(s.direct, s.primary.u), vec4(s.color, s.primary.v),
        uvec4(s.surface.prim_id, s.surface.inst_id, s.primary.prim_id, s.primary.inst_id));
}

PathState unpack_path(PathTexels t) {
    return PathState(t.a.xyz, t.b.xyz, t.d.xyz, Hit(0.0, t.c.x, t.c.y, t.ids.x, t.ids.y), t.e.xyz,
                     t.a.w, t.f.xyz, Hit(t.d.w, t.e.w, t.f.w, t.ids.z, t.ids.w));
}

// A pixel's path before its primary ray.
PathState begin_path_state(Ray ray) {
    Path path = begin_path();
    return PathState(ray.org, ray.dir, vec3(0.0), no_hit(), path.direct, path.weight,
                     path.pixel.color, path.pixel.primary);
}
