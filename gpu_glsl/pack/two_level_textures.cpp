#include "gpu_glsl/pack/two_level_textures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "gpu_glsl/pack/block_allocator.h"

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
    AddressTable(const TextureData& texture, AddressWidth width)
        : x_(centres(texture.size.x, width)), y_(centres(texture.size.y, width)) {}

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

// ---- The cell texture --------------------------------------------------------------------------

/// Where each grid lies in the cell texture.
struct CellAtlas {
    uvec3 size{0};               ///< texels
    std::vector<uvec3> corners;  ///< in cells, one a grid
    uint64_t used_blocks = 0;
};

uvec3 blocks_of(uvec3 cells) { return (cells + uvec3(kBlockCells - 1)) / uvec3(kBlockCells); }

/// Tries to place all grids, the largest first.
std::optional<CellAtlas> place_grids(const std::vector<const UniformGrid*>& grids, uvec3 size) {
    std::vector<size_t> order(grids.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return grids[a]->cell_count() > grids[b]->cell_count();
    });
    CellAtlas atlas;
    atlas.size = size;
    atlas.corners.resize(grids.size());
    BlockAllocator allocator(size / uvec3(kBlockCells));
    for (const size_t i : order) {
        const auto corner = allocator.allocate(blocks_of(grids[i]->dims));
        if (!corner) return std::nullopt;
        atlas.corners[i] = *corner * uvec3(kBlockCells);
    }
    atlas.used_blocks = allocator.used_blocks();
    return atlas;
}

/// The smallest texture that holds all grids, doubling one side after the other. Sides are powers
/// of two, so that walking by one texel is exact.
CellAtlas make_atlas(const std::vector<const UniformGrid*>& grids, uint32_t limit) {
    uint64_t blocks_needed = 0;
    uvec3 largest(1);
    for (const UniformGrid* grid : grids) {
        const uvec3 blocks = blocks_of(grid->dims);
        blocks_needed += uint64_t{blocks.x} * blocks.y * blocks.z;
        largest = glm::max(largest, grid->dims);
    }
    uvec3 size(kBlockCells);
    for (int axis = 0; size.x <= limit && size.y <= limit && size.z <= limit;
         axis = (axis + 1) % 3) {
        const uvec3 blocks = size / uvec3(kBlockCells);
        if (uint64_t{blocks.x} * blocks.y * blocks.z >= blocks_needed) {
            if (auto atlas = place_grids(grids, size)) return *atlas;
        }
        size[axis] *= 2;
    }
    throw Error(
        {"texture 'cells'",
         fmt::format("{} grids that fill {} blocks of {}^3 cells, the largest grid {} x {} "
                     "x {} cells",
                     grids.size(), blocks_needed, kBlockCells, largest.x, largest.y, largest.z),
         fmt::format("a fit in {0} x {0} x {0} cells", limit),
         "Lower --param density or top_density, or raise --param atlas."});
}

// ---- Lists of references -----------------------------------------------------------------------

/// Where the lists lie in the reference texture: a list never crosses a row.
struct ListLayout {
    uint32_t width = 0;
    uint64_t rows = 0;
    /// One a grid, one entry a cell: the index (column + width * row) of the cell's first
    /// reference.
    std::vector<std::vector<uint32_t>> first;

    uvec2 texel(size_t grid, uint64_t cell) const {
        return uvec2(first[grid][cell] % width, first[grid][cell] / width);
    }
};

ListLayout lay_lists(const std::vector<const UniformGrid*>& grids, uint32_t width) {
    ListLayout layout;
    layout.width = width;
    uint64_t row = 0;
    uint32_t column = 0;
    for (const UniformGrid* grid : grids) {
        std::vector<uint32_t>& first = layout.first.emplace_back(grid->cell_count());
        for (uint64_t cell = 0; cell < first.size(); ++cell) {
            const uint32_t count = grid->cell_begin[cell + 1] - grid->cell_begin[cell];
            if (column + count > width) {
                ++row;
                column = 0;
            }
            first[cell] = static_cast<uint32_t>(column + width * row);
            column += count;
        }
    }
    layout.rows = row + 1;
    return layout;
}

/// As square as powers of two allow.
ListLayout choose_layout(const std::vector<const UniformGrid*>& grids, uint32_t longest,
                         uint32_t max_side) {
    uint64_t references = 0;
    for (const UniformGrid* grid : grids) references += grid->references.size();
    const auto least_square = static_cast<uint64_t>(std::sqrt(static_cast<double>(references)));
    uint64_t width = std::bit_ceil(std::max({uint64_t{longest}, least_square, uint64_t{16}}));
    width = std::min<uint64_t>(width, max_side);
    if (longest <= width) {
        for (; width <= max_side; width *= 2) {
            ListLayout layout = lay_lists(grids, static_cast<uint32_t>(width));
            if (layout.rows <= max_side) return layout;
        }
    }
    throw Error({"texture 'references'",
                 fmt::format("{} references, {} in the longest list", references, longest),
                 fmt::format("lists within rows of {0} texels, and at most {0} rows", max_side),
                 "Use --param address=float, or lower --param density."});
}

