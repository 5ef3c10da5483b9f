// OpenGL contexts without a display: OSMesa (software, the default) and EGL (a GPU, or Mesa).
//
// Both libraries are opened at run time, so neither is a link dependency. A process uses one kind
// of context; agreement between the kinds is tested through files.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace onepass::gl {

/// `device` of a maker that may choose for itself, and of a context that no device belongs to.
inline constexpr int kAnyDevice = -1;

/// What a context runs on; goes into every result's manifest.
struct GlDescription {
    std::string kind;          ///< "osmesa" or "egl"
    std::string vendor;        ///< GL_VENDOR
    std::string renderer;      ///< GL_RENDERER
    std::string version;       ///< GL_VERSION, with the driver's own version
    std::string glsl_version;  ///< GL_SHADING_LANGUAGE_VERSION
    int gl = 0;                ///< version as a number: 450 for 4.5
    int device = kAnyDevice;   ///< index in EGL's device list, if one was opened
    bool software = false;     ///< it runs on the CPU: flagged in every result
    bool jumps = false;        ///< as is_jumping_renderer() says
    bool has_ballots = false;  ///< GL_KHR_shader_subgroup: ballots in compute shaders
};

/// The limits that packing and dispatching have to keep. 0: the context lacks the feature.
struct GlLimits {
    int64_t max_texture_size = 0;         ///< texels a side, 2D
    int64_t max_3d_texture_size = 0;      ///< texels a side
    int64_t max_texture_buffer_size = 0;  ///< texels
    int64_t max_texture_units = 0;        ///< of one stage
    int64_t max_draw_buffers = 0;
    int64_t max_ssbo_bytes = 0;     ///< of one buffer
    int64_t max_compute_ssbos = 0;  ///< of one compute shader
    int64_t max_compute_work_groups_x = 0;
    int64_t max_compute_work_groups_y = 0;
    int64_t max_compute_work_groups_z = 0;
    int64_t max_compute_invocations = 0;  ///< of one work group
    int64_t processors = 0;               ///< that run work groups: GL_NV_shader_thread_group
};

/// A core-profile context of OpenGL 3.3 to 4.6 (the highest there is), current when made.
class GlContext {
  public:
    virtual ~GlContext() = default;

    virtual const GlDescription& description() const = 0;
    virtual const GlLimits& limits() const = 0;

    /// Makes it the calling thread's context: needed only where a process has several.
    /// Throws: Error if the library refuses.
    virtual void make_current() = 0;
};

/// Throws: Error (Kind::device) if libOSMesa is missing or refuses, or if the process already uses
/// another kind of context.
std::unique_ptr<GlContext> make_osmesa_context();

/// Opens EGL's device number `device`; without one, the first GPU that works, else Mesa's
/// surfaceless platform, else a software device.
/// Throws: Error (Kind::device) if nothing works, naming every way that was tried.
std::unique_ptr<GlContext> make_egl_context(int device = kAnyDevice);

/// `kind`: "osmesa", "egl" or "auto" (EGL if a device is named; else OSMesa where it works, else
/// EGL).
/// Throws: Error for an unknown kind, for a device asked of OSMesa, and as the makers above.
std::unique_ptr<GlContext> make_context(const std::string& kind = "auto", int device = kAnyDevice);

/// One way to a context, as `onepass doctor` and `onepass list devices` show it.
struct GlProbe {
    std::string kind;         ///< "osmesa" or "egl"
    int device = kAnyDevice;  ///< index in EGL's device list
    std::string name;         ///< the library, device file or platform that was tried
    std::string renderer;     ///< GL_RENDERER if usable
    std::string version;      ///< GL_VERSION if usable
    bool usable = false;
    bool software = false;
    std::string problem;  ///< why not, and the remedy; empty if usable
};

/// Every way to a context that there is, tried by making one of each. Never throws; loads no GL
/// functions for the process and leaves no context current, so call it before making contexts.
std::vector<GlProbe> probe_contexts();

/// True for the names of renderers that run on the CPU (llvmpipe, softpipe, swrast, SwiftShader).
bool is_software_renderer(const std::string& renderer);

/// Whether a software renderer jumps over branches that none of its lanes takes, by GL_VERSION:
/// llvmpipe of Mesa 25 does, that of 22.3 goes through both sides of all of them. (What lies
/// between was not tried, and is taken for the older.)
bool is_jumping_renderer(const std::string& renderer, const std::string& version);

}  // namespace onepass::gl
