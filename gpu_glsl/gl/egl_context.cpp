// EGL without a display: a GPU by number (device platform), or Mesa's surfaceless platform. The
// library is opened at run time.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glad/gl.h>

#include "core/error.h"
#include "gpu_glsl/gl/context_common.h"

namespace onepass::gl {
namespace {

constexpr const char* kKind = "egl";
constexpr const char* kRemedy =
    "Install libegl1 with libgl1-mesa-dri, or the GPU's own driver; `onepass list devices` shows "
    "what is found.";

struct EglApi {
    DynamicLibrary library{{"libEGL.so.1", "libEGL.so"}, kRemedy};
    decltype(&eglGetProcAddress) get_proc_address =
        find<decltype(get_proc_address)>("eglGetProcAddress");
    decltype(&eglGetError) get_error = find<decltype(get_error)>("eglGetError");
    decltype(&eglQueryString) query_string = find<decltype(query_string)>("eglQueryString");
    decltype(&eglInitialize) initialize = find<decltype(initialize)>("eglInitialize");
    decltype(&eglBindAPI) bind_api = find<decltype(bind_api)>("eglBindAPI");
    decltype(&eglChooseConfig) choose_config = find<decltype(choose_config)>("eglChooseConfig");
    decltype(&eglCreateContext) create_context = find<decltype(create_context)>("eglCreateContext");
    decltype(&eglDestroyContext) destroy_context =
        find<decltype(destroy_context)>("eglDestroyContext");
    decltype(&eglCreatePbufferSurface) create_pbuffer =
        find<decltype(create_pbuffer)>("eglCreatePbufferSurface");
    decltype(&eglDestroySurface) destroy_surface =
        find<decltype(destroy_surface)>("eglDestroySurface");
    decltype(&eglGetCurrentContext) get_current_context =
        find<decltype(get_current_context)>("eglGetCurrentContext");
    decltype(&eglMakeCurrent) make_current = find<decltype(make_current)>("eglMakeCurrent");

    // Extensions; null where the library lacks them.
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display =
        extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string =
        extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");

