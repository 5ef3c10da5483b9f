// Streaming in its raster form: the state in ping-pong textures, each pass drawn over all of it.
//
// A round: one pass masks (shaders/streaming/raster/mask.glsl), then each kernel draws once under
// that mask. Occlusion queries count the fragments that ran; they are read some rounds late, so
// that the GPU never waits for the CPU, and the run stops when none ran.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/tracer.h"
#include "gpu_glsl/device_io.h"
#include "gpu_glsl/gl/passes.h"
#include "gpu_glsl/streaming/stream.h"

namespace onepass::streaming {

class RasterStream {
  public:
    /// What the pass that each round has beside its kernels' is called among the costs.
    static constexpr const char* kRoundPass = "passes_mask";

    /// `context` must outlive it.
    RasterStream(const Shaders& shaders, const gl::GlContext& context, const Variant& variant,
                 bool measures_copies);

    static ChunkOnDevice upload(std::span<const Ray> rays) { return upload_to_texels(rays); }
    /// The text of all kernels of a run over given rays.
    static std::string cast_text(const Shaders& shaders);

    Run cast(const ChunkOnDevice& chunk, CastResult& result);
    /// Rows first_row ... first_row + rows - 1 of an image, added to `frame`.
    Run render(const CameraFrame& camera, uint32_t width, uint32_t first_row, uint32_t rows,
               bool aovs, Frame& frame);

    /// Gives the state's memory back; the next run takes new.
    void release() { state_.reset(); }

  private:
    static constexpr size_t kLocations = 8;

    /// What one kernel owns: the same textures on two sides, by the location that writes them.
    struct Part {
        std::vector<std::optional<gl::Texture>> sides[2];
        std::optional<gl::PassTarget> targets[2];
    };

    struct State {
        State(const Variant& variant, uint32_t width, uint32_t height);

        uint32_t width;
        uint32_t height;
        std::array<Part, 3> parts;
        gl::Texture control;
        gl::Texture control_copy;
        gl::DepthBuffer depth;
        gl::PassTarget control_target;
        gl::PassTarget mask_target;
    };

    struct KernelPrograms {
        gl::Program kernel;
        std::optional<gl::Program> copy;
    };

    /// A pass whose samples are being counted.
    struct CountedPass {
        Kernel kernel;
        size_t count;  ///< index into counts_
    };

    void prepare_state(uint32_t width, uint32_t height);
    void bind_state(gl::Program& program, std::optional<Kernel> own) const;
    Run run(const gl::Framebuffer& results);
    void run_rounds(const Clock& clock, Run& run);
    void draw_kernel(Kernel kernel, bool copy, int written_side);

    const gl::GlContext& context_;
    Variant variant_;
    bool measures_copies_;
    gl::Program generate_;
    gl::Program mask_;
    std::vector<KernelPrograms> kernels_;
    gl::Program resolve_;
    std::optional<State> state_;
    std::deque<gl::SampleCount> counts_;  ///< one a kernel pass of a run; reused by the next run
};

}  // namespace onepass::streaming
