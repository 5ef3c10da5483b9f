// Irregular grids packed into buffers: storage/irregular_grid/buffer and ssbo.
#pragma once

#include <vector>

#include "core/grid/two_level_grid.h"
#include "core/irregular_grid/irregular_grid.h"
#include "core/scene.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/two_level_buffers.h"

namespace onepass {

/// A grid over instances, and an irregular one an object over its triangles.
struct TwoLevelIrregularGrid {
    /// `objects` lie where the irregular grids do, of one cell and one reference each: what frames,
    /// instances and the top level are packed from.
    TwoLevelGrid around;
    std::vector<IrregularGrid> objects;
    double build_ms = 0.0;  ///< wall time of the build
};

/// `densities`: empty, or one an object, instead of settings.density.
/// Cost: the sum of its grids. Throws: as build_irregular_grid and build_box_grid; Error for
/// another number of densities than objects.
TwoLevelIrregularGrid build_two_level_irregular_grid(const Scene& scene,
                                                     const IrregularGridSettings& settings,
                                                     const GridSizing& top,
                                                     const std::vector<double>& densities = {});

/// Layouts in gpu_glsl/shaders/storage/irregular_grid/irregular_cells.glsl and
/// shared/irregular_grid_layout.h.
///
/// Cost:   O(nodes + cells + references + triangles).
/// Throws: Error naming the buffer, what was asked and the limit, if the scene does not fit.
TwoLevelBuffers pack_irregular_grid_buffers(const Scene& scene, TwoLevelIrregularGrid grid,
                                            const TextureLimits& limits, BufferKind kind,
                                            PlanesForm form);

}  // namespace onepass
