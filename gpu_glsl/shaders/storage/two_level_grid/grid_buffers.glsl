// The two-level grid in buffers, addressed by integers: what storage/two_level_grid/buffer.glsl and
// ssbo.glsl have in common. They fetch the tables that a walk reads at every step:
//
//   uint reference_word(int index)
//   vec4 planes_texel(int index)
//
// two that a decision reads, an object's vertices and which of them a triangle has:
//
//   uint corner_word(int index), vertex_word(int index)
//
// an object's cells, as storage/two_level_grid/uniform_cells.glsl does, and what one walk goes
// through, as storage/two_level_grid/walked_instance.glsl does.
//
// All that belongs to a grid is stored in the grid's frame, so that an object far from the origin,
// or of any size, is as precise as one of size 1 around it. The frame's origin is at a corner of
// the object, on those axes where taking that corner off is exact, and else stays where it was; the
// frame of an object's grid is scaled by the power of two that makes its largest coordinate 1/2 to
// 1. Both are exact: no vertex is ever moved.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"
#include "shared/grid_buffers_layout.h"

// The object grids: fixed once they are built.
BUFFER(grid_frames)
UBUFFER(grid_numbers)
UBUFFER(instance_grids)

// Made anew when instances move (pack/top_level_update.h).
BUFFER(instance_rows)

struct Grid {
    vec3 centre;         // in its frame
    vec3 lower;          // corners of the whole grid, from its centre
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
    return Grid(vec3(FETCHBUFFER(grid_frames, at + 4)), vec3(FETCHBUFFER(grid_frames, at)),
                vec3(FETCHBUFFER(grid_frames, at + 1)), vec3(FETCHBUFFER(grid_frames, at + 2)),
                vec3(FETCHBUFFER(grid_frames, at + 3)),
                ivec3(int(dims.x), int(dims.y), int(dims.z)), int(dims.w), int(first.x),
                int(first.y));
}

// ---- Cells and lists: a word each --------------------------------------------------------------

bool is_empty_cell(uint cell) { return (cell & kEmptyCell) != 0u; }

// The edge of the cube of empty cells that lies ahead of a ray in an empty one, in cells, biased
// (lib/bits.glsl). `octant_shift`: 3 times the octant of its direction.
float empty_cube(uint cell, uint octant_shift) {
    uint code = (cell >> octant_shift) & 7u;
    return biased(1u + ((code * (code + 1u)) >> 1u));
}

int first_reference(uint cell) { return int(cell); }

uint fetch_triangle_reference(int index) {
    count_reference();
    return reference_word(index);
}

bool is_last_reference(uint reference) { return (reference & kMoreReferences) == 0u; }
uint referenced(uint reference) { return reference & ~kMoreReferences; }

// ---- Triangles and instances -------------------------------------------------------------------

// What the scene calls a triangle.
struct Name {
    uint inst_id;
    uint prim_id;
};

Planes fetch_planes(Grid grid, uint prim_id) {
    int at = (grid.first_triangle + int(prim_id)) * kPlanesTexels;
    return Planes(planes_texel(at), planes_texel(at + 1), planes_texel(at + 2));
}

vec3 fetch_corner(int index) {
    int at = 3 * int(corner_word(index));
    return vec3(uintBitsToFloat(vertex_word(at)), uintBitsToFloat(vertex_word(at + 1)),
                uintBitsToFloat(vertex_word(at + 2)));
}

Triangle fetch_triangle(Grid grid, uint prim_id) {
    int at = 3 * (grid.first_triangle + int(prim_id));
    return Triangle(fetch_corner(at), fetch_corner(at + 1), fetch_corner(at + 2));
}

int fetch_grid_of_instance(uint inst_id) {
    return int(FETCHBUFFER(instance_grids, int(inst_id)).x);
}

// The ray in the frame of the instance's grid. The place of the instance is taken off first, which
// is exact in doubles but for the smallest parts of far places, so that neither a large translation
// nor a cancelling rotation loses any.
#if NEEDS(has_linear_maps)
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
#else
// Where no instance is turned or scaled, M is a power of two.
LocalRay to_instance(uint inst_id, Ray ray) {
    int at = int(inst_id) * kInstanceRowTexels;
    vec4 x = FETCHBUFFER(instance_rows, at);
    vec3 place = vec3(x.w, FETCHBUFFER(instance_rows, at + 1).w, FETCHBUFFER(instance_rows, at + 2).w);
    vec3 origin = vec3(FETCHBUFFER(instance_rows, at + 3).w, FETCHBUFFER(instance_rows, at + 4).w,
                       FETCHBUFFER(instance_rows, at + 5).w);
    double scale = double(x.x);
    return LocalRay((dvec3(ray.org) - dvec3(place)) * scale - dvec3(origin), dvec3(ray.dir) * scale);
}
#endif

#if NEEDS(has_top_level)
#include "storage/two_level_grid/top_buffers.glsl"
#endif
