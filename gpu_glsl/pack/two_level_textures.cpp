#include "gpu_glsl/pack/two_level_textures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "gpu_glsl/pack/reference_lists.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/two_level_layout.h"

/// (k + 0.5) / W is exact in a half for W a power of two up to here, and lies in the right texel
/// for any W up to here: halves in [0.5, 1) are 2^-11 apart, so W times the error is at most 1/4.
constexpr uint32_t kHalfAddressLimit = 1024;

/// A list's length is stored beside its address; halves count exactly up to here.
constexpr uint32_t kHalfCountLimit = 2048;

float round_to_half(float value) { return glm::unpackHalf1x16(glm::packHalf1x16(value)); }

/// The normalised coordinates of texel centres, tabulated: packing asks for each of them many
/// times, and rounding to half is slow.
class AddressTable {
  public:
    AddressTable(uvec3 texture_size, AddressWidth width)
        : x_(centres(texture_size.x, width)), y_(centres(texture_size.y, width)) {}

    vec2 operator()(uvec2 texel) const { return vec2(x_[texel.x], y_[texel.y]); }

  private:
    static std::vector<float> centres(uint32_t side, AddressWidth width) {
        std::vector<float> table(side);
        for (uint32_t k = 0; k < side; ++k) {
            const float centre = (static_cast<float>(k) + 0.5f) / static_cast<float>(side);
            table[k] = width == AddressWidth::half ? round_to_half(centre) : centre;
        }
        return table;
    }

    std::vector<float> x_;
    std::vector<float> y_;
};

// ---- Grid and instance records -----------------------------------------------------------------

/// A number as the float that carries it: exact below 2^24.
float exact_float(uint64_t value, const char* what) {
    constexpr uint64_t kExactBelow = 1u << 24;
    if (value >= kExactBelow) {
        throw Error({"packing for the shader", fmt::format("{} {}", what, value),
                     fmt::format("less than {}, which a float texel holds exactly", kExactBelow),
                     "Use a smaller scene or a lower --param density."});
    }
    return static_cast<float>(value);
}

/// r_g = a r + b, with a = N / L in texels (D1), and the grid's box of texture coordinates.
/// `turns`: of the loop that walks it, at most, in one cell.
void pack_grid(float* out, const UniformGrid& grid, uvec3 corner, uvec3 atlas_size, uint64_t turns,
               uint64_t first_triangle) {
    const dvec3 texel = 1.0 / dvec3(atlas_size);
    const dvec3 lower = dvec3(corner) * texel;
    const dvec3 upper = dvec3(corner + grid.dims) * texel;
    const dvec3 a = texel / grid.cell_size();
    const dvec3 b = lower - dvec3(grid.bounds.lower) * a;
    // A walk crosses at most dims.x + dims.y + dims.z planes.
    const uint64_t walk_steps = uint64_t{grid.dims.x} + grid.dims.y + grid.dims.z + 3;
    const float step_budget = exact_float(walk_steps * turns, "a step budget of");
    for (const glm::dvec4& row :
         {glm::dvec4(a, step_budget), glm::dvec4(b, exact_float(first_triangle, "triangle number")),
          glm::dvec4(lower, 0.0), glm::dvec4(upper, 0.0)}) {
        for (int c = 0; c < 4; ++c) *out++ = static_cast<float>(row[c]);
    }
}

void pack_object_record(float* out, const UniformGrid& grid, uvec3 corner, uvec3 atlas_size,
                        uint64_t first_triangle) {
    pack_grid(out, grid, corner, atlas_size, 1, first_triangle);
}

/// The top loop also takes a turn for each reference on its way.
void pack_top_record(float* out, const UniformGrid& grid, uvec3 corner, uvec3 atlas_size) {
    pack_grid(out, grid, corner, atlas_size, 1 + uint64_t{longest_list(grid)}, 0);
}

// ---- Cells and lists of one grid ---------------------------------------------------------------

/// A texture of cells, or a box of one, and where a grid lies in it.
struct CellTarget {
    float* texels;
    uvec3 size;
    uvec3 corner;
};

/// The reference texture, or its rows from `first_row` on.
struct ListTarget {
    float* texels;
    uint32_t width;
    uint32_t first_row;
};

