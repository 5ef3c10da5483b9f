// What one walk goes through where there is one level only: a grid over the triangles of all
// instances, as they stand in the world.
//
// Cells, lists and planes are the flat grid's, and say which triangles a ray may hit. Whether it
// does is for doubles to say, in the frame of the triangle's instance and on the object's own
// vertices, all of which is as in storage/two_level_grid/grid_buffers.glsl: so no hit rests on a
// corner that was rounded on its way into the world.
#pragma once
#include "lib/triangle/candidates.glsl"
#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"

UBUFFER(flat_names)         // of each triangle in the lists: inst_id, slot
UNIFORM(vec3, flat_origin)  // of its frame, in the world
UNIFORM(float, flat_scale)  // its unit of length, a power of two
UNIFORM(vec3, flat_centre)  // its Grid; dims as floats
UNIFORM(vec3, flat_lower)
UNIFORM(vec3, flat_upper)
UNIFORM(vec3, flat_cell)
UNIFORM(vec3, flat_cells_per_unit)
UNIFORM(vec3, flat_dims)

const uint kWholeScene = kNoId;

const int test_boxes = 0;  // of instances that are walked through one by one

Grid fetch_walked_grid(uint inst_id) {
    return Grid(flat_centre, flat_lower, flat_upper, flat_cell, flat_cells_per_unit,
                ivec3(int(flat_dims.x), int(flat_dims.y), int(flat_dims.z)), 0, 0, 0);
}

LocalRay to_walked_grid(uint inst_id, Ray ray) {
    double scale = double(flat_scale);
    return LocalRay((dvec3(ray.org) - dvec3(flat_origin)) * scale, dvec3(ray.dir) * scale);
}

Name named(uint inst_id, uint listed) {
    uvec4 name = FETCHBUFFER(flat_names, int(listed));
    return Name(name.x, name.y);
}

uint listed_in(Nearest nearest, uint inst_id) { return nearest.listed; }

// (What `grid` starts from, so that both give the same bits.)
float start_in_instance(Grid grid, LocalRay local, Ray ray, float start) {
    if (is_from_afar(local)) start = course_in(grid, local, ray.tmin, ray.tmax).start;
    return start;
}
