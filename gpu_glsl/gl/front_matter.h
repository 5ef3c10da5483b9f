// The `//!` lines at the head of strategies/NAME.glsl. Internal to gpu_glsl/gl.
#pragma once

#include <string>
#include <string_view>

#include "gpu_glsl/gl/shader_library.h"

namespace onepass::gl {

/// What the front matter of `file` (strategies/NAME.glsl) says; storage files are not looked up.
/// Throws: Error with file:line for a missing, unknown, repeated or ill-formed line.
StrategyInfo parse_front_matter(const std::string& file, std::string_view text);

}  // namespace onepass::gl
