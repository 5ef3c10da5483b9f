#include "gpu_glsl/gpu_tracer.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "core/camera.h"
#include "core/error.h"
#include "gpu_glsl/device_io.h"
#include "gpu_glsl/gl/objects.h"

namespace onepass {
namespace {

/// Rays a chunk holds at most: 4 Mi rays take 128 MiB, and results of the same order.
constexpr size_t kMaxChunkRays = size_t{1} << 22;

/// The counts of entry/cast_compute_persistent.glsl.
constexpr size_t kQueueBytes = 2 * sizeof(uint32_t);

class GpuTracer final : public Tracer {
  public:
    GpuTracer(std::string name, PreparedStrategy prepared, GpuEntry entry,
              const gl::ShaderLibrary& library, gl::GlContext& context)
        : name_(std::move(name)),
          prepared_(std::move(prepared)),
          entry_(entry),
          library_(library),
          context_(context),
          glsl_version_(glsl_version_for(prepared_.info, entry, context.description().gl)) {
        for (const TextureData& texture : prepared_.inputs.textures) {
            textures_.push_back(upload_texture(texture));
        }
        give_texels_back();
        cast_program({}, kManyRays);
    }

    const std::string& name() const override { return name_; }

    Capabilities capabilities() const override {
        const gl::GlDescription& description = context_.description();
        Capabilities capabilities;
        capabilities.counters = true;
        capabilities.device_timer = !description.software;
        capabilities.software_renderer = description.software;
        capabilities.device = description.renderer;
        capabilities.shader_hash = cast_hash_;
        return capabilities;
    }

    std::vector<Stat> stats() const override { return prepared_.stats; }

    RayBatch upload(std::span<const Ray> rays) override {
        auto resident = std::make_shared<RaysOnDevice>();
        for (size_t first = 0; first < rays.size(); first += max_chunk_rays()) {
            const auto part = rays.subspan(first, std::min(max_chunk_rays(), rays.size() - first));
            resident->chunks.push_back(entry_ == GpuEntry::fragment ? upload_to_texels(part)
                                                                    : upload_to_buffer(part));
        }
        return {rays.size(), std::move(resident)};
    }

    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        CastResult result;
        result.hits.reserve(batch.count);
        result.flags.reserve(batch.count);
        const auto& rays = *static_cast<const RaysOnDevice*>(batch.resident.get());
        for (const ChunkOnDevice& chunk : rays.chunks) {
            if (entry_ == GpuEntry::fragment) {
                cast_fragments(chunk, options, result);
            } else {
                cast_compute(chunk, options, result);
            }
        }
        return result;
    }

    UpdateTimes update(std::span<const Affine> world_from_object) override {
        const auto start = std::chrono::steady_clock::now();
        TopLevelMove move = plan_move(prepared_, world_from_object);
        const std::chrono::duration<double, std::milli> planning =
            std::chrono::steady_clock::now() - start;
        UpdateTimes times;
        times.update_ms = planning.count();

        // New textures first: the device may not hold them, and nothing has changed yet.
        std::vector<gl::Texture> remade;
        const auto upload = [&] {
            for (const TextureData& texture : move.changes.remade) {
                remade.push_back(upload_texture(texture));
            }
            for (const TexelBox& box : move.changes.boxes) {
                gl::update_region(texture_named(box.texture), box.corner, box.size, box.texels);
            }
        };
        times.upload_ms = gl::finish_and_time(context_, upload).wall_ms;

        for (gl::Texture& texture : remade) texture_named(texture.name()) = std::move(texture);
        commit_move(prepared_, std::move(move));
        give_texels_back();
        for_each_program([this](gl::Program& program) { bind_inputs(program); });
        return times;
    }

