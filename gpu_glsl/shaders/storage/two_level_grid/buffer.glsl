// The two-level grid in buffer textures, addressed by integers.
//
// All that belongs to a grid is stored in the grid's frame, so that an object far from the origin is
// as precise as one around it. The frame's origin is at a corner of the object, on those axes where
// taking that corner off is exact, and else stays where it was: no vertex is ever moved.
#pragma once
#include "lib/dialect.glsl"
#include "lib/exact.glsl"
#include "lib/ray.glsl"
#include "shared/grid_buffers_layout.h"

UBUFFER(cells)          // first reference and their number
UBUFFER(references)     // triangles of an object, or instances
BUFFER(vertices)
BUFFER(grid_frames)
UBUFFER(grid_numbers)
BUFFER(instance_rows)
UBUFFER(instance_grids)
UNIFORM(vec3, top_frame)  // the origin of the top-level grid's frame, in the world

struct Grid {
    vec3 lower;          // corners of the whole grid, in its frame
    vec3 upper;
    vec3 cell;           // edge lengths of a cell
    vec3 cells_per_unit;
    ivec3 dims;
    int first_cell;
    int first_triangle;
};

struct CellList {
    int first;  // reference
    int count;
};

struct Triangle {
    vec3 v0;
    vec3 v1;
    vec3 v2;
};

// A ray in the frame of a grid. t means the same in all frames. The origin has twice the digits, as
// org + org_rest: a ray that starts close to a surface would lose the digits of its t to a rounded
// origin.
struct LocalRay {
    vec3 org;
    vec3 org_rest;
    vec3 dir;
};

Grid fetch_grid(int number) {
    int at = number * kGridFrameTexels;
    uvec4 dims = FETCHBUFFER(grid_numbers, number * kGridNumberTexels);
    uvec4 first = FETCHBUFFER(grid_numbers, number * kGridNumberTexels + 1);
    return Grid(vec3(FETCHBUFFER(grid_frames, at)), vec3(FETCHBUFFER(grid_frames, at + 1)),
                vec3(FETCHBUFFER(grid_frames, at + 2)), vec3(FETCHBUFFER(grid_frames, at + 3)),
                ivec3(int(dims.x), int(dims.y), int(dims.z)), int(dims.w), int(first.x));
}

CellList fetch_cell(Grid grid, ivec3 cell) {
    int index = cell.x + grid.dims.x * (cell.y + grid.dims.y * cell.z);
    uvec4 list = FETCHBUFFER(cells, grid.first_cell + index);
    return CellList(int(list.x), int(list.y));
}

uint fetch_reference(int index) {
    count_reference();
    return FETCHBUFFER(references, index).x;
}

Triangle fetch_triangle(Grid grid, uint prim_id) {
    int at = (grid.first_triangle + int(prim_id)) * kTriangleVertexTexels;
    return Triangle(vec3(FETCHBUFFER(vertices, at)), vec3(FETCHBUFFER(vertices, at + 1)),
                    vec3(FETCHBUFFER(vertices, at + 2)));
}

int fetch_grid_of_instance(uint inst_id) {
    return int(FETCHBUFFER(instance_grids, int(inst_id)).x);
}

// One coordinate of a point, and (without the translation) of a direction.
Pair transformed_point(vec4 row, vec4 rest, vec3 p) {
    Pair sum = add_product(Pair(row.w, rest.w), row.x, rest.x, p.x);
    sum = add_product(sum, row.y, rest.y, p.y);
    sum = add_product(sum, row.z, rest.z, p.z);
    return two_sum(sum.hi, sum.lo);
}
float transformed_direction(vec4 row, vec4 rest, vec3 v) {
    Pair sum = add_product(Pair(0.0, 0.0), row.x, rest.x, v.x);
    sum = add_product(sum, row.y, rest.y, v.y);
    sum = add_product(sum, row.z, rest.z, v.z);
    return sum.hi + sum.lo;
}

// The ray in the frame of the instance's grid. The matrix and the sums carry twice the digits, so
// that a large translation or a cancelling rotation loses nothing.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec4 y = FETCHBUFFER(instance_rows, at + 1);
    vec4 z = FETCHBUFFER(instance_rows, at + 2);
    vec4 x_rest = FETCHBUFFER(instance_rows, at + 3);
    vec4 y_rest = FETCHBUFFER(instance_rows, at + 4);
    vec4 z_rest = FETCHBUFFER(instance_rows, at + 5);
    Pair org_x = transformed_point(x, x_rest, ray.org);
    Pair org_y = transformed_point(y, y_rest, ray.org);
    Pair org_z = transformed_point(z, z_rest, ray.org);
    return LocalRay(vec3(org_x.hi, org_y.hi, org_z.hi), vec3(org_x.lo, org_y.lo, org_z.lo),
                    vec3(transformed_direction(x, x_rest, ray.dir),
                         transformed_direction(y, y_rest, ray.dir),
                         transformed_direction(z, z_rest, ray.dir)));
}

LocalRay to_top_level(Ray ray) { return LocalRay(ray.org - top_frame, vec3(0.0), ray.dir); }
