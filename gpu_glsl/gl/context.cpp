// The parts of a context that do not depend on its kind, and the choice between the kinds.
#include "gpu_glsl/gl/context.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <regex>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "gpu_glsl/gl/context_common.h"

namespace onepass::gl {
namespace {

std::string& kind_in_use() {
    static std::string kind;
    return kind;
}

std::vector<std::string>& debug_messages() {
    static std::vector<std::string> messages;
    return messages;
}

void GLAD_API_PTR on_debug_message(GLenum, GLenum type, GLuint, GLenum, GLsizei length,
                                   const GLchar* message, const void*) {
    if (type != GL_DEBUG_TYPE_ERROR) return;
    debug_messages().emplace_back(message, static_cast<size_t>(length));
}

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

int64_t limit(GLenum name) {
    GLint64 value = 0;
    glGetInteger64v(name, &value);
    return value;
}

int64_t indexed_limit(GLenum name, GLuint index) {
    GLint value = 0;
    glGetIntegeri_v(name, index, &value);
    return value;
}

bool has_ballots() {
    if (!GLAD_GL_KHR_shader_subgroup) return false;
    const int64_t features = limit(GL_SUBGROUP_SUPPORTED_FEATURES_KHR);
    const int64_t stages = limit(GL_SUBGROUP_SUPPORTED_STAGES_KHR);
    return (features & GL_SUBGROUP_FEATURE_BALLOT_BIT_KHR) != 0 &&
           (stages & GL_COMPUTE_SHADER_BIT) != 0;
}

}  // namespace

DynamicLibrary::DynamicLibrary(std::initializer_list<const char*> names,
                               const std::string& remedy) {
    std::vector<std::string> problems;
    for (const char* name : names) {
        library_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (library_) {
            name_ = name;
            return;
        }
        problems.emplace_back(dlerror());
    }
    throw Error({.where = fmt::format("loading {}", *names.begin()),
                 .got = fmt::format("\"{}\"", fmt::join(problems, "; ")),
                 .expected = "the shared library",
                 .remedy = remedy},
                Error::Kind::device);
}

void* DynamicLibrary::symbol(const char* name) const {
    if (void* address = dlsym(library_, name)) return address;
    throw Error({.where = name_,
                 .got = fmt::format("no function {}", name),
                 .expected = "a library that has it",
                 .remedy = "Install a newer version of the library."},
                Error::Kind::device);
}

const std::string& claimed_kind() { return kind_in_use(); }

void check_kind(std::string_view kind) {
    if (kind_in_use().empty() || kind_in_use() == kind) return;
    throw Error({.where = "making an OpenGL context",
                 .got = fmt::format("kind {} in a process that uses {}", kind, kind_in_use()),
                 .expected = "one kind of context a process",
                 .remedy = "Run the two kinds in two processes and compare their files."});
}

void claim_kind(std::string_view kind) {
    check_kind(kind);
    kind_in_use() = kind;
}

void load_gl(std::string_view kind, GLADloadfunc loader) {
    const int version = gladLoadGL(loader);
    if (version < GLAD_MAKE_VERSION(3, 3)) {
        throw Error({.where = fmt::format("loading OpenGL functions through {}", kind),
                     .got = fmt::format("version {}.{}", GLAD_VERSION_MAJOR(version),
                                        GLAD_VERSION_MINOR(version)),
                     .expected = "OpenGL 3.3 or later",
                     .remedy = "Update the driver, or choose another device."},
                    Error::Kind::device);
    }
    if (std::getenv("ONEPASS_GL_DEBUG") && glDebugMessageCallback) {
        // Synchronous, so that a message stands before the check_gl that reports it.
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageCallback(on_debug_message, nullptr);
    }
}

std::vector<std::string> take_debug_messages() { return std::exchange(debug_messages(), {}); }

GlDescription describe_current(std::string_view kind, int device) {
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);

    GlDescription description;
    description.kind = kind;
    description.vendor = gl_string(GL_VENDOR);
    description.renderer = gl_string(GL_RENDERER);
    description.version = gl_string(GL_VERSION);
    description.glsl_version = gl_string(GL_SHADING_LANGUAGE_VERSION);
    description.gl = 100 * major + 10 * minor;
    description.device = device;
    description.software = is_software_renderer(description.renderer);
    description.jumps = is_jumping_renderer(description.renderer, description.version);
    description.has_ballots = has_ballots();
    return description;
}