/// Writes the cells that are not empty, and their lists. `target_address(primitive)`: what a
/// reference holds.
template <class TargetAddress>
void write_grid(const UniformGrid& grid, const ListPlaces& places, const AddressTable& list_address,
                const TargetAddress& target_address, const CellTarget& cells,
                const ListTarget& lists) {
    const auto write_row = [&](uint32_t y, uint32_t z) {
        uint64_t cell = uint64_t{grid.dims.x} * (y + uint64_t{grid.dims.y} * z);
        const uvec3 at = cells.corner + uvec3(0, y, z);
        float* out =
            cells.texels + 4 * (at.x + size_t{cells.size.x} * (at.y + size_t{cells.size.y} * at.z));
        for (uint32_t x = 0; x < grid.dims.x; ++x, ++cell, out += 4) {
            const uint32_t begin = grid.cell_begin[cell];
            const uint32_t end = grid.cell_begin[cell + 1];
            if (begin == end) continue;
            const uvec2 texel(places[cell] % lists.width, places[cell] / lists.width);
            const vec2 address = list_address(texel);
            out[0] = address.x;
            out[1] = address.y;
            out[2] = static_cast<float>(end - begin);

            float* reference =
                lists.texels + 2 * (texel.x + size_t{lists.width} * (texel.y - lists.first_row));
            for (uint32_t i = begin; i < end; ++i) {
                const vec2 to = target_address(grid.references[i]);
                *reference++ = to.x;
                *reference++ = to.y;
            }
        }
    };
    // Rows of cells, enough of them a task to be worth one.
    constexpr uint32_t kCellsATask = 4096;
    const size_t rows = size_t{grid.dims.y} * grid.dims.z;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, rows, 1 + kCellsATask / grid.dims.x),
                      [&](const auto& range) {
                          for (size_t row = range.begin(); row != range.end(); ++row) {
                              write_row(static_cast<uint32_t>(row % grid.dims.y),
                                        static_cast<uint32_t>(row / grid.dims.y));
                          }
                      });
}

/// The top level's references point to instances.
void write_top(const UniformGrid& top, const ListPlaces& lists, const TwoLevelPlaces& places,
               const CellTarget& cells, const ListTarget& references) {
    const AddressTable list_address(places.references, places.address);
    const AddressTable instance_address(places.instances, places.address);
    write_grid(
        top, lists, list_address,
        [&](uint32_t instance) {
            return instance_address(record_texel(places.instances, instance, kInstanceTexels));
        },
        cells, references);
}

// ---- All grids of a scene ----------------------------------------------------------------------

uint32_t longest_of_all(std::span<const UniformGrid> objects, const UniformGrid& top) {
    uint32_t longest = longest_list(top);
    for (const UniformGrid& grid : objects) longest = std::max(longest, longest_list(grid));
    return longest;
}

uint32_t max_side(AddressWidth address, const TextureLimits& limits) {
    return address == AddressWidth::half ? std::min(kHalfAddressLimit, limits.max_2d)
                                         : limits.max_2d;
}

/// Half addresses where they reach: decided before anything large is made.
AddressWidth choose_address_width(const Scene& scene, std::span<const UniformGrid> objects,
                                  const UniformGrid& top) {
    const uint64_t texels = first_triangles(scene).back() * kTriangleTexels;
    uint64_t references = top.references.size();
    for (const UniformGrid& grid : objects) references += grid.references.size();
    const uint32_t longest = longest_of_all(objects, top);
    // Rows waste less than a longest list each, and the top level begins a row.
    constexpr uint64_t kHalfTexels = uint64_t{kHalfAddressLimit} * kHalfAddressLimit;
    const bool half_fits =
        texels <= kHalfTexels && longest < kHalfAddressLimit &&
        references + uint64_t{kHalfAddressLimit} * (longest + 1) <= kHalfTexels &&
        scene.instances.size() * kInstanceTexels <= kHalfTexels;
    return half_fits ? AddressWidth::half : AddressWidth::single;
}

