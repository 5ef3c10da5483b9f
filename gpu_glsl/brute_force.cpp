#include "gpu_glsl/brute_force.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "core/error.h"
#include "gpu_glsl/device_io.h"
#include "gpu_glsl/gl/objects.h"
#include "gpu_glsl/gpu_tracer.h"
#include "gpu_glsl/pack/triangle_planes.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/triangle_list_layout.h"
#include "gpu_glsl/shaders/shared/two_level_layout.h"

/// A software renderer (llvmpipe of Mesa 22.3) ends the loops of an invocation after 65,535 turns:
/// at most two a test, one of them where every instance is a single triangle.
constexpr long kDefaultChunk = 30000;

constexpr long kMaxChunk = std::numeric_limits<int32_t>::max();

/// Rays of one batch on the device.
constexpr size_t kMaxChunkRays = size_t{1} << 20;

/// What the front matter of a strategy file would say. The triangle test is the paper's, and so are
/// its deviations.
gl::StrategyInfo brute_force_info() {
    using Type = ParamInfo::Type;
    gl::StrategyInfo info;
    info.name = "brute_force";
    info.file = "brute_force/test_chunk.glsl";
    info.summary = "every triangle of every instance, with the paper's triangle test";
    info.source = "the paper's measure of its subdivision: a gain of over 100";
    info.structure = "triangle_list";
    info.storages = {"texture2d"};
    info.entries = {"fragment", "compute"};
    info.params = {
        {"edge_tolerance",
         Type::real,
         "1.004",
         "upper bound of la + lb in the triangle test (D11); 1 is exact",
         {}},
        {"local_planes",
         Type::integer,
         "0",
         "store planes relative to the triangle's first corner (D18)",
         {}},
        {"edge_slack",
         Type::real,
         "0",
         "tolerance of every edge, in units of its rounding (D19)",
         {}},
        {"chunk",
         Type::integer,
         fmt::format("{}", kDefaultChunk),
         "triangles tested in one pass; some software renderers end loops after 65,535 turns",
         {}},
    };
    info.deviations = {
        {"D11", "edge_tolerance", "1", "la + lb may exceed 1 by 0.4 %"},
        {"D19", "edge_slack", "3", "edges have no tolerance for rounding"},
        {"D18", "local_planes", "1", "planes are in absolute object coordinates"},
    };
    return info;
}

// ---- What the shader reads ---------------------------------------------------------------------

/// A number as the float that carries it.
float exact_float(uint64_t value) {
    constexpr uint64_t kExactBelow = 1u << 24;
    if (value >= kExactBelow) {
        throw Error({"packing for brute force", fmt::format("{} triangles", value),
                     fmt::format("less than {}, which a float texel counts", kExactBelow),
                     "Use a smaller scene."});
    }
    return static_cast<float>(value);
}

TextureData pack_listed_instances(const Scene& scene, uint32_t max_side) {
    const std::vector<uint64_t> first = first_triangles(scene);
    TextureData texture = make_record_texture("instances", "instances", scene.instances.size(),
                                              kListedInstanceTexels, max_side);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Affine m(inverse(instance.world_from_object));
        float* out = texel_at(texture, record_texel(texture, i, kListedInstanceTexels));
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column) *out++ = m[column][row];
        }
        *out++ = exact_float(first[instance.object]);
        *out++ = exact_float(scene.objects[instance.object].triangles.size());
    }
    return texture;
}

/// Records in a row, as the power of two that it is.
int32_t log2_per_row(const TextureData& texture, uint32_t texels_per_record) {
    return static_cast<int32_t>(std::bit_width(texture.size.x / texels_per_record)) - 1;
}

// ---- Passes ------------------------------------------------------------------------------------

/// One pass: `tests` triangles, from triangle `first_test` of instance `first_instance` on.
struct Pass {
    int32_t first_instance = 0;
    int32_t first_test = 0;
    int32_t tests = 0;
};

/// All (instance, triangle) pairs, `chunk` of them a pass.
std::vector<Pass> plan_passes(const Scene& scene, uint64_t chunk) {
    std::vector<Pass> passes = {{}};
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const uint64_t count = scene.objects[scene.instances[i].object].triangles.size();
        for (uint64_t done = 0; done < count;) {
            if (static_cast<uint64_t>(passes.back().tests) == chunk) {
                passes.push_back({static_cast<int32_t>(i), static_cast<int32_t>(done), 0});
            }
            const uint64_t room = chunk - static_cast<uint64_t>(passes.back().tests);
            const uint64_t taken = std::min(room, count - done);
            passes.back().tests += static_cast<int32_t>(taken);
            done += taken;
        }
    }
    return passes;
}

