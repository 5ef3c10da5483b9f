// The object level (Adinetz & Berezin, section 4): two nested loops, over cells and over triangles.
//
// Includes no triangle test: the strategy chooses one, lib/paper/triangle.glsl or its own, first.
#pragma once
#include "lib/paper/walk.glsl"

CONSTANT(int, clip_to_cell)

// A world ray's origin and direction in the frame of an instance's object.
vec3 object_origin(Instance instance, Ray ray) {
    return vec3(plane_at(instance.row0, ray.org), plane_at(instance.row1, ray.org),
                plane_at(instance.row2, ray.org));
}
vec3 object_direction(Instance instance, Ray ray) {
    return vec3(plane_along(instance.row0, ray.dir), plane_along(instance.row1, ray.dir),
                plane_along(instance.row2, ray.dir));
}

// Finds the nearest hit of one instance in [t_start, t_stop], if it is nearer than `hit`.
void intersect_instance(ADDRESS address, Ray ray, float t_start, float t_stop, INOUT(Hit) hit) {
    Instance instance = fetch_instance(address);
    vec3 org = object_origin(instance, ray);
    vec3 dir = object_direction(instance, ray);
    Grid grid = fetch_grid(instance.grid);
    Walk walk = begin_walk(grid, org, dir, t_start, t_stop);
    if (missed(walk, grid)) return;

    bool done = false;
    for (int steps = 0; steps < grid.step_budget; ++steps) {
        NOTE_CELL(instance.inst_id, cell_number(walk, grid));
        CellList list = list_of_cell(walk);
        float t_first = clip_to_cell == 1 ? walk.t_start : t_start;
        float t_last = clip_to_cell == 1 ? walk.t_end : t_stop;
        int k = 0;
        for (; k < list.count; ++k) {
            intersect_triangle(fetch_triangle_reference(list.address), org, dir, t_first, t_last,
                               instance.inst_id, grid.first_triangle, hit);
            list.address = next_triangle_reference(list.address);
        }
        if (k < list.count) break;  // the driver ended the loop: `done` stays false
        done = hit.t <= walk.t_end || !next_voxel(grid, walk);
        if (done) break;
    }
    if (!done) ray_flags |= kFlagExhausted;
}
