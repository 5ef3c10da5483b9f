#include "gpu_glsl/pack/two_level_variants.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/two_level_layout.h"

// ---- Reading the finished tables ---------------------------------------------------------------

/// The index of the texel that normalised coordinates lie in.
uint64_t texel_index(const TextureData& texture, const float* address) {
    const auto place = [](float coordinate, uint32_t side) {
        return static_cast<uint64_t>(coordinate * static_cast<float>(side));
    };
    return place(address[0], texture.size.x) +
           uint64_t{texture.size.x} * place(address[1], texture.size.y);
}

/// Writes the normalised coordinates of a texel's centre.
void set_address(float* address, const TextureData& texture, uint64_t texel) {
    const auto centre = [](uint64_t place, uint32_t side) {
        return (static_cast<float>(place) + 0.5f) / static_cast<float>(side);
    };
    address[0] = centre(texel % texture.size.x, texture.size.x);
    address[1] = centre(texel / texture.size.x, texture.size.y);
}

/// A cell's list that is not empty.
struct List {
    uint64_t cell = 0;   ///< texel of the cell texture
    uint64_t first = 0;  ///< texel of the reference texture
    uint32_t count = 0;
    uint32_t grid = 0;  ///< record of the grid texture; 0 is the top level
};

/// Grid records: the top level's and one an object.
uint32_t grid_count(const Scene& scene) { return static_cast<uint32_t>(1 + scene.objects.size()); }

/// The lists of grids [first_grid, last_grid), grid by grid, cell by cell.
std::vector<List> lists_of(const ShaderInputs& inputs, uint32_t first_grid, uint32_t last_grid) {
    const TextureData& cells = inputs.texture("cells");
    const TextureData& references = inputs.texture("references");
    const TextureData& grids = inputs.texture("grids");
    std::vector<List> lists;
    for (uint32_t g = first_grid; g < last_grid; ++g) {
        const uvec2 at = record_texel(grids, g, kGridTexels);
        const float* record = &grids.texels[4 * (at.x + size_t{grids.size.x} * at.y)];
        const uvec3 lower(vec3(record[8], record[9], record[10]) * vec3(cells.size));
        const uvec3 upper(vec3(record[12], record[13], record[14]) * vec3(cells.size));
        for (uint32_t z = lower.z; z < upper.z; ++z) {
            for (uint32_t y = lower.y; y < upper.y; ++y) {
                for (uint32_t x = lower.x; x < upper.x; ++x) {
                    const uint64_t cell =
                        x + uint64_t{cells.size.x} * (y + uint64_t{cells.size.y} * z);
                    const float* texel = &cells.texels[4 * cell];
                    if (texel[2] == 0.0f) continue;
                    lists.push_back(
                        {cell, texel_index(references, texel), static_cast<uint32_t>(texel[2]), g});
                }
            }
        }
    }
    return lists;
}

void set_stat(TwoLevelTextures& packed, const std::string& name, double value,
              const std::string& note) {
    for (Stat& stat : packed.stats) {
        if (stat.name == name) stat = {name, value, note};
    }
}

// ---- Copies ------------------------------------------------------------------------------------

/// Lays runs of `texels_each` texels an entry one after the other, none across a row: the texel
/// where each begins. Returns the rows it took.
uint64_t lay_runs(const std::vector<List>& lists, uint64_t width, uint64_t texels_each,
                  std::vector<uint64_t>& first) {
    first.clear();
    uint64_t row = 0;
    uint64_t column = 0;
    for (const List& list : lists) {
        const uint64_t texels = list.count * texels_each;
        if (column + texels > width) {
            ++row;
            column = 0;
        }
        first.push_back(column + width * row);
        column += texels;
    }
    return row + 1;
}

/// An empty texture for the copies, and the texel where each list's run begins.
TextureData make_copy_texture(const std::vector<List>& lists, uint32_t max_side,
                              std::vector<uint64_t>& first) {
    uint64_t copies = 0;
    uint64_t longest = 1;
    for (const List& list : lists) {
        copies += list.count;
        longest = std::max<uint64_t>(longest, list.count);
    }
    const auto side =
        static_cast<uint64_t>(std::sqrt(static_cast<double>(copies) * kTriangleTexels));
    for (uint64_t width = std::bit_ceil(std::max(longest * kTriangleTexels, side));
         width <= max_side; width *= 2) {
        const uint64_t rows = lay_runs(lists, width, kTriangleTexels, first);
        if (rows > max_side) continue;
        TextureData texture;
        texture.name = "triangles";
        texture.size = uvec3(width, rows, 1);
        texture.texels.assign(4 * width * rows, 0.0f);
        return texture;
    }
    throw Error(
        {"texture 'triangles'",
         fmt::format("{} copies of triangles, {} in the longest list", copies, longest),
         fmt::format("lists within rows of {0} texels, {1} a triangle, and at most {0} rows",
                     max_side, kTriangleTexels),
         "Lower --param density, or use storage texture2d, which shares triangles."});
}

// ---- Virtual arrays ----------------------------------------------------------------------------

/// Floats count exactly below this.
constexpr uint64_t kIndexLimit = uint64_t{1} << 24;

void check_indices(const TextureData& texture) {
    const uint64_t texels = uint64_t{texture.size.x} * texture.size.y * texture.size.z;
    if (texels <= kIndexLimit) return;
    throw Error({fmt::format("texture '{}'", texture.name), fmt::format("{} texels", texels),
                 fmt::format("at most {}, which a float index counts exactly", kIndexLimit),
                 "Lower --param density or atlas, or use storage texture2d."});
}

}  // namespace

