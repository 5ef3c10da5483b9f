// A strategy run by the GPU, in fragment or compute shaders.
#pragma once

#include <memory>
#include <string>

#include "core/tracer.h"
#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/prepared_strategy.h"

namespace onepass {

/// Which shader stage traces.
enum class GpuEntry { fragment, compute };

/// Uploads the prepared textures. `library` and `context` must outlive the tracer.
/// Throws: Error if the context lacks what the entry needs, or cannot hold the textures.
std::unique_ptr<Tracer> make_gpu_tracer(std::string name, PreparedStrategy prepared, GpuEntry entry,
                                        const gl::ShaderLibrary& library, gl::GlContext& context);

/// How that stage casts `rays` given rays.
CastForm cast_form(const PreparedStrategy& prepared, GpuEntry entry, size_t rays = kManyRays);

/// The shader files of an entry: for given rays, and for frames.
std::string cast_file(GpuEntry entry, CastForm form);
std::string render_file(GpuEntry entry);

/// The GLSL version a tracer's shaders are written in: what strategy and entry need, or 450 where
/// the context has it, for the sake of `precise`.
int glsl_version_for(const gl::StrategyInfo& info, GpuEntry entry, int context_gl);

}  // namespace onepass
