// Embree as tracers: casts one ray a call, in packets or in streams; renders, one ray a call, with
// core/shading.h.
//
// The number of threads is a TBB task arena's; "1thread" is a plain loop in the calling thread.
#include "cpu_ref/embree_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/camera.h"
#include "core/error.h"
#include "core/shading.h"
#include "cpu_ref/embree_scene.h"

namespace onepass {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What becomes of a ray, decided at upload so that timing holds traversal only.
enum class Ask : uint8_t { embree, answer_miss, answer_invalid };

Ask ask(const Ray& ray, const RayLimits& limits) {
    if (!oracle_can_take(ray, limits)) return Ask::answer_invalid;
    return is_empty_ray(ray) ? Ask::answer_miss : Ask::embree;
}

std::vector<Ask> asks_of(const std::vector<Ray>& rays, const RayLimits& limits) {
    std::vector<Ask> asks;
    asks.reserve(rays.size());
    for (const Ray& ray : rays) asks.push_back(ask(ray, limits));
    return asks;
}

struct ResidentRays {
    std::vector<Ray> rays;
    std::vector<Ask> asks;
    RayLimits limits;  ///< that the asks rest on
    bool coherent = false;
};

/// One of the entries of the catalogue.
struct Variant {
    std::string name;
    bool robust = true;
    bool one_thread = false;
    EmbreeCall call = EmbreeCall::one;

    bool casts_many() const { return call != EmbreeCall::one; }
};

/// Rays a task: long enough to hide the cost of a task, short enough to balance the cores.
constexpr size_t kRaysPerTask = 256;

EmbreeOptions::Quality quality_of(const std::string& text) {
    if (text == "low") return EmbreeOptions::Quality::low;
    if (text == "high") return EmbreeOptions::Quality::high;
    return EmbreeOptions::Quality::medium;
}

/// Threads asked for by the variant and its parameters; 0 of the parameter stands for all. More
/// than the cores cannot be had: Embree's device limits TBB to those.
int thread_count(const Variant& variant, const Params& params) {
    if (variant.one_thread) return 1;
    const int cores = tbb::info::default_concurrency();
    const long asked = params.integer("threads");
    if (asked < 0 || asked > cores) {
        throw Error({.where = variant.name + " --param threads",
                     .got = std::to_string(asked),
                     .expected = "0 to " + std::to_string(cores) + ", the usable cores",
                     .remedy = "Leave it out to use all of them"});
    }
    return asked > 0 ? static_cast<int>(asked) : cores;
}

class EmbreeTracer final : public Tracer {
  public:
    EmbreeTracer(const Variant& variant, ScenePtr scene, const Params& params)
        : name_(variant.name),
          scene_(std::move(scene)),
          shading_(*scene_),
          version_(embree_version()),
          call_(variant.call),
          coherence_(variant.casts_many() ? params.text("coherence") : "incoherent"),
          threads_(thread_count(variant, params)),
          arena_(threads_) {
        const EmbreeOptions options{variant.robust, quality_of(params.text("quality"))};
        arena_.execute([&] { embree_.emplace(*scene_, options); });
    }

    const std::string& name() const override { return name_; }

    Capabilities capabilities() const override {
        Capabilities capabilities;
        capabilities.render = call_ == EmbreeCall::one;
        capabilities.threads = static_cast<uint32_t>(threads_);
        capabilities.device = version_;
        return capabilities;
    }

    std::vector<Stat> stats() const override {
        double unique_triangles = 0.0;
        for (const Object& object : scene_->objects) {
            unique_triangles += static_cast<double>(object.triangles.size());
        }
        return {
            {"build_ms", embree_->build_ms(), "commits of all objects and of the top level"},
            {"triangles", static_cast<double>(instanced_triangle_count(*scene_)),
             "counted once an instance"},
            {"unique_triangles", unique_triangles, "counted once an object"},
            {"instances", static_cast<double>(scene_->instances.size()),
             embree_->instanced() ? "" : "traced without Embree's instance level"},
            {"bytes", embree_->bytes(), "as Embree reports it: trees and copies of the vertices"},
            {"object_builds", static_cast<double>(embree_->object_builds()),
             "commits of objects since the tracer was made"},
            {"top_builds", static_cast<double>(embree_->top_builds()),
             "commits of the top level since the tracer was made"},
        };
    }

