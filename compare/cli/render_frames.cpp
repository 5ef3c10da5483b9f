// onepass render --frames: the frames of an animation, each checked against Embree with its scene
// moved the same way.
#include <memory>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/render.h"
#include "compare/cli/table.h"
#include "compare/frames.h"
#include "compare/images.h"
#include "compare/manifest.h"
#include "compare/statistics.h"
#include "cpu_ref/exact_judge.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

/// What became of one frame.
struct FrameReport {
    uint32_t number = 0;
    double time_s = 0.0;
    UpdateTimes update;
    double trace_ms = 0.0;
    size_t exhausted = 0;
    // Only where frames are checked.
    ImageRecord image;
    CheckRecord hits;  ///< of the primary rays
};

/// One run of `render --frames`: a tracer, and the oracle that follows it.
struct FrameRun {
    Session& session;
    const RenderCommand& options;
    const FrameRange range;
    const FramePattern pattern;
    Stage stage;
    std::unique_ptr<Tracer> oracle;  ///< null: frames are not checked
    TimedFrames frames{};
    TimedFrames oracle_frames{};
    std::vector<FrameReport> reports{};
    uint64_t kept = 0;  ///< files that were there already
    Results results{};
    bool stopped = false;

    bool passed() const {
        bool all = true;
        for (const FrameReport& report : reports) all &= oracle == nullptr || report.image.passed;
        return all;
    }

    /// Compares the frame with the oracle's, and the answers to its primary rays with the truth
    /// about the scene as it is in this frame.
    void check(const Frame& frame, const std::vector<Affine>& transforms, FrameReport& report) {
        const UpdateTimes update = oracle->update(transforms);
        const Frame truth = oracle->render(stage.camera, stage.settings);
        oracle_frames.add(update, truth);
        report.image = compare_images(frame, truth);

        const auto scene =
            std::make_shared<const Scene>(scene_at(*stage.open.scene, report.time_s));
        const RaySet rays = make_ray_set(
            "primary", *scene, *oracle,
            {stage.settings.width, stage.settings.height, options.camera, session.globals.seed});
        const std::unique_ptr<Judge> judge = make_exact_judge(scene);
        const auto answers = [&](Tracer& tracer) {
            return tracer.cast(tracer.upload(rays.rays), {.query = rays.query});
        };
        HitComparison comparison =
            compare_hits(rays.rays, rays.query, answers(*stage.tracer), answers(*oracle), *judge,
                         {.seed = session.globals.seed});
        report.hits = std::move(comparison.record);
        report.hits.rays = rays.name;
        report.hits.ray_hash = rays.hash;
        results.manifest.judge = judge->name();

        // A frame's records stand under a name of their own: they are of another scene.
        report.image.scene = report.hits.scene = frame_name(stage.open.name, report.number);
        report.image.tracer = report.hits.tracer = stage.tracer->name();
        report.image.oracle = report.hits.oracle = oracle->name();
        results.images.push_back(report.image);
        results.checks.push_back(report.hits);
    }

    void render(uint32_t number) {
        const fs::path path = pattern.file(number);
        if (options.resume && fs::exists(path)) {
            ++kept;
            return;
        }
        const Scene& scene = *stage.open.scene;
        FrameReport report;
        report.number = number;
        report.time_s = frame_time(number, options.fps, scene.animation.duration());
        const std::vector<Affine> transforms = instance_transforms(scene, report.time_s);
        report.update = stage.tracer->update(transforms);
        const Frame frame = stage.tracer->render(stage.camera, stage.settings);
        frames.add(report.update, frame);
        report.trace_ms = frame.wall_ms;
        report.exhausted = exhausted_pixels(frame);
        if (oracle) check(frame, transforms, report);
        write_frame(path, frame, stage.aovs);
        reports.push_back(std::move(report));
    }

    void render_all() {
        frames.tracer = stage.tracer->name();
        if (oracle) oracle_frames.tracer = oracle->name();
        ProgressBar bar("render");
        const Progress progress = bar.part(0.0, 1.0);
        const auto count = static_cast<double>(range.count());
        for (uint64_t k = 0; k < range.count() && !stopped; ++k) {
            render(range.first + static_cast<uint32_t>(k));
            stopped = !go_on(progress, static_cast<double>(k + 1) / count);
        }
        stopped = stopped && kept + reports.size() < range.count();
    }

