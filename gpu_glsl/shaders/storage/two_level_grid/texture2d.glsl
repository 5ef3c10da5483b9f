// The two-level grid in textures, as the paper packs it (section 4).
//
// Cells of all grids lie in one 3D texture. A cell holds the address of its list and the list's
// length; a list is a run of addresses within one row of a 2D texture; each address is the place of a
// triangle's (or, from the top-level grid, an instance's) first texel in its own 2D texture. All
// addresses are normalised coordinates of texel centres, so a fetch needs no arithmetic, and the
// next texel is one texel size away.
//
// Addresses may be stored as 16-bit floats; then no texture is larger than 1024 texels a side,
// because (k + 0.5) / W is exact in a half only up to there.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "shared/two_level_layout.h"

TEXTURE3D(cells)
TEXTURE2D(references)
TEXTURE2D(triangles)
TEXTURE2D(instances)
TEXTURE2D(grids)

// A grid is encoded by the map from its own frame to cell-texture coordinates, r_g = a r + b, and by
// the box of texture coordinates that it fills.
struct Grid {
    vec3 a;
    vec3 b;
    vec3 lower;
    vec3 upper;
    int step_budget;     // more steps than any ray can take through it
    int first_triangle;  // of the object, in the order of the triangle texture
};

struct CellList {
    vec2 address;  // of its first reference
    int count;
};

struct Instance {
    vec4 row0;  // of object_from_world
    vec4 row1;
    vec4 row2;
    vec2 grid;  // address of its object's grid
    uint inst_id;
};

struct Triangle {
    vec4 plane;   // unit normal and offset
    vec4 side_u;  // the weight of v1 at a point of the plane
    vec4 side_v;  // the weight of v2
    vec4 side_w;  // the weight of v0
};

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

Triangle fetch_triangle(vec2 address) {
    vec2 next = vec2(1.0 / float(SIZE2D(triangles).x), 0.0);
    return Triangle(SAMPLE2D(triangles, address), SAMPLE2D(triangles, address + next),
                    SAMPLE2D(triangles, address + next * 2.0),
                    SAMPLE2D(triangles, address + next * 3.0));
}

// The position of a triangle in the triangle texture, counted in triangles.
int triangle_index(vec2 address) {
    ivec2 size = SIZE2D(triangles);
    ivec2 texel = ivec2(floor(address * vec2(size)));
    return (texel.y * size.x + texel.x) / kTriangleTexels;
}
