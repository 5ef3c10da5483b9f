// Walking a grid (Adinetz & Berezin, figure 2): from cell to cell by the distances of the exit
// planes.
//
// Both levels walk with this, in any storage: the storage comes first in the text. Numbers D1 to
// D19 refer to the deviation table of gpu_glsl/README.md.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"

CONSTANT(int, accumulate_ts)
CONSTANT(int, step_ties)
CONSTANT(int, guard_zero)

// A walk through the cells of one grid, in cell-texture coordinates.
struct Walk {
    vec3 org;       // r_g = a r_0 + b
    vec3 dir;       // k_g = a k
    vec3 voxel;     // lower corner of the current cell
    vec3 sign_dir;  // from this cell to the next, on each axis (D4: sign(k) * l)
    vec3 next_ts;   // t of the cell's exit plane on each axis
    vec3 delta_ts;  // t across one cell on each axis
    float t_start;  // the ray's part inside the cell: the paper's [vstart, vend]
    float t_end;
    float t_exit;   // where the ray leaves the grid, or ends
};

// D8: a component of 0 divides to infinity, and 0 / 0 to NaN when the origin lies in a cell plane.
vec3 guarded(vec3 dir) {
    float least = 1e-12 * largest(abs(dir));
    return vec3(abs(dir.x) < least ? least : dir.x, abs(dir.y) < least ? least : dir.y,
                abs(dir.z) < least ? least : dir.z);
}

// t of the exit planes of the current cell.
vec3 exit_ts(Walk walk) {
    vec3 planes = walk.voxel + step(vec3(0.0), walk.sign_dir) * cell_size();
    return (planes - walk.org) / walk.dir;
}

// D13: whether the walk is in a cell of its grid. It is not once t has drifted past the grid's
// border before the ray's exit, or when the ray's numbers are not finite.
bool in_grid(Walk walk, Grid grid) {
    vec3 centre = walk.voxel + 0.5 * cell_size();
    return centre.x > grid.lower.x && centre.y > grid.lower.y && centre.z > grid.lower.z &&
           centre.x < grid.upper.x && centre.y < grid.upper.y && centre.z < grid.upper.z;
}

// The current cell, counted from the grid's lower corner.
vec3 cell_number(Walk walk, Grid grid) { return (walk.voxel - grid.lower) / cell_size(); }

// Takes the part of the ray in [t_start, t_stop] to the cell where it enters the grid. A ray that
// misses the grid comes back with t_start > t_exit.
Walk begin_walk(Grid grid, vec3 org, vec3 dir, float t_start, float t_stop) {
    Walk walk;
    vec3 l = cell_size();
    walk.org = grid.a * org + grid.b;
    walk.dir = grid.a * dir;
    if (guard_zero == 1) walk.dir = guarded(walk.dir);

    // Clip to the grid's box.
    vec3 t_lower = (grid.lower - walk.org) / walk.dir;
    vec3 t_upper = (grid.upper - walk.org) / walk.dir;
    walk.t_start = greater(t_start, largest(lesser(t_lower, t_upper)));
    walk.t_exit = lesser(t_stop, smallest(greater(t_lower, t_upper)));

    // The cell of the entry point (D5: floor, not ceil; D14: never outside the box).
    vec3 entry = walk.org + walk.dir * walk.t_start;
    walk.voxel = lesser(greater(floor(entry / l) * l, grid.lower), grid.upper - l);

    walk.sign_dir = sign(walk.dir) * l;
    walk.delta_ts = l / abs(walk.dir);
    walk.next_ts = exit_ts(walk);
    walk.t_end = lesser(smallest(walk.next_ts), walk.t_exit);  // D6: clipped to the grid
    return walk;
}

bool missed(Walk walk, Grid grid) {
    return !(walk.t_start <= walk.t_exit && in_grid(walk, grid));
}

// D3: asked before stepping, or the last cell is lost.
bool finished(Walk walk) { return !(walk.t_end < walk.t_exit); }

// nextVoxel(): crosses the nearest plane, or all planes at the same t. False if there is no next
// cell.
bool next_voxel(Grid grid, INOUT(Walk) walk) {
    if (finished(walk)) return false;
    bool x = walk.next_ts.x <= walk.t_end;
    bool y = walk.next_ts.y <= walk.t_end && (step_ties == 1 || !x);
    bool z = walk.next_ts.z <= walk.t_end && (step_ties == 1 || !(x || y));
    walk.t_start = walk.t_end;
    walk.voxel += vec3(x ? walk.sign_dir.x : 0.0, y ? walk.sign_dir.y : 0.0,
                       z ? walk.sign_dir.z : 0.0);
    if (accumulate_ts == 1) {
        walk.next_ts += vec3(x ? walk.delta_ts.x : 0.0, y ? walk.delta_ts.y : 0.0,
                             z ? walk.delta_ts.z : 0.0);
    } else {
        walk.next_ts = exit_ts(walk);
    }
    walk.t_end = lesser(smallest(walk.next_ts), walk.t_exit);
    return in_grid(walk, grid);
}

// D7: a cell is fetched at its centre, not at its corner, where two texels meet.
CellList list_of_cell(Walk walk) {
    count_cell();
    return fetch_cell(walk.voxel + 0.5 * cell_size());
}
