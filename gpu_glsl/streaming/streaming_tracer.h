// The multi-pass tracer that the paper argues against: one pass a kernel, the rays' state in
// memory.
//
// Purcell, Buck, Mark, Hanrahan, Ray Tracing on Programmable Graphics Hardware (2002), over the
// paper's own two-level grid, textures and arithmetic: its hits are those of `paper`, bit by bit.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/tracer.h"
#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/gpu_tracer.h"
#include "gpu_glsl/prepared_strategy.h"

namespace onepass {

/// What stands in the catalogue, from what `paper`'s front matter says: its structure and
/// parameters, and those of streaming itself.
gl::StrategyInfo streaming_info(const gl::StrategyInfo& paper);

/// Rays in flight at once. Their state takes up to 500 bytes a ray; a larger batch, or image, is
/// done in parts.
inline constexpr size_t kMaxRaysInFlight = size_t{1} << 20;

/// `prepared`: by prepare_strategy() with streaming_info(). `library` and `context` must outlive
/// the tracer. Moving instances are not supported: update() throws. Throws: Error if the context
/// lacks what the entry needs, or for a bad parameter.
std::unique_ptr<Tracer> make_streaming_tracer(std::string name, PreparedStrategy prepared,
                                              GpuEntry entry, const gl::ShaderLibrary& library,
                                              gl::GlContext& context,
                                              size_t max_rays_in_flight = kMaxRaysInFlight);

}  // namespace onepass
