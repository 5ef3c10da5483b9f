// What scenes/modelling.h promises of curves, normals and groups.
#include "scenes/modelling.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/meshes.h"

namespace onepass {
namespace {

const std::vector<vec2> kKeys{{0, 0}, {0.5f, 0}, {0.5f, 0.2f}, {0.01f, 1}, {0.8f, 1.1f}, {0, 1.2f}};

TEST(CurveThrough, has_the_count_asked_for_and_every_key) {
    for (size_t count : {kKeys.size(), size_t{7}, size_t{62}}) {
        const std::vector<vec2> curve = curve_through(kKeys, count);
        ASSERT_EQ(curve.size(), count);
        for (const vec2& key : kKeys) {
            EXPECT_NE(std::find(curve.begin(), curve.end(), key), curve.end());
        }
    }
}

TEST(CurveThrough, never_leaves_the_range_of_the_keys_around_it) {
    size_t piece = 0;
    for (const vec2& p : curve_through(kKeys, 200)) {
        if (piece + 2 < kKeys.size() && p == kKeys[piece + 1]) ++piece;
        const vec2 low = glm::min(kKeys[piece], kKeys[piece + 1]);
        const vec2 high = glm::max(kKeys[piece], kKeys[piece + 1]);
        EXPECT_TRUE(p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y)
            << p.x << ", " << p.y << " in piece " << piece;
    }
}

TEST(CurveThrough, spreads_points_by_length) {
    const vec2 keys[] = {{0, 0}, {1, 0}, {1, 3}};
    const std::vector<vec2> curve = curve_through(keys, 9);
    EXPECT_EQ(curve[2], keys[1]);  // 2 of 8 steps for a quarter of the length
}

TEST(SetNormals, keeps_a_box_sharp_and_its_triangles_in_order) {
    Object box = make_box(3, 2, 1);
    const Object before = box;
    set_normals(box, 30);
    ASSERT_EQ(box.triangles.size(), before.triangles.size());
    for (size_t i = 0; i < box.triangles.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(box.positions[box.triangles[i][k]], before.positions[before.triangles[i][k]]);
        }
        const uvec3& t = box.triangles[i];
        const vec3 face = glm::normalize(glm::cross(box.positions[t.y] - box.positions[t.x],
                                                    box.positions[t.z] - box.positions[t.x]));
        for (int k = 0; k < 3; ++k) EXPECT_EQ(box.normals[t[k]], face);
    }
    EXPECT_TRUE(test::is_closed(box));
}

TEST(SetNormals, makes_a_sphere_smooth_without_new_vertices) {
    Object sphere = make_sphere(40, 20);
    const size_t vertices = sphere.positions.size();
    set_normals(sphere, 30);
    EXPECT_EQ(sphere.positions.size(), vertices);
    // Faces about a vertex are not alike in size, so their mean leans by a part of their angle, 9
    // degrees: cos(4.5 degrees).
    constexpr float kLeastCosine = 0.9969f;
    for (size_t v = 0; v < sphere.positions.size(); ++v) {
        EXPECT_GT(glm::dot(sphere.normals[v], sphere.positions[v]), kLeastCosine);
    }
}

TEST(SetGroups, keeps_quads_whole_and_every_triangle) {
    Object grid = make_grid(4, 1);
    set_groups(grid, {"left", "right"}, [](const vec3& c) { return c.x < -0.36f ? 0u : 1u; });
    ASSERT_EQ(grid.groups.size(), 2u);
    EXPECT_EQ(grid.groups[0], (TriangleGroup{"left", 0, 2}));
    EXPECT_EQ(grid.groups[1], (TriangleGroup{"right", 2, 6}));
    Object fans = make_sphere(5, 3);  // an odd number of triangles before the first quad
    set_groups(fans, {"lower", "upper"}, [](const vec3& c) { return c.y < -0.1f ? 0u : 1u; });
    EXPECT_EQ(fans.groups[0].triangle_count, 5u);
    EXPECT_EQ(fans.groups[1].triangle_count, 15u);
    EXPECT_TRUE(test::is_closed(fans));
}

}  // namespace
}  // namespace onepass
