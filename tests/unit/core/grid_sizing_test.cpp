// The resolution formula, the padding of a grid's box, and what both refuse.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/grid/sizing.h"

namespace onepass {
namespace {

Bounds box(const vec3& extent) { return {vec3(0.0f), extent}; }

std::string remedy_of(const GridSizing& sizing, uint64_t primitives = 100) {
    try {
        grid_resolution(box(vec3(1.0f)), primitives, sizing);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::input);
        return error.what();
    }
    return "no Error";
}

TEST(GridSizing, follows_the_formula_where_every_axis_has_a_cell) {
    // cbrt(5 * 1000 / 1) = 17.1
    EXPECT_EQ(grid_resolution(box(vec3(1.0f)), 1000, {.density = 5.0}), uvec3(17, 17, 17));
    // cbrt(4 * 1000 / 2) = 12.6 cells a unit
    EXPECT_EQ(grid_resolution(box(vec3(2, 1, 1)), 1000, {.density = 4.0}), uvec3(25, 13, 13));
    // cbrt(1.2 * 10 / 6) = 1.26 cells a unit
    EXPECT_EQ(grid_resolution(box(vec3(1, 2, 3)), 10, {.density = 1.2}), uvec3(1, 3, 4));
}

TEST(GridSizing, does_not_depend_on_the_unit_of_length) {
    for (const float scale : {1e-30f, 1e-3f, 1e6f, 1e30f}) {
        const Bounds b = box(vec3(1, 2, 3) * scale);
        EXPECT_EQ(grid_resolution(b, 5000, {.density = 3.0}),
                  grid_resolution(box(vec3(1, 2, 3)), 5000, {.density = 3.0}))
            << scale;
    }
}

TEST(GridSizing, keeps_the_density_of_a_flat_box) {
    const uvec3 n = grid_resolution(box(vec3(1.0f, 0x1p-19f, 1.0f)), 2000, {.density = 5.0});
    EXPECT_EQ(n, uvec3(100, 1, 100));  // sqrt(10,000)
}

TEST(GridSizing, keeps_the_density_of_a_thin_needle) {
    const uvec3 n = grid_resolution(box(vec3(1e-6f, 1e-6f, 1.0f)), 20, {.density = 5.0});
    EXPECT_EQ(n, uvec3(1, 1, 100));
}

TEST(GridSizing, gives_one_cell_when_there_is_less_than_one_to_share) {
    EXPECT_EQ(grid_resolution(box(vec3(1, 2, 3)), 1, {.density = 0.01}), uvec3(1));
}

TEST(GridSizing, clamps_every_axis) {
    EXPECT_EQ(
        grid_resolution(box(vec3(1.0f)), 1'000'000, {.density = 1000.0, .max_cells_per_axis = 64}),
        uvec3(64));
}

TEST(GridSizing, takes_an_explicit_resolution_as_it_is) {
    EXPECT_EQ(grid_resolution(box(vec3(1.0f)), 5, {.resolution = uvec3(3, 1, 7)}), uvec3(3, 1, 7));
}

TEST(GridSizing, refuses_an_explicit_resolution_outside_its_range) {
    EXPECT_NE(remedy_of({.resolution = uvec3(4, 0, 4)}).find("4 x 0 x 4"), std::string::npos);
    EXPECT_NE(remedy_of({.resolution = uvec3(4, 4, 1025)}).find("1 to 1024"), std::string::npos);
}

TEST(GridSizing, refuses_a_density_that_is_not_a_positive_number) {
    for (const double density : {0.0, -1.0, std::nan(""), double(kInfinity)}) {
        EXPECT_NE(remedy_of({.density = density}).find("grid density"), std::string::npos)
            << density;
    }
}

TEST(GridSizing, refuses_more_cells_than_the_limit_and_says_what_they_would_take) {
    const std::string by_resolution =
        remedy_of({.resolution = uvec3(2048), .max_cells_per_axis = 4096});
    EXPECT_NE(by_resolution.find("8589934592 cells (32.0 GiB"), std::string::npos) << by_resolution;
    EXPECT_NE(by_resolution.find("Lower the density"), std::string::npos) << by_resolution;

    const std::string by_density = remedy_of({.density = 1e30, .max_cells_per_axis = 0xFFFFFFFFu});
    EXPECT_NE(by_density.find("density 1e+30 for 100 primitives"), std::string::npos) << by_density;
}

TEST(GridSizing, refuses_a_clamp_of_zero) {
    EXPECT_NE(remedy_of({.max_cells_per_axis = 0}).find("max_cells_per_axis"), std::string::npos);
}

TEST(PaddedBounds, lie_strictly_outside_at_every_scale_and_place) {
    for (const float scale : {0.0f, 1e-45f, 1e-38f, 1.0f, 1e30f}) {
        for (const float offset : {0.0f, -1.0f, 1e6f, 1e37f}) {
            const Bounds b{vec3(offset), vec3(offset, offset + scale, offset + 2.0f * scale)};
            const Bounds padded = padded_bounds(b);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LT(padded.lower[axis], b.lower[axis]) << scale << " " << offset;
                EXPECT_GT(padded.upper[axis], b.upper[axis]) << scale << " " << offset;
            }
        }
    }
}

TEST(PaddedBounds, widen_by_a_millionth_of_the_largest_extent) {
    const Bounds padded = padded_bounds({vec3(0.0f), vec3(1, 0, 4)});
    EXPECT_EQ(padded.lower, vec3(-0x1p-18f));
    EXPECT_EQ(padded.upper, vec3(1, 0, 4) + vec3(0x1p-18f));
}

TEST(PaddedBounds, refuse_what_is_not_finite_or_would_not_be) {
    const float largest = std::numeric_limits<float>::max();
    EXPECT_THROW(padded_bounds({vec3(-largest), vec3(largest)}), Error);
    EXPECT_THROW(padded_bounds({vec3(0.0f), vec3(kInfinity)}), Error);
    EXPECT_THROW(padded_bounds({vec3(std::nanf("")), vec3(1.0f)}), Error);
    EXPECT_THROW(padded_bounds(Bounds{}), Error);
}

TEST(GridSizing, is_written_and_read_back) {
    EXPECT_EQ(parse_grid_sizing("4.5", "here"), GridSizing{.density = 4.5});
    EXPECT_EQ(parse_grid_sizing("64x32x1", "here").resolution, uvec3(64, 32, 1));
    for (const GridSizing& sizing : {GridSizing{.density = 0.1}, GridSizing{.density = 1e-30},
                                     GridSizing{.resolution = uvec3(1, 2, 3)}}) {
        EXPECT_EQ(parse_grid_sizing(to_text(sizing), "here"), sizing);
    }
    for (const char* text :
         {"", "0", "-1", "inf", "nan", "4,5", "4x5", "4x5x", "x4x5", "4x5x6x7"}) {
        EXPECT_THROW(parse_grid_sizing(text, "here"), Error) << text;
    }
}

}  // namespace
}  // namespace onepass
