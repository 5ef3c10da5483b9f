#include "gpu_glsl/streaming/stream.h"

#include <fmt/format.h>

namespace onepass::streaming {
namespace {

using glm::uint;
#include "gpu_glsl/shaders/shared/streaming_layout.h"

constexpr uint64_t kTexel = 16;  ///< bytes of four floats or integers
constexpr uint64_t kControl = 4;
constexpr uint64_t kRayBytes = 2 * kTexel;
constexpr uint64_t kHitBytes = kHitTexels * kTexel + 8;     // and two integers
constexpr uint64_t kPathBytes = kPathTexels * kTexel + 16;  // and four integers

gl::LaunchTime sum(const gl::LaunchTime& a, const gl::LaunchTime& b) {
    return {a.wall_ms + b.wall_ms, a.device_ms + b.device_ms};
}

}  // namespace

std::string to_string(Kernel kernel) {
    constexpr const char* kNames[] = {"traverse", "intersect", "shade"};
    return kNames[index_of(kernel)];
}

Variant needed_by(Kernel kernel, const Variant& variant) {
    Variant needed = variant;
    if (kernel != Kernel::shade) needed.needs = {};
    return needed;
}

// ---- Programs ----------------------------------------------------------------------------------

gl::ComposedShader Shaders::compose(const std::string& stage, const std::vector<std::string>& files,
                                    const Variant& variant, Role role) const {
    std::vector<gl::ShaderConstant> constants =
        prepared_.constants(variant.counters, variant.casting ? nullptr : &variant.needs);
    const auto bytes_per_texel = [&](const char* name) {
        const TextureData& texture = prepared_.inputs.texture(name);
        return static_cast<int32_t>(texture.channels *
                                    (texture.format == ChannelFormat::half ? 2 : 4));
    };
    constants.push_back({"casting", variant.casting});
    constants.push_back({"copy_only", role == Role::copy});
    constants.push_back({"over_all_rays", role == Role::over_all_rays});
    constants.push_back({"cell_bytes", bytes_per_texel("cells")});
    constants.push_back({"reference_bytes", bytes_per_texel("references")});
    std::vector<std::string> all_files = {
        fmt::format("storage/{}/{}.glsl", prepared_.info.structure, prepared_.storage)};
    all_files.insert(all_files.end(), files.begin(), files.end());
    return library_.compose({.glsl_version = glsl_version_,
                             .stage = stage,
                             .files = all_files,
                             .constants = std::move(constants)});
}

gl::Program Shaders::program(const std::string& name,
                             const std::vector<gl::ComposedShader>& stages) const {
    gl::Program program("streaming " + name, stages);
    // A kernel drops the textures and uniforms that it does not need.
    for (const gl::Texture& texture : scene_textures_) {
        program.set_texture(texture.name(), texture, gl::Missing::allowed);
    }
    for (const UniformData& uniform : prepared_.inputs.uniforms) {
        std::visit(
            [&](const auto& value) {
                program.set_uniform(uniform.name, value, gl::Missing::allowed);
            },
            uniform.value);
    }
    return program;
}

gl::Program Shaders::fragment_program(const std::vector<std::string>& files, const Variant& variant,
                                      Role role) const {
    return program(files.back(), {compose("fragment", files, variant, role),
                                  library_.compose({.glsl_version = glsl_version_,
                                                    .stage = "vertex",
                                                    .files = {"entry/fullscreen.vert.glsl"},
                                                    .constants = {}})});
}

gl::Program Shaders::compute_program(const std::vector<std::string>& files, const Variant& variant,
                                     Role role) const {
    return program(files.back(), {compose("compute", files, variant, role)});
}

// ---- Counts and bytes --------------------------------------------------------------------------

void add(const Run& part, Run& whole) {
    for (const Kernel kernel : kAllKernels) {
        whole.of(kernel).passes += part.of(kernel).passes;
        whole.of(kernel).rays += part.of(kernel).rays;
    }
    whole.rounds += part.rounds;
    whole.ends += part.ends;
    whole.bytes_read += part.bytes_read;
    whole.bytes_written += part.bytes_written;
    whole.grid_bytes += part.grid_bytes;
    whole.time = sum(whole.time, part.time);
    whole.copy_time = sum(whole.copy_time, part.copy_time);
}

StateBytes kernel_bytes(Kernel kernel, const Variant& variant) {
    const uint64_t work = variant.counters ? kTexel : 0;
    uint64_t own = 0;
    uint64_t others = 0;
    switch (kernel) {
        case Kernel::traverse:
            own = kWalkTexels * kTexel + work;
            others = kRayBytes + kTexel;  // the ray, and t of its best hit
            break;
        case Kernel::intersect:
            own = kHitBytes + work;
            others = kRayBytes + 2 * kTexel;  // the ray, and where it stands
            break;
        case Kernel::shade:
            own = kPathBytes;
            others = kHitBytes;
            break;
    }
    return {.read = kControl + own + others, .written = kControl + own};
}

StateBytes generate_bytes(const Variant& variant) {
    return {.read = 0, .written = kControl + (variant.casting ? 0 : kPathBytes)};
}

StateBytes resolve_bytes(const Variant& variant) {
    const uint64_t work = variant.counters ? 2 * kTexel : 0;
    const uint64_t part = variant.casting ? kHitBytes : 3 * kTexel + 16;  // colour, primary hit
    return {.read = kControl + part + work, .written = 0};
}

void add_kernel_bytes(const Variant& variant, uint64_t rays, const StateBytes& overhead, Run& run) {
    for (const Kernel kernel : kAllKernels) {
        const StateBytes bytes = kernel_bytes(kernel, variant);
        run.bytes_read += run.of(kernel).rays * (bytes.read + overhead.read);
        run.bytes_written += run.of(kernel).rays * (bytes.written + overhead.written);
    }
    run.bytes_read += rays * resolve_bytes(variant).read;
    run.bytes_written += rays * generate_bytes(variant).written;
}

// ---- Time --------------------------------------------------------------------------------------

void Clock::time_run(const std::function<void()>& run) const {
    if (measures_copies_) {
        run();  // its parts are timed
    } else {
        run_.time = gl::finish_and_time(context_, run);
    }
}

void Clock::time_part(const std::function<void()>& part) const {
    if (measures_copies_) {
        run_.time = sum(run_.time, gl::finish_and_time(context_, part));
    } else {
        part();
    }
}

void Clock::time_copy(const std::function<void()>& copy) const {
    if (measures_copies_) run_.copy_time = sum(run_.copy_time, gl::finish_and_time(context_, copy));
}

}  // namespace onepass::streaming
