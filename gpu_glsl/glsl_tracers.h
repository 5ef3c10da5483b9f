// All tracers of this module: every strategy file, in each storage, on the GPU and as twins.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/catalogue.h"
#include "core/render_settings.h"
#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/shader_library.h"

namespace onepass {

/// Makes the process's GL context at the first call, and returns the same one after that.
using GlContextProvider = std::function<gl::GlContext&()>;

/// One entry for each strategy, storage and entry of the library, and two twins for each strategy
/// that has them. The context is made when the first GPU tracer is; twins need none.
/// Throws: Error if a strategy promises a twin that was not built, or the other way round.
std::vector<CatalogueEntry> glsl_tracers(const gl::ShaderLibrary& library,
                                         GlContextProvider context);

/// The text the driver of a GPU with ballots gets for a tracer's `cast` (settings == nullptr) or
/// `render`; elsewhere parameters that are `auto` may stand for another one.
/// Throws: Error if `name` is not a GPU tracer of the library, or for bad parameters.
gl::ComposedShader compose_tracer_shader(const gl::ShaderLibrary& library, const std::string& name,
                                         ScenePtr scene, const ParamValues& params,
                                         const RenderSettings* settings);

}  // namespace onepass
