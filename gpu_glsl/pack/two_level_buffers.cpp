#include "gpu_glsl/pack/two_level_buffers.h"

#include <algorithm>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

/// Grid 0 is the top level, grid 1 + k that of object k.
std::vector<const UniformGrid*> all_grids(const TwoLevelGrid& grid) {
    std::vector<const UniformGrid*> grids = {&grid.top};
    for (const UniformGrid& object : grid.objects) grids.push_back(&object);
    return grids;
}

/// The origin of a grid's frame, in the frame the grid was built in. On each axis: the lower bound,
/// if the numbers of the box are within a factor of 2 of each other, so that subtracting it is
/// exact (Sterbenz); else 0, and then no number of the box is larger than twice its extent.
dvec3 frame_origin(const UniformGrid& grid) {
    dvec3 origin(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = grid.bounds.lower[axis];
        const double upper = grid.bounds.upper[axis];
        const bool is_far =
            lower > 0.0 ? upper <= 2.0 * lower : upper < 0.0 && lower >= 2.0 * upper;
        if (is_far) origin[axis] = lower;
    }
    return origin;
}

/// Where each grid's share of a buffer begins, and at the end the whole length.
template <class Count>
std::vector<uint64_t> starts_of(const std::vector<const UniformGrid*>& grids, const Count& count) {
    std::vector<uint64_t> starts = {0};
    for (const UniformGrid* grid : grids) starts.push_back(starts.back() + count(*grid));
    return starts;
}

/// (first reference, number of them) of every cell of every grid.
TextureData pack_cells(const std::vector<const UniformGrid*>& grids,
                       const std::vector<uint64_t>& first_cell,
                       const std::vector<uint64_t>& first_reference, const TextureLimits& limits) {
    TextureData cells = make_word_buffer("cells", "cells", first_cell.back(), 2, limits);
    for (size_t g = 0; g < grids.size(); ++g) {
        const UniformGrid& grid = *grids[g];
        uint32_t* out = &cells.words[2 * first_cell[g]];
        const auto base = static_cast<uint32_t>(first_reference[g]);
        tbb::parallel_for(tbb::blocked_range<uint64_t>(0, grid.cell_count(), 1 << 14),
                          [&](const auto& range) {
                              for (uint64_t i = range.begin(); i != range.end(); ++i) {
                                  out[2 * i] = base + grid.cell_begin[i];
                                  out[2 * i + 1] = grid.cell_begin[i + 1] - grid.cell_begin[i];
                              }
                          });
    }
    return cells;
}

TextureData pack_references(const std::vector<const UniformGrid*>& grids,
                            const std::vector<uint64_t>& first_reference,
                            const TextureLimits& limits) {
    TextureData references =
        make_word_buffer("references", "references", first_reference.back(), 1, limits);
    for (size_t g = 0; g < grids.size(); ++g) {
        std::copy(grids[g]->references.begin(), grids[g]->references.end(),
                  references.words.begin() + static_cast<ptrdiff_t>(first_reference[g]));
    }
    return references;
}

/// Triangle corners in the frames of their grids: exact, see frame_origin().
TextureData pack_vertices(const Scene& scene, const TwoLevelGrid& grid,
                          const std::vector<uint64_t>& first_triangle,
                          const TextureLimits& limits) {
    TextureData vertices = make_float_buffer("vertices", "triangles",
                                             first_triangle.back() * kTriangleVertexTexels, limits);
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Object& object = scene.objects[k];
        const dvec3 origin = frame_origin(grid.objects[k]);
        float* const out = &vertices.texels[4 * kTriangleVertexTexels * first_triangle[k]];
        tbb::parallel_for(
            tbb::blocked_range<size_t>(0, object.triangles.size(), 1 << 12),
            [&](const auto& range) {
                for (size_t i = range.begin(); i != range.end(); ++i) {
                    for (int v = 0; v < kTriangleVertexTexels; ++v) {
                        const vec3 p(dvec3(object.positions[object.triangles[i][v]]) - origin);
                        float* texel =
                            out + 4 * (kTriangleVertexTexels * i + static_cast<size_t>(v));
                        for (int c = 0; c < 3; ++c) texel[c] = p[c];
                    }
                }
            });
    }
    return vertices;
}

void put(float* texel, const dvec3& v) {
    for (int c = 0; c < 3; ++c) texel[c] = static_cast<float>(v[c]);
}