/// The longest list of a grid.
uint32_t longest_list(const UniformGrid& grid) {
    uint32_t longest = 0;
    for (uint64_t i = 0; i < grid.cell_count(); ++i) {
        longest = std::max(longest, grid.cell_begin[i + 1] - grid.cell_begin[i]);
    }
    return longest;
}

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
void pack_grid(TextureData& grids, uint64_t record, const UniformGrid& grid, uvec3 corner,
               uvec3 atlas_size, float step_budget, float first_triangle) {
    const dvec3 texel = 1.0 / dvec3(atlas_size);
    const dvec3 lower = dvec3(corner) * texel;
    const dvec3 upper = dvec3(corner + grid.dims) * texel;
    const dvec3 a = texel / grid.cell_size();
    const dvec3 b = lower - dvec3(grid.bounds.lower) * a;
    float* out = texel_at(grids, record_texel(grids, record, kGridTexels));
    for (const glm::dvec4& row : {glm::dvec4(a, step_budget), glm::dvec4(b, first_triangle),
                                  glm::dvec4(lower, 0.0), glm::dvec4(upper, 0.0)}) {
        for (int c = 0; c < 4; ++c) *out++ = static_cast<float>(row[c]);
    }
}

TextureData pack_instances(const Scene& scene, const TextureData& grids, AddressWidth width,
                           uint32_t max_side) {
    TextureData texture = make_record_texture("instances", "instances", scene.instances.size(),
                                              kInstanceTexels, max_side);
    const AddressTable grid_address(grids, width);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Affine m(inverse(instance.world_from_object));
        float* out = texel_at(texture, record_texel(texture, i, kInstanceTexels));
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column) *out++ = m[column][row];
        }
        const vec2 grid =
            grid_address(record_texel(grids, uint64_t{1} + instance.object, kGridTexels));
        *out++ = grid.x;
        *out++ = grid.y;
        *out++ = exact_float(i, "instance number");
    }
    return texture;
}

