// What one walk goes through where instances are walked through one by one: an instance's own grid,
// whose lists name a triangle by its slot. Where one walk goes through all instances,
// storage/flat_grid/flat_cells.glsl answers otherwise.
#pragma once
#include "lib/triangle/candidates.glsl"
#include "storage/two_level_grid/grid_buffers.glsl"

CONSTANT(int, test_boxes)  // 0: all instances of a cell are walked through

// The inst_id of the only walk, where there is no top level.
const uint kWholeScene = 0u;

// The grid of a walk, and the ray in its frame.
Grid fetch_walked_grid(uint inst_id) { return fetch_grid(fetch_grid_of_instance(inst_id)); }
LocalRay to_walked_grid(uint inst_id, Ray ray) { return to_instance(inst_id, ray); }

// What a triangle of the walk's lists is.
Name named(uint inst_id, uint listed) { return Name(inst_id, listed); }

// What the lists call the nearest hit; kNoId if it is not in them.
uint listed_in(Nearest nearest, uint inst_id) {
    return nearest.hit.inst_id == inst_id ? nearest.listed : kNoId;
}

// Where a ray enters an instance's own grid, which decisions on rays from afar begin at
// (lib/local_ray.glsl). `start`: where the walk begins.
float start_in_instance(Grid grid, LocalRay local, Ray ray, float start) { return start; }
