// The two-level grid packed into buffers: storage/two_level_grid/buffer and ssbo.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/two_level_grid.h"
#include "core/scene.h"
#include "core/storage_order.h"
#include "core/tracer.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/frames.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

struct TwoLevelBuffers {
    ShaderInputs inputs;
    std::vector<Stat> stats;
    std::vector<GridFrame> frames;           ///< of the objects' grids
    std::vector<RawVector<uint32_t>> slots;  ///< of each object's triangles (core/storage_order.h)
    uint64_t object_cells = 0;               ///< of all object grids
    uint64_t object_references = 0;
};

/// Layouts in gpu_glsl/shaders/storage/two_level_grid/grid_buffers.glsl and
/// shared/grid_buffers_layout.h.
///
/// Positions are stored in the frame of their object's grid, without rounding; triangles lie
/// in the order of core/storage_order.h. `kind`: of cells, references and triangles, which
/// a walk fetches; the rest is always read as textures. `form`: of what triangle tests read.
/// Cost:   O(cells + references + triangles); parallel. The grids' arrays become buffers in place:
///         beside them 8 bits a cell of one grid at a time, and where objects are several the
///         buffers are filled as the grids are given up; 4 bytes a triangle.
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
TwoLevelBuffers pack_two_level_buffers(const Scene& scene, TwoLevelGrid grid,
                                       const TextureLimits& limits, BufferKind kind,
                                       PlanesForm form);

/// Makes a grid's references and cells words (shared/grid_buffers_layout.h), in place. Its lists
/// begin at `first_reference` of the buffer. `slots`: by which they name what they refer to; empty:
/// by its number. Cost: parallel; 8 bits a cell while it works.
void grid_to_words(UniformGrid& grid, uint64_t first_reference,
                   std::span<const uint32_t> slots = {});

/// The part that changes when instances move: buffers of the top level and of the instances, and
/// uniforms. `boxes`: of the instances in the world, those that `top` was built over.
/// Cost: O(instances + top-level cells and references). Throws: as above.
ShaderInputs pack_top_buffers(const Scene& scene, std::span<const Affine> world_from_object,
                              std::span<const Bounds> boxes, UniformGrid top,
                              std::span<const GridFrame> frames, const TextureLimits& limits);

}  // namespace onepass
