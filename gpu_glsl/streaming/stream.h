// What the raster and the compute form of streaming share: kernels, programs, counts and bytes.
//
// A ray is in one of three kernels' hands at a time. A form keeps the state of all rays, runs a
// pass for each kernel in turn over the rays that wait for it, and stops when none waits.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/scene_needs.h"
#include "gpu_glsl/gl/context.h"
#include "gpu_glsl/gl/objects.h"
#include "gpu_glsl/gl/shader_library.h"
#include "gpu_glsl/prepared_strategy.h"

namespace onepass::streaming {

/// In the order of their turns (shaders/shared/streaming_layout.h).
enum class Kernel { traverse, intersect, shade };
inline constexpr Kernel kAllKernels[] = {Kernel::traverse, Kernel::intersect, Kernel::shade};

inline size_t index_of(Kernel kernel) { return static_cast<size_t>(kernel); }
std::string to_string(Kernel kernel);

/// What the programs and the state of a run depend on.
struct Variant {
    bool casting = false;  ///< given rays; else an image
    bool counters = false;
    SceneNeeds needs;  ///< of an image

    /// Given rays are not shaded.
    bool uses(Kernel kernel) const { return kernel != Kernel::shade || !casting; }

    bool operator==(const Variant&) const = default;
};

/// The part of a variant that a kernel's text depends on: only shade asks what the image needs.
Variant needed_by(Kernel kernel, const Variant& variant);

/// What a program does with the state.
enum class Role {
    kernel,
    copy,          ///< moves the bytes that the kernel moves
    over_all_rays  ///< generate and resolve: no kernel, and no ray is left out
};

/// Composes the programs, and gives them the scene's textures and uniforms.
class Shaders {
  public:
    /// All arguments must outlive it.
    Shaders(const PreparedStrategy& prepared, const gl::ShaderLibrary& library,
            const std::vector<gl::Texture>& scene_textures, int glsl_version)
        : prepared_(prepared),
          library_(library),
          scene_textures_(scene_textures),
          glsl_version_(glsl_version) {}

    /// `files`: after the storage's.
    gl::ComposedShader compose(const std::string& stage, const std::vector<std::string>& files,
                               const Variant& variant, Role role) const;
    gl::Program fragment_program(const std::vector<std::string>& files, const Variant& variant,
                                 Role role) const;
    gl::Program compute_program(const std::vector<std::string>& files, const Variant& variant,
                                Role role) const;

  private:
    gl::Program program(const std::string& name,
                        const std::vector<gl::ComposedShader>& stages) const;

    const PreparedStrategy& prepared_;
    const gl::ShaderLibrary& library_;
    const std::vector<gl::Texture>& scene_textures_;
    int glsl_version_;
};

/// What one kernel did in a run.
struct KernelWork {
    uint64_t passes = 0;
    uint64_t rays = 0;  ///< handled by these passes; a ray counts once a pass
};

/// What a run did. Bytes are those of the state: control words, walks, hits, paths, queues, masks;
/// neither the grid's nor the results'.
struct Run {
    std::array<KernelWork, 3> kernels;
    uint64_t rounds = 0;  ///< each has one more pass, that masks (raster) or turns queues (compute)
    uint64_t ends = 0;    ///< passes of generate and resolve
    uint64_t bytes_read = 0;
    uint64_t bytes_written = 0;
    uint64_t grid_bytes = 0;  ///< 0 without counters
    gl::LaunchTime time;
    gl::LaunchTime copy_time;  ///< of the replay by copies, if measured

    KernelWork& of(Kernel kernel) { return kernels[index_of(kernel)]; }
    const KernelWork& of(Kernel kernel) const { return kernels[index_of(kernel)]; }
};

/// Adds another run's counts and times.
void add(const Run& part, Run& whole);

/// Bytes of state that one ray's run of a kernel reads and writes, the control word included: by
/// the loads and stores of shaders/streaming/NAME.glsl.
struct StateBytes {
    uint64_t read = 0;
    uint64_t written = 0;
};
StateBytes kernel_bytes(Kernel kernel, const Variant& variant);
StateBytes generate_bytes(const Variant& variant);
StateBytes resolve_bytes(const Variant& variant);

/// Adds the bytes of generate, resolve and all kernel passes of `run` over `rays` rays. `overhead`:
/// what the form moves beside that in a ray's run of a kernel.
void add_kernel_bytes(const Variant& variant, uint64_t rays, const StateBytes& overhead, Run& run);

/// Times the parts of a run. While copies are measured, each part is timed apart, which costs two
/// glFinish a part; else the whole run is timed at once.
class Clock {
  public:
    Clock(const gl::GlContext& context, bool measures_copies, Run& run)
        : context_(context), measures_copies_(measures_copies), run_(run) {}

    bool measures_copies() const { return measures_copies_; }

    /// The whole run.
    void time_run(const std::function<void()>& run) const;
    /// A part of it.
    void time_part(const std::function<void()>& part) const;
    /// The same part by copies; does nothing unless these are measured.
    void time_copy(const std::function<void()>& copy) const;

  private:
    const gl::GlContext& context_;
    bool measures_copies_;
    Run& run_;
};

}  // namespace onepass::streaming
