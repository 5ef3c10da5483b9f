// Moving instances: the top-level grid rebuilt, and what depends on it packed again.
//
// The object grids, their cells, lists and triangles stay where they are: a move works out new
// texels for boxes of the textures that are there (the top level's cells, lists and record, the
// instances), and who holds the textures, a GPU or a twin, writes them. Only when the top level
// outgrows its room are cells, lists and records packed anew, into larger textures, from object
// grids that were kept for this.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/affine.h"
#include "core/catalogue.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/two_level_buffers.h"
#include "gpu_glsl/pack/two_level_textures.h"

namespace onepass {

/// What a move changes. Nothing has changed yet: a plan that cannot be carried out is dropped.
struct TopLevelMove {
    InputChanges changes;
    std::vector<Stat> stats;                   ///< those that are different now
    std::vector<Stat> counts;                  ///< to be added to what was counted before
    std::unique_ptr<TwoLevelPlaces> repacked;  ///< if cells and lists were packed anew
};

/// The state between moves of one packed scene.
///
/// Memory: the object grids, 4 bytes a cell and 4 a reference; so only scenes with an animation
/// have one.
class MovingTopLevel {
  public:
    /// `grid` packed with `options` gave `places`.
    MovingTopLevel(ScenePtr scene, TwoLevelGrid grid, const GridSizing& top_sizing,
                   TwoLevelPlaces places, const TwoLevelTexturesOptions& options);

    /// Instances with these transforms are hit with the same bits, whether they moved there or the
    /// scene was packed with them. (With the paper's guard_zero=1 the shape of the cell texture
    /// has a say as well, and it may be larger here: rays along an axis can differ in last bits.)
    ///
    /// Cost:   O(instances + top-level cells and references); O(all cells and references) when the
    ///         top level outgrows its room, which then doubles.
    /// Throws: Error if there is not one transform an instance, if one cannot be inverted, or if
    ///         the moved scene exceeds the textures' limits.
    TopLevelMove plan(std::span<const Affine> world_from_object) const;

    /// Goes over to what was planned.
    void commit(TopLevelMove& move);

  private:
    ScenePtr scene_;
    std::vector<UniformGrid> object_grids_;
    std::vector<Bounds> object_boxes_;  ///< in object space
    GridSizing top_sizing_;
    TwoLevelPlaces places_;
    TwoLevelTexturesOptions options_;
    uint64_t object_cells_ = 0;  ///< of all object grids
    uint64_t object_references_ = 0;
    uint32_t longest_object_list_ = 0;
};

/// The same for a scene packed into buffers, where the top level has its own: they are made anew at
/// every move, and no room can be outgrown.
class MovingTopBuffers {
  public:
    MovingTopBuffers(ScenePtr scene, const GridSizing& top_sizing, const TwoLevelBuffers& packed,
                     const TextureLimits& limits);

    /// As MovingTopLevel::plan(). Cost: O(instances + top-level cells and references).
    TopLevelMove plan(std::span<const Affine> world_from_object) const;

  private:
    ScenePtr scene_;
    std::vector<Bounds> object_boxes_;  ///< in object space
    std::vector<GridFrame> frames_;     ///< of the objects' grids
    GridSizing top_sizing_;
    TextureLimits limits_;
    uint64_t object_cells_ = 0;
    uint64_t object_references_ = 0;
};

}  // namespace onepass
