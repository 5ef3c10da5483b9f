#include "compare/cli/bench_ablation.h"

#include <memory>

#include <fmt/format.h>

#include "compare/ablation.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/table.h"
#include "compare/experiments.h"
#include "compare/frame_timing.h"
#include "compare/manifest.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

/// All sides of one scene, the strategy as it is first and second. What could not be made has a
/// record with a failure and no tracer.
struct Sides {
    std::vector<AblationRecord> records;  ///< blank, but for names
    std::vector<std::unique_ptr<Tracer>> tracers;
};

Sides make_sides(const Session& session, const Court& court, const CatalogueEntry& entry,
                 Results& results) {
    std::vector<AblationStep> steps = {{.without = {}}, {.without = {}}};
    const std::string strategy = entry.info.name.substr(0, entry.info.name.find('/'));
    for (const AblationStep& step : ablation_steps(strategy)) {
        const bool is_own =
            step.params.empty() && tracer_without(entry.info.name, step) == entry.info.name;
        if (!is_own) steps.push_back(step);
    }

    Sides sides;
    for (const AblationStep& step : steps) {
        const CatalogueEntry& listed = session.catalogue.at(tracer_without(entry.info.name, step));
        AblationRecord record;
        record.scene = court.open.name;
        record.tracer = listed.info.name;
        record.without = step.without;
        record.setting = step.params.empty() ? step.storage : params_text(step.params);
        std::unique_ptr<Tracer> tracer;
        try {
            tracer = listed.make(court.open.scene, step.params);
        } catch (const Error& error) {
            if (step.without.empty()) throw;
            record.failure = error.what();
        }
        if (sides.tracers.empty()) {
            results.tracers.push_back(
                make_tracer_record(court.open.name, *tracer, listed.info, step.params));
        }
        sides.records.push_back(std::move(record));
        sides.tracers.push_back(std::move(tracer));
    }
    return sides;
}

std::vector<Tracer*> made(const Sides& sides) {
    std::vector<Tracer*> tracers;
    for (const auto& tracer : sides.tracers) {
        if (tracer) tracers.push_back(tracer.get());
    }
    return tracers;
}

void take_samples(AblationRecord& record, const TimingRecord& timing) {
    record.rays = timing.ray_count;
    record.wall_ms = timing.wall_ms;
    record.device_ms = timing.device_ms;
}

void take_samples(AblationRecord& record, const FrameTimingRecord& timing) {
    record.rays = timing.primary_rays;
    record.errors = timing.differing_pixels;
    record.wall_ms = timing.wall_ms;
    record.device_ms = timing.device_ms;
}

/// Gives each record that has a tracer the next timing.
template <class Timing>
void take_all(std::vector<AblationRecord>& records, const std::vector<Timing>& timings) {
    size_t next = 0;
    for (AblationRecord& record : records) {
        if (record.failure.empty()) take_samples(record, timings[next++]);
    }
}

std::vector<AblationRecord> ablate_rays(Court& court, const Sides& sides, const std::string& kind,
                                        const RayRequest& request, const TimingOptions& timing,
                                        const Progress& progress, Results& results) {
    const Case subject = open_case(court, kind, request);
    std::vector<CastResult> answers;
    std::vector<std::string> names;
    for (Tracer* tracer : made(sides)) {
        answers.push_back(answers_of(subject, *tracer));
        names.push_back(tracer->name());
    }
    const std::vector<HitComparison> checks =
        check_answers(court, subject, answers, names, {.seed = timing.seed});
    const auto timings = time_casts(made(sides), 0, subject.rays, timing, progress);
    if (timings.front().wall_ms.empty()) return {};  // stopped before its first round
    std::vector<AblationRecord> records = sides.records;
    take_all(records, timings);
    results.checks.push_back(checks.front().record);  // of the strategy as it is
    size_t next = 0;
    for (AblationRecord& record : records) {
        if (!record.failure.empty()) continue;
        const CheckRecord& check = checks[next++].record;
        record.errors = check.errors();
        record.edges = check.classes[static_cast<size_t>(HitClass::edge)].count;
    }
    return records;
}

