// The built grids: CSR invariants, the same bits for any thread count, both builders, both levels,
// and what they refuse. Which cells a triangle belongs to exactly is grid_binning_test's business.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "core/error.h"
#include "core/grid/cell_lists.h"
#include "core/grid/two_level_grid.h"

namespace onepass {
namespace {

/// Small triangles all over the unit cube and a few that cross it, of every shape.
Object random_object(uint32_t triangle_count, uint32_t seed = 1) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto point = [&] {
        const float x = unit(engine);
        const float y = unit(engine);
        return vec3(x, y, unit(engine));
    };
    Object object;
    object.name = "random";
    for (uint32_t i = 0; i < triangle_count; ++i) {
        const float size = i % 1000 == 0 ? 1.0f : 0.03f;
        const vec3 centre = point();
        for (int corner = 0; corner < 3; ++corner) {
            object.positions.push_back(centre + (point() - vec3(0.5f)) * size);
        }
        object.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    object.groups = {{"all", 0, triangle_count}};
    return object;
}

std::vector<Bounds> random_boxes(uint32_t count) {
    const Object object = random_object(count);
    std::vector<Bounds> boxes(count);
    for (uint32_t i = 0; i < count; ++i) {
        for (int corner = 0; corner < 3; ++corner) {
            boxes[i].extend(object.positions[object.triangles[i][corner]]);
        }
    }
    return boxes;
}

Scene random_scene() {
    Scene scene;
    scene.materials = {Material{}};
    for (uint32_t k = 0; k < 4; ++k) scene.objects.push_back(random_object(50 + 3000 * k, k));
    for (uint32_t i = 0; i < 30; ++i) {
        Instance instance;
        instance.object = i % 4;
        instance.materials = {0};
        instance.world_from_object =
            Affine(vec3(0.5f, 0.1f * float(i), 0), vec3(0, -1, 0.3f), vec3(0, 0, 2),
                   vec3(float(i % 5), float(i / 5), float(i % 7)));
        scene.instances.push_back(instance);
    }
    return scene;
}

void expect_valid_lists(const UniformGrid& grid, uint32_t primitive_count) {
    ASSERT_EQ(grid.cell_begin.size(), grid.cell_count() + 1);
    EXPECT_EQ(grid.cell_begin.front(), 0u);
    EXPECT_EQ(grid.cell_begin.back(), grid.references.size());
    EXPECT_TRUE(std::is_sorted(grid.cell_begin.begin(), grid.cell_begin.end()));

    size_t not_ascending = 0;
    std::vector<bool> seen(primitive_count, false);
    for (uint64_t cell = 0; cell < grid.cell_count(); ++cell) {
        for (uint32_t k = grid.cell_begin[cell]; k < grid.cell_begin[cell + 1]; ++k) {
            ASSERT_LT(grid.references[k], primitive_count);
            seen[grid.references[k]] = true;
            const bool first = k == grid.cell_begin[cell];
            not_ascending += !first && grid.references[k - 1] >= grid.references[k];
        }
    }
    EXPECT_EQ(not_ascending, 0u) << "references of a cell must ascend, each once";
    EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0) << "primitives in no cell";
}

bool has_reference(const UniformGrid& grid, const uvec3& cell, uint32_t primitive) {
    const std::span<const uint32_t> list = grid.cell_references(cell);
    return std::binary_search(list.begin(), list.end(), primitive);
}

/// The cell that holds a point, by the geometry a traversal uses.
uvec3 cell_of(const UniformGrid& grid, const dvec3& p) {
    return uvec3(glm::floor((p - dvec3(grid.bounds.lower)) / grid.cell_size()));
}

/// Runs f with up to `threads` threads, more than the machine has if need be.
template <class F>
auto with_threads(int threads, F&& f) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(threads);
    return arena.execute(f);
}

std::string error_of(const std::function<void()>& f) {
    try {
        f();
    } catch (const Error& error) {
        return error.what();
    }
    return "no Error";
}

TEST(TriangleGrid, has_ascending_lists_and_forgets_no_triangle) {
    for (const uint32_t count : {1u, 2u, 2047u, 2048u, 2049u, 30000u}) {
        const UniformGrid grid = build_triangle_grid(random_object(count), {});
        expect_valid_lists(grid, count);
    }
}

