#include "gpu_glsl/streaming/raster_stream.h"

#include <algorithm>

#include <fmt/format.h>

namespace onepass::streaming {
namespace {

using glm::uint;
#include "gpu_glsl/shaders/shared/streaming_layout.h"

/// Rounds between drawing a pass and reading how many fragments ran: by then the GPU has finished
/// it.
constexpr size_t kCountDelay = 3;

/// Shade is drawn in every so many rounds: rays wait for it a little, and it finds more of them.
constexpr uint64_t kShadeInterval = 2;

/// Locations of the fragment outputs that come after texels of floats and integers.
constexpr uint32_t kWorkLocation = 6;
constexpr uint32_t kControlLocation = 7;

/// One texture of a kernel's part: its place, and what follows the part's name in a sampler's.
struct Piece {
    uint32_t location;
    std::string suffix;
    gl::TexelFormat format;
};

constexpr const char* kPartNames[] = {"walk", "hit", "path"};

std::vector<Piece> pieces_of(Kernel kernel, const Variant& variant) {
    if (!variant.uses(kernel)) return {};
    constexpr int kTexels[] = {kWalkTexels, kHitTexels, kPathTexels};
    std::vector<Piece> pieces;
    for (int i = 0; i < kTexels[index_of(kernel)]; ++i) {
        pieces.push_back(
            {static_cast<uint32_t>(i), fmt::format("{}", i), gl::TexelFormat::rgba32f});
    }
    if (kernel == Kernel::intersect) {
        pieces.push_back({kHitTexels, "_ids", gl::TexelFormat::rg32ui});
    }
    if (kernel == Kernel::shade) {
        pieces.push_back({kPathTexels, "_ids", gl::TexelFormat::rgba32ui});
    }
    if (kernel != Kernel::shade && variant.counters) {
        pieces.push_back({kWorkLocation, "_work", gl::TexelFormat::rgba32ui});
    }
    return pieces;
}

std::string state_file(const std::string& name) {
    return fmt::format("streaming/raster/{}_state.glsl", name);
}

std::vector<std::string> kernel_files(Kernel kernel, bool casting) {
    const std::string name = to_string(kernel);
    const std::string text = fmt::format("streaming/{}.glsl", name);
    if (kernel == Kernel::shade) return {state_file(name), text};  // it makes rays, and reads none
    const char* const ray = casting ? "cast_ray" : "path_ray";
    return {state_file(name), fmt::format("streaming/raster/{}.glsl", ray), text};
}

std::vector<std::string> generate_files(const Variant& variant) {
    if (variant.casting) return {state_file("generate_cast"), "streaming/generate_cast.glsl"};
    return {state_file("shade"), "streaming/generate_frame.glsl"};
}

std::vector<std::string> resolve_files(const Variant& variant) {
    const std::string name = variant.casting ? "resolve_cast" : "resolve_frame";
    return {state_file(name), fmt::format("streaming/{}.glsl", name)};
}

/// The side that a kernel's next pass writes: 1, 0, 1, ... (generate writes side 0).
int written_side(uint64_t passes_so_far) { return passes_so_far % 2 == 0 ? 1 : 0; }

/// Knows when no ray is left. A waiting ray runs in one of the next two passes of its kernel,
/// because one of them writes the side on which the ray's state does not lie. So once every kernel
/// has been drawn twice, in rounds after the last fragment ran, no ray waits.
class Silence {
  public:
    explicit Silence(const Variant& variant) {
        for (const Kernel kernel : kAllKernels) {
            if (!variant.uses(kernel)) quiet_passes_[index_of(kernel)] = kEnough;
        }
        at_start_ = quiet_passes_;
    }

    void hear_round(const std::vector<std::pair<Kernel, uint64_t>>& fragments_of_passes) {
        for (const auto& [kernel, fragments] : fragments_of_passes) {
            ++quiet_passes_[index_of(kernel)];
            if (fragments > 0) any_ran_ = true;
        }
        if (any_ran_) quiet_passes_ = at_start_;
        any_ran_ = false;
    }

    bool lasts() const {
        return std::ranges::all_of(quiet_passes_, [](int passes) { return passes >= kEnough; });
    }