/// Packs with one address width. Throws: Error if that width cannot address the scene.
GridTextures pack_grids_with_width(const Scene& scene, std::span<const UniformGrid> objects,
                                   const UniformGrid& top, AddressWidth width,
                                   const TwoLevelTexturesOptions& options,
                                   const TwoLevelPlaces& least) {
    const bool half = width == AddressWidth::half;
    const uint32_t side = max_side(width, options.limits);
    const ChannelFormat address_format = half ? ChannelFormat::half : ChannelFormat::single;
    const uint32_t longest = longest_of_all(objects, top);
    if (half && longest > kHalfCountLimit) {
        throw Error(
            {"texture 'cells'", fmt::format("a list of {} references", longest),
             fmt::format("at most {}, which a 16-bit float counts exactly", kHalfCountLimit),
             "Use --param address=float."});
    }

    // Where everything lies.
    const std::vector<uint64_t> first_triangle = first_triangles(scene);
    const uint32_t cell_limit = std::min(options.cell_texture_limit, options.limits.max_3d);
    TwoLevelPlaces places;
    places.address = width;
    places.triangles =
        record_texture_size("triangles", "triangles", first_triangle.back(), kTriangleTexels, side);
    places.instances = record_texture_size("instances", "instances", scene.instances.size(),
                                           kInstanceTexels, side);
    places.grids = record_texture_size("grids", "grids", 1 + objects.size(), kGridTexels, side);
    places.objects = place_object_grids(objects, cell_limit);
    const TopPlace top_place = place_top_grid(places.objects, top.dims, cell_limit);
    places.cells = glm::max(top_place.size, least.cells);
    const ListLayout lists =
        choose_list_layout(objects, top, side, options.moving, uvec2(least.references));
    places.first_top_row = lists.first_top_row;
    places.references = uvec3(lists.width, lists.rows, 1);

    // Cells and their lists.
    TextureData cells{.name = "cells",
                      .dimensions = 3,
                      .size = places.cells,
                      .format = address_format,
                      .texels = RawVector<float>(
                          size_t{4} * places.cells.x * places.cells.y * places.cells.z, 0.0f)};
    TextureData references{.name = "references",
                           .size = places.references,
                           .channels = 2,
                           .format = address_format,
                           .texels = RawVector<float>(size_t{2} * lists.width * lists.rows, 0.0f)};
    const ListTarget all_rows{references.texels.data(), lists.width, 0};
    const AddressTable list_address(places.references, width);
    const AddressTable triangle_address(places.triangles, width);
    for (size_t k = 0; k < objects.size(); ++k) {
        write_grid(
            objects[k], lists.objects[k], list_address,
            [&, first = first_triangle[k]](uint32_t triangle) {
                return triangle_address(
                    record_texel(places.triangles, first + triangle, kTriangleTexels));
            },
            {cells.texels.data(), places.cells, places.objects.corners[k]}, all_rows);
    }
    write_top(top, lists.top, places, {cells.texels.data(), places.cells, top_place.corner},
              all_rows);

    // Grid records: the top level's first, that of object k after it.
    TextureData records = zero_texture("grids", places.grids);
    const auto record = [&](size_t index) {
        return texel_at(records, record_texel(records, index, kGridTexels));
    };
    pack_top_record(record(0), top, top_place.corner, places.cells);
    for (size_t k = 0; k < objects.size(); ++k) {
        pack_object_record(record(1 + k), objects[k], places.objects.corners[k], places.cells,
                           first_triangle[k]);
    }

    GridTextures packed;
    packed.stats = {
        {"cell_bytes", static_cast<double>(cells.bytes()),
         fmt::format("texture of {} x {} x {} cells, {} blocks used", places.cells.x,
                     places.cells.y, places.cells.z,
                     places.objects.blocks.used_blocks() + block_count(top.dims))},
        {"reference_bytes", static_cast<double>(references.bytes()),
         fmt::format("{} rows of {}", lists.rows, lists.width)},
        {"address_bits", half ? 16.0 : 32.0, "width of a texture address"},
    };
    packed.places = std::move(places);
    for (TextureData* texture : {&cells, &references, &records}) {
        packed.textures.push_back(std::move(*texture));
    }
    return packed;
}

}  // namespace

GridTextures pack_grids(const Scene& scene, std::span<const UniformGrid> objects,
                        const UniformGrid& top, const TwoLevelTexturesOptions& options,
                        const TwoLevelPlaces& least) {
    const AddressWidth width = options.address == AddressWidth::automatic
                                   ? choose_address_width(scene, objects, top)
                                   : options.address;
    return pack_grids_with_width(scene, objects, top, width, options, least);
}

