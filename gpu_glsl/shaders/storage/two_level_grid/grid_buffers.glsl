// The two-level grid in buffers, addressed by integers: what storage/two_level_grid/buffer.glsl and
// ssbo.glsl have in common. They fetch the tables that a walk reads at every step:
//
//   uint reference_word(int index)
//   uvec4 planes_texel(int index)
//
// two that a decision reads, which vertices a triangle has, and those:
//
//   uvec4 corners_texel(int index)
//   vec4 vertex_texel(int index)
//
// an object's cells, as storage/two_level_grid/uniform_cells.glsl does, and what one walk goes
// through, as storage/two_level_grid/walked_instance.glsl does.
//
// All that belongs to a grid is stored in the grid's frame, so that an object far from the origin,
// or of any size, is as precise as one of size 1 around it. The frame's origin is at a corner of
// the object, on those axes where taking that corner off is exact, and else stays where it was; the
// frame of an object's grid is scaled by the power of two that makes its largest coordinate 1/2 to
// 1. Both are exact: no vertex is ever moved.
//
// Triangles are stored in an order of their own (core/storage_order.h), and named by their slots
// in it.
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"
#include "shared/grid_buffers_layout.h"
#include "storage/instance_rows.glsl"

// The object grids: fixed once they are built.
BUFFER(grid_frames)
UBUFFER(grid_numbers)
CONSTANT(bool, has_several_objects)  // false: one, with grid number 0 and the first triangles

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
                ivec3(int(dims.x), int(dims.y), int(dims.z)), int(dims.w),
                has_several_objects ? int(first.x) : 0, int(first.y));
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

// A triangle of an instance.
struct Name {
    uint inst_id;
    uint slot;
};

Planes fetch_planes(Grid grid, uint slot) {
    int at = (grid.first_triangle + int(slot)) * planes_texels();
    return Planes(planes_texel(at), planes_texel(at + 1),
                  has_fixed_planes ? uvec4(0u) : planes_texel(at + 2));
}

// Which vertices a triangle has.
struct Corners {
    uint v0;
    uint v1;
    uint v2;
    uint prim_id;  // what the scene calls it
};

Corners fetch_corners(Grid grid, uint slot) {
    uvec4 corners = corners_texel(grid.first_triangle + int(slot));
    return Corners(corners.x, corners.y, corners.z, corners.w);
}

Triangle fetch_triangle(Corners corners) {
    return Triangle(vec3(vertex_texel(int(corners.v0))), vec3(vertex_texel(int(corners.v1))),
                    vec3(vertex_texel(int(corners.v2))));
}

#if NEEDS(has_several_objects)
UBUFFER(instance_grids)
int fetch_grid_of_instance(uint inst_id) {
    return int(FETCHBUFFER(instance_grids, int(inst_id)).x);
}
#else
int fetch_grid_of_instance(uint inst_id) { return 0; }
#endif

#ifdef ONEPASS_TWIN
// (For notes of a walk.)
uint prim_id_of(Name name) {
    Grid grid = fetch_grid(fetch_grid_of_instance(name.inst_id));
    return fetch_corners(grid, name.slot).prim_id;
}
#endif

#if NEEDS(has_top_level)
#include "storage/two_level_grid/top_buffers.glsl"
#endif