GlLimits query_limits() {
    GlLimits limits;
    limits.max_texture_size = limit(GL_MAX_TEXTURE_SIZE);
    limits.max_3d_texture_size = limit(GL_MAX_3D_TEXTURE_SIZE);
    limits.max_texture_buffer_size = limit(GL_MAX_TEXTURE_BUFFER_SIZE);
    limits.max_texture_units = limit(GL_MAX_TEXTURE_IMAGE_UNITS);
    limits.max_draw_buffers = std::min(limit(GL_MAX_DRAW_BUFFERS), limit(GL_MAX_COLOR_ATTACHMENTS));
    if (!GLAD_GL_VERSION_4_3) return limits;
    limits.max_ssbo_bytes = limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    limits.max_compute_ssbos = limit(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
    limits.max_compute_work_groups_x = indexed_limit(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0);
    limits.max_compute_work_groups_y = indexed_limit(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 1);
    limits.max_compute_work_groups_z = indexed_limit(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 2);
    limits.max_compute_invocations = limit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
    if (GLAD_GL_NV_shader_thread_group) limits.processors = limit(GL_SM_COUNT_NV);
    return limits;
}

bool is_software_renderer(const std::string& renderer) {
    std::string lower;
    std::transform(renderer.begin(), renderer.end(), std::back_inserter(lower),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "swiftshader", "software"}) {
        if (lower.find(name) != std::string::npos) return true;
    }
    return false;
}

bool is_jumping_renderer(const std::string& renderer, const std::string& version) {
    constexpr int kFirstMesa = 25;
    static const std::regex kMesa(R"(.*\bMesa (\d{1,4})\..*)");
    std::smatch match;
    return renderer.starts_with("llvmpipe") && std::regex_match(version, match, kMesa) &&
           std::stoi(match[1]) >= kFirstMesa;
}

void describe_probe(GlProbe& probe, PFNGLGETSTRINGPROC get_string) {
    const auto text = [&](GLenum name) {
        const GLubyte* value = get_string ? get_string(name) : nullptr;
        return std::string(value ? reinterpret_cast<const char*>(value) : "");
    };
    probe.renderer = text(GL_RENDERER);
    probe.version = text(GL_VERSION);
    probe.software = is_software_renderer(probe.renderer);
    probe.usable = !probe.version.empty();
    if (!probe.usable) probe.problem = "The context was made, but glGetString gives nothing.";
}

std::vector<GlProbe> probe_contexts() {
    std::vector<GlProbe> probes = probe_osmesa();
    for (GlProbe& probe : probe_egl()) probes.push_back(std::move(probe));
    return probes;
}

std::unique_ptr<GlContext> make_context(const std::string& kind, int device) {
    const bool automatic = kind == "auto";
    if (kind == "osmesa" && device != kAnyDevice) {
        throw Error({.where = "--device",
                     .got = fmt::format("device {} with an OSMesa context", device),
                     .expected = "a device only with an EGL context",
                     .remedy = "Leave the device out, or choose the context kind egl."});
    }
    if (kind == "osmesa" || (automatic && claimed_kind() == "osmesa" && device == kAnyDevice)) {
        return make_osmesa_context();
    }
    if (kind == "egl" || (automatic && (claimed_kind() == "egl" || device != kAnyDevice))) {
        return make_egl_context(device);
    }
    if (!automatic) {
        throw Error({.where = "the kind of OpenGL context",
                     .got = fmt::format("\"{}\"", kind),
                     .expected = "auto, osmesa or egl",
                     .remedy = "Choose one of these."});
    }

    // Nothing asked, nothing used yet: OSMesa if it works, else whatever EGL finds.
    std::string osmesa_problem;
    try {
        return make_osmesa_context();
    } catch (const Error& error) {
        osmesa_problem = error.what();
    }
    try {
        return make_egl_context();
    } catch (const Error& error) {
        throw Error({.where = "making an OpenGL context",
                     .got = fmt::format("neither kind: [{}] [{}]", osmesa_problem, error.what()),
                     .expected = "OSMesa or EGL",
                     .remedy = "Install libosmesa6, or libegl1 with libgl1-mesa-dri, or a GPU "
                               "driver; `onepass doctor` shows what is found."},
                    Error::Kind::device);
    }
}

}  // namespace onepass::gl
