// Irregular grids: no triangle is lost in any cell that may be asked for it, however cells were
// divided, merged and expanded.
#include "core/irregular_grid/irregular_grid.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "core/error.h"
#include "core/irregular_grid/stages.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

/// A cloud of small triangles in a corner of a sparse one, with a few large ones through both.
Object uneven_object(uint32_t count) {
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    const auto point = [&] {
        const float x = unit(engine);
        const float y = unit(engine);
        return vec3(x, y, unit(engine));
    };
    Object object;
    object.name = "uneven";
    for (uint32_t i = 0; i < count; ++i) {
        const bool is_dense = i % 4 != 0;
        const float size = i % 400 == 0 ? 8.0f : (is_dense ? 0.02f : 0.3f);
        const vec3 centre = is_dense ? vec3(3.0f) + 0.3f * point() : 4.0f * point();
        for (int corner = 0; corner < 3; ++corner) {
            object.positions.push_back(centre + point() * size);
        }
        object.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    object.groups = {{"all", 0, count}};
    return object;
}

Object one_triangle(const vec3& a, const vec3& b, const vec3& c) {
    Object object;
    object.name = "one triangle";
    object.positions = {a, b, c};
    object.triangles = {{0, 1, 2}};
    object.groups = {{"all", 0, 1}};
    return object;
}

/// Points of a triangle, as places of the lattice.
class TrianglePoints {
  public:
    TrianglePoints(const Object& object, const IrregularGrid& grid)
        : object_(object), grid_(grid), engine_(3) {}

    /// In lattice cells, anywhere on the triangle; its corners and edges are not rare.
    dvec3 next(uint32_t triangle) {
        std::uniform_real_distribution<double> unit(-0.2, 1.2);
        const uvec3& t = object_.triangles[triangle];
        const double u = std::clamp(unit(engine_), 0.0, 1.0);
        const double v = std::clamp(unit(engine_), 0.0, 1.0 - u);
        const dvec3 p = (1.0 - u - v) * dvec3(object_.positions[t.x]) +
                        u * dvec3(object_.positions[t.y]) + v * dvec3(object_.positions[t.z]);
        return (p - dvec3(grid_.bounds.lower)) / grid_.edge;
    }

    /// The place that a walk which is off by up to `error` lattice cells may take it to be in.
    uvec3 next_place(uint32_t triangle, const dvec3& error) {
        std::uniform_int_distribution<int> side(-1, 1);
        const dvec3 off(side(engine_), side(engine_), side(engine_));
        const dvec3 p = glm::floor(next(triangle) + off * error);
        return uvec3(glm::clamp(p, dvec3(0.0), dvec3(grid_.dims()) - 1.0));
    }

  private:
    const Object& object_;
    const IrregularGrid& grid_;
    std::mt19937 engine_;
};

bool names(const IrregularGrid& grid, const IrregularCell& cell, uint32_t triangle) {
    return std::ranges::binary_search(grid.cell_references(cell), triangle);
}

bool holds(const IrregularCell& cell, const uvec3& place) {
    return glm::all(glm::lessThanEqual(cell.lower, place)) &&
           glm::all(glm::lessThanEqual(place, cell.last));
}

double volume(const IrregularCell& cell) {
    const dvec3 size = dvec3(cell.last - cell.lower) + 1.0;
    return size.x * size.y * size.z;
}

double sum_of_volumes(const IrregularGrid& grid) {
    double sum = 0.0;
    for (const IrregularCell& cell : grid.cells) sum += volume(cell);
    return sum;
}

TEST(IrregularGrid, names_a_triangle_in_every_cell_that_answers_for_a_place_near_it) {
    const Object object = uneven_object(4000);
    const IrregularGrid grid = build_irregular_grid(object, {});
    TrianglePoints points(object, grid);
    const dvec3 error = 0.99 * kLatticePad * dvec3(grid.dims());
    size_t lost = 0;
    size_t asked = 0;
    for (uint32_t i = 0; i < object.triangles.size(); ++i) {
        // Not only the cell that the nodes find: every cell whose box has been widened over it.
        const uvec3 place = points.next_place(i, error);
        for (const IrregularCell& cell : grid.cells) {
            if (!holds(cell, place)) continue;
            ++asked;
            lost += !names(grid, cell, i);
        }
    }
    EXPECT_EQ(lost, 0u);
    EXPECT_GT(asked, object.triangles.size()) << "no boxes overlap";
}

TEST(IrregularGrid, forgets_no_triangle_at_its_corners_and_edges) {
    for (const Object& object : {uneven_object(20000), make_ball_on_ground().objects.front(),
                                 make_big_small().objects.front()}) {
        const IrregularGrid grid = build_irregular_grid(object, {});
        TrianglePoints points(object, grid);
        const dvec3 error = 0.99 * kLatticePad * dvec3(grid.dims());
        size_t lost = 0;
        for (uint32_t i = 0; i < object.triangles.size(); ++i) {
            for (int k = 0; k < 6; ++k) {
                const uvec3 place = points.next_place(i, error);
                lost += !names(grid, grid.cells[grid.cell_at(place)], i);
            }
        }
        EXPECT_EQ(lost, 0u) << object.name;
    }
}

TEST(IrregularGrid, finds_for_every_place_a_cell_whose_box_holds_it) {
    const IrregularGrid grid = build_irregular_grid(uneven_object(4000), {});
    const uvec3 dims = grid.dims();
    std::mt19937 engine(9);
    size_t strayed = 0;
    for (int i = 0; i < 100'000; ++i) {
        const uvec3 place(engine() % dims.x, engine() % dims.y, engine() % dims.z);
        strayed += !holds(grid.cells[grid.cell_at(place)], place);
    }
    EXPECT_EQ(strayed, 0u);
}

TEST(IrregularGrid, has_lists_that_ascend_and_boxes_within_the_lattice) {
    const Object object = uneven_object(4000);
    const IrregularGrid grid = build_irregular_grid(object, {});
    for (const IrregularCell& cell : grid.cells) {
        const auto list = grid.cell_references(cell);
        ASSERT_TRUE(std::ranges::is_sorted(list, std::less_equal<>()));
        ASSERT_TRUE(list.empty() || list.back() < object.triangles.size());
        ASSERT_TRUE(glm::all(glm::lessThanEqual(cell.lower, cell.last)));
        ASSERT_TRUE(glm::all(glm::lessThan(cell.last, grid.dims())));
    }
}

TEST(IrregularGrid, is_a_partition_of_the_lattice_until_cells_are_expanded) {
    const Object object = uneven_object(4000);
    const IrregularGrid apart = build_irregular_grid(object, {.expansions = 0});
    const dvec3 dims(apart.dims());
    EXPECT_EQ(sum_of_volumes(apart), dims.x * dims.y * dims.z);

    const IrregularGrid grid = build_irregular_grid(object, {});
    ASSERT_EQ(grid.cells.size(), apart.cells.size());
    EXPECT_EQ(grid.references, apart.references);
    for (size_t i = 0; i < grid.cells.size(); ++i) {
        ASSERT_TRUE(holds(grid.cells[i], apart.cells[i].lower));
        ASSERT_TRUE(holds(grid.cells[i], apart.cells[i].last));
    }
    EXPECT_GT(sum_of_volumes(grid), 2.0 * sum_of_volumes(apart));
}

TEST(IrregularGrid, merges_cells_where_that_lowers_the_expected_cost_and_only_there) {
    const Object object = uneven_object(2000);
    IrregularGrid lattice = build_irregular_grid(object, {.expansions = 0});
    const IrregularGridSettings settings;
    std::vector<uint32_t> all(object.triangles.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    // The lattice as one top cell.
    lattice.top_dims = uvec3(1);
    lattice.depth = 16;
    const Subtree divided = divide_cube(object, lattice, settings, uvec3(0), 16, all);
    Subtree merged = divided;
    merge_cells(merged, settings.cell_cost);

    const auto cost_of = [&](const Subtree& tree) {
        double sum = 0.0;
        for (const IrregularCell& cell : tree.cells) {
            sum += expected_cost(cell.lower, cell.last, cell.count, settings.cell_cost);
        }
        return sum;
    };
    EXPECT_LT(merged.cells.size(), divided.cells.size() * 3 / 4);
    EXPECT_LT(cost_of(merged), cost_of(divided));
}

TEST(IrregularGrid, divides_where_triangles_are_small_and_nowhere_else) {
    const Object object = make_ball_on_ground().objects.front();
    const IrregularGrid grid = build_irregular_grid(object, {});
    size_t longest = 0;
    for (const IrregularCell& cell : grid.cells) longest = std::max<size_t>(longest, cell.count);
    // At its poles 264 triangles meet in one point; a uniform grid of as many cells has lists of
    // thousands.
    EXPECT_GE(longest, 264u);
    EXPECT_LT(longest, 300u);
    EXPECT_LT(grid.references.size(), 8 * object.triangles.size());
}

TEST(IrregularGrid, does_not_divide_for_triangles_that_no_division_parts) {
    Object object = one_triangle(vec3(0), vec3(1, 0, 0.1f), vec3(0, 1, 0.2f));
    object.triangles.assign(1000, object.triangles.front());
    object.groups = {{"all", 0, 1000}};
    const IrregularGrid grid = build_irregular_grid(object, {});
    EXPECT_LT(grid.references.size(), 100 * object.triangles.size());
    EXPECT_LT(grid.nodes.size(), 100 * object.triangles.size());
}

TEST(IrregularGrid, takes_objects_that_are_flat_or_points_or_far_away) {
    for (const float far : {0.0f, 1e6f}) {
        const vec3 at(far, -far, 0.0f);
        for (const Object& object :
             {one_triangle(at + vec3(0), at + vec3(4, 0, 0), at + vec3(0, 0, 2)),
              one_triangle(at + vec3(0), at + vec3(4, 0, 0), at + vec3(8, 0, 0)),
              one_triangle(at, at, at)}) {
            const IrregularGrid grid = build_irregular_grid(object, {});
            TrianglePoints points(object, grid);
            for (int k = 0; k < 20; ++k) {
                const uvec3 place = points.next_place(0, 0.99 * kLatticePad * dvec3(grid.dims()));
                EXPECT_TRUE(names(grid, grid.cells[grid.cell_at(place)], 0)) << far;
            }
        }
    }
}

TEST(IrregularGrid, names_no_triangle_that_equals_a_lower_one) {
    Object object = uneven_object(2000);
    const std::vector<uvec3> once = object.triangles;
    const IrregularGrid alone = build_irregular_grid(object, {.expansions = 0});
    for (const uvec3& corners : once) {
        object.triangles.push_back(uvec3(corners.z, corners.y, corners.x));
    }
    const IrregularGrid grid = build_irregular_grid(object, {.expansions = 0});
    EXPECT_GT(alone.references.size(), once.size());
    for (const uint32_t triangle : grid.references) ASSERT_LT(triangle, once.size());
}

TEST(IrregularGrid, lies_in_a_lattice_that_a_cells_words_can_name) {
    for (const double density : {1e-9, 0.12, 50.0}) {
        const IrregularGrid grid =
            build_irregular_grid(uneven_object(3000), {.top_density = density});
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(grid.dims()[axis], kLatticeMost) << density;
        const uvec3 dims = grid.dims();
        EXPECT_GT(std::max({dims.x, dims.y, dims.z}), kLatticeMost / 2) << density;
    }
}

TEST(IrregularGrid, has_the_same_bits_for_any_thread_count) {
    const Object object = uneven_object(30000);
    const auto build_with = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        tbb::task_arena arena(threads);
        return arena.execute([&] { return build_irregular_grid(object, {}); });
    };
    const IrregularGrid one = build_with(1);
    for (const int threads : {2, 7}) EXPECT_TRUE(build_with(threads) == one) << threads;
}

TEST(IrregularGrid, refuses_an_object_without_triangles_and_names_it) {
    Object empty;
    empty.name = "nothing";
    try {
        build_irregular_grid(empty, {});
        FAIL() << "an empty object was taken";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("'nothing'"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace onepass
