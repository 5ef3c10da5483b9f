#include "compare/cli/session.h"

#include <cstdio>

#include <fmt/format.h>

#include "compare/frames.h"
#include "compare/manifest.h"
#include "core/error.h"
#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "gpu_glsl/glsl_tracers.h"
#include "scenes/scenes.h"

namespace onepass::cli {

Session::Session(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
    const auto add = [&](std::vector<CatalogueEntry> entries) {
        for (CatalogueEntry& entry : entries) catalogue.add(std::move(entry));
    };
    add(glsl_tracers(gl::ShaderLibrary::embedded(),
                     [this]() -> gl::GlContext& { return gl_context(); }));
    add(embree_tracers());
}

gl::GlContext& Session::gl_context() {
    if (!gl_context_) gl_context_ = gl::make_context(globals.gl, globals.device);
    return *gl_context_;
}

DeviceClocks Session::device_clocks() {
    const bool software = gl_context_ && gl_context_->description().software;
    if (!gl_context_ || software) return {"no GPU", {}};
    if (gl_context_->description().vendor.find("NVIDIA") == std::string::npos) {
        return {"not known: not a device of NVIDIA's", {}};
    }
    if (!clock_reader_) clock_reader_ = std::make_unique<ClockReader>();
    return {clock_reader_->source(), [this] { return clock_reader_->read(); }};
}

Manifest Session::manifest() const {
    Manifest manifest = make_manifest(arguments_, globals.seed);
    manifest.embree = embree_description();
    if (gl_context_) {
        const gl::GlDescription& description = gl_context_->description();
        manifest.gl_context = description.kind;
        manifest.gl_renderer = description.renderer;
        manifest.gl_version = description.version;
        manifest.software_renderer = description.software;
    }
    return manifest;
}

OpenScene open_scene(const std::string& name_or_path) {
    LoadedScene loaded = load_scene(name_or_path);
    for (const std::string& note : loaded.notes) {
        fmt::print(stderr, "onepass: {}: {}\n", name_or_path, note);
    }
    OpenScene open;
    open.name = name_or_path;
    open.record = make_scene_record(name_or_path, loaded);
    open.scene = std::make_shared<const Scene>(std::move(loaded.scene));
    return open;
}

Court open_court(const Session& session, const std::string& name_or_path) {
    Court court;
    court.open = open_scene(name_or_path);
    court.oracle = session.catalogue.at(kOracleName).make(court.open.scene, {});
    court.judge = make_exact_judge(court.open.scene);
    return court;
}

std::vector<Affine> move_to_frame(Court& court, uint32_t frame, double frames_per_s) {
    const Scene& scene = *court.open.scene;
    if (scene.animation.empty()) {
        throw Error({"--frames", fmt::format("'{}', in which nothing moves", court.open.name),
                     "a scene with an animation",
                     "Leave --frames out, or choose another scene, for instance balls-1."});
    }
    const double time_s = frame_time(frame, frames_per_s, scene.animation.duration());
    std::vector<Affine> transforms = instance_transforms(scene, time_s);
    court.oracle->update(transforms);
    court.open.scene = std::make_shared<const Scene>(scene_at(scene, time_s));
    court.open.name = court.open.record.name = frame_name(court.open.name, frame);
    court.judge = make_exact_judge(court.open.scene);
    return transforms;
}

Case open_case(Court& court, const std::string& kind_or_file, const RayRequest& request) {
    Case subject;
    subject.rays = make_ray_set(kind_or_file, *court.open.scene, *court.oracle, request);
    subject.truth =
        court.oracle->cast(court.oracle->upload(subject.rays.rays), {.query = subject.rays.query});
    return subject;
}

CastResult answers_of(const Case& subject, Tracer& tracer) {
    return tracer.cast(tracer.upload(subject.rays.rays), {.query = subject.rays.query});
}

std::vector<HitComparison> check_answers(const Court& court, const Case& subject,
                                         std::span<const CastResult> answers,
                                         std::span<const std::string> tracers,
                                         const HitCheckOptions& options) {
    const RaySet& rays = subject.rays;
    HitCheckOptions bounds = options;
    if (rays.at_edges) bounds.allowed.try_emplace(HitClass::edge, rays.rays.size());
    std::vector<HitComparison> comparisons =
        compare_hits(rays.rays, rays.query, answers, subject.truth, *court.judge, bounds);
    for (size_t i = 0; i < comparisons.size(); ++i) {
        CheckRecord& record = comparisons[i].record;
        record.scene = court.open.name;
        record.rays = rays.name;
        record.ray_hash = rays.hash;
        record.tracer = tracers[i];
        record.oracle = court.oracle->name();
    }
    return comparisons;
}

HitComparison check_tracer(const Court& court, const Case& subject, Tracer& tracer,
                           const HitCheckOptions& options) {
    const CastResult answers = answers_of(subject, tracer);
    const std::string name(tracer.name());
    return std::move(
        check_answers(court, subject, std::span(&answers, 1), std::span(&name, 1), options)
            .front());
}

void finish(Session& session, Results& results, const std::string& json, bool stopped) {
    const std::string judge = results.manifest.judge;
    results.manifest = session.manifest();
    results.manifest.judge = judge;
    results.manifest.complete = !stopped;
    if (stopped) {
        session.exit_code = kStopped;
        fmt::print(stderr, "onepass: stopped; the results hold what was finished before\n");
    }
    if (json.empty()) return;
    write_results(results, json);
    if (json != "-") fmt::print(stderr, "onepass: wrote {}\n", json);
}

std::FILE* table_stream(const std::string& json) { return json == "-" ? stderr : stdout; }

}  // namespace onepass::cli
