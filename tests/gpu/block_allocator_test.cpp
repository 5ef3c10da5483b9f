// The cell texture's blocks: boxes never overlap, and freed ones are used again.
#include "gpu_glsl/pack/block_allocator.h"

#include <gtest/gtest.h>

namespace onepass {
namespace {

TEST(BlockAllocator, hands_out_boxes_that_do_not_overlap_until_none_is_left) {
    BlockAllocator allocator(uvec3(4, 4, 4));
    EXPECT_EQ(allocator.allocate(uvec3(4, 4, 2)), uvec3(0, 0, 0));
    EXPECT_EQ(allocator.allocate(uvec3(2, 4, 2)), uvec3(0, 0, 2));
    EXPECT_EQ(allocator.allocate(uvec3(3, 1, 1)), std::nullopt);
    EXPECT_EQ(allocator.allocate(uvec3(2, 4, 2)), uvec3(2, 0, 2));
    EXPECT_EQ(allocator.allocate(uvec3(1)), std::nullopt);
    EXPECT_EQ(allocator.used_blocks(), 64u);
}

TEST(BlockAllocator, uses_a_released_box_again) {
    BlockAllocator allocator(uvec3(2, 2, 2));
    const auto corner = allocator.allocate(uvec3(2, 2, 2));
    ASSERT_TRUE(corner);
    EXPECT_EQ(allocator.allocate(uvec3(1)), std::nullopt);
    allocator.release(*corner, uvec3(2, 2, 2));
    EXPECT_EQ(allocator.allocate(uvec3(2, 1, 2)), uvec3(0));
}

TEST(BlockAllocator, refuses_a_box_larger_than_the_texture) {
    BlockAllocator allocator(uvec3(2, 2, 2));
    EXPECT_EQ(allocator.allocate(uvec3(3, 1, 1)), std::nullopt);
}

}  // namespace
}  // namespace onepass
