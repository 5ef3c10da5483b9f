#include "gpu_glsl/streaming/streaming_tracer.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "core/camera.h"
#include "core/error.h"
#include "core/scene_needs.h"
#include "gpu_glsl/device_io.h"
#include "gpu_glsl/streaming/compute_stream.h"
#include "gpu_glsl/streaming/raster_stream.h"
#include "gpu_glsl/streaming/stream.h"

namespace onepass {
namespace {

using glm::uint;
#include "gpu_glsl/shaders/shared/streaming_layout.h"

/// Steps a pass takes, unless a user says otherwise. See gpu_glsl/README.md.
constexpr const char* kDefaultSteps = "16";

void check_range(const char* what, uint32_t value, uint32_t most) {
    if (value <= most) return;
    throw Error({"streaming", fmt::format("{} {}", value, what), fmt::format("at most {}", most),
                 "The rest of a ray's control word has no room for more: use another tracer."});
}

template <class Stream>
class StreamingTracer final : public Tracer {
  public:
    StreamingTracer(std::string name, PreparedStrategy prepared, GpuEntry entry,
                    const gl::ShaderLibrary& library, gl::GlContext& context, size_t max_rays)
        : name_(std::move(name)),
          prepared_(std::move(prepared)),
          context_(context),
          max_rays_(max_rays),
          measures_copies_(prepared_.params.integer("measure_copy") != 0),
          shaders_(prepared_, library, textures_,
                   glsl_version_for(prepared_.info, entry, context.description().gl)) {
        const long steps = prepared_.params.integer("steps_per_pass");
        if (steps < 1) {
            throw Error({"--param steps_per_pass", fmt::format("{}", steps), "at least 1",
                         "Purcell's is 1: one cell or one triangle a pass."});
        }
        for (TextureData& texture : prepared_.inputs.textures) {
            textures_.push_back(upload_texture(texture));
            // The device has it now: give the memory back.
            give_back(texture.texels);
        }
        shader_hash_ = gl::fnv1a_hex(Stream::cast_text(shaders_));
    }

    const std::string& name() const override { return name_; }

    Capabilities capabilities() const override {
        const gl::GlDescription& description = context_.description();
        Capabilities capabilities;
        capabilities.counters = true;
        capabilities.device_timer = !description.software;
        capabilities.software_renderer = description.software;
        capabilities.device = description.renderer;
        capabilities.shader_hash = shader_hash_;
        return capabilities;
    }

    std::vector<Stat> stats() const override { return prepared_.stats; }

    RayBatch upload(std::span<const Ray> rays) override {
        auto resident = std::make_shared<RaysOnDevice>();
        for (size_t first = 0; first < rays.size(); first += max_rays_) {
            resident->chunks.push_back(
                Stream::upload(rays.subspan(first, std::min(max_rays_, rays.size() - first))));
        }
        return {rays.size(), std::move(resident)};
    }

    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        CastResult result;
        result.hits.reserve(batch.count);
        result.flags.reserve(batch.count);
        const auto& rays = *static_cast<const RaysOnDevice*>(batch.resident.get());
        streaming::Run whole;
        for (const ChunkOnDevice& chunk : rays.chunks) {
            Stream& stream =
                stream_for({.casting = true, .counters = options.counters, .needs = {}});
            streaming::add(stream.cast(chunk, result), whole);
        }
        result.wall_ms = whole.time.wall_ms;
        result.device_ms = whole.time.device_ms;
        result.costs = costs(whole, options.counters);
        return result;
    }

    UpdateTimes update(std::span<const Affine>) override {
        throw Error({name_, "an update", "a tracer that moves instances",
                     "Make a new tracer for each frame, or use the strategy paper."});
    }

    Frame render(const Camera& camera, const RenderSettings& settings) override {
        const SceneNeeds needs = scene_needs(*prepared_.scene, settings);
        check_range("lights", needs.light_count, kLightMask - 1);
        check_range("mirror bounces", needs.max_depth, kDepthMask);
        Frame frame;
        frame.width = settings.width;
        frame.height = settings.height;
        const CameraFrame view = camera_frame(camera, settings.width, settings.height);

        // In bands of whole rows, as many as may be in flight.
        const auto band_rows = static_cast<uint32_t>(
            std::max<size_t>(1, max_rays_ / std::max<uint32_t>(1, settings.width)));
        streaming::Run whole;
        for (uint32_t row = 0; row < settings.height; row += band_rows) {
            Stream& stream =
                stream_for({.casting = false, .counters = settings.aovs, .needs = needs});
            streaming::add(
                stream.render(view, settings.width, row, std::min(band_rows, settings.height - row),
                              settings.aovs, frame),
                whole);
        }
        frame.wall_ms = whole.time.wall_ms;
        frame.device_ms = whole.time.device_ms;
        frame.costs = costs(whole, settings.aovs);
        return frame;
    }