  private:
    template <class Function>
    Function find(const char* name) const {
        return library.function<Function>(name);
    }
    template <class Function>
    Function extension(const char* name) const {
        return reinterpret_cast<Function>(get_proc_address(name));
    }
};

const EglApi& egl_api() {
    static const EglApi api;
    return api;
}

std::string egl_error_name(EGLint code) {
    switch (code) {
        case EGL_SUCCESS:
            return "EGL_SUCCESS (a refusal without a reason)";
        case EGL_NOT_INITIALIZED:
            return "EGL_NOT_INITIALIZED";
        case EGL_BAD_ACCESS:
            return "EGL_BAD_ACCESS";
        case EGL_BAD_ALLOC:
            return "EGL_BAD_ALLOC";
        case EGL_BAD_ATTRIBUTE:
            return "EGL_BAD_ATTRIBUTE";
        case EGL_BAD_CONFIG:
            return "EGL_BAD_CONFIG";
        case EGL_BAD_CONTEXT:
            return "EGL_BAD_CONTEXT";
        case EGL_BAD_CURRENT_SURFACE:
            return "EGL_BAD_CURRENT_SURFACE";
        case EGL_BAD_DISPLAY:
            return "EGL_BAD_DISPLAY";
        case EGL_BAD_MATCH:
            return "EGL_BAD_MATCH";
        case EGL_BAD_NATIVE_PIXMAP:
            return "EGL_BAD_NATIVE_PIXMAP";
        case EGL_BAD_NATIVE_WINDOW:
            return "EGL_BAD_NATIVE_WINDOW";
        case EGL_BAD_PARAMETER:
            return "EGL_BAD_PARAMETER";
        case EGL_BAD_SURFACE:
            return "EGL_BAD_SURFACE";
        case EGL_CONTEXT_LOST:
            return "EGL_CONTEXT_LOST";
        case EGL_BAD_DEVICE_EXT:
            return "EGL_BAD_DEVICE_EXT";
        default:
            return fmt::format("EGL error 0x{:04X}", code);
    }
}

/// True if `name` is one of the words of an extension string.
bool has_extension(const char* extensions, std::string_view name) {
    const std::string padded = fmt::format(" {} ", extensions ? extensions : "");
    return padded.find(fmt::format(" {} ", name)) != std::string::npos;
}

/// One way to a display.
struct EglPlatform {
    std::string name;
    EGLenum platform = 0;
    void* native = nullptr;  ///< the EGLDeviceEXT of a device
    int device = kAnyDevice;
    bool software = false;
};

[[noreturn]] void fail(const EglPlatform& platform, const std::string& call,
                       const std::string& expected) {
    throw Error({.where = fmt::format("{}: {}: {}", egl_api().library.name(), platform.name, call),
                 .got = egl_error_name(egl_api().get_error()),
                 .expected = expected,
                 .remedy = kRemedy},
                Error::Kind::device);
}

std::string device_name(int index, EGLDeviceEXT device, const char* extensions) {
    const EglApi& egl = egl_api();
    const char* detail = nullptr;
    if (has_extension(extensions, "EGL_EXT_device_query_name")) {
        detail = egl.query_device_string(device, EGL_RENDERER_EXT);
    }
    if (!detail && has_extension(extensions, "EGL_EXT_device_drm")) {
        detail = egl.query_device_string(device, EGL_DRM_DEVICE_FILE_EXT);
    }
    if (!detail && has_extension(extensions, "EGL_MESA_device_software")) detail = "software";
    return detail ? fmt::format("EGL device {} ({})", index, detail)
                  : fmt::format("EGL device {}", index);
}

/// All devices by number, then Mesa's surfaceless platform.
std::vector<EglPlatform> egl_platforms() {
    const EglApi& egl = egl_api();
    const char* client = egl.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<EglPlatform> platforms;
    if (!egl.get_platform_display) return platforms;

    const bool devices_listed = has_extension(client, "EGL_EXT_device_base") ||
                                has_extension(client, "EGL_EXT_device_enumeration");
    if (devices_listed && egl.query_devices && egl.query_device_string &&
        has_extension(client, "EGL_EXT_platform_device")) {
        EGLint count = 0;
        egl.query_devices(0, nullptr, &count);
        std::vector<EGLDeviceEXT> devices(static_cast<size_t>(std::max(count, 0)));
        if (count > 0) egl.query_devices(count, devices.data(), &count);
        for (int index = 0; index < count; ++index) {
            const EGLDeviceEXT device = devices[static_cast<size_t>(index)];
            const char* extensions = egl.query_device_string(device, EGL_EXTENSIONS);
            platforms.push_back(
                {.name = device_name(index, device, extensions),
                 .platform = EGL_PLATFORM_DEVICE_EXT,
                 .native = device,
                 .device = index,
                 .software = has_extension(extensions, "EGL_MESA_device_software")});
        }
    }
    if (has_extension(client, "EGL_MESA_platform_surfaceless")) {
        platforms.push_back({.name = "EGL surfaceless platform",
                             .platform = EGL_PLATFORM_SURFACELESS_MESA,
                             .native = EGL_DEFAULT_DISPLAY});
    }
    return platforms;
}

/// A raw context on one platform. The display is never terminated: EGL gives every context of a
/// platform the same display, and terminating it would end the others.
class EglWindow {
  public:
    // Delegates, so that a step that throws still runs the destructor.
    explicit EglWindow(EglPlatform platform) : EglWindow() {
        platform_ = std::move(platform);
        open_display();
        create_context();
        create_surface();
        make_current();
    }
    EglWindow(const EglWindow&) = delete;
    EglWindow& operator=(const EglWindow&) = delete;
    ~EglWindow() {
        const EglApi& egl = egl_api();
        if (context_ != EGL_NO_CONTEXT && egl.get_current_context() == context_) {
            egl.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        if (surface_ != EGL_NO_SURFACE) egl.destroy_surface(display_, surface_);
        if (context_ != EGL_NO_CONTEXT) egl.destroy_context(display_, context_);
    }

    void make_current() {
        if (!egl_api().make_current(display_, surface_, surface_, context_)) {
            fail(platform_, "eglMakeCurrent", "a current context");
        }
    }

    const EglPlatform& platform() const { return platform_; }

  private:
    EglWindow() = default;

    void open_display() {
        const EglApi& egl = egl_api();
        display_ = egl.get_platform_display(platform_.platform, platform_.native, nullptr);
        if (display_ == EGL_NO_DISPLAY) fail(platform_, "eglGetPlatformDisplayEXT", "a display");
        if (!egl.initialize(display_, nullptr, nullptr)) {
            fail(platform_, "eglInitialize", "an initialised display");
        }
        extensions_ = egl.query_string(display_, EGL_EXTENSIONS);
        if (!egl.bind_api(EGL_OPENGL_API)) {
            fail(platform_, "eglBindAPI(EGL_OPENGL_API)", "a display with desktop OpenGL");
        }
    }

    void create_context() {
        const EglApi& egl = egl_api();
        const std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT,
                                              EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLint count = 0;
        const bool chosen = egl.choose_config(display_, wanted.data(), &config_, 1, &count);
        if (!chosen || count == 0) {
            config_ = EGL_NO_CONFIG_KHR;
            if (!has_extension(extensions_, "EGL_KHR_no_config_context")) {
                fail(platform_, "eglChooseConfig", "a configuration for desktop OpenGL");
            }
        }
        for (const int version : kCoreVersions) {
            const std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION_KHR,
                                                      version / 10,
                                                      EGL_CONTEXT_MINOR_VERSION_KHR,
                                                      version % 10,
                                                      EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                                                      EGL_NONE};
            context_ = egl.create_context(display_, config_, EGL_NO_CONTEXT, attributes.data());
            if (context_ != EGL_NO_CONTEXT) return;
        }
        fail(platform_, "eglCreateContext", "a core-profile context of OpenGL 3.3 to 4.6");
    }

