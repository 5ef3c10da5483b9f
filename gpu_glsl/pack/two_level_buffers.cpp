#include "gpu_glsl/pack/two_level_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/empty_space.h"
#include "gpu_glsl/pack/barycentric_planes.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

/// Where each grid's share of a buffer begins, and at the end the whole length.
template <class Count>
std::vector<uint64_t> starts_of(const std::vector<UniformGrid>& grids, const Count& count) {
    std::vector<uint64_t> starts = {0};
    for (const UniformGrid& grid : grids) starts.push_back(starts.back() + count(grid));
    return starts;
}

/// What the shader decodes is what core/grid encodes.
constexpr bool same_empty_cube_edges() {
    for (size_t code = 0; code < kEmptyCubeEdges.size(); ++code) {
        const uint32_t edges = code < 4 ? kEmptyCubeEdges0 : kEmptyCubeEdges4;
        if (((edges >> (8 * (code % 4))) & 255u) != kEmptyCubeEdges[code]) return false;
    }
    return true;
}
static_assert(same_empty_cube_edges());

/// The words of a grid's cells (shared/grid_buffers_layout.h).
void put_cells(uint32_t* out, const UniformGrid& grid, uint64_t first_reference) {
    const auto base = static_cast<uint32_t>(first_reference);
    find_empty_cubes(grid, out);
    tbb::parallel_for(tbb::blocked_range<uint64_t>(0, grid.cell_count(), 1 << 14),
                      [&](const auto& range) {
                          for (uint64_t i = range.begin(); i != range.end(); ++i) {
                              const bool is_empty = grid.cell_begin[i] == grid.cell_begin[i + 1];
                              out[i] = is_empty ? kEmptyCell | out[i] : base + grid.cell_begin[i];
                          }
                      });
}

/// The words of a grid's references.
void put_references(uint32_t* out, const UniformGrid& grid) {
    tbb::parallel_for(
        tbb::blocked_range<uint64_t>(0, grid.cell_count(), 1 << 14), [&](const auto& range) {
            for (uint64_t i = range.begin(); i != range.end(); ++i) {
                const uint32_t end = grid.cell_begin[i + 1];
                for (uint32_t k = grid.cell_begin[i]; k < end; ++k) {
                    out[k] = grid.references[k] | (k + 1 == end ? 0 : kMoreReferences);
                }
            }
        });
}

void check_index_range(const char* what, uint64_t count) {
    if (count < kMoreReferences) return;
    throw Error({.where = "packing grids into buffers",
                 .got = fmt::format("{} {}", count, what),
                 .expected = fmt::format("fewer than {}: an index has 31 bits", kMoreReferences),
                 .remedy = "Lower --param density, or split the scene."});
}

TextureData pack_cells(const std::vector<UniformGrid>& grids,
                       const std::vector<uint64_t>& first_cell,
                       const std::vector<uint64_t>& first_reference, const TextureLimits& limits) {
    check_index_range("references", first_reference.back());
    TextureData cells = make_word_buffer("cells", "cells", first_cell.back(), 1, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        put_cells(&cells.words[first_cell[k]], grids[k], first_reference[k]);
    }
    return cells;
}

TextureData pack_references(const std::vector<UniformGrid>& grids,
                            const std::vector<uint64_t>& first_reference,
                            const TextureLimits& limits) {
    TextureData references =
        make_word_buffer("references", "references", first_reference.back(), 1, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        put_references(&references.words[first_reference[k]], grids[k]);
    }
    return references;
}

void put(float* texel, const dvec3& v) {
    for (int c = 0; c < 3; ++c) texel[c] = static_cast<float>(v[c]);
}

/// Triangle corners in the frames of their grids: exact.
TextureData pack_triangles(const Scene& scene, const TwoLevelGrid& grid,
                           const std::vector<uint64_t>& first_triangle,
                           const TextureLimits& limits) {
    check_index_range("triangles", first_triangle.back());
    TextureData triangles = make_float_buffer(
        "triangles", "triangles", first_triangle.back() * kTriangleVertexTexels, limits);
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Object& object = scene.objects[k];
        const GridFrame frame = object_frame(grid.objects[k].bounds);
        float* const out = &triangles.texels[4 * kTriangleVertexTexels * first_triangle[k]];
        tbb::parallel_for(tbb::blocked_range<size_t>(0, object.triangles.size(), 1 << 12),
                          [&](const auto& range) {
                              for (size_t i = range.begin(); i != range.end(); ++i) {
                                  const uvec3& corners = object.triangles[i];
                                  for (int v = 0; v < kTriangleVertexTexels; ++v) {
                                      const auto at = kTriangleVertexTexels * i + size_t(v);
                                      const dvec3 p(object.positions[corners[v]]);
                                      put(out + 4 * at, (p - frame.origin) * frame.scale);
                                  }
                              }
                          });
    }
    return triangles;
}

/// The planes of the same triangles, from the corners as stored.
TextureData pack_planes(const TextureData& triangles, const TextureLimits& limits) {
    const size_t count = triangles.texels.size() / (4 * kTriangleVertexTexels);
    TextureData planes = make_float_buffer("planes", "triangles", count * kPlanesTexels, limits);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1 << 12), [&](const auto& range) {
        for (size_t i = range.begin(); i != range.end(); ++i) {
            const auto corner = [&](size_t v) {
                const float* const p = &triangles.texels[4 * (kTriangleVertexTexels * i + v)];
                return dvec3(p[0], p[1], p[2]);
            };
            put_barycentric_planes(&planes.texels[4 * kPlanesTexels * i], corner(0), corner(1),
                                   corner(2));
        }
    });
    return planes;
}