std::optional<std::deque<TexelBox>> pack_top_grid(const UniformGrid& top,
                                                  const TwoLevelPlaces& places,
                                                  const TwoLevelTexturesOptions& options) {
    // Does it fit?
    const TopPlace place = place_top_grid(
        places.objects, top.dims, std::min(options.cell_texture_limit, options.limits.max_3d));
    if (glm::any(glm::greaterThan(place.size, places.cells))) return std::nullopt;
    const uint32_t width = places.references.x;
    if (longest_list(top) > width) return std::nullopt;
    ListRows rows(width, places.first_top_row);
    const ListPlaces lists = rows.lay(top);
    if (rows.end_row() > places.references.y) return std::nullopt;

    // All its cells, the empty ones too: others lay here before.
    TexelBox cells{.texture = "cells",
                   .corner = place.corner,
                   .size = top.dims,
                   .texels = RawVector<float>(4 * top.cell_count(), 0.0f)};
    const auto row_count = static_cast<uint32_t>(rows.end_row() - places.first_top_row);
    TexelBox references{.texture = "references",
                        .corner = uvec3(0, places.first_top_row, 0),
                        .size = uvec3(width, row_count, 1),
                        .texels = RawVector<float>(size_t{2} * width * row_count, 0.0f)};
    write_top(top, lists, places, {cells.texels.data(), top.dims, uvec3(0)},
              {references.texels.data(), width, places.first_top_row});
    TexelBox record{.texture = "grids",
                    .size = uvec3(kGridTexels, 1, 1),
                    .texels = RawVector<float>(4 * kGridTexels, 0.0f)};
    pack_top_record(record.texels.data(), top, place.corner, places.cells);

    std::deque<TexelBox> boxes;
    for (TexelBox* box : {&cells, &references, &record}) boxes.push_back(std::move(*box));
    return boxes;
}

TextureData pack_instances(const Scene& scene, std::span<const Affine> object_from_world,
                           const TwoLevelPlaces& places) {
    constexpr size_t kInstancesATask = 1024;
    TextureData texture = zero_texture("instances", places.instances);
    const AddressTable grid_address(places.grids, places.address);
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, scene.instances.size(), kInstancesATask),
        [&](const auto& range) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                const Affine& m = object_from_world[i];
                float* out = texel_at(texture, record_texel(texture, i, kInstanceTexels));
                for (int row = 0; row < 3; ++row) {
                    for (int column = 0; column < 4; ++column) *out++ = m[column][row];
                }
                const vec2 grid = grid_address(record_texel(
                    places.grids, uint64_t{1} + scene.instances[i].object, kGridTexels));
                *out++ = grid.x;
                *out++ = grid.y;
                *out++ = exact_float(i, "instance number");
            }
        });
    return texture;
}

TwoLevelTextures pack_two_level_textures(const Scene& scene, const TwoLevelGrid& grid,
                                         const TwoLevelTexturesOptions& options) {
    ONEPASS_CHECK_EQ(grid.objects.size(), scene.objects.size());
    GridTextures grids = pack_grids(scene, grid.objects, grid.top, options);
    TextureData triangles = pack_triangle_planes(scene, options.triangles,
                                                 max_side(grids.places.address, options.limits));
    std::vector<Affine> object_from_world;
    for (const Instance& instance : scene.instances) {
        object_from_world.emplace_back(inverse(instance.world_from_object));
    }

    TwoLevelTextures packed;
    uint64_t cell_count = grid.top.cell_count();
    uint64_t reference_count = grid.top.references.size();
    for (const UniformGrid& object : grid.objects) {
        cell_count += object.cell_count();
        reference_count += object.references.size();
    }
    packed.stats = {
        {"cells", static_cast<double>(cell_count), "both levels"},
        {"references", static_cast<double>(reference_count), "both levels"},
        {"longest_list", static_cast<double>(longest_of_all(grid.objects, grid.top)),
         "references in one cell"},
        {"triangle_bytes", static_cast<double>(triangles.bytes()), "four texels each"},
    };
    packed.stats.insert(packed.stats.end(), grids.stats.begin(), grids.stats.end());
    packed.inputs.textures = std::move(grids.textures);
    packed.inputs.textures.push_back(std::move(triangles));
    packed.inputs.textures.push_back(pack_instances(scene, object_from_world, grids.places));
    packed.places = std::move(grids.places);
    return packed;
}

}  // namespace onepass