std::vector<AblationRecord> ablate_image(const Court& court, const Sides& sides,
                                         const RayRequest& request, const TimingOptions& timing,
                                         const Progress& progress) {
    const RenderSettings settings{.width = request.width, .height = request.height};
    const FrameRequest frame{court.open.scene->cameras.at(request.camera), settings, {}};
    std::vector<AblationRecord> records = sides.records;
    take_all(records, time_frames(made(sides), 0, frame, timing, progress));
    return records;
}

/// The scene's points that the study needs.
void ablate_scene(const Session& session, const BenchAblationCommand& options,
                  const std::string& name, ProgressBar& bar, Study& study) {
    std::vector<std::string> kinds = options.rays.kinds;
    std::erase_if(kinds, [&](const auto& kind) { return !study.needs(case_key(name, kind)); });
    if (kinds.empty()) return;
    const ImageSize size = parse_size(options.rays.size);
    const RayRequest request{size.width, size.height, options.rays.camera, session.globals.seed};

    // What the points share.
    Court court = open_court(session, name);
    study.check_scene(court.open.record);
    Results shared;
    shared.manifest.judge = court.judge->name();
    shared.scenes.push_back(court.open.record);
    const CatalogueEntry& entry = *session.catalogue.select(options.strategy).front();
    const Sides sides = make_sides(session, court, entry, shared);

    for (const std::string& kind : kinds) {
        if (stop_requested()) return;
        const Progress progress = next_point(bar, study);
        Results point = shared;
        point.ablations =
            kind == "image"
                ? ablate_image(court, sides, request, options.timing, progress)
                : ablate_rays(court, sides, kind, request, options.timing, progress, point);
        if (stop_requested()) return;
        for (AblationRecord& record : point.ablations) record.work = kind;
        compare_ablations(point.ablations, options.timing.seed);
        study.add(case_key(name, kind), std::move(point));
    }
}

std::string side_name(const AblationRecord& record, bool is_first) {
    if (!record.without.empty()) return record.without;
    return is_first ? "as it is" : "as it is, again";
}

void print(const Results& results, std::FILE* out) {
    const std::vector<AblationRecord>& all = results.ablations;
    for (size_t begin = 0; begin < all.size();) {
        const AblationRecord& full = all[begin];
        std::vector<std::vector<std::string>> rows = {
            {"without", "setting", "relative", "95 % interval", "Mrays/s", "ms", "errors", "edge"}};
        for (; begin < all.size(); ++begin) {
            const AblationRecord& r = all[begin];
            if (r.scene != full.scene || r.work != full.work) break;
            const bool timed = r.failure.empty();
            rows.push_back({side_name(r, rows.size() == 1), r.setting,
                            timed ? fmt::format("{:.3f}", r.ratio) : "-",
                            timed ? fmt::format("{:.3f}..{:.3f}", r.ratio_low, r.ratio_high) : "-",
                            timed ? fmt::format("{:.3f}", mrays_per_s(r)) : "-",
                            timed ? fmt::format("{:.3f}", median_ms(r)) : "-",
                            std::to_string(r.errors), std::to_string(r.edges)});
        }
        fmt::print(out, "{}, {}, {}: {} rays; speed relative to the strategy as it is\n{}",
                   full.scene, full.work, full.tracer, full.rays, format_table(rows));
    }
    fmt::print(out, "judge of the errors: {}\n", results.manifest.judge);
}

}  // namespace

void bench_ablation(Session& session, const BenchAblationCommand& options) {
    check_scene_names(options.scenes);
    parse_size(options.rays.size);
    BenchAblationCommand command = options;
    command.timing.seed = session.globals.seed;
    check_repetitions(command.timing);
    const std::vector<const CatalogueEntry*> entries = session.catalogue.select(command.strategy);
    std::vector<std::string> keys;
    for (const std::string& scene : command.scenes) {
        for (const std::string& kind : command.rays.kinds) keys.push_back(case_key(scene, kind));
    }

    Study study = open_study(session, command.study, std::move(keys), entries);
    {
        ProgressBar bar("bench --ablate");
        for (const std::string& scene : command.scenes) {
            if (stop_requested()) break;
            ablate_scene(session, command, scene, bar, study);
        }
    }
    Results results = study.results();
    print(results, table_stream(command.study.json));
    finish_study(session, study, results, command.study);
}

}  // namespace onepass::cli