TextureData pack_grid_frames(const std::vector<const UniformGrid*>& grids,
                             const TextureLimits& limits) {
    TextureData frames =
        make_float_buffer("grid_frames", "grids", grids.size() * kGridFrameTexels, limits);
    for (size_t g = 0; g < grids.size(); ++g) {
        const UniformGrid& grid = *grids[g];
        float* out = &frames.texels[4 * kGridFrameTexels * g];
        const dvec3 origin = frame_origin(grid);
        put(out, dvec3(grid.bounds.lower) - origin);
        put(out + 4, dvec3(grid.bounds.upper) - origin);
        put(out + 8, grid.cell_size());
        put(out + 12, 1.0 / grid.cell_size());
    }
    return frames;
}

TextureData pack_grid_numbers(const std::vector<const UniformGrid*>& grids,
                              const std::vector<uint64_t>& first_cell,
                              const std::vector<uint64_t>& first_triangle,
                              const TextureLimits& limits) {
    TextureData numbers =
        make_word_buffer("grid_numbers", "grids", grids.size() * kGridNumberTexels, 4, limits);
    for (size_t g = 0; g < grids.size(); ++g) {
        uint32_t* out = &numbers.words[4 * kGridNumberTexels * g];
        for (int axis = 0; axis < 3; ++axis) out[axis] = grids[g]->dims[axis];
        out[3] = static_cast<uint32_t>(first_cell[g]);
        if (g != kTopGrid) out[4] = static_cast<uint32_t>(first_triangle[g - 1]);
    }
    return numbers;
}

/// The rows of the map from the world to the object's grid, each number as the sum of two floats.
TextureData pack_instance_rows(const Scene& scene, const TwoLevelGrid& grid,
                               const TextureLimits& limits) {
    TextureData rows = make_float_buffer("instance_rows", "instances",
                                         scene.instances.size() * kInstanceRowTexels, limits);
    constexpr int kRows = 3;
    static_assert(kInstanceRowTexels == 2 * kRows);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        DAffine map = inverse(instance.world_from_object);
        map[3] -= frame_origin(grid.objects[instance.object]);
        float* out = &rows.texels[4 * kInstanceRowTexels * i];
        for (int row = 0; row < kRows; ++row) {
            for (int column = 0; column < 4; ++column) {
                const double value = map[column][row];
                const auto leading = static_cast<float>(value);
                out[4 * row + column] = leading;
                out[4 * (row + kRows) + column] = static_cast<float>(value - double{leading});
            }
        }
    }
    return rows;
}

TextureData pack_instance_grids(const Scene& scene, const TextureLimits& limits) {
    TextureData grids =
        make_word_buffer("instance_grids", "instances", scene.instances.size(), 1, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        grids.words[i] = scene.instances[i].object + 1;
    }
    return grids;
}

}  // namespace

TwoLevelBuffers pack_two_level_buffers(const Scene& scene, const TwoLevelGrid& grid,
                                       const TextureLimits& limits) {
    const std::vector<const UniformGrid*> grids = all_grids(grid);
    const std::vector<uint64_t> first_cell =
        starts_of(grids, [](const UniformGrid& g) { return g.cell_count(); });
    const std::vector<uint64_t> first_reference =
        starts_of(grids, [](const UniformGrid& g) { return uint64_t{g.references.size()}; });
    std::vector<uint64_t> first_triangle = {0};
    for (const Object& object : scene.objects) {
        first_triangle.push_back(first_triangle.back() + object.triangles.size());
    }

    TwoLevelBuffers packed;
    const auto add = [&](TextureData texture) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
        packed.inputs.textures.push_back(std::move(texture));
    };
    add(pack_cells(grids, first_cell, first_reference, limits));
    add(pack_references(grids, first_reference, limits));
    add(pack_vertices(scene, grid, first_triangle, limits));
    add(pack_grid_frames(grids, limits));
    add(pack_grid_numbers(grids, first_cell, first_triangle, limits));
    add(pack_instance_rows(scene, grid, limits));
    add(pack_instance_grids(scene, limits));
    packed.inputs.uniforms.push_back({"top_frame", vec3(frame_origin(grid.top))});
    packed.stats.push_back({"cells", static_cast<double>(first_cell.back()), "of all grids"});
    packed.stats.push_back(
        {"references", static_cast<double>(first_reference.back()), "of all grids"});
    packed.stats.push_back({"triangles", static_cast<double>(first_triangle.back()), "unique"});
    return packed;
}

}  // namespace onepass