    RayBatch upload(std::span<const Ray> rays) override {
        auto resident = std::make_shared<ResidentRays>();
        resident->rays.assign(rays.begin(), rays.end());
        resident->limits = embree_->limits();
        resident->asks = asks_of(resident->rays, resident->limits);
        resident->coherent = are_coherent(rays);
        return {rays.size(), resident};
    }

    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        const auto& resident = *static_cast<const ResidentRays*>(batch.resident.get());
        CastResult result;
        result.hits.resize(batch.count);
        result.flags.resize(batch.count);
        result.device_ms = std::numeric_limits<double>::quiet_NaN();

        // An update since the upload may have changed which rays Embree can be asked about.
        const bool asks_hold = resident.limits == embree_->limits();
        const std::vector<Ask> new_asks =
            asks_hold ? std::vector<Ask>() : asks_of(resident.rays, embree_->limits());
        const std::vector<Ask>& asks = asks_hold ? resident.asks : new_asks;

        const Coherence coherence = coherence_of(resident);
        const auto answer = [&](size_t begin, size_t end) {
            for (size_t first = begin; first < end; first += kRaysPerTask) {
                std::array<uint32_t, kRaysPerTask> which;
                size_t count = 0;
                for (size_t i = first; i < std::min(end, first + kRaysPerTask); ++i) {
                    if (asks[i] == Ask::embree) {
                        which[count++] = static_cast<uint32_t>(i);
                    } else if (asks[i] == Ask::answer_invalid) {
                        result.flags[i] = kFlagOracleInvalid;
                    }
                }
                embree_->ask(options.query, call_, coherence, resident.rays,
                             std::span(which).first(count), result.hits);
            }
        };
        const Clock::time_point start = Clock::now();
        for_each_chunk(batch.count, kRaysPerTask, answer);
        result.wall_ms = ms_since(start);
        if (call_ != EmbreeCall::one) {
            const bool coherent = coherence == Coherence::coherent;
            result.costs = {{"coherent", coherent ? 1.0 : 0.0, "what Embree was told of the rays"}};
        }
        return result;
    }

    UpdateTimes update(std::span<const Affine> world_from_object) override {
        if (scene_->animation.empty()) {
            throw Error({name_, "an update of a scene without an animation",
                         "a scene in which something moves", "Make a new tracer."});
        }
        if (world_from_object.size() != scene_->instances.size()) {
            throw Error({name_, std::to_string(world_from_object.size()) + " transforms",
                         std::to_string(scene_->instances.size()) + ", one an instance",
                         "Take them from instance_transforms()."});
        }
        const Clock::time_point start = Clock::now();
        arena_.execute([&] { embree_->update(world_from_object); });
        shading_.move(world_from_object);
        return {.update_ms = ms_since(start), .upload_ms = 0.0};
    }

    Frame render(const Camera& camera, const RenderSettings& settings) override {
        if (call_ != EmbreeCall::one) {
            throw Error({name_, "a request for an image", "rays to cast: it renders nothing",
                         "Choose a tracer that renders, such as embree/fast/threads."});
        }
        const CameraFrame view = camera_frame(camera, settings.width, settings.height);
        const size_t pixels = size_t{settings.width} * settings.height;
        Frame frame;
        frame.width = settings.width;
        frame.height = settings.height;
        frame.color.resize(pixels);
        frame.flags.resize(pixels);
        if (settings.aovs) {
            frame.hits.resize(pixels);
            frame.normals.resize(pixels);
            frame.counters.resize(pixels);
        }
        frame.device_ms = std::numeric_limits<double>::quiet_NaN();

        const auto rows = [&](size_t begin, size_t end) {
            for (size_t y = begin; y < end; ++y) {
                for (uint32_t x = 0; x < settings.width; ++x) {
                    const Ray ray = primary_ray(view, x, static_cast<uint32_t>(y));
                    shade_pixel(ray, settings, y * settings.width + x, frame);
                }
            }
        };
        const Clock::time_point start = Clock::now();
        for_each_chunk(settings.height, 1, rows);
        frame.wall_ms = ms_since(start);
        return frame;
    }

  private:
    Coherence coherence_of(const ResidentRays& rays) const {
        const bool coherent = coherence_ == "auto" ? rays.coherent : coherence_ == "coherent";
        return coherent ? Coherence::coherent : Coherence::incoherent;
    }

    Hit query(const Ray& ray, Query kind) const {
        if (kind == Query::closest) return embree_->closest(ray);
        return embree_->occluded(ray) ? some_hit(ray) : Hit{};
    }

