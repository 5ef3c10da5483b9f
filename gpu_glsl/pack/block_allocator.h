// Room for grids in the cell texture: blocks with a used flag each (paper, section 4).
#pragma once

#include <optional>
#include <vector>

#include "core/types.h"

namespace onepass {

/// Hands out boxes of contiguous blocks, first fit in x, then y, then z.
class BlockAllocator {
  public:
    /// `blocks`: how many there are along each axis.
    explicit BlockAllocator(uvec3 blocks);

    /// The lower corner of the first free box of `box` blocks; nothing if none is free.
    /// Cost: O(blocks * box) at worst.
    std::optional<uvec3> find(uvec3 box) const;

    /// The same box, now marked used.
    std::optional<uvec3> allocate(uvec3 box);

    /// Marks a box that allocate() gave free again.
    void release(uvec3 corner, uvec3 box);

    uint64_t used_blocks() const;

  private:
    size_t index(uvec3 block) const {
        return block.x + size_t{blocks_.x} * (block.y + size_t{blocks_.y} * block.z);
    }
    bool is_free(uvec3 corner, uvec3 box) const;
    void mark(uvec3 corner, uvec3 box, bool used);

    uvec3 blocks_;
    std::vector<bool> used_;
};

}  // namespace onepass