TextureData pack_grid_frames(const std::vector<UniformGrid>& grids, const TextureLimits& limits) {
    TextureData frames =
        make_float_buffer("grid_frames", "grids", grids.size() * kGridFrameTexels, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        const UniformGrid& grid = grids[k];
        const GridFrame frame = object_frame(grid.bounds);
        const dvec3 cell = grid.cell_size() * frame.scale;
        float* const out = &frames.texels[4 * kGridFrameTexels * k];
        put(out, (dvec3(grid.bounds.lower) - frame.origin) * frame.scale);
        put(out + 4, (dvec3(grid.bounds.upper) - frame.origin) * frame.scale);
        put(out + 8, cell);
        put(out + 12, 1.0 / cell);
    }
    return frames;
}

TextureData pack_grid_numbers(const std::vector<UniformGrid>& grids,
                              const std::vector<uint64_t>& first_cell,
                              const std::vector<uint64_t>& first_triangle,
                              const TextureLimits& limits) {
    TextureData numbers =
        make_word_buffer("grid_numbers", "grids", grids.size() * kGridNumberTexels, 4, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        uint32_t* out = &numbers.words[4 * kGridNumberTexels * k];
        for (int axis = 0; axis < 3; ++axis) out[axis] = grids[k].dims[axis];
        out[3] = static_cast<uint32_t>(first_cell[k]);
        out[4] = static_cast<uint32_t>(first_triangle[k]);
    }
    return numbers;
}

TextureData pack_instance_rows(const Scene& scene, std::span<const Affine> world_from_object,
                               std::span<const GridFrame> frames, const TextureLimits& limits) {
    TextureData rows = make_float_buffer("instance_rows", "instances",
                                         world_from_object.size() * kInstanceRowTexels, limits);
    constexpr size_t kInstancesATask = 512;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, world_from_object.size(), kInstancesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              put_instance_rows(&rows.texels[4 * kInstanceRowTexels * i],
                                                world_from_object[i],
                                                frames[scene.instances[i].object]);
                          }
                      });
    return rows;
}

TextureData pack_instance_grids(const Scene& scene, const TextureLimits& limits) {
    TextureData grids =
        make_word_buffer("instance_grids", "instances", scene.instances.size(), 1, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        grids.words[i] = scene.instances[i].object;
    }
    return grids;
}

}  // namespace

std::vector<GridFrame> object_frames(const TwoLevelGrid& grid) {
    std::vector<GridFrame> frames;
    for (const UniformGrid& object : grid.objects) frames.push_back(object_frame(object.bounds));
    return frames;
}

ShaderInputs pack_top_buffers(const Scene& scene, std::span<const Affine> world_from_object,
                              const UniformGrid& top, std::span<const GridFrame> frames,
                              const TextureLimits& limits) {
    TextureData cells = make_word_buffer("top_cells", "cells", top.cell_count(), 1, limits);
    put_cells(cells.words.data(), top, 0);
    TextureData references =
        make_word_buffer("top_references", "references", top.references.size(), 1, limits);
    put_references(references.words.data(), top);

    ShaderInputs inputs;
    inputs.textures.push_back(std::move(cells));
    inputs.textures.push_back(std::move(references));
    inputs.textures.push_back(pack_instance_rows(scene, world_from_object, frames, limits));
    const dvec3 origin = frame_origin(top.bounds);
    inputs.uniforms = {{"top_frame", vec3(origin)},
                       {"top_lower", vec3(dvec3(top.bounds.lower) - origin)},
                       {"top_upper", vec3(dvec3(top.bounds.upper) - origin)},
                       {"top_cell", vec3(top.cell_size())},
                       {"top_cells_per_unit", vec3(1.0 / top.cell_size())},
                       {"top_dims", vec3(top.dims)}};
    return inputs;
}

TwoLevelBuffers pack_two_level_buffers(const Scene& scene, const TwoLevelGrid& grid,
                                       const TextureLimits& limits) {
    const std::vector<UniformGrid>& grids = grid.objects;
    const std::vector<uint64_t> first_cell =
        starts_of(grids, [](const UniformGrid& g) { return g.cell_count(); });
    const std::vector<uint64_t> first_reference =
        starts_of(grids, [](const UniformGrid& g) { return uint64_t{g.references.size()}; });
    std::vector<uint64_t> first_triangle = {0};
    for (const Object& object : scene.objects) {
        first_triangle.push_back(first_triangle.back() + object.triangles.size());
    }
    std::vector<Affine> world_from_object;
    for (const Instance& instance : scene.instances) {
        world_from_object.push_back(instance.world_from_object);
    }

    TwoLevelBuffers packed;
    const auto add = [&](TextureData texture) {
        packed.inputs.textures.push_back(std::move(texture));
    };
    add(pack_cells(grids, first_cell, first_reference, limits));
    add(pack_references(grids, first_reference, limits));
    add(pack_triangles(scene, grid, first_triangle, limits));
    add(pack_planes(packed.inputs.textures.back(), limits));
    add(pack_grid_frames(grids, limits));
    add(pack_grid_numbers(grids, first_cell, first_triangle, limits));
    add(pack_instance_grids(scene, limits));
    packed.inputs.append(
        pack_top_buffers(scene, world_from_object, grid.top, object_frames(grid), limits));
    for (const TextureData& texture : packed.inputs.textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    packed.object_cells = first_cell.back();
    packed.object_references = first_reference.back();
    packed.stats.push_back({"triangles", static_cast<double>(first_triangle.back()), "unique"});
    packed.stats.push_back({"cells",
                            static_cast<double>(packed.object_cells + grid.top.cell_count()),
                            "of all grids"});
    packed.stats.push_back(
        {"references", static_cast<double>(packed.object_references + grid.top.references.size()),
         "of all grids"});
    return packed;
}

}  // namespace onepass