    void shade_pixel(const Ray& primary, const RenderSettings& settings, size_t pixel,
                     Frame& frame) const {
        const auto checked = [&](const Ray& ray, Query kind) {
            const Ask decision = ask(ray, embree_->limits());
            if (decision == Ask::answer_invalid) frame.flags[pixel] |= kFlagOracleInvalid;
            return decision == Ask::embree ? query(ray, kind) : Hit{};
        };
        const ShadedPath path = shade_path(
            shading_, primary, settings,
            [&](const Ray& ray) { return checked(ray, Query::closest); },
            [&](const Ray& ray) { return checked(ray, Query::any).is_hit(); });
        frame.color[pixel] = path.color;
        if (!settings.aovs) return;
        frame.hits[pixel] = path.primary;
        frame.normals[pixel] = path.normal;
        frame.counters[pixel].rays = path.rays;
    }

    /// work(begin, end) over [0, count), on this tracer's threads.
    template <class Work>
    void for_each_chunk(size_t count, size_t grain, const Work& work) {
        if (threads_ == 1) {
            work(size_t{0}, count);
            return;
        }
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain),
                              [&](const auto& range) { work(range.begin(), range.end()); });
        });
    }

    std::string name_;
    ScenePtr scene_;
    ShadingScene shading_;
    std::string version_;
    EmbreeCall call_;
    std::string coherence_;
    int threads_ = 1;
    tbb::task_arena arena_;
    std::optional<EmbreeScene> embree_;
};

std::vector<ParamInfo> params_of(const Variant& variant) {
    std::vector<ParamInfo> infos = {{.name = "quality",
                                     .type = ParamInfo::Type::choice,
                                     .default_value = "medium",
                                     .summary = "Embree's build quality",
                                     .choices = {"low", "medium", "high"}}};
    if (!variant.one_thread) {
        infos.push_back({.name = "threads",
                         .type = ParamInfo::Type::integer,
                         .default_value = "0",
                         .summary = "threads to build and trace with; 0: all usable cores",
                         .choices = {}});
    }
    if (variant.casts_many()) {
        infos.push_back({.name = "coherence",
                         .type = ParamInfo::Type::choice,
                         .default_value = "auto",
                         .summary = "what Embree is told of the rays; auto: coherent where rays "
                                    "that follow each other go nearly the same way",
                         .choices = {"auto", "coherent", "incoherent"}});
    }
    return infos;
}

const char* manner_of(EmbreeCall call) {
    switch (call) {
        case EmbreeCall::one:
            return "one ray a call";
        case EmbreeCall::packet8:
            return "packets of 8 rays";
        case EmbreeCall::packet16:
            return "packets of 16 rays";
        case EmbreeCall::stream:
            return "streams of 256 rays";
    }
    return "";
}

CatalogueEntry entry_of(const Variant& variant) {
    CatalogueEntry entry;
    entry.info.name = variant.name;
    entry.info.summary = std::string("Embree's BVH, ") + manner_of(variant.call) + ", " +
                         (variant.robust ? "robust" : "fast") + " mode, " +
                         (variant.one_thread ? "one thread" : "all threads");
    entry.info.source = embree_header_version();
    entry.info.params = params_of(variant);
    entry.info.is_oracle = true;
    entry.info.by_default = !variant.casts_many();
    entry.make = [variant](ScenePtr scene, const ParamValues& values) -> std::unique_ptr<Tracer> {
        const Params params(variant.name, params_of(variant), values);
        return std::make_unique<EmbreeTracer>(variant, std::move(scene), params);
    };
    return entry;
}

}  // namespace

std::vector<CatalogueEntry> embree_tracers() {
    return {entry_of({"embree/robust/threads", true, false}),
            entry_of({"embree/fast/threads", false, false}),
            entry_of({"embree/robust/1thread", true, true}),
            entry_of({"embree/fast/1thread", false, true}),
            entry_of({"embree/robust/packet8", true, false, EmbreeCall::packet8}),
            entry_of({"embree/fast/packet8", false, false, EmbreeCall::packet8}),
            entry_of({"embree/robust/packet16", true, false, EmbreeCall::packet16}),
            entry_of({"embree/fast/packet16", false, false, EmbreeCall::packet16}),
            entry_of({"embree/robust/stream", true, false, EmbreeCall::stream}),
            entry_of({"embree/fast/stream", false, false, EmbreeCall::stream})};
}

}  // namespace onepass
