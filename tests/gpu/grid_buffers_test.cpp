// The grid's buffers: the same words whether objects share them or not, and no more memory on the
// way than was promised.
#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "compare/peak_memory.h"
#include "core/grid/two_level_grid.h"
#include "gpu_glsl/pack/two_level_buffers.h"
#include "scenes/shapes.h"

namespace onepass::test {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

constexpr TextureLimits kLimits;

Scene scene_of(std::vector<Object> objects) {
    Scene scene;
    scene.objects = std::move(objects);
    scene.materials = {Material{}};
    for (uint32_t k = 0; k < scene.objects.size(); ++k) {
        scene.instances.push_back(Instance{.name = "one", .object = k, .materials = {0}});
    }
    return scene;
}

TwoLevelBuffers packed(const Scene& scene, double density) {
    return pack_two_level_buffers(scene,
                                  build_two_level_grid(scene, {.object = {.density = density}}),
                                  kLimits, BufferKind::texture, PlanesForm::floats);
}

TEST(GridBuffers, of_an_object_are_the_same_alone_and_behind_another) {
    const std::vector<Object> objects = {make_box(4, 3, 5), make_sphere(30, 20)};
    const TwoLevelBuffers first = packed(scene_of({objects[0]}), 16.0);
    const TwoLevelBuffers alone = packed(scene_of({objects[1]}), 16.0);
    const TwoLevelBuffers both = packed(scene_of(objects), 16.0);

    const auto words_behind = [&](const char* name) {
        const auto& words = both.inputs.texture(name).words;
        const size_t before = first.inputs.texture(name).words.size();
        return std::vector<uint32_t>(words.begin() + std::ptrdiff_t(before), words.end());
    };
    // Full cells begin behind the other's references; empty ones say the same.
    std::vector<uint32_t> cells(alone.inputs.texture("cells").words.begin(),
                                alone.inputs.texture("cells").words.end());
    const auto moved = static_cast<uint32_t>(first.object_references);
    size_t full = 0;
    for (uint32_t& cell : cells) {
        if ((cell & kEmptyCell) != 0) continue;
        cell += moved;
        ++full;
    }
    EXPECT_GT(full, 100u);
    EXPECT_EQ(words_behind("cells"), cells);
    // Behind the last list of all lies one word more.
    const auto& own_references = alone.inputs.texture("references").words;
    const auto& references = both.inputs.texture("references").words;
    ASSERT_EQ(references.size(), first.object_references + alone.object_references + 1);
    EXPECT_TRUE(std::equal(own_references.begin(), own_references.end(),
                           references.begin() + std::ptrdiff_t(first.object_references)));
    const auto& planes = both.inputs.texture("planes").words;
    const auto& own = alone.inputs.texture("planes").words;
    EXPECT_TRUE(std::equal(own.begin(), own.end(), planes.end() - std::ptrdiff_t(own.size())));
    // So do triangles behind the other's vertices.
    const auto& vertices = both.inputs.texture("vertices").texels;
    const auto& own_vertices = alone.inputs.texture("vertices").texels;
    EXPECT_TRUE(std::equal(own_vertices.begin(), own_vertices.end(),
                           vertices.end() - std::ptrdiff_t(own_vertices.size())));
    std::vector<uint32_t> corners(alone.inputs.texture("corners").words.begin(),
                                  alone.inputs.texture("corners").words.end());
    for (size_t i = 0; i < corners.size(); ++i) {
        const bool is_prim_id = i % 4 == 3;
        if (!is_prim_id) corners[i] += static_cast<uint32_t>(objects[0].positions.size());
    }
    EXPECT_EQ(words_behind("corners"), corners);
}

TEST(GridBuffers, hold_each_cells_list_and_its_end) {
    const Scene scene = scene_of({make_sphere(30, 20)});
    const TwoLevelGrid grid = build_two_level_grid(scene, {.object = {.density = 16.0}});
    const UniformGrid& object = grid.objects.front();
    const TwoLevelBuffers buffers =
        pack_two_level_buffers(scene, grid, kLimits, BufferKind::texture, PlanesForm::floats);
    const auto& cells = buffers.inputs.texture("cells").words;
    const auto& references = buffers.inputs.texture("references").words;
    const auto& corners = buffers.inputs.texture("corners").words;
    ASSERT_EQ(cells.size(), object.cell_count());
    for (uint64_t i = 0; i < cells.size(); ++i) {
        const uint32_t first = object.cell_begin[i];
        const uint32_t end = object.cell_begin[i + 1];
        ASSERT_EQ((cells[i] & kEmptyCell) != 0, first == end) << i;
        if (first == end) continue;
        ASSERT_EQ(cells[i], first);
        for (uint32_t k = first; k < end; ++k) {
            ASSERT_EQ((references[k] & kMoreReferences) != 0, k + 1 < end) << i;
            const size_t slot = references[k] & ~kMoreReferences;
            ASSERT_EQ(corners[4 * slot + 3], object.references[k]) << i;
        }
    }
}

TEST(GridBuffers, hold_every_triangle_once_with_its_own_corners) {
    const Scene scene = scene_of({make_box(4, 3, 5), make_sphere(30, 20)});
    const TwoLevelBuffers buffers = packed(scene, 16.0);
    const auto& corners = buffers.inputs.texture("corners").words;
    const auto& vertices = buffers.inputs.texture("vertices").texels;
    size_t slot = 0;
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Object& object = scene.objects[k];
        const GridFrame& frame = buffers.frames[k];
        std::vector<bool> is_met(object.triangles.size());
        for (size_t i = 0; i < object.triangles.size(); ++i, ++slot) {
            const uint32_t prim_id = corners[4 * slot + 3];
            ASSERT_LT(prim_id, object.triangles.size());
            ASSERT_FALSE(is_met[prim_id]);
            is_met[prim_id] = true;
            EXPECT_EQ(buffers.slots[k][prim_id], i);
            for (int v = 0; v < 3; ++v) {
                const float* const vertex = &vertices[4 * corners[4 * slot + size_t(v)]];
                const vec3& p = object.positions[object.triangles[prim_id][v]];
                for (int axis = 0; axis < 3; ++axis) {
                    const double expected = (double{p[axis]} - frame.origin[axis]) * frame.scale;
                    ASSERT_EQ(vertex[axis], expected);
                }
            }
        }
    }
    EXPECT_EQ(4 * slot, corners.size());
}

