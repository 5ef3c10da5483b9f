#include "gpu_glsl/pack/block_allocator.h"

#include <algorithm>

#include "core/error.h"

namespace onepass {
namespace {

/// Calls f(block) for the blocks of a box until f returns false; tells whether it never did.
template <class F>
bool for_each_block(uvec3 corner, uvec3 box, F&& f) {
    for (uint32_t z = corner.z; z < corner.z + box.z; ++z) {
        for (uint32_t y = corner.y; y < corner.y + box.y; ++y) {
            for (uint32_t x = corner.x; x < corner.x + box.x; ++x) {
                if (!f(uvec3(x, y, z))) return false;
            }
        }
    }
    return true;
}

}  // namespace

BlockAllocator::BlockAllocator(uvec3 blocks)
    : blocks_(blocks), used_(size_t{blocks.x} * blocks.y * blocks.z, false) {}

std::optional<uvec3> BlockAllocator::find(uvec3 box) const {
    ONEPASS_CHECK(box.x > 0 && box.y > 0 && box.z > 0);
    if (box.x > blocks_.x || box.y > blocks_.y || box.z > blocks_.z) return std::nullopt;
    std::optional<uvec3> found;
    for_each_block(uvec3(0), blocks_ - box + uvec3(1), [&](uvec3 corner) {
        if (is_free(corner, box)) found = corner;
        return !found.has_value();
    });
    return found;
}

std::optional<uvec3> BlockAllocator::allocate(uvec3 box) {
    const std::optional<uvec3> found = find(box);
    if (found) mark(*found, box, true);
    return found;
}

void BlockAllocator::release(uvec3 corner, uvec3 box) { mark(corner, box, false); }

uint64_t BlockAllocator::used_blocks() const {
    return static_cast<uint64_t>(std::count(used_.begin(), used_.end(), true));
}

bool BlockAllocator::is_free(uvec3 corner, uvec3 box) const {
    return for_each_block(corner, box, [&](uvec3 block) { return !used_[index(block)]; });
}

void BlockAllocator::mark(uvec3 corner, uvec3 box, bool used) {
    for_each_block(corner, box, [&](uvec3 block) {
        ONEPASS_CHECK(used_[index(block)] != used);
        used_[index(block)] = used;
        return true;
    });
}

}  // namespace onepass