/// Packs with one address width. Throws: Error if that width cannot address the scene.
TwoLevelTextures pack_with_width(const Scene& scene, const TwoLevelGrid& grid, AddressWidth width,
                                 const TwoLevelTexturesOptions& options) {
    const bool half = width == AddressWidth::half;
    const uint32_t max_side =
        half ? std::min(kHalfAddressLimit, options.limits.max_2d) : options.limits.max_2d;
    const ChannelFormat address_format = half ? ChannelFormat::half : ChannelFormat::single;

    // Grid 0 is the top level, grid 1 + k that of object k.
    std::vector<const UniformGrid*> grids = {&grid.top};
    for (const UniformGrid& object : grid.objects) grids.push_back(&object);
    const std::vector<uint64_t> first_triangle = first_triangles(scene);
    uint32_t longest = 0;
    for (const UniformGrid* g : grids) longest = std::max(longest, longest_list(*g));
    if (half && longest > kHalfCountLimit) {
        throw Error(
            {"texture 'cells'", fmt::format("a list of {} references", longest),
             fmt::format("at most {}, which a 16-bit float counts exactly", kHalfCountLimit),
             "Use --param address=float."});
    }

    // What references point to.
    TextureData triangles = pack_triangle_planes(scene, options.triangles, max_side);
    TextureData grid_records =
        make_record_texture("grids", "grids", grids.size(), kGridTexels, max_side);
    TextureData instances = pack_instances(scene, grid_records, width, max_side);

    // Cells and their lists.
    const CellAtlas atlas =
        make_atlas(grids, std::min(options.cell_texture_limit, options.limits.max_3d));
    TextureData cells{
        .name = "cells",
        .dimensions = 3,
        .size = atlas.size,
        .format = address_format,
        .texels = std::vector<float>(size_t{4} * atlas.size.x * atlas.size.y * atlas.size.z, 0.0f)};
    const ListLayout lists = choose_layout(grids, longest, max_side);
    TextureData references{.name = "references",
                           .size = uvec3(lists.width, lists.rows, 1),
                           .channels = 2,
                           .format = address_format,
                           .texels = std::vector<float>(2 * lists.width * lists.rows, 0.0f)};
    const AddressTable list_address(references, width);
    const AddressTable instance_address(instances, width);
    const AddressTable triangle_address(triangles, width);
    for (size_t g = 0; g < grids.size(); ++g) {
        const UniformGrid& source = *grids[g];
        const bool top = g == 0;
        const TextureData& target = top ? instances : triangles;
        const AddressTable& target_address = top ? instance_address : triangle_address;
        const auto texels_per_record =
            static_cast<uint32_t>(top ? kInstanceTexels : kTriangleTexels);
        const uint64_t first_record = top ? 0 : first_triangle[g - 1];
        tbb::parallel_for(
            tbb::blocked_range<uint64_t>(0, source.cell_count()), [&](const auto& range) {
                for (uint64_t cell = range.begin(); cell != range.end(); ++cell) {
                    const std::span<const uint32_t> list(
                        source.references.data() + source.cell_begin[cell],
                        source.references.data() + source.cell_begin[cell + 1]);
                    if (list.empty()) continue;
                    const uvec3 at = atlas.corners[g] + uvec3(cell % source.dims.x,
                                                              cell / source.dims.x % source.dims.y,
                                                              cell / source.dims.x / source.dims.y);
                    const uvec2 texel = lists.texel(g, cell);
                    const vec2 address = list_address(texel);
                    float* out =
                        &cells.texels[4 * (at.x + size_t{atlas.size.x} *
                                                      (at.y + size_t{atlas.size.y} * at.z))];
                    out[0] = address.x;
                    out[1] = address.y;
                    out[2] = static_cast<float>(list.size());

                    float* reference =
                        &references.texels[2 * (texel.x + size_t{lists.width} * texel.y)];
                    for (const uint32_t primitive : list) {
                        const vec2 to = target_address(
                            record_texel(target, first_record + primitive, texels_per_record));
                        *reference++ = to.x;
                        *reference++ = to.y;
                    }
                }
            });
    }

    // Grid records. A walk crosses at most dims.x + dims.y + dims.z planes; the top loop also takes
    // a turn for each reference on its way.
    for (size_t g = 0; g < grids.size(); ++g) {
        const uvec3 dims = grids[g]->dims;
        const uint64_t walk_steps = uint64_t{dims.x} + dims.y + dims.z + 3;
        const uint64_t turns = g == 0 ? 1 + uint64_t{longest_list(grid.top)} : 1;
        pack_grid(grid_records, g, *grids[g], atlas.corners[g], atlas.size,
                  exact_float(walk_steps * turns, "a step budget of"),
                  g == 0 ? 0.0f : exact_float(first_triangle[g - 1], "triangle number"));
    }

    TwoLevelTextures packed;
    packed.address = width;
    uint64_t cell_count = 0;
    uint64_t reference_count = 0;
    for (const UniformGrid* g : grids) {
        cell_count += g->cell_count();
        reference_count += g->references.size();
    }
    const std::string atlas_note =
        fmt::format("texture of {} x {} x {} cells, {} blocks used", atlas.size.x, atlas.size.y,
                    atlas.size.z, atlas.used_blocks);
    packed.stats = {
        {"cells", static_cast<double>(cell_count), "both levels"},
        {"references", static_cast<double>(reference_count), "both levels"},
        {"longest_list", static_cast<double>(longest), "references in one cell"},
        {"cell_bytes", static_cast<double>(cells.bytes()), atlas_note},
        {"reference_bytes", static_cast<double>(references.bytes()),
         fmt::format("{} rows of {}", lists.rows, lists.width)},
        {"triangle_bytes", static_cast<double>(triangles.bytes()), "four texels each"},
        {"address_bits", half ? 16.0 : 32.0, "width of a texture address"},
    };
    // Not an initializer list: that would copy them.
    for (TextureData* texture : {&cells, &references, &triangles, &instances, &grid_records}) {
        packed.inputs.textures.push_back(std::move(*texture));
    }
    return packed;
}

}  // namespace

TwoLevelTextures pack_two_level_textures(const Scene& scene, const TwoLevelGrid& grid,
                                         const TwoLevelTexturesOptions& options) {
    ONEPASS_CHECK_EQ(grid.objects.size(), scene.objects.size());
    if (options.address != AddressWidth::automatic) {
        return pack_with_width(scene, grid, options.address, options);
    }
    // Half addresses where they reach: the width is decided before anything large is made.
    uint64_t texels = 0;
    for (const Object& object : scene.objects) texels += object.triangles.size() * kTriangleTexels;
    uint64_t references = grid.top.references.size();
    uint32_t longest = longest_list(grid.top);
    for (const UniformGrid& object : grid.objects) {
        references += object.references.size();
        longest = std::max(longest, longest_list(object));
    }
    // Rows waste less than a longest list each.
    constexpr uint64_t kHalfTexels = uint64_t{kHalfAddressLimit} * kHalfAddressLimit;
    const bool half_fits = texels <= kHalfTexels && longest < kHalfAddressLimit &&
                           references + uint64_t{kHalfAddressLimit} * longest <= kHalfTexels &&
                           scene.instances.size() * kInstanceTexels <= kHalfTexels;
    return pack_with_width(scene, grid, half_fits ? AddressWidth::half : AddressWidth::single,
                           options);
}

}  // namespace onepass
