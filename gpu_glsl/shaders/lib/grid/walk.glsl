// Walking a grid without drift: integer cells, and every exit plane computed from its number.
//
// Why no cell is lost. A grid is built with each triangle in all cells within kBinningPad of a cell
// (core/grid/uniform_grid.h). The walk starts where the ray enters the grid, so that its position
// on each axis is wrong by at most 10 * 2^-24 of the grid's size there (gpu_glsl/README.md adds it
// up): less than that pad up to 1,600 cells on an axis; core/grid/sizing.h stops at 1,024. So the
// cell where the walk is at any t names every triangle that the ray meets there.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"

// A part of the ray, in t.
struct Span {
    float enter;
    float leave;
};

// The ray as a walk sees it: from where it enters the grid.
struct Course {
    vec3 org;      // in the grid's frame; t = 0 is the start
    vec3 org_rest;  // as in LocalRay
    vec3 dir;
    vec3 inverse;  // 1 / dir, and a large number where dir is 0 or nearly
    float start;   // t of the ray at org
    float leave;   // where it leaves the grid or ends, from the start on
};

struct Walk {
    ivec3 cell;
    ivec3 step;    // -1 or 1 on each axis
    vec3 t_exit;   // of the cell's far planes, from the start on
};

// A component of 0 would divide to infinity, and 0 * infinity is no number. One that is 2^-66 of
// the largest moves the ray by nothing within the grid.
float guarded_inverse(float d, float largest_component) {
    float least = 1.3552527156068805e-20 * largest_component;
    float kept = abs(d) < least ? (d < 0.0 ? -least : least) : d;
    return 1.0 / kept;
}

vec3 guarded_inverse(vec3 dir) {
    float size = largest(abs(dir));
    return vec3(guarded_inverse(dir.x, size), guarded_inverse(dir.y, size),
                guarded_inverse(dir.z, size));
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

// The ray's point at t, on one axis.
Pair moved(float org, float org_rest, float dir, float dir_rest, float t) {
    return normalised(add_product(Pair(org, org_rest), Pair(dir, dir_rest), Pair(t, 0.0)));
}

// Moves the ray's origin to where the part [t_first, t_last] enters the grid. leave < 0 if it does
// not.
Course course_in(Grid grid, LocalRay ray, float t_first, float t_last) {
    Course course;
    course.dir = ray.dir;
    course.inverse = guarded_inverse(ray.dir);
    Span span = span_in_box(ray.org, course.inverse, grid.lower, grid.upper);
    course.start = greater(t_first, span.enter);
    Pair x = moved(ray.org.x, ray.org_rest.x, ray.dir.x, ray.dir_rest.x, course.start);
    Pair y = moved(ray.org.y, ray.org_rest.y, ray.dir.y, ray.dir_rest.y, course.start);
    Pair z = moved(ray.org.z, ray.org_rest.z, ray.dir.z, ray.dir_rest.z, course.start);
    course.org = vec3(x.hi, y.hi, z.hi);
    course.org_rest = vec3(x.lo, y.lo, z.lo);
    course.leave = lesser(t_last, span.leave) - course.start;
    return course;
}

// t of the far plane of a cell on one axis.
float exit_t(int cell, int step, float lower, float edge, float org, float inverse) {
    return (lower + float(step > 0 ? cell + 1 : cell) * edge - org) * inverse;
}
float exit_x(Grid grid, Course course, Walk walk) {
    return exit_t(walk.cell.x, walk.step.x, grid.lower.x, grid.cell.x, course.org.x,
                  course.inverse.x);
}
float exit_y(Grid grid, Course course, Walk walk) {
    return exit_t(walk.cell.y, walk.step.y, grid.lower.y, grid.cell.y, course.org.y,
                  course.inverse.y);
}
float exit_z(Grid grid, Course course, Walk walk) {
    return exit_t(walk.cell.z, walk.step.z, grid.lower.z, grid.cell.z, course.org.z,
                  course.inverse.z);
}

int start_cell(float position, float cells_per_unit, int dim) {
    return clamp(int(floor(position * cells_per_unit)), 0, dim - 1);
}

// The walk from a point of the course, `t` from its start.
Walk begin_walk(Grid grid, Course course, float t) {
    vec3 at = course.org + course.dir * t;
    Walk walk;
    walk.cell = ivec3(start_cell(at.x - grid.lower.x, grid.cells_per_unit.x, grid.dims.x),
                      start_cell(at.y - grid.lower.y, grid.cells_per_unit.y, grid.dims.y),
                      start_cell(at.z - grid.lower.z, grid.cells_per_unit.z, grid.dims.z));
    walk.step = ivec3(course.inverse.x < 0.0 ? -1 : 1, course.inverse.y < 0.0 ? -1 : 1,
                      course.inverse.z < 0.0 ? -1 : 1);
    walk.t_exit = vec3(exit_x(grid, course, walk), exit_y(grid, course, walk),
                       exit_z(grid, course, walk));
    return walk;
}

// Crosses the nearest plane: one axis, one cell. False if that leads out of the grid.
bool next_cell(Grid grid, Course course, INOUT(Walk) walk) {
    if (walk.t_exit.x <= walk.t_exit.y && walk.t_exit.x <= walk.t_exit.z) {
        walk.cell.x += walk.step.x;
        walk.t_exit.x = exit_x(grid, course, walk);
        return walk.cell.x >= 0 && walk.cell.x < grid.dims.x;
    }
    if (walk.t_exit.y <= walk.t_exit.z) {
        walk.cell.y += walk.step.y;
        walk.t_exit.y = exit_y(grid, course, walk);
        return walk.cell.y >= 0 && walk.cell.y < grid.dims.y;
    }
    walk.cell.z += walk.step.z;
    walk.t_exit.z = exit_z(grid, course, walk);
    return walk.cell.z >= 0 && walk.cell.z < grid.dims.z;
}

int step_budget(Grid grid) { return grid.dims.x + grid.dims.y + grid.dims.z; }
