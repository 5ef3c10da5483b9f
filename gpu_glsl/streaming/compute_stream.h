// Streaming in its compute form: the state in buffers, in place, a pass an indirect dispatch over a
// queue.
//
// A round dispatches each kernel over the rays that wait for it; a last, tiny dispatch turns the
// queues over (shaders/streaming/compute/queues.glsl). The CPU looks at the queues' lengths every
// few rounds and stops when all are empty.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/tracer.h"
#include "gpu_glsl/device_io.h"
#include "gpu_glsl/gl/passes.h"
#include "gpu_glsl/streaming/stream.h"

namespace onepass::streaming {

class ComputeStream {
  public:
    /// What the pass that each round has beside its kernels' is called among the costs.
    static constexpr const char* kRoundPass = "passes_queue";

    /// `context` must outlive it.
    ComputeStream(const Shaders& shaders, const gl::GlContext& context, const Variant& variant,
                  bool measures_copies);

    static ChunkOnDevice upload(std::span<const Ray> rays) { return upload_to_buffer(rays); }
    /// The text of all kernels of a run over given rays.
    static std::string cast_text(const Shaders& shaders);

    Run cast(const ChunkOnDevice& chunk, CastResult& result);
    /// Rows first_row ... first_row + rows - 1 of an image, added to `frame`.
    Run render(const CameraFrame& camera, uint32_t width, uint32_t first_row, uint32_t rows,
               bool aovs, Frame& frame);

    /// Gives the state's memory back; the next run takes new.
    void release() { state_.reset(); }

  private:
    struct State {
        State(const Variant& variant, size_t rays);

        size_t rays;
        gl::Buffer control;
        gl::Buffer walks;
        gl::Buffer hits;
        gl::Buffer hit_ids;
        gl::Buffer paths;
        gl::Buffer path_ids;
        gl::Buffer work;
        gl::Buffer queues;
        gl::Buffer queue_heads;
    };

    struct KernelPrograms {
        gl::Program kernel;
        std::optional<gl::Program> copy;
    };

    void prepare_state(size_t rays);
    void for_all_programs(const std::function<void(gl::Program&)>& action);
    Run run();
    void run_rounds(const Clock& clock, Run& run);
    uint64_t waiting(int parity) const;

    const gl::GlContext& context_;
    Variant variant_;
    bool measures_copies_;
    gl::Program generate_;
    gl::Program queues_;
    std::optional<gl::Program> queues_copy_;
    std::vector<KernelPrograms> kernels_;
    gl::Program resolve_;
    std::optional<State> state_;
};

}  // namespace onepass::streaming