TEST(GridBuffers, hold_boxes_a_pad_wider_than_the_instances_exact_places) {
    Scene scene = scene_of({make_box(4, 3, 5), make_sphere(30, 20)});
    scene.instances[0].world_from_object =
        Affine({0.6f, 0.8f, 0}, {-0.8f, 0.6f, 0}, {0, 0, 1}, {1e4f, 0.1f, -3e4f});
    scene.instances[1].world_from_object =
        Affine({-1, 0, 0}, {0.5f, 1, 0}, {0, 0, 3}, {1e4f, 7, -3e4f});
    const TwoLevelGrid grid = build_two_level_grid(scene, {.top = {.resolution = uvec3(5, 6, 7)}});
    const dvec3 cell = grid.top.cell_size();
    const TwoLevelBuffers buffers =
        pack_two_level_buffers(scene, grid, kLimits, BufferKind::texture, PlanesForm::floats);
    const auto& texels = buffers.inputs.texture("instance_boxes").texels;
    ASSERT_EQ(texels.size(), 4 * kInstanceBoxTexels * scene.instances.size());
    const auto& uniforms = buffers.inputs.uniforms;
    const auto frame = std::ranges::find(uniforms, "top_frame", &UniformData::name);
    ASSERT_NE(frame, uniforms.end());
    const vec3 origin = std::get<vec3>(frame->value);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const DAffine m(instance.world_from_object);
        const float* const box = &texels[4 * kInstanceBoxTexels * i];
        for (int axis = 0; axis < 3; ++axis) {
            double least = kInfinity;
            double most = -kInfinity;
            for (const vec3& p : scene.objects[instance.object].positions) {
                const double at = transform_point(m, dvec3(p))[axis] - double{origin[axis]};
                least = std::min(least, at);
                most = std::max(most, at);
            }
            // (The box itself may be wider: it is that of the object's box, an ulp larger.)
            const double pad = cell[axis] / kListPadsACell;
            EXPECT_LT(box[axis], least - 0.99 * pad) << i;
            EXPECT_GT(box[4 + axis], most + 0.99 * pad) << i;
            EXPECT_GT(box[axis], least - pad - 0.5 * (most - least)) << i;
        }
    }
}

TEST(GridBuffers, take_at_their_peak_no_more_than_64_bytes_a_triangle_16_a_reference_8_a_cell) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer's memory counts too";
#endif
    if (!reset_peak_memory()) GTEST_SKIP() << "no peak of resident memory to be had";
    const tbb::global_control few(tbb::global_control::max_allowed_parallelism, 4);
    packed(scene_of({make_sphere(10, 10)}), 16.0);  // threads are there before
    const Object ball = make_sphere(600, 301);
    for (const size_t objects : {1, 3}) {
        const Scene scene = scene_of(std::vector<Object>(objects, ball));
        TwoLevelBuffers result;
        const auto build = [&] { result = packed(scene, 16.0); };
        const uint64_t peak = *peak_memory_of(build);
        EXPECT_LE(peak, 64 * objects * ball.triangles.size() + 16 * result.object_references +
                            8 * result.object_cells)
            << objects << " objects";
    }
}

}  // namespace
}  // namespace onepass::test
