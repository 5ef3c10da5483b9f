// Bounding volume hierarchies packed into buffer textures: storage/bvh/buffer.
#pragma once

#include <vector>

#include "core/bvh/bvh.h"
#include "core/scene.h"
#include "core/tracer.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

struct BvhBuffers {
    ShaderInputs inputs;
    std::vector<Stat> stats;
};

/// Layouts in gpu_glsl/shaders/storage/bvh/buffer.glsl and shared/bvh_layout.h.
///
/// Positions and boxes are stored in the frame of their object, without rounding.
/// Cost:   O(nodes + triangles).
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
BvhBuffers pack_bvh_buffers(const Scene& scene, const TwoLevelBvh& bvh,
                            const TextureLimits& limits);

}  // namespace onepass
