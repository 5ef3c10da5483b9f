// Walking a grid without drift: whole cells, every exit plane computed from its number, and empty
// space crossed at once.
//
// An empty cell says how large a cube of empty cells lies ahead, in each octant of directions; so
// the ray goes on to where it leaves that cube. A full cell is its own cube.
//
// Why no cell is lost. A grid is built with each triangle in all cells within kBinningPad of a cell
// (core/grid/uniform_grid.h). The walk starts where the ray enters the grid, so that at any
// computed t its position on each axis is known to 20 * 2^-24 of the grid's size there
// (gpu_glsl/README.md adds it up): less than that pad up to 1,638 cells on an axis;
// core/grid/sizing.h stops at 1,024. So the cell where the walk is at any t names every triangle
// that the ray meets there, and between two such places it was in the cube.
#pragma once
#include "lib/course.glsl"

// The walk through the cells. On each axis they are counted by how many are left, this one
// included, to where the ray leaves the grid: the ray leaves the cell with `left` to go at
// t_leave - (left - 1) t_edge, from the start of the course on.
struct Walk {
    vec3 left;         // at least 1; biased (lib/bits.glsl)
    vec3 t_leave;
    vec3 t_edge;
    vec3 cells_per_t;  // 1 / t_edge
    ivec3 stride;      // of the cells' indices, from one with `left` to go to the one before it
    int origin;        // the index of the cell for which the bits of `left` are 0
};

// A course through the grid.
Course course_in(Grid grid, LocalRay ray, float t_first, float t_last) {
    return course_in(Box(grid.centre, grid.lower, grid.upper), ray, t_first, t_last);
}

// How many cells are left at t, biased. A place on a plane is beyond it, but at the last.
float left_at(float t, float t_leave, float cells_per_t) {
    return floor((t_leave - t) * cells_per_t) + (bias() + 1.0);
}

// Begins at t of the course.
Walk begin_walk(Grid grid, Course course, float t) {
    Walk walk;
    vec3 inverse = 1.0 / course.dir;
    vec3 upper = grid.lower + vec3(grid.dims) * grid.cell;
    vec3 far = vec3(mix(upper.x, grid.lower.x, course.dir.x < 0.0),
                    mix(upper.y, grid.lower.y, course.dir.y < 0.0),
                    mix(upper.z, grid.lower.z, course.dir.z < 0.0));
    walk.t_leave = (far - course.org) * inverse;
    walk.t_edge = grid.cell * abs(inverse);
    walk.cells_per_t = grid.cells_per_unit * abs(course.dir);
    vec3 left = vec3(left_at(t, walk.t_leave.x, walk.cells_per_t.x),
                     left_at(t, walk.t_leave.y, walk.cells_per_t.y),
                     left_at(t, walk.t_leave.z, walk.cells_per_t.z));
    vec3 most = vec3(biased(uint(grid.dims.x)), biased(uint(grid.dims.y)),
                     biased(uint(grid.dims.z)));
    walk.left = clamp(left, vec3(biased(1u)), most);

    // A ray that goes up an axis has left = dims - cell, one that goes down left = cell + 1.
    // (Places of an irregular grid have no index: of the strides only the signs are used.)
    ivec3 stride = grid.depth > 0 ? ivec3(1) : ivec3(1, grid.dims.x, grid.dims.x * grid.dims.y);
    ivec3 up = ivec3(course.dir.x < 0.0 ? 0 : 1, course.dir.y < 0.0 ? 0 : 1,
                     course.dir.z < 0.0 ? 0 : 1);
    walk.stride = stride * (1 - 2 * up);
    ivec3 none_left = up * (grid.dims + 1) - 1;
    walk.origin = grid.first_cell + none_left.x * stride.x + none_left.y * stride.y +
                  none_left.z * stride.z -
                  kBitsOfBias * (walk.stride.x + walk.stride.y + walk.stride.z);
    return walk;
}

// The index of the walk's cell.
int cell_index(Walk walk) {
    return walk.origin + biased_bits(walk.left.x) * walk.stride.x +
           biased_bits(walk.left.y) * walk.stride.y + biased_bits(walk.left.z) * walk.stride.z;
}

// 3 times the octant of the ray's direction: 1 for greater x, plus 2 for greater y, plus 4 for
// greater z.
uint octant_shift(Walk walk) {
    return (walk.stride.x < 0 ? 3u : 0u) + (walk.stride.y < 0 ? 6u : 0u) +
           (walk.stride.z < 0 ? 12u : 0u);
}

// The cells left on an axis at t, where the ray leaves a box: those behind the box if it leaves it
// on this axis, else no more than before: two axes could undo each other's steps by their rounding.
float left_beside(float t, float t_exit, float behind, float left, float t_leave,
                  float cells_per_t) {
    return mix(min(left, left_at(t, t_leave, cells_per_t)), behind + bias(), t_exit <= t);
}

// How many cells are left, not biased, behind the cube of that edge, biased, that begins with the
// walk's cell.
vec3 left_behind_cube(Walk walk, float edge) { return walk.left - vec3(edge); }

// Leaves a box of cells, behind which so many are left, and says at which t. (One no smaller than
// that where the ray leaves the grid is the end: there is no cell.)
float leave_cells(INOUT(Walk) walk, vec3 behind) {
    vec3 t_exit = walk.t_leave - behind * walk.t_edge;
    float t = min(t_exit.x, min(t_exit.y, t_exit.z));
    walk.left = vec3(left_beside(t, t_exit.x, behind.x, walk.left.x, walk.t_leave.x,
                                 walk.cells_per_t.x),
                     left_beside(t, t_exit.y, behind.y, walk.left.y, walk.t_leave.y,
                                 walk.cells_per_t.y),
                     left_beside(t, t_exit.z, behind.z, walk.left.z, walk.t_leave.z,
                                 walk.cells_per_t.z));
    return t;
}

// The walk's cell, counted from the grid's lower corner.
ivec3 cell_of(Grid grid, Walk walk) {
    ivec3 left = ivec3(biased_bits(walk.left.x), biased_bits(walk.left.y),
                       biased_bits(walk.left.z)) - kBitsOfBias;
    return ivec3(walk.stride.x < 0 ? grid.dims.x - left.x : left.x - 1,
                 walk.stride.y < 0 ? grid.dims.y - left.y : left.y - 1,
                 walk.stride.z < 0 ? grid.dims.z - left.z : left.z - 1);
}