    /// Only for a driver that cannot make a context current without a surface.
    void create_surface() {
        if (has_extension(extensions_, "EGL_KHR_surfaceless_context")) return;
        const std::array<EGLint, 5> size = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
        surface_ = egl_api().create_pbuffer(display_, config_, size.data());
        if (surface_ == EGL_NO_SURFACE) {
            fail(platform_, "eglCreatePbufferSurface", "a surface of 1 x 1 pixel");
        }
    }

    EglPlatform platform_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    const char* extensions_ = nullptr;
    EGLConfig config_ = nullptr;
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;
};

class EglGlContext final : public GlContext {
  public:
    explicit EglGlContext(EglPlatform platform) : window_(std::move(platform)) {
        load_gl(kKind, [](const char* name) { return egl_api().get_proc_address(name); });
        description_ = describe_current(kKind, window_.platform().device);
        limits_ = query_limits();
    }

    const GlDescription& description() const override { return description_; }
    const GlLimits& limits() const override { return limits_; }
    void make_current() override { window_.make_current(); }

  private:
    EglWindow window_;
    GlDescription description_;
    GlLimits limits_;
};

std::unique_ptr<GlContext> make_on_device(const std::vector<EglPlatform>& platforms, int device) {
    const auto found = std::find_if(platforms.begin(), platforms.end(),
                                    [&](const EglPlatform& p) { return p.device == device; });
    if (found != platforms.end()) return std::make_unique<EglGlContext>(*found);
    const auto count = std::count_if(platforms.begin(), platforms.end(),
                                     [](const EglPlatform& p) { return p.device != kAnyDevice; });
    throw Error({.where = "--device",
                 .got = fmt::format("device {}", device),
                 .expected = count == 0 ? "none: EGL lists no devices here"
                                        : fmt::format("a number from 0 to {}", count - 1),
                 .remedy = "`onepass list devices` shows the numbers."},
                Error::Kind::device);
}

std::unique_ptr<GlContext> make_on_any(std::vector<EglPlatform> platforms) {
    // GPUs first, then the surfaceless platform (it may find a GPU too), then software devices.
    const auto rank = [](const EglPlatform& p) {
        return p.software ? 2 : p.device == kAnyDevice ? 1 : 0;
    };
    std::stable_sort(platforms.begin(), platforms.end(),
                     [&](const auto& a, const auto& b) { return rank(a) < rank(b); });

    std::vector<std::string> problems;
    for (const EglPlatform& platform : platforms) {
        try {
            return std::make_unique<EglGlContext>(platform);
        } catch (const Error& error) {
            problems.push_back(fmt::format("{}: {}", error.parts().where, error.parts().got));
        }
    }
    throw Error({.where = fmt::format("{}: making a context", egl_api().library.name()),
                 .got = problems.empty() ? "no device and no surfaceless platform"
                                         : fmt::format("{}", fmt::join(problems, "; ")),
                 .expected = "a device or platform that gives OpenGL 3.3 or later",
                 .remedy = kRemedy},
                Error::Kind::device);
}

}  // namespace

std::unique_ptr<GlContext> make_egl_context(int device) {
    check_kind(kKind);
    const std::vector<EglPlatform> platforms = egl_platforms();
    auto context =
        device == kAnyDevice ? make_on_any(platforms) : make_on_device(platforms, device);
    claim_kind(kKind);
    return context;
}

std::vector<GlProbe> probe_egl() {
    GlProbe library;
    library.kind = kKind;
    library.name = "libEGL";
    std::vector<EglPlatform> platforms;
    try {
        platforms = egl_platforms();
        library.name = egl_api().library.name();
    } catch (const Error& error) {
        library.problem = error.what();
        return {library};
    }
    if (platforms.empty()) {
        library.problem =
            fmt::format("It lists no devices and no surfaceless platform. {}", kRemedy);
        return {library};
    }

    std::vector<GlProbe> probes;
    for (const EglPlatform& platform : platforms) {
        GlProbe probe;
        probe.kind = kKind;
        probe.device = platform.device;
        probe.name = platform.name;
        try {
            EglWindow window(platform);
            describe_probe(probe, reinterpret_cast<PFNGLGETSTRINGPROC>(
                                      egl_api().get_proc_address("glGetString")));
        } catch (const Error& error) {
            probe.problem = error.what();
        }
        probes.push_back(std::move(probe));
    }
    return probes;
}

}  // namespace onepass::gl