class BruteForceTracer final : public Tracer {
  public:
    BruteForceTracer(std::string name, const gl::StrategyInfo& info, const ScenePtr& scene,
                     const ParamValues& values, GpuEntry entry,
                     std::shared_ptr<const gl::ShaderLibrary> library, gl::GlContext& context)
        : name_(std::move(name)),
          info_(info),
          params_(info.name, info.params, values),
          entry_(entry),
          library_(std::move(library)),
          context_(context) {
        const long chunk = params_.integer("chunk");
        if (chunk < 1 || chunk > kMaxChunk) {
            throw Error({"--param chunk", fmt::format("{}", chunk),
                         fmt::format("1 to {} triangles", kMaxChunk),
                         fmt::format("The default is {}.", kDefaultChunk)});
        }
        passes_ = plan_passes(*scene, static_cast<uint64_t>(chunk));
        instance_count_ = static_cast<int32_t>(scene->instances.size());

        // The scene to the device.
        const auto max_side = static_cast<uint32_t>(context.limits().max_texture_size);
        const TextureData triangles =
            pack_triangle_planes(*scene, {.local = params_.integer("local_planes") == 1}, max_side);
        const TextureData instances = pack_listed_instances(*scene, max_side);
        log2_triangles_per_row_ = log2_per_row(triangles, kTriangleTexels);
        log2_instances_per_row_ = log2_per_row(instances, kListedInstanceTexels);
        for (const TextureData* texture : {&triangles, &instances}) {
            textures_.push_back(upload_texture(*texture));
        }
        stats_ = {{"triangle_bytes", static_cast<double>(triangles.bytes()), "four texels each"},
                  {"device_bytes", static_cast<double>(triangles.bytes() + instances.bytes()),
                   "no structure"}};
        program(false);
    }

    const std::string& name() const override { return name_; }

    Capabilities capabilities() const override {
        const gl::GlDescription& description = context_.description();
        Capabilities capabilities;
        capabilities.render = false;
        capabilities.counters = true;
        capabilities.device_timer = !description.software;
        capabilities.software_renderer = description.software;
        capabilities.device = description.renderer;
        capabilities.shader_hash = shader_hash_;
        return capabilities;
    }

    std::vector<Stat> stats() const override { return stats_; }

