// The two-level grid packed into textures as the paper packs it: storage/two_level_grid/texture2d.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/two_level_grid.h"
#include "core/scene.h"
#include "core/tracer.h"
#include "gpu_glsl/pack/cell_atlas.h"
#include "gpu_glsl/pack/shader_inputs.h"
#include "gpu_glsl/pack/triangle_planes.h"

namespace onepass {

/// How texture addresses are stored. `half` is the paper's 16-bit float: exact up to 1024 texels a
/// side. `automatic`: half where the scene fits, else single.
enum class AddressWidth { automatic, half, single };

struct TwoLevelTexturesOptions {
    AddressWidth address = AddressWidth::automatic;
    uint32_t cell_texture_limit = 256;  ///< cells a side of the cell texture; the paper's 256^3
    TrianglePlanesOptions triangles;
    TextureLimits limits;
    bool moving = false;  ///< leave rows for a top level of twice the references
};

/// Where the parts of a packed scene lie: what packing its top level again takes.
struct TwoLevelPlaces {
    AddressWidth address = AddressWidth::single;  ///< half or single
    ObjectPlaces objects;
    uint32_t first_top_row = 0;  ///< of the reference texture
    uvec3 cells{0};              ///< sizes of the textures, in texels
    uvec3 references{0};
    uvec3 triangles{0};
    uvec3 instances{0};
    uvec3 grids{0};
};

struct TwoLevelTextures {
    ShaderInputs inputs;
    TwoLevelPlaces places;
    std::vector<Stat> stats;
};

/// Layouts in gpu_glsl/shaders/storage/two_level_grid/texture2d.glsl and shared/two_level_layout.h.
///
/// Cost:   O(cells + references + triangles); parallel where it pays.
/// Throws: Error naming the table, what was asked and the limit, if the scene does not fit.
/// Source: Adinetz & Berezin, section 4.
TwoLevelTextures pack_two_level_textures(const Scene& scene, const TwoLevelGrid& grid,
                                         const TwoLevelTexturesOptions& options);

// ---- The parts that top_level_update.h packs again ---------------------------------------------

/// The textures `cells`, `references` and `grids`, in this order.
struct GridTextures {
    std::deque<TextureData> textures;
    TwoLevelPlaces places;
    std::vector<Stat> stats;
};

/// `least`: no texture gets smaller than there. Cost, errors: as pack_two_level_textures.
GridTextures pack_grids(const Scene& scene, std::span<const UniformGrid> objects,
                        const UniformGrid& top, const TwoLevelTexturesOptions& options,
                        const TwoLevelPlaces& least = {});

/// The top level packed into what pack_grids() made: its boxes of `cells`, `references` and
/// `grids`; nothing if it needs larger textures.
/// Throws: Error if it exceeds the limits.
std::optional<std::deque<TexelBox>> pack_top_grid(const UniformGrid& top,
                                                  const TwoLevelPlaces& places,
                                                  const TwoLevelTexturesOptions& options);

/// The texture `instances`; object_from_world one an instance.
TextureData pack_instances(const Scene& scene, std::span<const Affine> object_from_world,
                           const TwoLevelPlaces& places);

}  // namespace onepass
