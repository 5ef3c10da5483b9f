// The top level in buffers, the second half of storage/two_level_grid/grid_buffers.glsl: a scene of
// one instance has none. All of it is made anew when instances move (pack/top_level_update.h).
#pragma once
#include "lib/course.glsl"

UBUFFER(top_cells)
UBUFFER(top_references)   // instances
BUFFER(instance_boxes)    // in its frame, a little wider than the instances
UNIFORM(vec3, top_frame)  // the origin of its frame, in the world
UNIFORM(vec3, top_lower)  // its Grid; dims as floats
UNIFORM(vec3, top_upper)
UNIFORM(vec3, top_cell)
UNIFORM(vec3, top_cells_per_unit)
UNIFORM(vec3, top_dims)

Grid fetch_top_grid() {
    return Grid(vec3(0.0), top_lower, top_upper, top_cell, top_cells_per_unit,
                ivec3(int(top_dims.x), int(top_dims.y), int(top_dims.z)), 0, 0, 0);
}

uint top_cell_word(int index) { return FETCHBUFFER(top_cells, index).x; }

uint fetch_instance_reference(int index) {
    count_reference();
    return FETCHBUFFER(top_references, index).x;
}

Box fetch_instance_box(uint inst_id) {
    int at = int(inst_id) * kInstanceBoxTexels;
    vec3 lower = vec3(FETCHBUFFER(instance_boxes, at));
    return Box(vec3(0.0), lower, vec3(FETCHBUFFER(instance_boxes, at + 1)));
}

LocalRay to_top_level(Ray ray) {
    return LocalRay(dvec3(ray.org) - dvec3(top_frame), dvec3(ray.dir));
}