  private:
    struct VariantStream {
        streaming::Variant variant;
        Stream stream;
    };

    /// The variant's programs; the others give their state's memory back.
    Stream& stream_for(const streaming::Variant& variant) {
        for (VariantStream& other : streams_) {
            if (other.variant != variant) other.stream.release();
        }
        const auto found = std::ranges::find(streams_, variant, &VariantStream::variant);
        if (found != streams_.end()) return found->stream;
        return streams_
            .emplace_back(
                VariantStream{variant, Stream(shaders_, context_, variant, measures_copies_)})
            .stream;
    }

    std::vector<Stat> costs(const streaming::Run& run, bool counters) const {
        using streaming::Kernel;
        const auto number = [](uint64_t value) { return static_cast<double>(value); };
        uint64_t passes = run.rounds + run.ends;
        for (const streaming::KernelWork& work : run.kernels) passes += work.passes;
        std::vector<Stat> stats = {{"passes", number(passes), "of all kinds"}};
        for (const Kernel kernel : streaming::kAllKernels) {
            stats.push_back({"passes_" + to_string(kernel), number(run.of(kernel).passes), ""});
        }
        stats.push_back({Stream::kRoundPass, number(run.rounds), ""});
        for (const Kernel kernel : streaming::kAllKernels) {
            stats.push_back({"rays_" + to_string(kernel), number(run.of(kernel).rays),
                             "handled by these passes; a ray counts once a pass"});
        }
        stats.push_back({"state_bytes_read", number(run.bytes_read), "counted, not measured"});
        stats.push_back({"state_bytes_written", number(run.bytes_written), "counted likewise"});
        if (counters) {
            stats.push_back({"grid_bytes_read", number(run.grid_bytes),
                             "by the fetches of the shader text; caches not considered"});
        }
        if (measures_copies_) {
            const bool timer = !std::isnan(run.copy_time.device_ms);
            stats.push_back({"copy_ms", timer ? run.copy_time.device_ms : run.copy_time.wall_ms,
                             timer ? "device time; compare with device_ms of this run"
                                   : "wall time; compare with wall_ms of this run"});
        }
        return stats;
    }

    std::string name_;
    PreparedStrategy prepared_;
    gl::GlContext& context_;
    size_t max_rays_;  // in flight
    bool measures_copies_;
    std::vector<gl::Texture> textures_;
    streaming::Shaders shaders_;
    std::deque<VariantStream> streams_;  // a deque: the programs stay where they are
    std::string shader_hash_;
};

}  // namespace

gl::StrategyInfo streaming_info(const gl::StrategyInfo& paper) {
    using Type = ParamInfo::Type;
    gl::StrategyInfo info = paper;
    info.name = "streaming";
    info.summary = "the paper's grid and arithmetic in many passes, the rays' state in memory";
    info.source =
        "Purcell, Buck, Mark, Hanrahan, Ray Tracing on Programmable Graphics Hardware, 2002";
    info.entries = {"fragment", "compute"};
    info.twin = false;
    info.no_twin_reason = "its unit of work is a pass; compare it with paper, bit by bit";
    info.params.push_back({"steps_per_pass",
                           Type::integer,
                           kDefaultSteps,
                           "cells a traverse pass walks, and triangles an intersect pass tests",
                           {}});
    info.params.push_back({"measure_copy",
                           Type::integer,
                           "0",
                           "1 also times copies that move the same bytes (cost copy_ms)",
                           {}});
    return info;
}

std::unique_ptr<Tracer> make_streaming_tracer(std::string name, PreparedStrategy prepared,
                                              GpuEntry entry, const gl::ShaderLibrary& library,
                                              gl::GlContext& context, size_t max_rays_in_flight) {
    if (entry == GpuEntry::compute) {
        return std::make_unique<StreamingTracer<streaming::ComputeStream>>(
            std::move(name), std::move(prepared), entry, library, context, max_rays_in_flight);
    }
    return std::make_unique<StreamingTracer<streaming::RasterStream>>(
        std::move(name), std::move(prepared), entry, library, context, max_rays_in_flight);
}

}  // namespace onepass
