// The state of a ray between two passes, as the kernels see it.
//
// Each kernel owns one part of the state, which no other kernel writes: traverse the walks,
// intersect the hit, shade the path. Only the control word is written by all. Where the parts lie
// is the business of the two forms: raster/ keeps them in textures, compute/ in buffers.
//
// Little is stored. What a function of the strategy computes from ray and grid (the ray in grid
// coordinates, the steps and the exit of a walk) it computes again in every pass, to the same bits.
#pragma once
#include "lib/paper/walk.glsl"
#include "lib/paper/triangle.glsl"
#include "lib/paper/object_level.glsl"
#include "shared/streaming_layout.h"

CONSTANT(int, steps_per_pass)
CONSTANT(bool, casting)          // given rays; else an image
CONSTANT(bool, copy_only)        // moves the same bytes as the kernel, and does nothing else
CONSTANT(int, cell_bytes)        // of one texel
CONSTANT(int, reference_bytes)

// ---- Both levels' walks: owned by traverse -----------------------------------------------------

struct Walks {
    // Through the top-level grid.
    vec3 top_voxel;
    vec3 top_next_ts;
    float top_t_start;
    float top_t_end;
    int top_steps_left;  // of the grid's step budget
    CellList list;       // what remains of the cell's list; the instance at hand comes first

    // Through the grid of the object of the instance at hand.
    vec2 instance;  // its address
    vec3 voxel;
    vec3 next_ts;
    float t_start;
    float t_end;
    int steps_left;
};

// Intersect reads only the last two.
struct WalkTexels {
    vec4 a;
    vec4 b;
    vec4 c;
    vec4 d;
    vec4 e;
    vec4 f;
};

WalkTexels pack_walks(Walks w) {
    return WalkTexels(
        vec4(w.top_voxel, w.top_t_start), vec4(w.top_next_ts, float(w.top_steps_left)),
        vec4(w.list.address, float(w.list.count), w.top_t_end),
        vec4(w.next_ts, float(w.steps_left)), vec4(w.voxel, w.t_start),
        vec4(w.instance, w.t_end, 0.0));
}

Walks unpack_walks(WalkTexels w) {
    return Walks(w.a.xyz, w.b.xyz, w.a.w, w.c.w, int(w.b.w), CellList(w.c.xy, int(w.c.z)), w.f.xy,
                 w.e.xyz, w.d.xyz, w.e.w, w.f.z, int(w.d.w));
}

// ---- The best hit so far: owned by intersect ---------------------------------------------------

struct HitState {
    Hit hit;
    int cursor;  // triangles of the current cell's list that are done
};

HitState unpack_hit(uint control, vec4 texel, uvec2 ids) {
    if ((control & kHasHitState) == 0u) return HitState(no_hit(), 0);
    return HitState(Hit(texel.x, texel.y, texel.z, ids.x, ids.y), int(texel.w));
}

// ---- The control word --------------------------------------------------------------------------

uint turn_of(uint control) { return control & kTurnMask; }
uint with_turn(uint control, uint turn) { return (control & ~kTurnMask) | turn; }

int light_of(uint control) { return int((control >> kLightShift) & kLightMask) - 1; }
int depth_of(uint control) { return int((control >> kDepthShift) & kDepthMask); }

// A ray of a path that no kernel has seen yet; keeps the flags and sides of `control`.
uint with_new_ray(uint control, int light, int depth) {
    uint kept = control & (kOutOfBudget | kWalkSide | kHitSide | kPathSide);
    return kept | kTurnTraverse | kBegins | (uint(light + 1) << kLightShift) |
           (uint(depth) << kDepthShift);
}

// ---- Work --------------------------------------------------------------------------------------

// Bytes of the grid's textures that this run read, by the fetches of the shader text.
uint grid_bytes;

// A grid or an instance: four texels of four floats.
void count_record() {
    if (count_work) grid_bytes += 64u;
}

// A cell that an earlier pass has read and counted.
CellList fetch_cell_again(vec3 voxel) {
    if (count_work) grid_bytes += uint(cell_bytes);
    return fetch_cell(voxel + 0.5 * cell_size());
}

uint all_grid_bytes() {
    return grid_bytes + uint(cell_bytes) * cells_visited + uint(reference_bytes) * references_read +
           64u * triangle_tests;
}

// ---- Copies ------------------------------------------------------------------------------------

// Always 0. A copy mixes what it has no other use for into the control word, times this, so that no
// compiler can leave the reading out.
uniform uint nothing;

uint touched(vec4 v) {
    uvec4 bits = floatBitsToUint(v);
    return nothing & (bits.x ^ bits.y ^ bits.z ^ bits.w);
}
uint touched(Ray ray) {
    return touched(vec4(ray.org, ray.tmin)) | touched(vec4(ray.dir, ray.tmax));
}
uint touched(Hit hit) {
    return touched(vec4(hit.t, hit.u, hit.v, 0.0)) | (nothing & (hit.prim_id ^ hit.inst_id));
}