TEST(TriangleGrid, has_ascending_lists_at_any_resolution) {
    const Object object = random_object(5000);
    for (const uvec3& n : {uvec3(1), uvec3(1, 1, 1024), uvec3(1023, 3, 1), uvec3(70, 80, 90)}) {
        const UniformGrid grid = build_triangle_grid(object, {.resolution = n});
        EXPECT_EQ(grid.dims, n);
        expect_valid_lists(grid, 5000);
    }
}

TEST(TriangleGrid, has_the_same_bits_for_any_thread_count) {
    const Object object = random_object(60000);
    const auto build = [&] { return build_triangle_grid(object, {}); };
    const UniformGrid one = with_threads(1, build);
    for (const int threads : {2, 7}) {
        for (int repetition = 0; repetition < 5; ++repetition) {
            EXPECT_TRUE(with_threads(threads, build) == one) << threads << " threads";
        }
    }
}

TEST(TriangleGrid, references_every_triangle_from_the_cell_of_any_of_its_points) {
    const Object object = random_object(20000);
    const UniformGrid grid = build_triangle_grid(object, {.density = 20.0});
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    size_t lost = 0;
    for (uint32_t i = 0; i < object.triangles.size(); ++i) {
        for (int sample = 0; sample < 20; ++sample) {
            double u = unit(engine);
            double v = unit(engine);
            if (u + v > 1.0) {
                u = 1.0 - u;
                v = 1.0 - v;
            }
            const uvec3& t = object.triangles[i];
            const dvec3 p = (1.0 - u - v) * dvec3(object.positions[t.x]) +
                            u * dvec3(object.positions[t.y]) + v * dvec3(object.positions[t.z]);
            lost += !has_reference(grid, cell_of(grid, p), i);
        }
    }
    EXPECT_EQ(lost, 0u);
}

TEST(TriangleGrid, sizes_itself_by_density) {
    const Object object = random_object(10000);
    const UniformGrid grid = build_triangle_grid(object, {.density = 3.0});
    EXPECT_EQ(grid.bounds, padded_bounds(object_bounds(object)));
    EXPECT_EQ(grid.dims, grid_resolution(grid.bounds, 10000, {.density = 3.0}));
}

TEST(TriangleGrid, refuses_objects_it_cannot_bin_and_names_them) {
    Object nan = random_object(10);
    nan.name = "broken mesh";
    nan.positions[7].y = std::nanf("");
    EXPECT_NE(error_of([&] { build_triangle_grid(nan, {}); }).find("'broken mesh', vertex 7"),
              std::string::npos);

    Object empty;
    empty.name = "nothing";
    EXPECT_NE(error_of([&] { build_triangle_grid(empty, {}); }).find("'nothing'"),
              std::string::npos);
}

TEST(BoxGrid, references_a_box_from_exactly_the_widened_cells_it_overlaps) {
    const std::vector<Bounds> boxes = random_boxes(300);
    const UniformGrid grid = build_box_grid(boxes, {.density = 2.0});
    expect_valid_lists(grid, 300);

    const dvec3 size = grid.cell_size();
    size_t wrong = 0;
    for (uint32_t i = 0; i < boxes.size(); ++i) {
        for (uint32_t z = 0; z < grid.dims.z; ++z) {
            for (uint32_t y = 0; y < grid.dims.y; ++y) {
                for (uint32_t x = 0; x < grid.dims.x; ++x) {
                    bool overlaps = true;
                    const uvec3 cell(x, y, z);
                    for (int axis = 0; axis < 3; ++axis) {
                        const double lower = grid.bounds.lower[axis] + cell[axis] * size[axis];
                        const double pad = kBinningPad * size[axis];
                        overlaps &= boxes[i].upper[axis] >= lower - pad &&
                                    boxes[i].lower[axis] <= lower + size[axis] + pad;
                    }
                    wrong += overlaps != has_reference(grid, cell, i);
                }
            }
        }
    }
    EXPECT_EQ(wrong, 0u);
}

TEST(BoxGrid, takes_boxes_that_are_flat_or_points) {
    const std::vector<Bounds> boxes = {{vec3(0.0f), vec3(1, 0, 1)},
                                       {vec3(0.5f, 0, 0.5f), vec3(0.5f, 0, 0.5f)}};
    expect_valid_lists(build_box_grid(boxes, {.resolution = uvec3(4, 4, 4)}), 2);
    expect_valid_lists(build_box_grid(std::span(boxes).subspan(1), {}), 1);
}