    Frame render(const Camera& camera, const RenderSettings& settings) override {
        Frame frame;
        frame.width = settings.width;
        frame.height = settings.height;
        gl::Program& program = render_program(settings);
        const CameraFrame view = camera_frame(camera, settings.width, settings.height);
        program.set_uniform("camera_eye", view.eye);
        program.set_uniform("camera_corner", view.corner);
        program.set_uniform("camera_dx", view.dx);
        program.set_uniform("camera_dy", view.dy);
        if (entry_ == GpuEntry::fragment) {
            render_fragments(program, settings, frame);
        } else {
            render_compute(program, settings, frame);
        }
        return frame;
    }

  private:
    size_t max_chunk_rays() const {
        const gl::GlLimits& limits = context_.limits();
        const size_t most = entry_ == GpuEntry::compute
                                ? static_cast<size_t>(limits.max_ssbo_bytes) / sizeof(HitRecord)
                                : most_rays_in_texels(limits.max_texture_buffer_size);
        return std::min(kMaxChunkRays, most);
    }

    /// Work is counted for one ray an invocation.
    CastForm form(const CastOptions& options, size_t rays) const {
        return options.counters ? CastForm::single : cast_form(prepared_, entry_, rays);
    }

    /// The device has them now.
    void give_texels_back() {
        for (TextureData& texture : prepared_.inputs.textures) {
            give_back(texture.texels);
            give_back(texture.words);
        }
    }

    gl::Texture& texture_named(const std::string& name) {
        const auto found = std::find_if(textures_.begin(), textures_.end(),
                                        [&](const gl::Texture& t) { return t.name() == name; });
        ONEPASS_CHECK(found != textures_.end());
        return *found;
    }

    // ---- Programs: one a variant ---------------------------------------------------------------

    gl::Program make_program(const std::string& entry,
                             const std::vector<gl::ShaderConstant>& constants, std::string* hash) {
        const bool fragment = entry_ == GpuEntry::fragment;
        std::vector<gl::ComposedShader> stages;
        stages.push_back(library_.compose({.glsl_version = glsl_version_,
                                           .stage = fragment ? "fragment" : "compute",
                                           .files = prepared_.files_with(entry),
                                           .constants = constants}));
        if (hash != nullptr) *hash = stages.front().hash;
        if (fragment) {
            stages.push_back(library_.compose({.glsl_version = glsl_version_,
                                               .stage = "vertex",
                                               .files = {"entry/fullscreen.vert.glsl"},
                                               .constants = {}}));
        }
        gl::Program program(name_, stages);
        for (const gl::ShaderConstant& constant : constants) {
            if (!constant.late) continue;
            std::visit(
                [&](auto value) {
                    program.set_uniform(constant.name, value, gl::Missing::allowed);
                },
                constant.value);
        }
        bind_inputs(program);
        return program;
    }

    void bind_inputs(gl::Program& program) {
        // A variant drops the textures and uniforms that it does not need.
        for (const gl::Texture& texture : textures_) {
            program.set_texture(texture.name(), texture, gl::Missing::allowed);
            if (texture.buffer_id() == 0) continue;
            program.set_buffer(texture.name() + "_block", texture, gl::Missing::allowed);
        }
        for (const UniformData& uniform : prepared_.inputs.uniforms) {
            std::visit(
                [&](const auto& value) {
                    program.set_uniform(uniform.name, value, gl::Missing::allowed);
                },
                uniform.value);
        }
    }

    template <class F>
    void for_each_program(const F& f) {
        for (auto& [variant, program] : cast_programs_) f(program);
        for (RenderVariant& variant : render_programs_) f(variant.program);
    }

    gl::Program& cast_program(const CastOptions& options, size_t rays) {
        const bool any = options.query == Query::any && prepared_.answers_any();
        const CastVariant variant = {any, options.counters, form(options, rays)};
        auto found = cast_programs_.find(variant);
        if (found == cast_programs_.end()) {
            // The first, which the constructor makes, gives the tracer's hash.
            std::string* hash = cast_programs_.empty() ? &cast_hash_ : nullptr;
            gl::Program program =
                make_program(cast_file(entry_, form(options, rays)),
                             prepared_.constants(options.counters, nullptr, options.query), hash);
            found = cast_programs_.emplace(variant, std::move(program)).first;
        }
        return found->second;
    }

