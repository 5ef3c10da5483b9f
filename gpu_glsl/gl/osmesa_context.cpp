// OSMesa: a core-profile context in plain memory, without display or GPU. The library is opened at
// run time.
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>
// GL/osmesa.h pulls in GL/gl.h unless the loader stands before it.
// clang-format off
#include <glad/gl.h>
#include <GL/osmesa.h>
// clang-format on

#include "core/error.h"
#include "gpu_glsl/gl/context_common.h"

namespace onepass::gl {
namespace {

constexpr const char* kKind = "osmesa";
constexpr const char* kRemedy =
    "Install libosmesa6 (newer Mesa releases no longer have it), or use EGL: libegl1 with "
    "libgl1-mesa-dri, or a GPU driver.";

struct OsmesaApi {
    DynamicLibrary library{{"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}, kRemedy};
    decltype(&OSMesaCreateContextAttribs) create_context =
        library.function<decltype(create_context)>("OSMesaCreateContextAttribs");
    decltype(&OSMesaDestroyContext) destroy_context =
        library.function<decltype(destroy_context)>("OSMesaDestroyContext");
    decltype(&OSMesaMakeCurrent) make_current =
        library.function<decltype(make_current)>("OSMesaMakeCurrent");
    decltype(&OSMesaGetCurrentContext) get_current_context =
        library.function<decltype(get_current_context)>("OSMesaGetCurrentContext");
    decltype(&OSMesaGetProcAddress) get_proc_address =
        library.function<decltype(get_proc_address)>("OSMesaGetProcAddress");
};

const OsmesaApi& osmesa_api() {
    static const OsmesaApi api;
    return api;
}

[[noreturn]] void refuse(const std::string& call, const std::string& expected) {
    throw Error({.where = fmt::format("{}: {}", osmesa_api().library.name(), call),
                 .got = "a refusal",
                 .expected = expected,
                 .remedy = kRemedy},
                Error::Kind::device);
}

/// A raw context with the memory it draws to, which nothing reads: we draw to framebuffer objects.
class OsmesaWindow {
  public:
    // Delegates, so that a step that throws still runs the destructor.
    OsmesaWindow() : OsmesaWindow(nullptr) {
        for (const int version : kCoreVersions) {
            const std::array<int, 11> attributes = {OSMESA_FORMAT,
                                                    OSMESA_RGBA,
                                                    OSMESA_PROFILE,
                                                    OSMESA_CORE_PROFILE,
                                                    OSMESA_CONTEXT_MAJOR_VERSION,
                                                    version / 10,
                                                    OSMESA_CONTEXT_MINOR_VERSION,
                                                    version % 10,
                                                    0};
            context_ = osmesa_api().create_context(attributes.data(), nullptr);
            if (context_) break;
        }
        if (!context_) {
            refuse("OSMesaCreateContextAttribs", "a core-profile context of OpenGL 3.3 to 4.6");
        }
        make_current();
    }
    OsmesaWindow(const OsmesaWindow&) = delete;
    OsmesaWindow& operator=(const OsmesaWindow&) = delete;
    ~OsmesaWindow() {
        if (!context_) return;
        const OsmesaApi& osmesa = osmesa_api();
        if (osmesa.get_current_context() == context_) {
            osmesa.make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0);
        }
        osmesa.destroy_context(context_);
    }

    void make_current() {
        if (!osmesa_api().make_current(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
            refuse("OSMesaMakeCurrent", "a current context");
        }
    }

  private:
    explicit OsmesaWindow(OSMesaContext context) : context_(context) {}

    static constexpr int kSide = 8;
    std::array<unsigned char, 4 * kSide * kSide> pixels_{};
    OSMesaContext context_ = nullptr;
};

class OsmesaGlContext final : public GlContext {
  public:
    OsmesaGlContext() {
        load_gl(kKind, [](const char* name) { return osmesa_api().get_proc_address(name); });
        description_ = describe_current(kKind, kAnyDevice);
        limits_ = query_limits();
    }

    const GlDescription& description() const override { return description_; }
    const GlLimits& limits() const override { return limits_; }
    void make_current() override { window_.make_current(); }

  private:
    OsmesaWindow window_;
    GlDescription description_;
    GlLimits limits_;
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() {
    check_kind(kKind);
    auto context = std::make_unique<OsmesaGlContext>();
    claim_kind(kKind);
    return context;
}

std::vector<GlProbe> probe_osmesa() {
    GlProbe probe;
    probe.kind = kKind;
    probe.name = "libOSMesa";
    try {
        probe.name = osmesa_api().library.name();
        OsmesaWindow window;
        describe_probe(probe, reinterpret_cast<PFNGLGETSTRINGPROC>(
                                  osmesa_api().get_proc_address("glGetString")));
    } catch (const Error& error) {
        probe.problem = error.what();
    }
    return {probe};
}

}  // namespace onepass::gl