TEST(BoxGrid, has_the_same_bits_for_any_thread_count) {
    const std::vector<Bounds> boxes = random_boxes(20000);
    const auto build = [&] { return build_box_grid(boxes, {.density = 1.2}); };
    const UniformGrid one = with_threads(1, build);
    EXPECT_TRUE(with_threads(2, build) == one);
    EXPECT_TRUE(with_threads(7, build) == one);
}

TEST(BoxGrid, refuses_empty_and_infinite_boxes_and_names_them) {
    std::vector<Bounds> boxes = random_boxes(5);
    const auto error_with = [&](const Bounds& bad) {
        boxes[3] = bad;
        return error_of([&] { build_box_grid(boxes, {}); });
    };
    EXPECT_NE(error_with(Bounds{}).find("box 3"), std::string::npos);
    EXPECT_NE(error_with({vec3(0, 2, 0), vec3(1)}).find("box 3"), std::string::npos);
    EXPECT_NE(error_with({vec3(0), vec3(1, kInfinity, 1)}).find("box 3"), std::string::npos);
    EXPECT_NE(error_with({vec3(std::nanf("")), vec3(1)}).find("box 3"), std::string::npos);
    EXPECT_THROW(build_box_grid({}, {}), Error);
}

TEST(CellLists, refuse_more_references_than_their_limit_and_say_the_remedy) {
    const auto ten_each = [](uint32_t, auto&& emit) { emit(0, 9); };
    EXPECT_EQ(list_by_cell(100, 10, ten_each, 1000).references.size(), 1000u);
    const std::string message = error_of([&] { list_by_cell(101, 10, ten_each, 1000); });
    EXPECT_NE(message.find("more than 1000 references from 101 primitives"), std::string::npos)
        << message;
    EXPECT_NE(message.find("Lower the density"), std::string::npos) << message;
}

