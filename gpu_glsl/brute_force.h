// Brute force on the GPU: every ray against every triangle, without any structure.
//
// A tracer of several passes, so that it is made in C++; what a pass does stands in
// shaders/brute_force/test_chunk.glsl. It casts rays and renders nothing.
#pragma once

#include <memory>
#include <vector>

#include "core/catalogue.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/glsl_tracers.h"

namespace onepass {

/// brute_force/texture2d/fragment and brute_force/texture2d/compute.
std::vector<CatalogueEntry> brute_force_tracers(
    const std::shared_ptr<const gl::ShaderLibrary>& library, const GlContextProvider& context);

}  // namespace onepass
