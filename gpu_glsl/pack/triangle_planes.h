// Triangles as planes: the texels that the published ray-triangle test reads.
#pragma once

#include <vector>

#include "core/scene.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

struct TrianglePlanesOptions {
    /// `half`: every number is rounded to a 16-bit float; beyond 65504 it is infinite, and the
    /// triangle is never hit.
    ChannelFormat format = ChannelFormat::single;
    /// Planes relative to the triangle's first corner, which takes the place of the fourth plane.
    bool local = false;

    bool operator==(const TrianglePlanesOptions&) const = default;
};

/// The triangles of all objects, object by object: texture "triangles", records as
/// shared/two_level_layout.h says. Planes are computed in double and rounded once.
///
/// A triangle without area gets planes of NaN, which no comparison of the shader's test accepts: it
/// is never hit.
/// Throws: Error as make_record_texture.
TextureData pack_triangle_planes(const Scene& scene, const TrianglePlanesOptions& options,
                                 uint32_t max_side);

/// The number of each object's first triangle in that texture, and after them the count of all.
std::vector<uint64_t> first_triangles(const Scene& scene);

}  // namespace onepass
