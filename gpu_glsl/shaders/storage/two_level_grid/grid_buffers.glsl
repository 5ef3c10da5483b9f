// The two-level grid in buffers, addressed by integers: what storage/two_level_grid/buffer.glsl and
// ssbo.glsl have in common. They fetch the tables that a walk reads at every step:
//
//   uint reference_word(int index)
//   vec4 triangle_texel(int index)
//
// and an object's cells, as storage/two_level_grid/uniform_cells.glsl does:
//
//   CELL fetch_cell(Grid, ivec3 place)
//   bool is_empty_cell(CELL)
//   int first_reference(CELL)
//   ivec3 far_corner(CELL, ivec3 place, ivec3 step, uint octant_shift)
//                                  the last place where a ray from `place` on is in the cell
//
// All that belongs to a grid is stored in the grid's frame, so that an object far from the origin,
// or of any size, is as precise as one of size 1 around it. The frame's origin is at a corner of
// the object, on those axes where taking that corner off is exact, and else stays where it was; the
// frame of an object's grid is scaled by the power of two that makes its largest coordinate 1/2 to
// 1. Both are exact: no vertex is ever moved.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "lib/triangle/rule_out.glsl"
#include "shared/grid_buffers_layout.h"

// The object grids: fixed once they are built.
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
    int depth;           // of an irregular grid: its cells' cubes are divided by 2^depth; else 0
};

Grid fetch_grid(int number) {
    int at = number * kGridFrameTexels;
    uvec4 dims = FETCHBUFFER(grid_numbers, number * kGridNumberTexels);
    uvec4 first = FETCHBUFFER(grid_numbers, number * kGridNumberTexels + 1);
    return Grid(vec3(FETCHBUFFER(grid_frames, at)), vec3(FETCHBUFFER(grid_frames, at + 1)),
                vec3(FETCHBUFFER(grid_frames, at + 2)), vec3(FETCHBUFFER(grid_frames, at + 3)),
                ivec3(int(dims.x), int(dims.y), int(dims.z)), int(dims.w), int(first.x),
                int(first.y));
}

Grid fetch_top_grid() {
    return Grid(top_lower, top_upper, top_cell, top_cells_per_unit,
                ivec3(int(top_dims.x), int(top_dims.y), int(top_dims.z)), 0, 0, 0);
}

// ---- Cells and lists: a word each --------------------------------------------------------------

int cell_index(Grid grid, ivec3 cell) {
    return grid.first_cell + cell.x + grid.dims.x * (cell.y + grid.dims.y * cell.z);
}

uint fetch_top_cell(Grid grid, ivec3 cell) {
    return FETCHBUFFER(top_cells, cell_index(grid, cell)).x;
}

bool is_empty_cell(uint cell) { return (cell & kEmptyCell) != 0u; }

// The edge of the cube of empty cells that lies ahead of a ray, in cells: 1 for a full cell.
// `octant_shift`: 3 times the octant of its direction.
int empty_cube(uint cell, uint octant_shift) {
    uint code = (cell >> octant_shift) & 7u;
    uint edges = code < 4u ? kEmptyCubeEdges0 : kEmptyCubeEdges4;
    int edge = int((edges >> (8u * (code & 3u))) & 255u);
    return is_empty_cell(cell) ? edge : 1;
}

int first_reference(uint cell) { return int(cell); }

uint fetch_triangle_reference(int index) {
    count_reference();
    return reference_word(index);
}

uint fetch_instance_reference(int index) {
    count_reference();
    return FETCHBUFFER(top_references, index).x;
}

bool is_last_reference(uint reference) { return (reference & kMoreReferences) == 0u; }
uint referenced(uint reference) { return reference & ~kMoreReferences; }

// ---- Triangles and instances -------------------------------------------------------------------

Triangle fetch_triangle(Grid grid, uint prim_id) {
    int at = (grid.first_triangle + int(prim_id)) * kTriangleVertexTexels;
    return Triangle(vec3(triangle_texel(at)), vec3(triangle_texel(at + 1)),
                    vec3(triangle_texel(at + 2)));
}

int fetch_grid_of_instance(uint inst_id) {
    return int(FETCHBUFFER(instance_grids, int(inst_id)).x);
}

// The ray in the frame of the instance's grid. The place of the instance is taken off first, which
// is exact in doubles but for the smallest parts of far places, so that neither a large translation
// nor a cancelling rotation loses any.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec4 y = FETCHBUFFER(instance_rows, at + 1);
    vec4 z = FETCHBUFFER(instance_rows, at + 2);
    vec4 x_rest = FETCHBUFFER(instance_rows, at + 3);
    vec4 y_rest = FETCHBUFFER(instance_rows, at + 4);
    vec4 z_rest = FETCHBUFFER(instance_rows, at + 5);
    dvec3 row_x = dvec3(vec3(x)) + dvec3(vec3(x_rest));
    dvec3 row_y = dvec3(vec3(y)) + dvec3(vec3(y_rest));
    dvec3 row_z = dvec3(vec3(z)) + dvec3(vec3(z_rest));
    dvec3 from = dvec3(ray.org) - dvec3(vec3(x.w, y.w, z.w));
    dvec3 dir = dvec3(ray.dir);
    dvec3 origin = dvec3(vec3(x_rest.w, y_rest.w, z_rest.w));
    return LocalRay(dvec3(sharp_dot(row_x, from), sharp_dot(row_y, from), sharp_dot(row_z, from)) - origin,
                    dvec3(sharp_dot(row_x, dir), sharp_dot(row_y, dir), sharp_dot(row_z, dir)));
}

LocalRay to_top_level(Ray ray) {
    return LocalRay(dvec3(ray.org) - dvec3(top_frame), dvec3(ray.dir));
}
