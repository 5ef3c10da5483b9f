// What the OSMesa and the EGL context share: opening libraries, loading GL, the one-kind rule.
// Internal to gpu_glsl/gl.
#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <glad/gl.h>

#include "gpu_glsl/gl/context.h"

namespace onepass::gl {

/// Core-profile versions to ask for, best first. 3.3 is what the `paper` strategy needs.
inline constexpr std::array<int, 8> kCoreVersions = {46, 45, 44, 43, 42, 41, 40, 33};

/// A shared library that stays open until the process ends: GL drivers leave threads and
/// thread-local data behind, so closing one is not safe.
class DynamicLibrary {
  public:
    /// Opens the first of `names` that there is.
    /// Throws: Error (Kind::device) with every name, the loader's own words and `remedy`.
    DynamicLibrary(std::initializer_list<const char*> names, const std::string& remedy);

    /// The function of this name. Throws: Error (Kind::device) if the library lacks it.
    template <class Function>
    Function function(const char* name) const {
        return reinterpret_cast<Function>(symbol(name));
    }

    const std::string& name() const { return name_; }

  private:
    void* symbol(const char* name) const;

    std::string name_;
    void* library_ = nullptr;
};

/// Throws: Error if this process already uses another kind of context.
void check_kind(std::string_view kind);

/// Remembers the kind for the rest of the process.
void claim_kind(std::string_view kind);

/// The kind that this process uses; empty so far.
const std::string& claimed_kind();

/// Loads all GL functions for the process through the current context's own loader.
/// Throws: Error (Kind::device) if that fails or the context is older than 3.3.
void load_gl(std::string_view kind, GLADloadfunc loader);

/// What the current context says of itself. Needs load_gl.
GlDescription describe_current(std::string_view kind, int device);
GlLimits query_limits();

/// Fills renderer, version and software by one glGetString of the current context's own, without
/// loading anything for the process.
void describe_probe(GlProbe& probe, PFNGLGETSTRINGPROC get_string);

/// The ways of each kind, for probe_contexts.
std::vector<GlProbe> probe_osmesa();
std::vector<GlProbe> probe_egl();

/// Driver messages about errors since the last call; filled only if the environment variable
/// ONEPASS_GL_DEBUG is set and the context is 4.3 or later.
std::vector<std::string> take_debug_messages();

}  // namespace onepass::gl
