// One grid over the triangles of all instances, built and packed: storage/flat_grid/buffer and
// ssbo.
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/uniform_grid.h"
#include "core/scene.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/frames.h"
#include "gpu_glsl/pack/two_level_buffers.h"

namespace onepass {

/// The triangles of all instances as they stand in the world: instance by instance, each in the
/// order of its object. A triangle that equals a lower one of its object is not among them
/// (core/grid/duplicates.h): it is never the answer.
struct FlatGrid {
    GridFrame frame;  ///< of the world: its largest extent becomes 1/2 to 1
    dvec3 centre;     ///< of the scene there, as floats hold it
    std::vector<std::vector<uint32_t>>
        listed;                   ///< of each object, the triangles that are among them
    std::vector<uint64_t> first;  ///< where those of each instance begin, and their number
    UniformGrid grid;             ///< in the frame, from the centre
    double build_ms = 0.0;        ///< wall time of the build
};

/// Cost:   as build_triangle_grid over the triangles of all instances, for which it also holds
///         48 bytes a triangle while it works.
/// Throws: as build_triangle_grid.
FlatGrid build_flat_grid(const Scene& scene, const GridSizing& sizing);

/// Throws: Error if the triangles of all instances surely exceed what buffers of that kind hold.
void check_flat_grid_fits(const Scene& scene, const TextureLimits& limits, BufferKind kind,
                          PlanesForm form);

/// Layouts in gpu_glsl/shaders/storage/flat_grid/flat_cells.glsl. Objects' vertices and instances,
/// on which decisions rest, are packed as pack_two_level_buffers() does.
///
/// Cost:   O(cells + references + triangles of all instances); parallel.
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
TwoLevelBuffers pack_flat_grid_buffers(const Scene& scene, FlatGrid grid,
                                       const TextureLimits& limits, BufferKind kind,
                                       PlanesForm form);

}  // namespace onepass
