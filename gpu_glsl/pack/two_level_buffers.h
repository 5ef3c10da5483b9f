// The two-level grid packed into buffer textures: storage/two_level_grid/buffer.
#pragma once

#include <vector>

#include "core/grid/two_level_grid.h"
#include "core/scene.h"
#include "core/tracer.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

struct TwoLevelBuffers {
    ShaderInputs inputs;
    std::vector<Stat> stats;
};

/// Layouts in gpu_glsl/shaders/storage/two_level_grid/buffer.glsl and shared/grid_buffers_layout.h.
///
/// Positions are stored in the frame of their object's grid, without rounding.
/// Cost:   O(cells + references + triangles); parallel where it pays.
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
TwoLevelBuffers pack_two_level_buffers(const Scene& scene, const TwoLevelGrid& grid,
                                       const TextureLimits& limits);

}  // namespace onepass
