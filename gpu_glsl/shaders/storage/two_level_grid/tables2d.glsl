// The tables of the two-level grid in textures, as the paper packs them (section 4).
//
// Cells of all grids lie in one 3D texture. A cell holds the address of its list and the list's
// length; a list is a run within one row of a 2D texture. All addresses are normalised coordinates
// of texel centres, so a fetch needs no arithmetic, and the next texel is one texel size away.
//
// What an object grid's list is made of is left to the storages that include this: references to
// shared triangles (texture2d), or the triangles themselves (texture2d_copies).
#pragma once
#define ADDRESS vec2
#include "storage/two_level_grid/records.glsl"

TEXTURE3D(cells)
TEXTURE2D(references)
TEXTURE2D(triangles)
TEXTURE2D(instances)
TEXTURE2D(grids)

// The size of a cell in texture coordinates: one texel (the paper's dl).
vec3 cell_size() { return 1.0 / vec3(SIZE3D(cells)); }

// The top-level grid is the first record.
vec2 top_grid_address() { return 0.5 / vec2(SIZE2D(grids)); }

Grid fetch_grid(vec2 address) {
    vec2 next = vec2(1.0 / float(SIZE2D(grids).x), 0.0);
    vec4 a = SAMPLE2D(grids, address);
    vec4 b = SAMPLE2D(grids, address + next);
    vec4 lower = SAMPLE2D(grids, address + next * 2.0);
    vec4 upper = SAMPLE2D(grids, address + next * 3.0);
    return Grid(vec3(a), vec3(b), vec3(lower), vec3(upper), int(a.w), int(b.w));
}

// `centre`: the centre of the cell's texel.
CellList fetch_cell(vec3 centre) {
    vec4 texel = SAMPLE3D(cells, centre);
    return CellList(vec2(texel.x, texel.y), int(texel.z));
}

vec2 fetch_reference(vec2 address) {
    count_reference();
    vec4 texel = SAMPLE2D(references, address);
    return vec2(texel.x, texel.y);
}

vec2 next_reference(vec2 address) {
    return address + vec2(1.0 / float(SIZE2D(references).x), 0.0);
}

Instance fetch_instance(vec2 address) {
    vec2 next = vec2(1.0 / float(SIZE2D(instances).x), 0.0);
    vec4 ids = SAMPLE2D(instances, address + next * 3.0);
    return Instance(SAMPLE2D(instances, address), SAMPLE2D(instances, address + next),
                    SAMPLE2D(instances, address + next * 2.0), vec2(ids.x, ids.y),
                    uint(int(ids.z)));
}

vec4 fetch_plane(vec2 triangle, int k) {
    return SAMPLE2D(triangles, triangle + vec2(float(k) / float(SIZE2D(triangles).x), 0.0));
}
