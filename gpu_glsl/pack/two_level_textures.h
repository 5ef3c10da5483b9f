// The two-level grid packed into textures as the paper packs it: storage/two_level_grid/texture2d.
#pragma once

#include <vector>

#include "core/grid/two_level_grid.h"
#include "core/scene.h"
#include "core/tracer.h"
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
};

struct TwoLevelTextures {
    ShaderInputs inputs;
    AddressWidth address = AddressWidth::single;  ///< half or single
    std::vector<Stat> stats;
};

/// Layouts in gpu_glsl/shaders/storage/two_level_grid/texture2d.glsl and shared/two_level_layout.h.
///
/// Cost:   O(cells + references + triangles); parallel where it pays.
/// Throws: Error naming the table, what was asked and the limit, if the scene does not fit.
/// Source: Adinetz & Berezin, section 4.
TwoLevelTextures pack_two_level_textures(const Scene& scene, const TwoLevelGrid& grid,
                                         const TwoLevelTexturesOptions& options);

}  // namespace onepass