    RayBatch upload(std::span<const Ray> rays) override {
        auto resident = std::make_shared<RaysOnDevice>();
        for (size_t first = 0; first < rays.size(); first += kMaxChunkRays) {
            const auto part = rays.subspan(first, std::min(kMaxChunkRays, rays.size() - first));
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
        result.costs = {{"passes", static_cast<double>(passes_.size() * rays.chunks.size()), ""}};
        return result;
    }

    UpdateTimes update(std::span<const Affine>) override {
        throw Error({name_, "an update", "a tracer that moves instances", "Make a new tracer."});
    }

    Frame render(const Camera&, const RenderSettings&) override {
        throw Error({name_, "a request for an image", "rays to cast: it renders nothing",
                     "Choose a tracer that renders."});
    }

  private:
    gl::Program& program(bool counters) {
        std::optional<gl::Program>& made = programs_[counters ? 1 : 0];
        if (!made) made = make_program(counters);
        return *made;
    }

    gl::Program make_program(bool counters) {
        const bool fragment = entry_ == GpuEntry::fragment;
        const int version = glsl_version_for(info_, entry_, context_.description().gl);
        const std::string stage = fragment ? "fragment" : "compute";
        std::vector<gl::ComposedShader> stages;
        stages.push_back(library_->compose(
            {.glsl_version = version,
             .stage = stage,
             .files = {"storage/triangle_list/texture2d.glsl",
                       fmt::format("entry/brute_force_{}.glsl", stage)},
             .constants = {
                 {"count_work", counters},
                 {"edge_tolerance", static_cast<float>(params_.real("edge_tolerance"))},
                 {"edge_slack", static_cast<float>(params_.real("edge_slack"))},
                 {"local_planes", static_cast<int32_t>(params_.integer("local_planes"))},
                 {"instance_count", instance_count_},
                 {"log2_triangles_per_row", log2_triangles_per_row_},
                 {"log2_instances_per_row", log2_instances_per_row_},
             }}));
        if (!counters) shader_hash_ = stages.front().hash;
        if (fragment) {
            stages.push_back(library_->compose({.glsl_version = version,
                                                .stage = "vertex",
                                                .files = {"entry/fullscreen.vert.glsl"}}));
        }
        gl::Program program(name_, stages);
        for (const gl::Texture& texture : textures_) program.set_texture(texture.name(), texture);
        return program;
    }

    static void set_pass(gl::Program& program, const Pass& pass, bool is_first) {
        program.set_uniform("first_instance", pass.first_instance);
        program.set_uniform("first_test", pass.first_test);
        program.set_uniform("chunk_tests", pass.tests);
        program.set_uniform("is_first_chunk", is_first);
    }

    /// Passes draw into one framebuffer and read the other, in turn.
    void cast_fragments(const ChunkOnDevice& chunk, const CastOptions& options,
                        CastResult& result) {
        using enum gl::TexelFormat;
        std::vector<gl::TexelFormat> targets = {rgba32f, rgba32ui};
        if (options.counters) targets.push_back(rgba32ui);
        const uvec2 fragments = chunk.fragments();
        const gl::Framebuffer framebuffers[2] = {{fragments.x, fragments.y, targets},
                                                 {fragments.x, fragments.y, targets}};
        gl::Program& program = this->program(options.counters);
        chunk.give_to(program);
        const auto draw_all = [&] {
            for (size_t p = 0; p < passes_.size(); ++p) {
                const gl::Framebuffer& last = framebuffers[(p + 1) % 2];
                program.set_texture("last_hit", last.target(0));
                program.set_texture("last_ids", last.target(1));
                if (options.counters) program.set_texture("last_counters", last.target(2));
                set_pass(program, passes_[p], p == 0);
                gl::draw_fullscreen(program, framebuffers[p % 2]);
            }
        };
        add_time(gl::finish_and_time(context_, draw_all), result);
        append_hits(framebuffers[(passes_.size() - 1) % 2], chunk.count, options.counters, result);
    }

    void cast_compute(const ChunkOnDevice& chunk, const CastOptions& options, CastResult& result) {
        const AnswersOnDevice answers(chunk.count, options.counters);
        gl::Program& program = this->program(options.counters);
        program.set_buffer("RayBuffer", *chunk.buffer);
        answers.give_to(program);
        program.set_uniform("ray_count", static_cast<int32_t>(chunk.count));

        // A batch of 2^20 rays has fewer groups than one dimension may have.
        const auto group_size = static_cast<size_t>(program.work_group_size().x);
        const auto groups = static_cast<uint32_t>((chunk.count + group_size - 1) / group_size);
        const auto dispatch_all = [&] {
            for (size_t p = 0; p < passes_.size(); ++p) {
                set_pass(program, passes_[p], p == 0);
                gl::dispatch(program, uvec3(groups, 1, 1));
            }
        };
        add_time(gl::finish_and_time(context_, dispatch_all), result);
        append_hits(answers, chunk.count, result);
    }

    static void add_time(const gl::LaunchTime& time, CastResult& result) {
        result.wall_ms += time.wall_ms;
        result.device_ms += time.device_ms;
    }

    std::string name_;
    gl::StrategyInfo info_;
    Params params_;
    GpuEntry entry_;
    std::shared_ptr<const gl::ShaderLibrary> library_;
    gl::GlContext& context_;
    std::vector<Pass> passes_;
    int32_t instance_count_ = 0;
    int32_t log2_triangles_per_row_ = 0;
    int32_t log2_instances_per_row_ = 0;
    std::vector<gl::Texture> textures_;
    std::vector<Stat> stats_;
    std::optional<gl::Program> programs_[2];  ///< without and with counters
    std::string shader_hash_;
};

}  // namespace

std::vector<CatalogueEntry> brute_force_tracers(
    const std::shared_ptr<const gl::ShaderLibrary>& library, const GlContextProvider& context) {
    const gl::StrategyInfo info = brute_force_info();
    std::vector<CatalogueEntry> entries;
    for (const std::string& stage : info.entries) {
        const GpuEntry entry = stage == "compute" ? GpuEntry::compute : GpuEntry::fragment;
        const std::string name = fmt::format("{}/{}/{}", info.name, info.storages.front(), stage);
        CatalogueEntry result;
        result.info = {.name = name,
                       .summary = fmt::format("{}, in a {} shader", info.summary, stage),
                       .source = info.source,
                       .params = info.params,
                       .deviations = info.deviations,
                       .by_default = false};
        result.make = [=](const ScenePtr& scene, const ParamValues& values) {
            return std::make_unique<BruteForceTracer>(name, info, scene, values, entry, library,
                                                      context());
        };
        entries.push_back(std::move(result));
    }
    return entries;
}

}  // namespace onepass
