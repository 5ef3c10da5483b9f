// The paper's structure: one grid over instances, and one grid an object over its triangles.
#pragma once

#include <vector>

#include "core/grid/uniform_grid.h"
#include "core/scene.h"

namespace onepass {

/// References of `top` are indices into Scene::instances, those of objects[k] into the triangles of
/// Scene::objects[k].
struct TwoLevelGrid {
    UniformGrid top;                     ///< world space
    std::vector<UniformGrid> objects;    ///< object space
    std::vector<Bounds> instance_boxes;  ///< those that `top` is over
    double build_ms = 0.0;               ///< wall time of the build
};

/// Cost: the sum of its grids. Throws: as build_box_grid, build_triangle_grid, check_object_count.
TwoLevelGrid build_two_level_grid(const Scene& scene, const TwoLevelSizing& sizing,
                                  Duplicates duplicates = Duplicates::kept);

}  // namespace onepass
