// Places in the cell and reference textures: the top level goes where objects are not, and where
// depends on sizes alone.
#include "gpu_glsl/pack/cell_atlas.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu_glsl/pack/reference_lists.h"

namespace onepass {
namespace {

constexpr uint32_t kLimit = 256;

UniformGrid empty_grid(uvec3 dims) {
    UniformGrid grid;
    grid.dims = dims;
    grid.cell_begin.assign(grid.cell_count() + 1, 0);
    return grid;
}

/// A grid of one row of cells, with lists of these lengths.
UniformGrid grid_with_lists(const std::vector<uint32_t>& lengths) {
    UniformGrid grid = empty_grid(uvec3(lengths.size(), 1, 1));
    for (size_t i = 0; i < lengths.size(); ++i) {
        grid.cell_begin[i + 1] = grid.cell_begin[i] + lengths[i];
    }
    grid.references.assign(grid.cell_begin.back(), 0);
    return grid;
}

bool overlap(uvec3 corner_a, uvec3 dims_a, uvec3 corner_b, uvec3 dims_b) {
    return glm::all(glm::lessThan(corner_a, corner_b + dims_b)) &&
           glm::all(glm::lessThan(corner_b, corner_a + dims_a));
}

TEST(CellAtlas, keeps_the_top_level_apart_from_the_objects_and_within_its_texture) {
    const std::vector<UniformGrid> objects = {
        empty_grid(uvec3(40, 33, 17)), empty_grid(uvec3(5, 5, 5)), empty_grid(uvec3(16, 16, 48))};
    const ObjectPlaces places = place_object_grids(objects, kLimit);
    for (const uvec3& dims : {uvec3(1), uvec3(17, 3, 60), uvec3(250, 1, 1), uvec3(1, 200, 20),
                              uvec3(64), uvec3(1, 1, 256)}) {
        const TopPlace top = place_top_grid(places, dims, kLimit);
        EXPECT_TRUE(glm::all(glm::lessThanEqual(top.corner + dims, top.size)));
        EXPECT_TRUE(glm::all(glm::lessThanEqual(places.size, top.size)));
        for (size_t k = 0; k < objects.size(); ++k) {
            EXPECT_FALSE(overlap(top.corner, dims, places.corners[k], objects[k].dims))
                << dims.x << " x " << dims.y << " x " << dims.z << ", object " << k;
        }
    }
}

TEST(CellAtlas, uses_what_the_objects_leave_before_it_grows) {
    const std::vector<UniformGrid> objects = {empty_grid(uvec3(48))};
    const ObjectPlaces places = place_object_grids(objects, kLimit);
    EXPECT_EQ(places.size, uvec3(64));
    EXPECT_EQ(place_top_grid(places, uvec3(16), kLimit).size, uvec3(64));
    EXPECT_EQ(place_top_grid(places, uvec3(20, 17, 17), kLimit).size, uvec3(128, 64, 64));
}

TEST(CellAtlas, goes_beside_the_objects_where_above_them_there_is_no_room) {
    const std::vector<UniformGrid> objects = {empty_grid(uvec3(64))};
    const ObjectPlaces places = place_object_grids(objects, kLimit);
    EXPECT_EQ(place_top_grid(places, uvec3(16, 16, 192), kLimit).size, uvec3(64, 64, 256));
    EXPECT_EQ(place_top_grid(places, uvec3(16, 16, 208), kLimit).size, uvec3(128, 64, 256));
}

TEST(CellAtlas, refuses_a_top_level_that_does_not_fit_beside_the_objects) {
    const std::vector<UniformGrid> objects = {empty_grid(uvec3(256, 256, 241))};
    const ObjectPlaces places = place_object_grids(objects, kLimit);
    EXPECT_THROW(place_top_grid(places, uvec3(1), kLimit), Error);
    EXPECT_THROW(place_object_grids(objects, 128), Error);
}

TEST(ReferenceLists, never_cross_a_row_and_the_top_level_begins_one) {
    const std::vector<UniformGrid> objects = {grid_with_lists({10, 5, 0, 9, 16})};
    const UniformGrid top = grid_with_lists({3, 14});
    const ListLayout layout = choose_list_layout(objects, top, 64, false, uvec2(0));
    ASSERT_EQ(layout.width, 16u);
    EXPECT_EQ(layout.objects[0][0], 0u);
    EXPECT_EQ(layout.objects[0][1], 10u);
    EXPECT_EQ(layout.objects[0][3], 16u);
    EXPECT_EQ(layout.objects[0][4], 32u);
    EXPECT_EQ(layout.first_top_row, 3u);
    EXPECT_EQ(layout.top, (ListPlaces{48, 64}));
    EXPECT_EQ(layout.rows, 5u);
}

TEST(ReferenceLists, leave_room_as_far_as_the_texture_may_reach) {
    const std::vector<UniformGrid> objects = {grid_with_lists({16, 16})};
    const UniformGrid top = grid_with_lists({16, 16, 16});
    EXPECT_EQ(choose_list_layout(objects, top, 64, true, uvec2(0)).rows, 2u + 2u * 3u);
    EXPECT_EQ(choose_list_layout(objects, top, 64, true, uvec2(16, 20)).rows, 20u);
    EXPECT_EQ(choose_list_layout(objects, top, 16, true, uvec2(16, 99)).rows, 16u);
    EXPECT_THROW(choose_list_layout(objects, top, 8, true, uvec2(0)), Error);
}

}  // namespace
}  // namespace onepass
