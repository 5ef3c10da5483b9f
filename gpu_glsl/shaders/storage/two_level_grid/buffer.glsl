// The two-level grid in buffer textures, addressed by integers.
//
// All that belongs to a grid is stored in the grid's frame, so that an object far from the origin,
// or of any size, is as precise as one of size 1 around it. The frame's origin is at a corner of
// the object, on those axes where taking that corner off is exact, and else stays where it was; the
// frame of an object's grid is scaled by the power of two that makes its largest coordinate 1/2 to
// 1. Both are exact: no vertex is ever moved.
#pragma once
#include "lib/dialect.glsl"
#include "lib/exact.glsl"
#include "lib/ray.glsl"
#include "shared/grid_buffers_layout.h"

// The object grids: fixed once they are built.
UBUFFER(cells)          // first reference and their number
UBUFFER(references)     // triangles of an object
BUFFER(vertices)
BUFFER(grid_frames)
UBUFFER(grid_numbers)
UBUFFER(instance_grids)

// The top level: made anew when instances move (pack/top_level_update.h).
UBUFFER(top_cells)
UBUFFER(top_references)  // instances
BUFFER(instance_rows)
UNIFORM(vec3, top_frame)  // the origin of its frame, in the world
UNIFORM(vec3, top_lower)  // its Grid; dims as floats
UNIFORM(vec3, top_upper)
UNIFORM(vec3, top_cell)
UNIFORM(vec3, top_cells_per_unit)
UNIFORM(vec3, top_dims)

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

// A ray in the frame of a grid. t means the same in all frames. Every number has twice the digits,
// as x + x_rest: a ray that starts close to a surface would lose the digits of its t to a rounded
// origin, and one that starts far away would pass beside it by a rounded direction.
struct LocalRay {
    vec3 org;
    vec3 org_rest;
    vec3 dir;
    vec3 dir_rest;
};

Grid fetch_grid(int number) {
    int at = number * kGridFrameTexels;
    uvec4 dims = FETCHBUFFER(grid_numbers, number * kGridNumberTexels);
    uvec4 first = FETCHBUFFER(grid_numbers, number * kGridNumberTexels + 1);
    return Grid(vec3(FETCHBUFFER(grid_frames, at)), vec3(FETCHBUFFER(grid_frames, at + 1)),
                vec3(FETCHBUFFER(grid_frames, at + 2)), vec3(FETCHBUFFER(grid_frames, at + 3)),
                ivec3(int(dims.x), int(dims.y), int(dims.z)), int(dims.w), int(first.x));
}

Grid fetch_top_grid() {
    return Grid(top_lower, top_upper, top_cell, top_cells_per_unit,
                ivec3(int(top_dims.x), int(top_dims.y), int(top_dims.z)), 0, 0);
}

int cell_index(Grid grid, ivec3 cell) {
    return grid.first_cell + cell.x + grid.dims.x * (cell.y + grid.dims.y * cell.z);
}

CellList fetch_cell(Grid grid, ivec3 cell) {
    uvec4 list = FETCHBUFFER(cells, cell_index(grid, cell));
    return CellList(int(list.x), int(list.y));
}

CellList fetch_top_cell(Grid grid, ivec3 cell) {
    uvec4 list = FETCHBUFFER(top_cells, cell_index(grid, cell));
    return CellList(int(list.x), int(list.y));
}

uint fetch_triangle_reference(int index) {
    count_reference();
    return FETCHBUFFER(references, index).x;
}

uint fetch_instance_reference(int index) {
    count_reference();
    return FETCHBUFFER(top_references, index).x;
}

Triangle fetch_triangle(Grid grid, uint prim_id) {
    int at = (grid.first_triangle + int(prim_id)) * kTriangleVertexTexels;
    return Triangle(vec3(FETCHBUFFER(vertices, at)), vec3(FETCHBUFFER(vertices, at + 1)),
                    vec3(FETCHBUFFER(vertices, at + 2)));
}

int fetch_grid_of_instance(uint inst_id) {
    return int(FETCHBUFFER(instance_grids, int(inst_id)).x);
}

// One coordinate of a point or a direction: a row of a matrix applied to it.
Pair transformed(Pair from, vec4 row, vec4 rest, Pair x, Pair y, Pair z) {
    Pair sum = add_product(from, Pair(row.x, rest.x), x);
    sum = add_product(sum, Pair(row.y, rest.y), y);
    sum = add_product(sum, Pair(row.z, rest.z), z);
    return normalised(sum);
}

// The ray in the frame of the instance's grid. The place of the instance is taken off first, which
// is exact, and the matrix and the sums carry twice the digits; so neither a large translation nor
// a cancelling rotation loses any.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec4 y = FETCHBUFFER(instance_rows, at + 1);
    vec4 z = FETCHBUFFER(instance_rows, at + 2);
    vec4 x_rest = FETCHBUFFER(instance_rows, at + 3);
    vec4 y_rest = FETCHBUFFER(instance_rows, at + 4);
    vec4 z_rest = FETCHBUFFER(instance_rows, at + 5);
    Pair from_x = two_sum(ray.org.x, -x.w);
    Pair from_y = two_sum(ray.org.y, -y.w);
    Pair from_z = two_sum(ray.org.z, -z.w);
    Pair org_x = transformed(Pair(-x_rest.w, 0.0), x, x_rest, from_x, from_y, from_z);
    Pair org_y = transformed(Pair(-y_rest.w, 0.0), y, y_rest, from_x, from_y, from_z);
    Pair org_z = transformed(Pair(-z_rest.w, 0.0), z, z_rest, from_x, from_y, from_z);
    Pair dx = Pair(ray.dir.x, 0.0);
    Pair dy = Pair(ray.dir.y, 0.0);
    Pair dz = Pair(ray.dir.z, 0.0);
    Pair dir_x = transformed(Pair(0.0, 0.0), x, x_rest, dx, dy, dz);
    Pair dir_y = transformed(Pair(0.0, 0.0), y, y_rest, dx, dy, dz);
    Pair dir_z = transformed(Pair(0.0, 0.0), z, z_rest, dx, dy, dz);
    return LocalRay(vec3(org_x.hi, org_y.hi, org_z.hi), vec3(org_x.lo, org_y.lo, org_z.lo),
                    vec3(dir_x.hi, dir_y.hi, dir_z.hi), vec3(dir_x.lo, dir_y.lo, dir_z.lo));
}

LocalRay to_top_level(Ray ray) {
    Pair x = two_sum(ray.org.x, -top_frame.x);
    Pair y = two_sum(ray.org.y, -top_frame.y);
    Pair z = two_sum(ray.org.z, -top_frame.z);
    return LocalRay(vec3(x.hi, y.hi, z.hi), vec3(x.lo, y.lo, z.lo), ray.dir, vec3(0.0));
}
