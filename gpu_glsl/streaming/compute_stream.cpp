#include "gpu_glsl/streaming/compute_stream.h"

#include <cstddef>
#include <functional>

#include <fmt/format.h>

namespace onepass::streaming {
namespace {

using glm::uint;
#include "gpu_glsl/shaders/shared/streaming_layout.h"

static_assert(sizeof(QueueHead) == 32 && offsetof(QueueHead, count) == 12,
              "std430 lays it out so, and an indirect dispatch reads its first three members");

/// Empty queues.
std::vector<QueueHead> empty_queues() {
    QueueHead empty{};
    empty.groups_y = 1;
    empty.groups_z = 1;
    // Copies write behind the heads that are in use.
    return std::vector<QueueHead>(2 * kQueues, empty);
}

/// Rounds between two looks at the queues. A look waits for the GPU, an idle round costs a few
/// empty dispatches.
constexpr uint64_t kRoundsPerLook = 8;

std::vector<std::string> kernel_files(Kernel kernel) {
    const char* state = kernel == Kernel::shade ? "shade_state" : "walk_state";
    return {fmt::format("streaming/compute/{}.glsl", state),
            fmt::format("streaming/{}.glsl", to_string(kernel))};
}

std::vector<std::string> generate_files(const Variant& variant) {
    if (variant.casting) {
        return {"streaming/compute/state.glsl", "streaming/generate_cast.glsl"};
    }
    return {"streaming/compute/path_state.glsl", "streaming/generate_frame.glsl"};
}

std::vector<std::string> resolve_files(const Variant& variant) {
    const std::string name = variant.casting ? "resolve_cast" : "resolve_frame";
    return {fmt::format("streaming/compute/{}_state.glsl", name),
            fmt::format("streaming/{}.glsl", name)};
}

size_t head_offset(Kernel kernel, int parity) {
    return (2 * index_of(kernel) + static_cast<size_t>(parity)) * sizeof(QueueHead);
}

uvec3 groups_for(size_t rays) {
    return uvec3((rays + kQueueGroupSize - 1) / kQueueGroupSize, 1, 1);
}

}  // namespace

// ---- Programs and state ------------------------------------------------------------------------

ComputeStream::ComputeStream(const Shaders& shaders, const gl::GlContext& context,
                             const Variant& variant, bool measures_copies)
    : context_(context),
      variant_(variant),
      measures_copies_(measures_copies),
      generate_(shaders.compute_program(generate_files(variant), variant, Role::over_all_rays)),
      queues_(shaders.compute_program({"streaming/compute/queues.glsl"}, variant, Role::kernel)),
      resolve_(shaders.compute_program(resolve_files(variant), variant, Role::over_all_rays)) {
    if (measures_copies) {
        queues_copy_ =
            shaders.compute_program({"streaming/compute/queues.glsl"}, variant, Role::copy);
    }
    for (const Kernel kernel : kAllKernels) {
        if (!variant.uses(kernel)) continue;
        const Variant needed = needed_by(kernel, variant);
        KernelPrograms programs{shaders.compute_program(kernel_files(kernel), needed, Role::kernel),
                                {}};
        if (measures_copies) {
            programs.copy = shaders.compute_program(kernel_files(kernel), needed, Role::copy);
        }
        for (gl::Program* program : {&programs.kernel, programs.copy ? &*programs.copy : nullptr}) {
            if (program == nullptr) continue;
            program->set_uniform("kernel", static_cast<int32_t>(index_of(kernel)));
        }
        kernels_.push_back(std::move(programs));
    }
}

std::string ComputeStream::cast_text(const Shaders& shaders) {
    const Variant variant{.casting = true, .counters = false, .needs = {}};
    std::string text;
    for (const Kernel kernel : {Kernel::traverse, Kernel::intersect}) {
        text += shaders.compose("compute", kernel_files(kernel), variant, Role::kernel).text;
    }
    return text;
}

ComputeStream::State::State(const Variant& variant, size_t ray_count)
    : rays(ray_count),
      control("control", rays * sizeof(uint32_t)),
      walks("walks", rays * kWalkTexels * sizeof(vec4)),
      hits("hits", rays * kHitTexels * sizeof(vec4)),
      hit_ids("hit_ids", rays * sizeof(uvec2)),
      paths("paths", variant.casting ? 0 : rays * kPathTexels * sizeof(vec4)),
      path_ids("path_ids", variant.casting ? 0 : rays * sizeof(glm::uvec4)),
      work("work", variant.counters ? 2 * rays * sizeof(glm::uvec4) : 0),
      // More than there are: copies write behind them.
      queues("queues", (kQueues + 1) * rays * sizeof(uint32_t)),
      queue_heads(gl::Buffer::of("queue heads", empty_queues())) {}

void ComputeStream::for_all_programs(const std::function<void(gl::Program&)>& action) {
    action(generate_);
    action(queues_);
    if (queues_copy_) action(*queues_copy_);
    action(resolve_);
    for (KernelPrograms& programs : kernels_) {
        action(programs.kernel);
        if (programs.copy) action(*programs.copy);
    }
}

void ComputeStream::prepare_state(size_t rays) {
    if (!state_ || state_->rays != rays) {
        state_.reset();  // before its successor takes memory
        state_.emplace(variant_, rays);
        for_all_programs([&](gl::Program& program) {
            using enum gl::Missing;
            program.set_buffer("ControlBuffer", state_->control, allowed);
            program.set_buffer("WalkBuffer", state_->walks, allowed);
            program.set_buffer("HitStateBuffer", state_->hits, allowed);
            program.set_buffer("HitIdBuffer", state_->hit_ids, allowed);
            program.set_buffer("PathBuffer", state_->paths, allowed);
            program.set_buffer("PathIdBuffer", state_->path_ids, allowed);
            program.set_buffer("WorkBuffer", state_->work, allowed);
            program.set_buffer("QueueBuffer", state_->queues, allowed);
            program.set_buffer("QueueHeads", state_->queue_heads, allowed);
            // An image's rays are the first two texels of the paths.
            program.set_buffer("RayBuffer", state_->paths, allowed);
            program.set_uniform("ray_count", static_cast<int32_t>(rays), allowed);
        });
    }
    if (variant_.counters) gl::clear(state_->work);
    state_->queue_heads.write(empty_queues());
}

// ---- Runs --------------------------------------------------------------------------------------

Run ComputeStream::cast(const ChunkOnDevice& chunk, CastResult& result) {
    prepare_state(chunk.count);
    for_all_programs([&](gl::Program& program) {
        program.set_buffer("RayBuffer", *chunk.buffer, gl::Missing::allowed);
    });
    const AnswersOnDevice answers(chunk.count, variant_.counters);
    answers.give_to(resolve_);
    Run done = run();
    done.grid_bytes = append_hits(answers, chunk.count, result);
    return done;
}

Run ComputeStream::render(const CameraFrame& camera, uint32_t width, uint32_t first_row,
                          uint32_t rows, bool aovs, Frame& frame) {
    const size_t pixels = size_t{width} * rows;
    prepare_state(pixels);
    for (gl::Program* program : {&generate_, &resolve_}) {
        program->set_uniform("camera_eye", camera.eye, gl::Missing::allowed);
        program->set_uniform("camera_corner", camera.corner, gl::Missing::allowed);
        program->set_uniform("camera_dx", camera.dx, gl::Missing::allowed);
        program->set_uniform("camera_dy", camera.dy, gl::Missing::allowed);
        program->set_uniform("image_width", static_cast<int32_t>(width), gl::Missing::allowed);
        program->set_uniform("first_row", static_cast<int32_t>(first_row), gl::Missing::allowed);
    }
    const gl::Buffer results("pixels", pixels * sizeof(PixelRecord));
    resolve_.set_buffer("PixelBuffer", results);
    Run done = run();
    done.grid_bytes = append_pixels(results, pixels, aovs, frame);
    return done;
}

Run ComputeStream::run() {
    Run done;
    const Clock clock(context_, measures_copies_, done);
    clock.time_run([&] {
        // Generate fills the queues of parity 0: as if a round of parity 1 had done so.
        clock.time_part([&] {
            gl::dispatch(generate_, groups_for(state_->rays));
            queues_.set_uniform("parity", 1);
            gl::dispatch(queues_, uvec3(1));
        });
        ++done.rounds;
        run_rounds(clock, done);
        clock.time_part([&] { gl::dispatch(resolve_, groups_for(state_->rays)); });
    });
    done.ends = 2;

    const std::vector<QueueHead> heads = state_->queue_heads.read<QueueHead>();
    for (const Kernel kernel : kAllKernels) {
        for (size_t parity = 0; parity < 2; ++parity) {
            const QueueHead& head = heads[2 * index_of(kernel) + parity];
            done.of(kernel).rays += (uint64_t{head.runs_high} << 32) + head.runs_low;
        }
    }
    // Each run of a kernel takes a ray from a queue, into which another has put it.
    add_kernel_bytes(variant_, state_->rays, {.read = 4, .written = 4}, done);
    return done;
}

void ComputeStream::run_rounds(const Clock& clock, Run& run) {
    for (uint64_t round = 0;; ++round) {
        const int parity = static_cast<int>(round % 2);
        if (round % kRoundsPerLook == 0 && waiting(parity) == 0) break;
        const auto dispatch_round = [&](bool copies) {
            for (const Kernel kernel : kAllKernels) {
                if (!variant_.uses(kernel)) continue;
                KernelPrograms& programs = kernels_[index_of(kernel)];
                gl::Program& program = copies ? *programs.copy : programs.kernel;
                program.set_uniform("parity", parity);
                gl::dispatch_indirect(program, state_->queue_heads, head_offset(kernel, parity));
            }
            gl::barrier();
            gl::Program& queues = copies ? *queues_copy_ : queues_;
            queues.set_uniform("parity", parity);
            gl::dispatch(queues, uvec3(1));
        };
        clock.time_copy([&] { dispatch_round(true); });
        clock.time_part([&] { dispatch_round(false); });
        for (const Kernel kernel : kAllKernels) {
            if (variant_.uses(kernel)) ++run.of(kernel).passes;
        }
        ++run.rounds;
    }
}

/// Rays in the queues of one parity.
uint64_t ComputeStream::waiting(int parity) const {
    const std::vector<QueueHead> heads = state_->queue_heads.read<QueueHead>();
    uint64_t rays = 0;
    for (const Kernel kernel : kAllKernels) {
        rays += heads[2 * index_of(kernel) + static_cast<size_t>(parity)].count;
    }
    return rays;
}

}  // namespace onepass::streaming
