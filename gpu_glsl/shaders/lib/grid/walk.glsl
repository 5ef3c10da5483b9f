// Walking a grid without drift: integer cells, every exit plane computed from its number, and empty
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
#include "lib/triangle/rule_out.glsl"

// A part of the ray, in t.
struct Span {
    float enter;
    float leave;
};

// The ray as a walk sees it: from where it enters the grid.
struct Course {
    LocalRay ray;  // its origin at the start
    vec3 dir;      // of the ray, no component 0
    float start;   // t of the whole ray at the start
    float leave;   // where it leaves the grid or ends, from the start on
};

// The walk through the cells. On each axis the ray leaves cell k at t_exit + k t_edge, from the start
// of the course on.
struct Walk {
    ivec3 cell;
    ivec3 step;        // -1 or 1 on each axis
    vec3 t_exit;
    vec3 t_edge;
    vec3 cells_per_t;  // 1 / t_edge
};

// A component of 0 would divide to infinity, and 0 * infinity is no number. One that is 2^-66 of
// the largest moves the ray by nothing within the grid; nor does the least normal number, 2^-126, if
// the largest is at least 2^-100.
float guarded(float d, float largest_component) {
    float least = greater(1.3552527156068805e-20 * largest_component, 1.1754943508222875e-38);
    return abs(d) < least ? (d < 0.0 ? -least : least) : d;
}

vec3 guarded(vec3 dir) {
    float size = largest(abs(dir));
    return vec3(guarded(dir.x, size), guarded(dir.y, size), guarded(dir.z, size));
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

// Moves the ray's origin to where the part [t_first, t_last] enters the grid. leave < 0 if it does
// not.
Course course_in(Grid grid, LocalRay ray, float t_first, float t_last) {
    Course course;
    course.dir = guarded(vec3(ray.dir));
    Span span = span_in_box(vec3(ray.org), 1.0 / course.dir, grid.lower, grid.upper);
    course.start = greater(t_first, span.enter);
    course.ray = moved(ray, course.start);
    course.leave = lesser(t_last, span.leave) - course.start;
    return course;
}

// A cell's number is that of its lower plane: a ray that goes up leaves cell k at plane k + 1.
int plane_ahead(int step) { return step > 0 ? 1 : 0; }

// The cell on one axis at t, within [first, last].
int cell_at(float t, float t_exit, float cells_per_t, int step, int first, int last) {
    int cell = int(floor((t - t_exit) * cells_per_t)) + plane_ahead(step);
    return clamp(cell, first, last);
}

// Begins at t of the course.
Walk begin_walk(Grid grid, Course course, float t) {
    Walk walk;
    vec3 inverse = 1.0 / course.dir;
    walk.step = ivec3(course.dir.x < 0.0 ? -1 : 1, course.dir.y < 0.0 ? -1 : 1,
                      course.dir.z < 0.0 ? -1 : 1);
    vec3 ahead = vec3(float(plane_ahead(walk.step.x)), float(plane_ahead(walk.step.y)),
                      float(plane_ahead(walk.step.z)));
    walk.t_exit = ((grid.lower - vec3(course.ray.org)) + ahead * grid.cell) * inverse;
    walk.t_edge = grid.cell * inverse;
    walk.cells_per_t = grid.cells_per_unit * course.dir;
    walk.cell = ivec3(
        cell_at(t, walk.t_exit.x, walk.cells_per_t.x, walk.step.x, 0, grid.dims.x - 1),
        cell_at(t, walk.t_exit.y, walk.cells_per_t.y, walk.step.y, 0, grid.dims.y - 1),
        cell_at(t, walk.t_exit.z, walk.cells_per_t.z, walk.step.z, 0, grid.dims.z - 1));
    return walk;
}

// 3 times the octant of the ray's direction: 1 for greater x, plus 2 for greater y, plus 4 for
// greater z.
uint octant_shift(Walk walk) {
    return (walk.step.x > 0 ? 3u : 0u) + (walk.step.y > 0 ? 6u : 0u) + (walk.step.z > 0 ? 12u : 0u);
}

// The far corner of the cube of that edge that begins at the walk's cell.
ivec3 last_cell(Walk walk, int edge) { return walk.cell + walk.step * (edge - 1); }

// t on each axis where the ray leaves a cell.
vec3 exit_t(Walk walk, ivec3 cell) { return walk.t_exit + vec3(cell) * walk.t_edge; }

// The cell on an axis that is not crossed when the ray leaves a cube. It does not go back: else two
// axes could undo each other's steps by their rounding.
int cell_beside(float t, float t_exit, float cells_per_t, int step, int cell, int last) {
    return cell_at(t, t_exit, cells_per_t, step, min(cell, last), max(cell, last));
}

// Leaves the cube of cells that ends at `last`, whose planes are at `t_exit`, by the nearest of them.
// False if that leads out of the grid.
bool next_cell(Grid grid, ivec3 last, vec3 t_exit, INOUT(Walk) walk) {
    float t = smallest(t_exit);
    ivec3 next = last + walk.step;
    if (t_exit.x > t) {
        next.x = cell_beside(t, walk.t_exit.x, walk.cells_per_t.x, walk.step.x, walk.cell.x, last.x);
    }
    if (t_exit.y > t) {
        next.y = cell_beside(t, walk.t_exit.y, walk.cells_per_t.y, walk.step.y, walk.cell.y, last.y);
    }
    if (t_exit.z > t) {
        next.z = cell_beside(t, walk.t_exit.z, walk.cells_per_t.z, walk.step.z, walk.cell.z, last.z);
    }
    walk.cell = next;
    return next.x >= 0 && next.x < grid.dims.x && next.y >= 0 && next.y < grid.dims.y &&
           next.z >= 0 && next.z < grid.dims.z;
}

int step_budget(Grid grid) { return grid.dims.x + grid.dims.y + grid.dims.z; }