    void record() {
        results.scenes.push_back(stage.open.record);
        const auto add = [&](const Tracer& tracer, const CatalogueEntry& entry,
                             const ParamValues& params, const TimedFrames& timed) {
            results.tracers.push_back(
                make_tracer_record(stage.open.name, tracer, entry.info, params));
            results.tracers.back().sizing = sizing_name(entry.info, options.sizing);
            if (timed.wall_ms.empty()) return;
            FrameTimingRecord record = timing_record(timed, oracle_frames, session.globals.seed);
            record.scene = stage.open.name;
            results.frame_timings.push_back(std::move(record));
        };
        add(*stage.tracer, *stage.strategy.entry, stage.strategy.params, frames);
        if (!oracle) return;
        add(*oracle, session.catalogue.at(kOracleName), {}, oracle_frames);
        for (const FrameReport& report : reports) {
            FrameTimingRecord& timing = results.frame_timings.front();
            timing.differing_pixels += report.image.differing_pixels;
            timing.compared_pixels += uint64_t{report.image.width} * report.image.height;
        }
    }

    std::string table() const {
        std::vector<std::vector<std::string>> rows = {
            {"frame", "time s", "update ms", "upload ms", "trace ms"}};
        if (oracle) {
            rows[0].insert(rows[0].end(),
                           {"PSNR dB", "pixels off", "allowed", "false_miss", "false_hit",
                            "wrong_surface", "t_error", "edge", "exhausted", "verdict"});
        }
        for (const FrameReport& report : reports) {
            std::vector<std::string> row = {std::to_string(report.number),
                                            fmt::format("{:.3f}", report.time_s),
                                            fmt::format("{:.3f}", report.update.update_ms),
                                            fmt::format("{:.3f}", report.update.upload_ms),
                                            fmt::format("{:.2f}", report.trace_ms)};
            if (oracle) {
                const auto count = [&](HitClass c) {
                    return std::to_string(report.hits.classes[static_cast<size_t>(c)].count);
                };
                row.insert(row.end(), {fmt::format("{:.1f}", report.image.psnr_db),
                                       std::to_string(report.image.differing_pixels),
                                       std::to_string(report.image.allowed_pixels),
                                       count(HitClass::false_miss), count(HitClass::false_hit),
                                       count(HitClass::wrong_surface), count(HitClass::t_error),
                                       count(HitClass::edge), std::to_string(report.exhausted),
                                       report.image.passed ? "agrees" : "DIFFERS"});
            }
            rows.push_back(std::move(row));
        }
        return format_table(rows);
    }

    static std::string summary_line(const Tracer& tracer, const TimedFrames& timed) {
        // A tracer that does not count its builds must not seem to have made none.
        const auto count = [&](const std::string& name) -> std::string {
            for (const Stat& stat : tracer.stats()) {
                if (stat.name == name) return fmt::format("{:.0f}", stat.value);
            }
            return "an unknown number of";
        };
        return fmt::format(
            "{}: {} frames, median update {:.3f} ms, upload {:.3f} ms, trace {:.2f} ms; in all {} "
            "object builds and {} top-level builds\n",
            timed.tracer, timed.wall_ms.size(), median(timed.update_ms), median(timed.upload_ms),
            median(timed.wall_ms), count("object_builds"), count("top_builds"));
    }

    void print() const {
        std::FILE* out = table_stream(options.json);
        if (kept > 0) {
            fmt::print(out, "{} frames were there already and are not in the table\n", kept);
        }
        if (reports.empty()) return;
        fmt::print(out, "{}, {} x {} pixels, {} frames a second, {} on {}\n", stage.open.name,
                   stage.settings.width, stage.settings.height, options.fps, frames.tracer,
                   stage.tracer->capabilities().device);
        fmt::print(out, "{}{}", table(), summary_line(*stage.tracer, frames));
        if (!oracle) return;
        uint64_t agreed = 0;
        for (const FrameReport& report : reports) agreed += report.image.passed;
        fmt::print(out, "{}{} of {} frames agree with {}, whose scene moved the same way\n",
                   summary_line(*oracle, oracle_frames), agreed, reports.size(),
                   oracle_frames.tracer);
        fmt::print(out, "image bound: {}\nhit classes are of the primary rays; judge: {}\n",
                   results.images.front().reason, results.manifest.judge);
    }
};

}  // namespace

void render_frames(Session& session, const RenderCommand& options) {
    const FrameRange range = parse_frames(options.frames);
    const FramePattern pattern(output_path(options));
    if (!options.json.empty() && options.json != "-") check_writable(options.json);
    FrameRun run{
        session, options, range, pattern, set_up(session, options, pattern.file(range.first)),
        nullptr};
    if (options.check) {
        run.oracle = session.catalogue.at(kOracleName).make(run.stage.open.scene, {});
    }
    run.render_all();
    run.record();
    run.print();
    session.exit_code = run.passed() ? kPassed : kFailed;
    finish(session, run.results, options.json, run.stopped);
}

}  // namespace onepass::cli
