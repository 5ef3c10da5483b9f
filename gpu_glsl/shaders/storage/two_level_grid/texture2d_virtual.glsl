// Virtual one-dimensional arrays: the tables of texture2d, but an address is an index, and every
// fetch turns it into the place of a texel by arithmetic. Cells lie in such an array as well: cell
// (x, y, z) of a box of N cells has index x + N.x (y + N.y z).
//
// Indices are floats, which count exactly below 2^24; textures are powers of two wide, so that the
// arithmetic is exact. The paper prefers addresses that need none.
#pragma once
#define ADDRESS float
#include "storage/two_level_grid/records.glsl"

TEXTURE2D(cells)
TEXTURE2D(references)
TEXTURE2D(triangles)
TEXTURE2D(instances)
TEXTURE2D(grids)
UNIFORM(vec3, cell_array)  // cells on each axis of the box that the grids share

// Texel `index` of a texture of that size, row after row, in normalised coordinates.
vec2 texel_centre(float index, ivec2 texture_size) {
    vec2 size = vec2(texture_size);
    float row = floor(index / size.x);
    return vec2((index - row * size.x + 0.5) / size.x, (row + 0.5) / size.y);
}

// Grid coordinates are those of texture2d, so that both walk the same cells.
vec3 cell_size() { return 1.0 / cell_array; }

float top_grid_address() { return 0.0; }

vec4 fetch_grid_texel(float index) {
    return SAMPLE2D(grids, texel_centre(index, SIZE2D(grids)));
}

Grid fetch_grid(float address) {
    vec4 a = fetch_grid_texel(address);
    vec4 b = fetch_grid_texel(address + 1.0);
    vec4 lower = fetch_grid_texel(address + 2.0);
    vec4 upper = fetch_grid_texel(address + 3.0);
    return Grid(vec3(a), vec3(b), vec3(lower), vec3(upper), int(a.w), int(b.w));
}

CellList fetch_cell(vec3 centre) {
    vec3 cell = floor(centre * cell_array);
    float index = cell.x + cell_array.x * (cell.y + cell_array.y * cell.z);
    vec4 texel = SAMPLE2D(cells, texel_centre(index, SIZE2D(cells)));
    return CellList(texel.x, int(texel.y));
}

float fetch_reference(float address) {
    count_reference();
    return SAMPLE2D(references, texel_centre(address, SIZE2D(references))).x;
}
float next_reference(float address) { return address + 1.0; }

float fetch_triangle_reference(float address) { return fetch_reference(address); }
float next_triangle_reference(float address) { return next_reference(address); }

vec4 fetch_instance_texel(float index) {
    return SAMPLE2D(instances, texel_centre(index, SIZE2D(instances)));
}

Instance fetch_instance(float address) {
    vec4 ids = fetch_instance_texel(address + 3.0);
    return Instance(fetch_instance_texel(address), fetch_instance_texel(address + 1.0),
                    fetch_instance_texel(address + 2.0), ids.x, uint(int(ids.y)));
}

vec4 fetch_plane(float triangle, int k) {
    return SAMPLE2D(triangles, texel_centre(triangle + float(k), SIZE2D(triangles)));
}

uint fetch_prim_id(float triangle, int first_triangle) {
    return uint(int(triangle) / kTriangleTexels - first_triangle);
}