    gl::Program& render_program(const RenderSettings& settings) {
        const SceneNeeds needs = scene_needs(*prepared_.scene, settings);
        const auto same = [&](const RenderVariant& v) {
            return v.needs == needs && v.count_work == settings.aovs;
        };
        auto found = std::find_if(render_programs_.begin(), render_programs_.end(), same);
        if (found == render_programs_.end()) {
            render_programs_.push_back(
                {needs, settings.aovs,
                 make_program(render_file(entry_), prepared_.constants(settings.aovs, &needs),
                              nullptr)});
            found = std::prev(render_programs_.end());
        }
        return found->program;
    }

    // ---- Cast ----------------------------------------------------------------------------------

    void add_time(const gl::LaunchTime& time, CastResult& result) {
        result.wall_ms += time.wall_ms;
        result.device_ms += time.device_ms;
    }

    void cast_fragments(const ChunkOnDevice& chunk, const CastOptions& options,
                        CastResult& result) {
        using enum gl::TexelFormat;
        const size_t each = form(options, chunk.count) == CastForm::pairs ? 2 : 1;
        std::vector<gl::TexelFormat> targets = {rgba32f, rgba32ui};
        if (options.counters) targets.push_back(rgba32ui);
        if (each == 2) targets.assign(3, rgba32ui);
        const uvec2 fragments = chunk.fragments(each);
        const gl::Framebuffer framebuffer(fragments.x, fragments.y, targets);
        gl::Program& program = cast_program(options, chunk.count);
        chunk.give_to(program, each);
        add_time(gl::finish_and_time(context_, [&] { gl::draw_fullscreen(program, framebuffer); }),
                 result);

        if (!options.answers) return;
        if (each == 2) {
            append_pairs(framebuffer, chunk.count, result);
        } else {
            append_hits(framebuffer, chunk.count, options.counters, result);
        }
    }

    void cast_compute(const ChunkOnDevice& chunk, const CastOptions& options, CastResult& result) {
        const AnswersOnDevice answers(chunk.count, options.counters);
        gl::Program& program = cast_program(options, chunk.count);
        program.set_buffer("RayBuffer", *chunk.buffer);
        answers.give_to(program);
        program.set_uniform("ray_count", static_cast<int32_t>(chunk.count));
        const size_t group_size = program.work_group_size().x;
        size_t groups = (chunk.count + group_size - 1) / group_size;
        if (form(options, chunk.count) == CastForm::persistent) {
            if (!queue_) queue_.emplace("queue", kQueueBytes);
            program.set_buffer("QueueBuffer", *queue_);
            if (!prepared_.ends_loops()) {
                groups = std::min<size_t>(groups, prepared_.device.processors);
            }
        }

        // Groups in two dimensions: one dimension holds at least 65,535.
        constexpr size_t kMaxGroupsX = 65535;
        const size_t groups_x = std::min(groups, kMaxGroupsX);
        const size_t groups_y = (groups + groups_x - 1) / groups_x;
        add_time(gl::finish_and_time(context_,
                                     [&] { gl::dispatch(program, uvec3(groups_x, groups_y, 1)); }),
                 result);

        if (!options.answers) return;
        append_hits(answers, chunk.count, result);
    }

    // ---- Render --------------------------------------------------------------------------------