  private:
    static constexpr int kEnough = 2;
    std::array<int, 3> quiet_passes_{};
    std::array<int, 3> at_start_{};
    bool any_ran_ = false;
};

}  // namespace

// ---- Programs and state ------------------------------------------------------------------------

RasterStream::RasterStream(const Shaders& shaders, const gl::GlContext& context,
                           const Variant& variant, bool measures_copies)
    : context_(context),
      variant_(variant),
      measures_copies_(measures_copies),
      generate_(shaders.fragment_program(generate_files(variant), variant, Role::over_all_rays)),
      mask_(shaders.fragment_program({"streaming/raster/mask.glsl"}, variant, Role::kernel)),
      resolve_(shaders.fragment_program(resolve_files(variant), variant, Role::over_all_rays)) {
    for (const Kernel kernel : kAllKernels) {
        if (!variant.uses(kernel)) continue;
        const Variant needed = needed_by(kernel, variant);
        const std::vector<std::string> files = kernel_files(kernel, variant.casting);
        KernelPrograms programs{shaders.fragment_program(files, needed, Role::kernel), {}};
        if (measures_copies) {
            programs.copy = shaders.fragment_program(files, needed, Role::copy);
        }
        kernels_.push_back(std::move(programs));
    }
}

std::string RasterStream::cast_text(const Shaders& shaders) {
    const Variant variant{.casting = true, .counters = false, .needs = {}};
    std::string text;
    for (const Kernel kernel : {Kernel::traverse, Kernel::intersect}) {
        text += shaders.compose("fragment", kernel_files(kernel, true), variant, Role::kernel).text;
    }
    return text;
}

RasterStream::State::State(const Variant& variant, uint32_t state_width, uint32_t state_height)
    : width(state_width),
      height(state_height),
      control(gl::texture_2d("control", gl::TexelFormat::r32ui, width, height)),
      control_copy(gl::texture_2d("control_copy", gl::TexelFormat::r32ui, width, height)),
      depth(width, height),
      control_target({nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, &control},
                     nullptr),
      mask_target({&control_copy}, &depth) {
    for (const Kernel kernel : kAllKernels) {
        const std::vector<Piece> pieces = pieces_of(kernel, variant);
        if (pieces.empty()) continue;
        Part& part = parts[index_of(kernel)];
        for (int side = 0; side < 2; ++side) {
            part.sides[side].resize(kLocations);
            std::vector<const gl::Texture*> by_location(kLocations, nullptr);
            by_location[kControlLocation] = &control;
            for (const Piece& piece : pieces) {
                std::optional<gl::Texture>& texture = part.sides[side][piece.location];
                texture = gl::texture_2d(
                    fmt::format("{}{}_{}", kPartNames[index_of(kernel)], piece.suffix, side),
                    piece.format, width, height);
                by_location[piece.location] = &*texture;
            }
            part.targets[side].emplace(by_location, &depth);
        }
    }
}

void RasterStream::prepare_state(uint32_t width, uint32_t height) {
    if (!state_ || state_->width != width || state_->height != height) {
        state_.reset();  // before its successor takes memory
        state_.emplace(variant_, width, height);
        bind_state(generate_, Kernel::shade);
        bind_state(resolve_, std::nullopt);
        // Once all have finished, the control words themselves may be read.
        resolve_.set_texture("control_copy", state_->control);
        mask_.set_texture("control_words", state_->control);
        for (const Kernel kernel : kAllKernels) {
            if (!variant_.uses(kernel)) continue;
            KernelPrograms& programs = kernels_[index_of(kernel)];
            bind_state(programs.kernel, kernel);
            if (programs.copy) bind_state(*programs.copy, kernel);
        }
    }
    if (!variant_.counters) return;
    for (const Kernel kernel : {Kernel::traverse, Kernel::intersect}) {
        state_->parts[index_of(kernel)].targets[0]->clear_uints(kWorkLocation);
    }
}

void RasterStream::bind_state(gl::Program& program, std::optional<Kernel> own) const {
    program.set_texture("control_copy", state_->control_copy, gl::Missing::allowed);
    for (const Kernel kernel : kAllKernels) {
        if (kernel == own) continue;  // draw_kernel() binds one side
        for (const auto& side : state_->parts[index_of(kernel)].sides) {
            for (const std::optional<gl::Texture>& texture : side) {
                if (!texture) continue;
                program.set_texture(texture->name(), *texture, gl::Missing::allowed);
            }
        }
    }
}

// ---- Runs --------------------------------------------------------------------------------------

Run RasterStream::cast(const ChunkOnDevice& chunk, CastResult& result) {
    const uvec2 fragments = chunk.fragments();
    prepare_state(fragments.x, fragments.y);
    for (KernelPrograms& programs : kernels_) {
        for (gl::Program* program : {&programs.kernel, programs.copy ? &*programs.copy : nullptr}) {
            if (program == nullptr) continue;
            chunk.give_to(*program);
        }
    }
    std::vector<gl::TexelFormat> targets = {gl::TexelFormat::rgba32f, gl::TexelFormat::rgba32ui};
    if (variant_.counters) targets.push_back(gl::TexelFormat::rgba32ui);
    const gl::Framebuffer results(fragments.x, fragments.y, targets);
    Run done = run(results);
    done.grid_bytes = append_hits(results, chunk.count, variant_.counters, result);
    return done;
}

Run RasterStream::render(const CameraFrame& camera, uint32_t width, uint32_t first_row,
                         uint32_t rows, bool aovs, Frame& frame) {
    prepare_state(width, rows);
    for (gl::Program* program : {&generate_, &resolve_}) {
        program->set_uniform("camera_eye", camera.eye, gl::Missing::allowed);
        program->set_uniform("camera_corner", camera.corner, gl::Missing::allowed);
        program->set_uniform("camera_dx", camera.dx, gl::Missing::allowed);
        program->set_uniform("camera_dy", camera.dy, gl::Missing::allowed);
        program->set_uniform("first_row", static_cast<int32_t>(first_row), gl::Missing::allowed);
    }
    using enum gl::TexelFormat;
    std::vector<gl::TexelFormat> targets = {rgba32f};
    if (aovs) targets.insert(targets.end(), {rgba32f, rgba32ui, rgba32f, rgba32ui});
    const gl::Framebuffer results(width, rows, targets);
    Run done = run(results);
    done.grid_bytes = append_pixels(results, aovs, frame);
    return done;
}

Run RasterStream::run(const gl::Framebuffer& results) {
    Run done;
    const Clock clock(context_, measures_copies_, done);
    clock.time_run([&] {
        clock.time_part([&] {
            const Part& path = state_->parts[index_of(Kernel::shade)];
            gl::draw_pass(generate_, variant_.casting ? state_->control_target : *path.targets[0],
                          gl::DepthUse::none);
        });
        run_rounds(clock, done);
        clock.time_part([&] { gl::draw_fullscreen(resolve_, results); });
    });
    done.ends = 2;

    // The mask of a round reads every control word and writes it and a depth.
    const uint64_t rays = uint64_t{state_->width} * state_->height;
    add_kernel_bytes(variant_, rays, {}, done);
    done.bytes_read += done.rounds * rays * 4;
    done.bytes_written += done.rounds * rays * 8;
    return done;
}

void RasterStream::run_rounds(const Clock& clock, Run& run) {
    std::deque<std::vector<CountedPass>> unread;  // rounds whose counts have not been read
    size_t counts_used = 0;
    Silence silence(variant_);
    const auto read_oldest_round = [&] {
        std::vector<std::pair<Kernel, uint64_t>> fragments;
        for (const CountedPass& pass : unread.front()) {
            const uint64_t ran = counts_[pass.count].result();
            run.of(pass.kernel).rays += ran;
            fragments.push_back({pass.kernel, ran});
        }
        unread.pop_front();
        silence.hear_round(fragments);
    };

    for (uint64_t round = 0; !silence.lasts(); ++round) {
        // Which kernels run, and which side each of them writes.
        std::vector<std::pair<Kernel, int>> passes;
        uint32_t written_sides = 0;
        for (const Kernel kernel : kAllKernels) {
            if (!variant_.uses(kernel)) continue;
            const int side = written_side(run.of(kernel).passes);
            if (side == 1) written_sides |= kWalkSide << index_of(kernel);
            const bool due = kernel != Kernel::shade || round % kShadeInterval == 1;
            if (due) passes.push_back({kernel, side});
        }
        mask_.set_uniform("written_sides", written_sides);

        // A copy writes where its kernel then writes, so it disturbs nothing.
        clock.time_copy([&] {
            gl::draw_pass(mask_, state_->mask_target, gl::DepthUse::write);
            for (const auto& [kernel, side] : passes) draw_kernel(kernel, true, side);
        });
        clock.time_part([&] {
            gl::draw_pass(mask_, state_->mask_target, gl::DepthUse::write);
            std::vector<CountedPass>& counted = unread.emplace_back();
            for (const auto& [kernel, side] : passes) {
                if (counts_used == counts_.size()) counts_.emplace_back();
                counts_[counts_used].begin();
                draw_kernel(kernel, false, side);
                counts_[counts_used].end();
                counted.push_back({kernel, counts_used++});
                ++run.of(kernel).passes;
            }
        });
        ++run.rounds;
        if (unread.size() > kCountDelay) read_oldest_round();
    }
    while (!unread.empty()) read_oldest_round();
}

void RasterStream::draw_kernel(Kernel kernel, bool copy, int written_side) {
    const Part& part = state_->parts[index_of(kernel)];
    KernelPrograms& programs = kernels_[index_of(kernel)];
    gl::Program& program = copy ? *programs.copy : programs.kernel;
    const size_t name_length = std::string(kPartNames[index_of(kernel)]).size();
    for (const std::optional<gl::Texture>& texture : part.sides[1 - written_side]) {
        if (!texture) continue;
        // "walk3_0" is the kernel's "own3".
        const std::string& name = texture->name();
        program.set_texture("own" + name.substr(name_length, name.size() - name_length - 2),
                            *texture, gl::Missing::allowed);
    }
    gl::draw_pass(program, *part.targets[written_side], gl::DepthUse::only_equal,
                  static_cast<float>(kPassDepths) * static_cast<float>(index_of(kernel) + 1));
}

}  // namespace onepass::streaming
