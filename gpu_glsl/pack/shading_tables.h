// The tables that lib/shading reads: normals, instances, materials, lights; and its constants.
#pragma once

#include <span>

#include "core/scene.h"
#include "core/scene_needs.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/pack/shader_inputs.h"

namespace onepass {

/// Packs the shading tables of a scene; layouts in gpu_glsl/shaders/shared/shading_layout.h.
/// `smooth_normals`: SceneNeeds::smooth_normals, which the shader variant must be given as well.
/// Throws: Error if a table exceeds the limits, or an index 2^24 (floats hold it).
ShaderInputs pack_shading_tables(const Scene& scene, bool smooth_normals,
                                 const TextureLimits& limits);

/// The table `shading_instances` alone, for instances that have moved: object_from_world one an
/// instance. Throws: as pack_shading_tables.
TextureData pack_shading_instances(const Scene& scene, std::span<const Affine> object_from_world,
                                   const TextureLimits& limits);

/// The constants that a variant of lib/shading needs.
std::vector<gl::ShaderConstant> shading_constants(const SceneNeeds& needs);

}  // namespace onepass