    void render_fragments(const gl::Program& program, const RenderSettings& settings,
                          Frame& frame) {
        using enum gl::TexelFormat;
        std::vector<gl::TexelFormat> targets = {rgba32f};
        if (settings.aovs) targets.insert(targets.end(), {rgba32f, rgba32ui, rgba32f, rgba32ui});
        const gl::Framebuffer framebuffer(settings.width, settings.height, targets);
        const gl::LaunchTime time =
            gl::finish_and_time(context_, [&] { gl::draw_fullscreen(program, framebuffer); });
        frame.wall_ms = time.wall_ms;
        frame.device_ms = time.device_ms;

        append_pixels(framebuffer, settings.aovs, frame);
    }

    void render_compute(gl::Program& program, const RenderSettings& settings, Frame& frame) {
        const size_t pixels = size_t{settings.width} * settings.height;
        const gl::Buffer pixel_buffer("pixels", pixels * sizeof(PixelRecord));
        program.set_buffer("PixelBuffer", pixel_buffer);
        program.set_uniform("image_size", glm::ivec2(settings.width, settings.height));
        const uvec2 group_size(program.work_group_size());
        const uvec2 groups =
            (uvec2(settings.width, settings.height) + group_size - uvec2(1)) / group_size;
        const gl::LaunchTime time =
            gl::finish_and_time(context_, [&] { gl::dispatch(program, uvec3(groups, 1)); });
        frame.wall_ms = time.wall_ms;
        frame.device_ms = time.device_ms;

        append_pixels(pixel_buffer, pixels, settings.aovs, frame);
    }

    /// For any hit; with counters; the form.
    using CastVariant = std::tuple<bool, bool, CastForm>;

    struct RenderVariant {
        SceneNeeds needs;
        bool count_work = false;
        gl::Program program;
    };

    std::string name_;
    PreparedStrategy prepared_;
    GpuEntry entry_;
    const gl::ShaderLibrary& library_;
    gl::GlContext& context_;
    int glsl_version_;
    std::vector<gl::Texture> textures_;
    std::optional<gl::Buffer> queue_;  ///< of persistent casts
    std::map<CastVariant, gl::Program> cast_programs_;
    std::vector<RenderVariant> render_programs_;
    std::string cast_hash_;
};

}  // namespace

CastForm cast_form(const PreparedStrategy& prepared, GpuEntry entry, size_t rays) {
    return entry == GpuEntry::fragment ? prepared.fragment_form() : prepared.compute_form(rays);
}

std::string cast_file(GpuEntry entry, CastForm form) {
    switch (form) {
        case CastForm::pairs:
            return "entry/cast_fragment_pairs.glsl";
        case CastForm::persistent:
            return "entry/cast_compute_persistent.glsl";
        case CastForm::single:
            break;
    }
    return entry == GpuEntry::fragment ? "entry/cast_fragment.glsl" : "entry/cast_compute.glsl";
}

std::string render_file(GpuEntry entry) {
    return entry == GpuEntry::fragment ? "entry/fragment.glsl" : "entry/compute.glsl";
}

int glsl_version_for(const gl::StrategyInfo& info, GpuEntry entry, int context_gl) {
    constexpr int kComputeNeeds = 430;
    constexpr int kPreferred = 450;
    const int needed = entry == GpuEntry::compute ? std::max(info.gl, kComputeNeeds) : info.gl;
    if (context_gl < needed) {
        throw Error(
            {fmt::format("{} in a {} shader", info.name,
                         entry == GpuEntry::compute ? "compute" : "fragment"),
             fmt::format("a context of OpenGL {}.{}", context_gl / 100, context_gl % 100 / 10),
             fmt::format("at least {}.{}", needed / 100, needed % 100 / 10),
             "Choose another device with --device, or the fragment entry."},
            Error::Kind::device);
    }
    return std::max(needed, std::min(context_gl, kPreferred));
}

std::unique_ptr<Tracer> make_gpu_tracer(std::string name, PreparedStrategy prepared, GpuEntry entry,
                                        const gl::ShaderLibrary& library, gl::GlContext& context) {
    return std::make_unique<GpuTracer>(std::move(name), std::move(prepared), entry, library,
                                       context);
}

}  // namespace onepass
