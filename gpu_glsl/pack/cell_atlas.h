// Where grids lie in the cell texture: the object grids side by side, then the top-level grid in
// what they leave.
//
// A grid's corner decides how a walk through it rounds. So the object grids' corners depend on the
// object grids alone, and the top level's on those and its own size, never on what lay there
// before: instances that moved to a place are hit with the same bits as instances that were packed
// there. The texture may be larger than needed; its sides are powers of two, which rounds nothing.
#pragma once

#include <span>
#include <vector>

#include "core/grid/uniform_grid.h"
#include "core/types.h"
#include "gpu_glsl/pack/block_allocator.h"

namespace onepass {

/// The object grids in the smallest texture that holds them.
struct ObjectPlaces {
    uvec3 size{0};               ///< of that texture, in cells: powers of two
    std::vector<uvec3> corners;  ///< in cells, one an object
    uvec3 used{0};               ///< blocks from the origin that hold all of them
    BlockAllocator blocks{uvec3(0)};
};

/// Places the object grids, the largest first, in a texture of at most `limit` cells a side that
/// doubles one side after the other. Throws: Error if they do not fit.
ObjectPlaces place_object_grids(std::span<const UniformGrid> objects, uint32_t limit);

struct TopPlace {
    uvec3 corner{0};  ///< in cells
    uvec3 size{0};    ///< of the smallest texture that holds it beside the objects
};

/// Places a top-level grid of `dims` cells: into free blocks of the objects' texture, or else
/// beside them, along the axis that makes the smallest texture. Depends on its arguments alone.
/// Throws: Error if it does not fit in `limit` cells a side.
TopPlace place_top_grid(const ObjectPlaces& objects, uvec3 dims, uint32_t limit);

/// How many of the cell texture's blocks a grid of `dims` cells takes.
uint64_t block_count(uvec3 dims);

}  // namespace onepass
