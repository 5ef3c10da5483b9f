// Walking a grid without drift: whole cells, every exit plane computed from its number, and empty
// space crossed at once.
//
// An empty cell says how large a cube of empty cells lies ahead, in each octant of directions; so the
// ray goes on to where it leaves that cube. A full cell is its own cube.
//
// Why no cell is lost. A grid is built with each triangle in all cells within kBinningPad of a cell
// (core/grid/uniform_grid.h). The walk starts where the ray enters the grid, so that at any
// computed t its position on each axis is known to 20 * 2^-24 of the grid's size there
// (gpu_glsl/README.md adds it up): less than that pad up to 1,638 cells on an axis;
// core/grid/sizing.h stops at 1,024. So the cell where the walk is at any t names every triangle
// that the ray meets there, and between two such places it was in the cube.
#pragma once
#include "lib/local_ray.glsl"
#include "lib/triangle/rule_out.glsl"

// A part of the ray, in t.
struct Span {
    float enter;
    float leave;
};

// The part of a ray that a walk may see: it begins where the ray enters the grid, and its t is a
// length in the grid's frame, counted from there.
struct Course {
    vec3 org;            // from the grid's centre
    vec3 dir;            // its largest component 1/2 to 1, none 0
    float start;         // t of the whole ray at the origin
    double length_of_t;  // the course's t that go into one of the ray's
    float leave;         // where the ray ends, or a little behind the grid; negative: it misses the grid
};

// The ray's t as one of the course.
float t_along(Course course, double t) {
    return float((t - double(course.start)) * course.length_of_t);
}

// The walk through the cells. On each axis they are counted by how many are left, this one included, to
// where the ray leaves the grid: the ray leaves the cell with `left` to go at t_leave - (left - 1)
// t_edge, from the start of the course on.
struct Walk {
    vec3 left;         // at least 1; biased (lib/bits.glsl)
    vec3 t_leave;
    vec3 t_edge;
    vec3 cells_per_t;  // 1 / t_edge
    ivec3 stride;      // of the cells' indices, from one with `left` to go to the one before it
    int origin;        // the index of the cell for which the bits of `left` are 0
};

// A component of 0 would divide to infinity, and 0 * infinity is no number. One of 2^-66 moves the
// ray by nothing within the grid.
float guarded(float d) {
    const float kLeast = 1.3552527156068805e-20;
    return mix(d, mix(kLeast, -kLeast, d < 0.0), abs(d) < kLeast);
}

// Where the ray is in the box; enter > leave where it misses. The rounding of t is
// given to both ends: a box wrongly entered costs a few steps, one wrongly missed costs hits.
Span span_in_box(vec3 org, vec3 inverse, vec3 lower, vec3 upper) {
    const float kRounding = 4.76837158203125e-7;  // 2^-21: four ulps
    vec3 t_lower = (lower - org) * inverse;
    vec3 t_upper = (upper - org) * inverse;
    float enter = largest(lesser(t_lower, t_upper));
    float leave = smallest(greater(t_lower, t_upper));
    return Span(enter - kRounding * abs(enter), leave + kRounding * abs(leave));
}

// Moves the ray's origin to where the part [t_first, t_last] enters the grid.
Course course_in(Grid grid, LocalRay ray, float t_first, float t_last) {
    Course course;
    course.length_of_t = length_scale(ray);
    double t_of_length = inverse_of_power(course.length_of_t);
    vec3 dir = vec3(ray.dir * t_of_length);
    course.dir = vec3(guarded(dir.x), guarded(dir.y), guarded(dir.z));
    LocalRay centred = LocalRay(ray.org - dvec3(grid.centre), ray.dir);
    Span span = span_in_box(vec3(centred.org), 1.0 / course.dir, grid.lower, grid.upper);
    course.start = greater(t_first, float(double(span.enter) * t_of_length));
    course.org = vec3(moved(centred, course.start).org);
    course.leave = lesser(t_along(course, double(t_last)),
                          span.leave - float(double(course.start) * course.length_of_t));
    // A ray from so far away that floats do not hold it misses. (Nor would a walk along numbers that are
    // none be sure to end.)
    course.leave = mix(course.leave, -1.0, !is_finite(course.org));
    return course;
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

// The cells left on an axis at t, where the ray leaves a box: those behind the box if it leaves it on
// this axis, else no more than before: two axes could undo each other's steps by their rounding.
float left_beside(float t, float t_exit, float behind, float left, float t_leave,
                  float cells_per_t) {
    return mix(min(left, left_at(t, t_leave, cells_per_t)), behind + bias(), t_exit <= t);
}

// How many cells are left, not biased, behind the cube of that edge, biased, that begins with the
// walk's cell.
vec3 left_behind_cube(Walk walk, float edge) { return walk.left - vec3(edge); }

// Leaves a box of cells, behind which so many are left, and says at which t. (One no smaller than that
// where the ray leaves the grid is the end: there is no cell.)
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
