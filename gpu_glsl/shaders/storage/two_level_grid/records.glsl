// What every storage of the two-level grid hands out. The contract, beside these records:
//
//   ADDRESS                          the type of an address in the storage's tables
//   vec3 cell_size()                 a cell in grid coordinates (the paper's dl)
//   ADDRESS top_grid_address()
//   Grid fetch_grid(ADDRESS)
//   CellList fetch_cell(vec3)        by the centre of the cell, in grid coordinates
//   ADDRESS fetch_reference(ADDRESS), next_reference(ADDRESS)
//                                    the top level's lists, of instances
//   ADDRESS fetch_triangle_reference(ADDRESS), next_triangle_reference(ADDRESS)
//                                    the object grids' lists, of triangles
//   Instance fetch_instance(ADDRESS)
//   vec4 fetch_plane(ADDRESS, int k) texel k of a triangle, as shared/two_level_layout.h says
//   uint fetch_prim_id(ADDRESS, int first_triangle)
//                                    the triangle's number within its object
#pragma once
#include "lib/dialect.glsl"
#include "lib/ray.glsl"
#include "shared/two_level_layout.h"

// A grid is encoded by the map from its own frame to grid coordinates, r_g = a r + b, and by the
// box of these coordinates that it fills.
struct Grid {
    vec3 a;
    vec3 b;
    vec3 lower;
    vec3 upper;
    int step_budget;     // more steps than any ray can take through it
    int first_triangle;  // of the object, in the order of the triangle texture
};

struct CellList {
    ADDRESS address;  // of its first entry
    int count;
};

struct Instance {
    vec4 row0;  // of object_from_world
    vec4 row1;
    vec4 row2;
    ADDRESS grid;  // of its object
    uint inst_id;
};
