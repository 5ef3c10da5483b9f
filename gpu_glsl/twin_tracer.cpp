#include "gpu_glsl/twin_tracer.h"

#include <chrono>
#include <limits>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/camera.h"

namespace onepass {
namespace {

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

std::vector<UniformData> camera_uniforms(const CameraFrame& view) {
    return {{"camera_eye", view.eye},
            {"camera_corner", view.corner},
            {"camera_dx", view.dx},
            {"camera_dy", view.dy}};
}

class TwinTracer final : public Tracer {
  public:
    TwinTracer(std::string name, PreparedStrategy prepared, const twin::Unit& unit)
        : name_(std::move(name)), prepared_(std::move(prepared)), unit_(unit) {}

    const std::string& name() const override { return name_; }

    Capabilities capabilities() const override {
        Capabilities capabilities;
        capabilities.counters = true;
        capabilities.walks = true;
        capabilities.threads = static_cast<uint32_t>(tbb::this_task_arena::max_concurrency());
        capabilities.device = fmt::format("CPU, {}-bit floating point", unit_.bits);
        return capabilities;
    }

    std::vector<Stat> stats() const override { return prepared_.stats; }

    RayBatch upload(std::span<const Ray> rays) override {
        return {rays.size(), std::make_shared<std::vector<Ray>>(rays.begin(), rays.end())};
    }

    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        const auto& rays = *static_cast<const std::vector<Ray>*>(batch.resident.get());
        CastResult result;
        result.hits.resize(rays.size());
        result.flags.resize(rays.size());
        if (options.counters) result.counters.resize(rays.size());

        // The whole text is compiled at once, shading included, so it wants all its values.
        const SceneNeeds needs = scene_needs(*prepared_.scene, {});
        const auto constants = prepared_.constants(options.counters, &needs, options.query);
        const auto uniforms = camera_uniforms({});
        const twin::Bindings bindings(prepared_.inputs, uniforms, constants);
        constexpr size_t kGrain = 1024;
        const auto start = std::chrono::steady_clock::now();
        tbb::parallel_for(tbb::blocked_range<size_t>(0, rays.size(), kGrain),
                          [&](const auto& range) {
                              const size_t first = range.begin();
                              const size_t count = range.size();
                              twin::CastOutput out{std::span(result.hits).subspan(first, count),
                                                   std::span(result.flags).subspan(first, count),
                                                   {}};
                              if (options.counters) {
                                  out.counters = std::span(result.counters).subspan(first, count);
                              }
                              unit_.cast(bindings, std::span(rays).subspan(first, count), out);
                          });
        result.wall_ms = ms_since(start);
        result.device_ms = std::numeric_limits<double>::quiet_NaN();
        return result;
    }

    std::optional<RayWalk> walk(const Ray& ray) override {
        const SceneNeeds needs = scene_needs(*prepared_.scene, {});
        const auto constants = prepared_.constants(true, &needs);
        const auto uniforms = camera_uniforms({});
        return unit_.walk(twin::Bindings(prepared_.inputs, uniforms, constants), ray);
    }

    std::vector<ivec3> cells_of(uint32_t inst_id, uint32_t prim_id) override {
        return cells_of_triangle(prepared_, inst_id, prim_id);
    }

    UpdateTimes update(std::span<const Affine> world_from_object) override {
        const auto start = std::chrono::steady_clock::now();
        commit_move(prepared_, plan_move(prepared_, world_from_object));
        return {.update_ms = ms_since(start), .upload_ms = 0.0};
    }

    Frame render(const Camera& camera, const RenderSettings& settings) override {
        const size_t pixels = size_t{settings.width} * settings.height;
        Frame frame;
        frame.width = settings.width;
        frame.height = settings.height;
        frame.color.resize(pixels);
        frame.hits.resize(pixels);
        frame.normals.resize(pixels);
        frame.counters.resize(pixels);
        frame.flags.resize(pixels);

        const SceneNeeds needs = scene_needs(*prepared_.scene, settings);
        const auto constants = prepared_.constants(settings.aovs, &needs);
        const auto uniforms =
            camera_uniforms(camera_frame(camera, settings.width, settings.height));
        const twin::Bindings bindings(prepared_.inputs, uniforms, constants);
        const auto start = std::chrono::steady_clock::now();
        tbb::parallel_for(tbb::blocked_range<uint32_t>(0, settings.height), [&](const auto& rows) {
            unit_.render(bindings, rows.begin(), rows.end(), frame);
        });
        frame.wall_ms = ms_since(start);
        frame.device_ms = std::numeric_limits<double>::quiet_NaN();
        return frame;
    }

  private:
    std::string name_;
    PreparedStrategy prepared_;
    twin::Unit unit_;
};

}  // namespace

std::unique_ptr<Tracer> make_twin_tracer(std::string name, PreparedStrategy prepared,
                                         const twin::Unit& unit) {
    return std::make_unique<TwinTracer>(std::move(name), std::move(prepared), unit);
}

}  // namespace onepass