TwoLevelTextures with_copied_triangles(const Scene& scene, TwoLevelTextures packed,
                                       const TextureLimits& limits) {
    ONEPASS_CHECK(packed.inputs.texture("references").format == ChannelFormat::single);
    TextureData& cells = packed.inputs.texture("cells");
    TextureData& references = packed.inputs.texture("references");
    TextureData& triangles = packed.inputs.texture("triangles");
    const TextureData& grids = packed.inputs.texture("grids");

    // Part the lists: the top level's stay, the others become runs of copies.
    const std::vector<List> top_lists = lists_of(packed.inputs, 0, 1);
    const std::vector<List> lists = lists_of(packed.inputs, 1, grid_count(scene));

    // Copy triangle by triangle, each with its number.
    std::vector<uint64_t> first;
    TextureData copies = make_copy_texture(lists, limits.max_2d, first);
    tbb::parallel_for(size_t{0}, lists.size(), [&](size_t i) {
        const List& list = lists[i];
        const uvec2 record = record_texel(grids, list.grid, kGridTexels);
        const auto first_triangle = static_cast<int64_t>(
            grids.texels[4 * (record.x + size_t{grids.size.x} * record.y) + 7]);
        float* out = &copies.texels[4 * first[i]];
        for (uint32_t k = 0; k < list.count; ++k) {
            const uint64_t from = texel_index(triangles, &references.texels[2 * (list.first + k)]);
            out = std::copy_n(&triangles.texels[4 * from], 4 * kTriangleTexels, out);
            out[-1] =
                static_cast<float>(static_cast<int64_t>(from / kTriangleTexels) - first_triangle);
        }
        set_address(&cells.texels[4 * list.cell], copies, first[i]);
    });

    // Keep the references that are still named.
    std::vector<uint64_t> kept;
    const uint64_t rows = lay_runs(top_lists, references.size.x, 1, kept);
    TextureData top_references{.name = "references",
                               .size = uvec3(references.size.x, rows, 1),
                               .channels = 2,
                               .texels = RawVector<float>(2 * references.size.x * rows, 0.0f)};
    for (size_t i = 0; i < top_lists.size(); ++i) {
        const List& list = top_lists[i];
        std::copy_n(&references.texels[2 * list.first], 2 * list.count,
                    &top_references.texels[2 * kept[i]]);
        set_address(&cells.texels[4 * list.cell], top_references, kept[i]);
    }
    references = std::move(top_references);

    const uint64_t shared_bytes = triangles.bytes();
    triangles = std::move(copies);
    set_stat(packed, "reference_bytes", static_cast<double>(references.bytes()), "top level only");
    set_stat(packed, "triangle_bytes", static_cast<double>(triangles.bytes()),
             fmt::format("a copy for each reference; shared they take {}", shared_bytes));
    return packed;
}

TwoLevelTextures with_virtual_arrays(const Scene& scene, TwoLevelTextures packed,
                                     const TextureLimits& limits) {
    ONEPASS_CHECK(packed.inputs.texture("references").format == ChannelFormat::single);
    TextureData& cells = packed.inputs.texture("cells");
    TextureData& references = packed.inputs.texture("references");
    TextureData& instances = packed.inputs.texture("instances");
    const TextureData& triangles = packed.inputs.texture("triangles");
    const TextureData& grids = packed.inputs.texture("grids");
    for (const TextureData& texture : packed.inputs.textures) check_indices(texture);
    const uint64_t cell_count = uint64_t{cells.size.x} * cells.size.y * cells.size.z;
    const uint64_t width =
        std::bit_ceil(static_cast<uint64_t>(std::ceil(std::sqrt(static_cast<double>(cell_count)))));
    if (width > limits.max_2d) {
        throw Error({"texture 'cells'", fmt::format("{} cells", cell_count),
                     fmt::format("at most {0} x {0} texels", limits.max_2d),
                     "Lower --param density or atlas, or use storage texture2d."});
    }

    // Cells and references: (list, count) and one index each. Both tables keep their order.
    TextureData cell_array{.name = "cells",
                           .size = uvec3(width, cell_count / width, 1),
                           .channels = 2,
                           .texels = RawVector<float>(2 * cell_count, 0.0f)};
    TextureData index_array{
        .name = "references",
        .size = references.size,
        .channels = 1,
        .texels = RawVector<float>(uint64_t{references.size.x} * references.size.y, 0.0f)};
    for (const List& list : lists_of(packed.inputs, 0, grid_count(scene))) {
        cell_array.texels[2 * list.cell] = static_cast<float>(list.first);
        cell_array.texels[2 * list.cell + 1] = static_cast<float>(list.count);
        const TextureData& target = list.grid == 0 ? instances : triangles;
        for (uint64_t k = list.first; k < list.first + list.count; ++k) {
            index_array.texels[k] =
                static_cast<float>(texel_index(target, &references.texels[2 * k]));
        }
    }

    // Instances: (grid, inst_id, 0, 0) after their rows.
    for (size_t record = 0; record < scene.instances.size(); ++record) {
        float* ids = texel_at(instances, record_texel(instances, record, kInstanceTexels)) + 12;
        ids[0] = static_cast<float>(texel_index(grids, ids));
        ids[1] = ids[2];
        ids[2] = 0.0f;
    }

    packed.inputs.uniforms.push_back({"cell_array", vec3(cells.size)});
    cells = std::move(cell_array);
    references = std::move(index_array);
    set_stat(packed, "cell_bytes", static_cast<double>(cells.bytes()), "a virtual array");
    set_stat(packed, "reference_bytes", static_cast<double>(references.bytes()), "indices");
    return packed;
}

}  // namespace onepass