TEST(CellLists, add_up_the_references_of_all_primitives_before_they_refuse) {
    const auto one_each = [](uint32_t, auto&& emit) { emit(0, 0); };
    EXPECT_EQ(list_by_cell(50'000, 1, one_each, 50'000).references.size(), 50'000u);
    EXPECT_THROW(list_by_cell(50'000, 1, one_each, 49'999), Error);
}

TEST(CellLists, notice_too_many_references_of_one_primitive_at_once) {
    size_t rows = 0;
    const auto endless_rows = [&](uint32_t, auto&& emit) {
        for (; rows < 20'000; ++rows) emit(0, 999);
    };
    EXPECT_THROW(list_by_cell(1, 1000, endless_rows, 1000), Error);
    EXPECT_LT(rows, 100u);
}

/// What is asked of lists: by cell, then by primitive; written plainly.
CellLists listed_plainly(uint32_t primitives, uint64_t cells,
                         const std::function<std::pair<uint64_t, uint64_t>(uint32_t)>& run_of) {
    std::vector<std::vector<uint32_t>> by_cell(cells);
    for (uint32_t i = 0; i < primitives; ++i) {
        const auto [first, last] = run_of(i);
        for (uint64_t cell = first; cell <= last; ++cell) by_cell[cell].push_back(i);
    }
    CellLists lists;
    lists.cell_begin.push_back(0);
    for (const std::vector<uint32_t>& list : by_cell) {
        lists.references.insert(lists.references.end(), list.begin(), list.end());
        lists.cell_begin.push_back(static_cast<uint32_t>(lists.references.size()));
    }
    return lists;
}

TEST(CellLists, hold_every_run_whatever_chunks_and_ranges_it_crosses) {
    // Numbers on both sides of where a chunk or a range ends, and runs across several ranges.
    for (const uint32_t primitives : {1u, 2048u, 2049u, 700'000u}) {
        for (const uint64_t cells :
             {uint64_t{1}, uint64_t{1024}, uint64_t{1025}, uint64_t{9000}, uint64_t{3'000'001}}) {
            const auto run_of = [&](uint32_t i) {
                const uint64_t first = (i * uint64_t{2'654'435'761}) % cells;
                const uint64_t length = i % 5000 == 0 ? 4000 : i % 3;
                return std::pair(first, std::min(first + length, cells - 1));
            };
            const CellLists lists = list_by_cell(primitives, cells, [&](uint32_t i, auto&& emit) {
                const auto [first, last] = run_of(i);
                emit(first, last);
            });
            const CellLists expected = listed_plainly(primitives, cells, run_of);
            EXPECT_TRUE(lists.cell_begin == expected.cell_begin) << primitives << ", " << cells;
            EXPECT_TRUE(lists.references == expected.references) << primitives << ", " << cells;
        }
    }
}

TEST(CellLists, fit_a_reference_into_a_word_at_any_size) {
    for (const uint32_t primitives : {1u, 1'000'000u, 100'000'000u, kNoId - 1}) {
        for (const uint64_t cells : {uint64_t{1}, uint64_t{1} << 24, kMaxCells - 1, kMaxCells}) {
            const SortCuts cuts(primitives, cells);
            for (const uint64_t cell : {uint64_t{0}, cells / 3, cells - 1}) {
                for (const uint64_t i :
                     {uint64_t{0}, primitives / uint64_t{3}, uint64_t{primitives} - 1}) {
                    const size_t range = cuts.range_of(cell);
                    ASSERT_LT(range, cuts.range_count());
                    size_t chunk = 0;
                    while (cuts.first_primitive(chunk + 1) <= i) ++chunk;
                    ASSERT_LT(chunk, cuts.chunk_count());
                    const uint32_t word = cuts.word(cell, i);
                    EXPECT_EQ(cuts.first_cell(range) + cuts.cell_in_range(word), cell);
                    EXPECT_EQ(cuts.first_primitive(chunk) + cuts.primitive_in_chunk(word), i);
                }
            }
        }
    }
}

TEST(TwoLevelGrid, holds_one_grid_an_object_and_one_over_the_instances) {
    const Scene scene = random_scene();
    const TwoLevelSizing sizing;
    const TwoLevelGrid grid = build_two_level_grid(scene, sizing);
    ASSERT_EQ(grid.objects.size(), scene.objects.size());
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        EXPECT_EQ(grid.objects[k], build_triangle_grid(scene.objects[k], sizing.object)) << k;
    }
    EXPECT_EQ(grid.top, build_box_grid(instance_bounds(scene), sizing.top));
    EXPECT_GT(grid.build_ms, 0.0);
}

TEST(TwoLevelGrid, gives_each_object_the_size_that_is_stated_for_it) {
    const Scene scene = random_scene();
    const TwoLevelSizing shared{.object = {.density = 3.0}};
    TwoLevelSizing own = shared;
    own.objects.assign(scene.objects.size(), {.density = 3.0});
    TwoLevelGrid same = build_two_level_grid(scene, own);
    const TwoLevelGrid expected = build_two_level_grid(scene, shared);
    EXPECT_EQ(same.objects, expected.objects) << "the same size for all is that size";
    EXPECT_EQ(same.top, expected.top);

    own.objects.back() = {.resolution = uvec3(5, 4, 3)};
    same = build_two_level_grid(scene, own);
    EXPECT_EQ(same.objects.back().dims, uvec3(5, 4, 3));
    for (size_t k = 0; k + 1 < scene.objects.size(); ++k) {
        EXPECT_EQ(same.objects[k], expected.objects[k]) << k;
    }
    own.objects.push_back({});
    EXPECT_THROW(build_two_level_grid(scene, own), Error);
}

TEST(TwoLevelGrid, counts_the_object_grids_it_builds) {
    const Scene scene = random_scene();
    const uint64_t before = triangle_grids_built();
    build_two_level_grid(scene, {});
    EXPECT_EQ(triangle_grids_built() - before, scene.objects.size());
    build_box_grid(instance_bounds(scene), {});
    EXPECT_EQ(triangle_grids_built() - before, scene.objects.size());
}

TEST(TwoLevelGrid, has_the_same_bits_for_any_thread_count) {
    const Scene scene = random_scene();
    const auto build = [&] { return build_two_level_grid(scene, {}); };
    const TwoLevelGrid one = with_threads(1, build);
    for (const int threads : {2, 7}) {
        const TwoLevelGrid many = with_threads(threads, build);
        EXPECT_EQ(many.top, one.top) << threads << " threads";
        EXPECT_EQ(many.objects, one.objects) << threads << " threads";
    }
}

}  // namespace
}  // namespace onepass
