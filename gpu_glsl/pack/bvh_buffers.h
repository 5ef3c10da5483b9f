// Bounding volume hierarchies packed into buffers: storage/bvh/buffer and ssbo.
#pragma once

#include <vector>

#include "core/bvh/bvh.h"
#include "core/scene.h"
#include "core/tracer.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

struct BvhBuffers {
    ShaderInputs inputs;
    std::vector<Stat> stats;
};

/// Layouts in gpu_glsl/shaders/storage/bvh/trees.glsl and shared/bvh_layout.h.
///
/// Positions are stored in the frame of their object, without rounding; boxes are counted from its
/// centre and rounded outwards. `kind`: of nodes and triangles, which a walk fetches; the rest is
/// always read as textures. `form`: of what triangle tests read.
/// Cost:   O(nodes + triangles).
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
BvhBuffers pack_bvh_buffers(const Scene& scene, const TwoLevelBvh& bvh, const TextureLimits& limits,
                            BufferKind kind, PlanesForm form);

}  // namespace onepass
