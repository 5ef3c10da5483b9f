// onepass check: every strategy against the oracle, ray by ray and pixel by pixel.
#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "compare/atomic_file.h"
#include "compare/attribution.h"
#include "compare/cli/commands.h"
#include "compare/cli/options.h"
#include "compare/cli/pictures.h"
#include "compare/cli/progress_bar.h"
#include "compare/cli/sizing.h"
#include "compare/cli/study_run.h"
#include "compare/cli/table.h"
#include "compare/frames.h"
#include "compare/hash.h"
#include "compare/images.h"
#include "compare/manifest.h"
#include "compare/pixels.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

struct CheckCommand {
    std::vector<std::string> scenes;
    StrategyOptions strategy;
    SizingOptions sizing;
    RayOptions rays{{"primary", "random"}, "512x512", 0};
    std::vector<std::string> allow;
    double sample = HitCheckOptions{}.agreement_sample;
    bool image = true;
    std::string frames;  ///< empty: the scenes at rest
    double fps = 24.0;
    bool attribute = false;
    StudyOptions study;
    std::string pictures;
};

// What the tables say.

std::string id_text(uint32_t id) { return id == kNoId ? "-" : std::to_string(id); }

std::string hit_text(const Hit& hit) {
    if (!hit.is_hit()) return "miss";
    return fmt::format("t {} triangle {} instance {}", hit.t, id_text(hit.prim_id),
                       id_text(hit.inst_id));
}

std::string vector_text(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

std::string worst_text(HitClass hit_class, const WorstRay& worst) {
    const Verdict& verdict = worst.verdict;
    const std::string truth =
        verdict.true_inst_id == kNoId
            ? "miss"
            : fmt::format("t {} triangle {} instance {}", verdict.true_t,
                          id_text(verdict.true_prim_id), id_text(verdict.true_inst_id));
    std::string text = fmt::format(
        "    worst {}: ray {} org {} tmin {} dir {} tmax {}\n      answer {}; oracle {}; judge {}",
        to_string(hit_class), worst.index, vector_text(worst.ray.org), worst.ray.tmin,
        vector_text(worst.ray.dir), worst.ray.tmax, hit_text(worst.answer), hit_text(worst.oracle),
        truth);
    if (!std::isnan(verdict.t_error_ulps)) {
        text += fmt::format("; t off by {:.3g} ulps", verdict.t_error_ulps);
    }
    if (hit_class == HitClass::edge) {
        text +=
            fmt::format("; right for a ray moved by {:.3g} of the bound", verdict.backward_error);
    }
    return text + "\n";
}

/// The bounds that a record breaks; "" if none.
std::string failure_text(const CheckRecord& record) {
    std::string reasons;
    for (size_t c = 0; c < kHitClassCount; ++c) {
        if (record.classes[c].count <= record.allowed[c]) continue;
        reasons += fmt::format("{}{} {} > {}", reasons.empty() ? ": " : ", ",
                               to_string(static_cast<HitClass>(c)), record.classes[c].count,
                               record.allowed[c]);
    }
    return reasons;
}

std::string verdict_text(const CheckRecord& record) {
    if (record.reference) return record.tracer == record.oracle ? "(the oracle)" : "(beside it)";
    return record.passed ? "passed" : "FAILED";
}

/// The wrong rays of one record, by the deviation that each disappears without.
std::string attribution_text(const CheckRecord& record, const Attribution& attribution) {
    std::string text = fmt::format("{}, {} rays, {}: where {} wrong rays come from\n", record.scene,
                                   record.rays, record.tracer, record.errors());
    std::map<std::string, Culprit> by_id;
    for (const Culprit& culprit : attribution.culprits) by_id[culprit.id()] = culprit;
    for (const auto& [id, count] : attribution.record.by_deviation) {
        if (count == 0) continue;
        text += fmt::format("  {} rays by {}\n", count, id);
        for (const Deviation& deviation : by_id[id].off) {
            text += fmt::format("    {}: {}; gone with --param {}={}\n", deviation.id,
                                deviation.summary, deviation.param, deviation.value);
        }
    }
    text += fmt::format("  {} rays unattributed\n", attribution.record.unattributed);
    if (const auto& worst = attribution.worst_unattributed) {
        text += worst_text(worst->verdict.hit_class, *worst);
    }
    return text;
}

/// The records of one scene and one ray set.
std::string check_table(const std::vector<const CheckRecord*>& records) {
    const CheckRecord& first = *records.front();
    std::string text = fmt::format(
        "{}, {} rays: {} rays, of which {} hit; {} the oracle cannot take; edge budget {}\n",
        first.scene, first.rays, first.ray_count, first.hit_count, first.oracle_invalid,
        first.allowed[static_cast<size_t>(HitClass::edge)]);
    std::vector<std::string> heading = {"tracer"};
    for (size_t c = 0; c < kHitClassCount; ++c) {
        heading.emplace_back(to_string(static_cast<HitClass>(c)));
    }
    heading.insert(heading.end(), {"other triangle", "exhausted", "judged", "verdict"});

    std::vector<std::vector<std::string>> rows = {heading};
    std::string worst;
    for (const CheckRecord* record : records) {
        std::vector<std::string> row = {record->tracer};
        for (size_t c = 0; c < kHitClassCount; ++c) {
            row.push_back(std::to_string(record->classes[c].count));
        }
        row.insert(row.end(),
                   {std::to_string(record->wrong_triangle), std::to_string(record->exhausted),
                    std::to_string(record->judged), verdict_text(*record)});
        rows.push_back(row);

        worst += fmt::format("  {}{}\n", record->tracer, failure_text(*record));
        for (size_t c = 0; c < kHitClassCount; ++c) {
            const auto& ray = record->classes[c].worst;
            if (ray) worst += worst_text(static_cast<HitClass>(c), *ray);
        }
    }
    return text + format_table(rows) + worst;
}

std::string image_line(const ImageRecord& image) {
    return fmt::format(
        "{}, image {} x {}: {} against {}: PSNR {:.1f} dB, RMSE {:.3g}, largest difference {:.3g} "
        "at ({}, {}), {} pixels differ by more than {:.3g} ({} allowed), {:.2f} rays a pixel: "
        "{}\n",
        image.scene, image.width, image.height, image.tracer, image.oracle, image.psnr_db,
        image.rmse, image.max_difference, image.max_x, image.max_y, image.differing_pixels,
        image.tolerance, image.allowed_pixels, image.rays_per_pixel,
        image.passed ? "passed" : "FAILED");
}

// The work.

/// The work on a scene's image has a key like that on its rays.
constexpr char kImage[] = "image";

/// What a tracer's image leaves for the sheet of pixels.
struct ImageTrace {
    Picture picture;
    std::vector<RayCounters> counters;  ///< empty: it counts none
};
using ImageTraces = std::map<std::string, ImageTrace>;  ///< by tracer

/// The chosen of a whole image's values; none of none.
template <class T>
std::vector<T> chosen_of(const std::vector<T>& values, std::span<const uint32_t> indices) {
    std::vector<T> chosen;
    if (values.empty()) return chosen;
    for (const uint32_t index : indices) chosen.push_back(values[index]);
    return chosen;
}

/// One run of the command: fills `study`, and `pictures` beside it.
struct CheckRun {
    Session& session;
    const CheckCommand& options;
    const std::vector<SelectedStrategy> asked;
    const ImageSize size;
    const HitCheckOptions hit_options;
    PictureSet pictures;
    Study study;
    std::string attributions = {};            ///< as text
    std::vector<std::string> cast_only = {};  ///< scenes and tracers without an image to compare
    std::exception_ptr refused = {};          ///< why the last strategy could not take a scene
    std::vector<SelectedStrategy> selected =
        {};  ///< those asked for, as this scene's sizing has it

    RayRequest ray_request() const {
        return {size.width, size.height, options.rays.camera, session.globals.seed};
    }

    void attribute(const Court& court, const Case& subject, const SelectedStrategy& strategy,
                   HitComparison& comparison) {
        const auto suspects = suspects_of(*strategy.entry, court.open.scene, strategy.params);
        const Attribution attribution =
            attribute_errors(comparison.wrong, subject.rays.query, *court.judge, suspects);
        comparison.record.attribution = attribution.record;
        attributions += attribution_text(comparison.record, attribution);
    }

    /// Null, and a refusal more, if the strategy cannot take the scene: what others have found, or
    /// will, is kept. Throws: Error where there is no device.
    std::unique_ptr<Tracer> made(const std::string& name, const CatalogueEntry& entry,
                                 const ScenePtr& scene, const ParamValues& params,
                                 Results& results) {
        try {
            return entry.make(scene, params);
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::device) throw;
            refused = std::current_exception();
            results.refusals.push_back({name, entry.info.name, error.what()});
            return nullptr;
        }
    }

    /// Judges all answers to one case, the first of them those of the selected strategies
    /// `taking_part`.
    void check_hits(const Court& court, const Case& subject, std::span<const CastResult> answers,
                    std::span<const std::string> tracers, std::span<const size_t> taking_part,
                    const ImageTraces& traces, Results& results) {
        const RaySet& rays = subject.rays;
        auto comparisons = check_answers(court, subject, answers, tracers, hit_options);
        for (size_t i = 0; i < comparisons.size(); ++i) {
            HitComparison& comparison = comparisons[i];
            const bool is_checked = i < taking_part.size();
            comparison.record.reference = !is_checked;
            if (options.attribute && is_checked) {
                attribute(court, subject, selected[taking_part[i]], comparison);
            }
            if (!rays.pixels.empty() && is_checked) {
                comparison.record.picture = pictures.add(
                    fmt::format("{}_{}_{}_classes", court.open.name, tracers[i], rays.name),
                    class_picture(comparison.classes, rays.pixels, rays.width, rays.height));
            }
            results.checks.push_back(std::move(comparison.record));
        }
        if (rays.name == "primary" && pictures.has_folder()) {
            keep_pixels(court.open.name, rays, answers, tracers, comparisons, traces, results);
        }
    }

    /// The sheet of pixels, for the page's inspector.
    void keep_pixels(const std::string& scene, const RaySet& rays,
                     std::span<const CastResult> answers, std::span<const std::string> tracers,
                     std::span<const HitComparison> comparisons, const ImageTraces& traces,
                     Results& results) {
        // Which pixels, and the ray of each.
        std::vector<RayClasses> classes;
        for (const HitComparison& comparison : comparisons) classes.push_back(comparison.classes);
        const auto [chosen, left_out] =
            choose_pixels(classes, rays.pixels, rays.width, rays.height);
        std::vector<uint32_t> ray_of(size_t{rays.width} * rays.height);
        for (size_t ray = 0; ray < rays.pixels.size(); ++ray) {
            ray_of[rays.pixels[ray]] = static_cast<uint32_t>(ray);
        }
        const std::vector<uint32_t> chosen_rays = chosen_of(ray_of, chosen);

        // Every tracer's answers.
        PixelSheet sheet{scene, rays.width, rays.height, chosen, {}};
        for (size_t i = 0; i < tracers.size(); ++i) {
            SheetColumn& column = sheet.tracers.emplace_back();
            column.tracer = tracers[i];
            column.hits = chosen_of(answers[i].hits, chosen_rays);
            column.classes = chosen_of(classes[i], chosen_rays);
            const auto image = traces.find(tracers[i]);
            if (image == traces.end()) continue;
            column.colors = chosen_of(image->second.picture.pixels, chosen);
            column.counters = chosen_of(image->second.counters, chosen);
        }
        std::string text = to_json(sheet);
        PixelSheetRecord record{scene,    rays.width, rays.height,      chosen.size(),
                                left_out, "",         sha256_text(text)};
        record.file = pictures.add_file(scene + "_pixels", ".json", std::move(text));
        if (!record.file.empty()) results.pixel_sheets.push_back(std::move(record));
    }

    ImageRecord check_image_of(const Court& court, const Frame& truth, Tracer& tracer,
                               ImageTraces& traces) {
        const RenderSettings settings{.width = size.width, .height = size.height};
        const Camera& camera = court.open.scene->cameras[options.rays.camera];
        const Frame frame = tracer.render(camera, settings);
        ImageRecord record = compare_images(frame, truth);
        record.scene = court.open.name;
        record.tracer = tracer.name();
        record.oracle = court.oracle->name();

        traces[tracer.name()] = {tone_mapped(frame), {}};
        if (tracer.capabilities().counters) traces[tracer.name()].counters = frame.counters;

        const auto add = [&](const std::string& role, const std::string& owner, Picture picture) {
            const std::string path =
                pictures.add(fmt::format("{}_{}_{}", court.open.name, owner, role), picture);
            if (!path.empty()) record.pictures.emplace_back(role, path);
        };
        add("image", tracer.name(), tone_mapped(frame));
        add("oracle", court.oracle->name(), tone_mapped(truth));
        add("difference", tracer.name(), difference_picture(frame, truth, record.tolerance));
        if (tracer.capabilities().counters) {
            HeatMap cells = cells_heat_map(frame);
            record.cells_full_scale = cells.full_scale;
            add("cells", tracer.name(), std::move(cells.picture));
        }
        return record;
    }

    /// Writes the pictures and the sheet first: no record may name one that is not there.
    void finish_point(const std::string& key, Results point) {
        pictures.write();
        study.add(key, std::move(point));
    }

    /// The scene's points that the study needs; at a frame, the scene is a scene of its own.
    void check_scene(const std::string& name, std::optional<uint32_t> frame, ProgressBar& bar) {
        const std::string frame_or_name = frame ? frame_name(name, *frame) : name;
        std::vector<std::string> kinds = options.rays.kinds;
        std::erase_if(
            kinds, [&](const auto& kind) { return !study.needs(case_key(frame_or_name, kind)); });
        const bool image = options.image && study.needs(case_key(frame_or_name, kImage));
        if (kinds.empty() && !image) return;

        // The truth, once. Tracers are made at rest, and moved to the frame.
        Court court = open_court(session, name);
        const ScenePtr at_rest = court.open.scene;
        selected = sized(session, court.open, asked, options.sizing, options.rays.kinds,
                         options.rays.camera);
        const std::vector<Affine> transforms =
            frame ? move_to_frame(court, *frame, options.fps) : std::vector<Affine>();
        study.check_scene(court.open.record);
        Results shared;
        shared.manifest.judge = court.judge->name();
        shared.scenes.push_back(court.open.record);
        std::vector<Case> cases;
        for (const std::string& kind : kinds) {
            cases.push_back(open_case(court, kind, ray_request()));
        }
        Frame truth;
        // The image is rendered for its own point, and for the sheet of pixels.
        const bool has_sheet = pictures.has_folder() && std::ranges::count(kinds, "primary") > 0;
        const bool render = options.image && (image || has_sheet);
        ImageTraces traces;
        if (render) {
            truth = court.oracle->render(court.open.scene->cameras.at(options.rays.camera),
                                         {.width = size.width, .height = size.height});
            traces[court.oracle->name()] = {tone_mapped(truth), {}};
        }

        // Every strategy answers.
        std::vector<ImageRecord> images;
        std::vector<size_t> taking_part;
        std::vector<std::string> tracers;
        std::vector<std::vector<CastResult>> answers(cases.size());
        const auto cast_all = [&](Tracer& tracer) {
            tracers.push_back(tracer.name());
            for (size_t c = 0; c < cases.size(); ++c) {
                answers[c].push_back(answers_of(cases[c], tracer));
            }
        };
        const Progress progress = next_point(bar, study);
        const double steps = static_cast<double>(selected.size() + 1);
        for (size_t s = 0; s < selected.size(); ++s) {
            if (!go_on(progress, static_cast<double>(s) / steps)) return;
            const auto& [entry, params] = selected[s];
            const std::unique_ptr<Tracer> tracer =
                made(court.open.name, *entry, at_rest, params, shared);
            if (!tracer) continue;
            taking_part.push_back(s);
            if (frame) tracer->update(transforms);
            shared.tracers.push_back(
                make_tracer_record(court.open.name, *tracer, entry->info, params));
            shared.tracers.back().sizing = sizing_name(entry->info, options.sizing);
            cast_all(*tracer);
            if (render && tracer->capabilities().render) {
                images.push_back(check_image_of(court, truth, *tracer, traces));
            } else if (image) {
                cast_only.push_back(fmt::format("{}, {}", court.open.name, tracer->name()));
            }
        }

        // Where nobody found anything, the reason is the result.
        if (refused && taking_part.empty() && study.done() == 0) std::rethrow_exception(refused);

        // Embree answers beside them, and all are judged.
        for (const char* reference : {kFastEmbreeName, kOracleName}) {
            if (std::find(tracers.begin(), tracers.end(), reference) != tracers.end()) continue;
            const CatalogueEntry& entry = session.catalogue.at(reference);
            if (reference == court.oracle->name()) {
                shared.tracers.push_back(
                    make_tracer_record(court.open.name, *court.oracle, entry.info, {}));
                tracers.emplace_back(reference);
                for (size_t c = 0; c < cases.size(); ++c) answers[c].push_back(cases[c].truth);
                continue;
            }
            const std::unique_ptr<Tracer> embree = entry.make(court.open.scene, {});
            shared.tracers.push_back(make_tracer_record(court.open.name, *embree, entry.info, {}));
            cast_all(*embree);
        }
        if (image) {
            Results point = shared;
            point.images = std::move(images);
            finish_point(case_key(frame_or_name, kImage), std::move(point));
        }
        for (size_t c = 0; c < cases.size(); ++c) {
            if (!go_on(next_point(bar, study), 0.0)) return;
            Results point = shared;
            check_hits(court, cases[c], answers[c], tracers, taking_part, traces, point);
            finish_point(case_key(frame_or_name, kinds[c]), std::move(point));
        }
    }

    void print(const Results& results) const {
        std::FILE* out = table_stream(options.study.json);
        for (const SceneRecord& scene : results.scenes) {
            for (const std::string& kind : options.rays.kinds) {
                std::vector<const CheckRecord*> records;
                for (const CheckRecord& record : results.checks) {
                    if (record.scene == scene.name && record.rays == kind) {
                        records.push_back(&record);
                    }
                }
                if (!records.empty()) fmt::print(out, "{}", check_table(records));
            }
            for (const ImageRecord& image : results.images) {
                if (image.scene == scene.name) fmt::print(out, "{}", image_line(image));
            }
        }
        for (const std::string& what : cast_only) {
            fmt::print(out, "{}: answers rays only, so there is no image to compare\n", what);
        }
        for (const RefusalRecord& refusal : results.refusals) {
            fmt::print(out, "refused: {}, {}: {}\n", refusal.scene, refusal.tracer, refusal.reason);
        }
        fmt::print(out, "{}judge: {}\n", attributions, results.manifest.judge);
        if (!results.images.empty()) {
            fmt::print(out, "image bound: {}\n", results.images.front().reason);
        }
    }
};

bool passed(const Results& results) {
    bool all = results.refusals.empty();
    for (const CheckRecord& record : results.checks) all &= record.passed || record.reference;
    for (const ImageRecord& record : results.images) all &= record.passed;
    return all;
}

void run(Session& session, const CheckCommand& options) {
    check_scene_names(options.scenes);
    HitCheckOptions hit_options;
    hit_options.allowed = parse_allowances(options.allow);
    hit_options.agreement_sample = options.sample;
    hit_options.seed = session.globals.seed;
    const ImageSize size = parse_size(options.rays.size);
    std::vector<SelectedStrategy> selected = select_strategies(session.catalogue, options.strategy);
    std::vector<const CatalogueEntry*> entries;
    for (const SelectedStrategy& strategy : selected) entries.push_back(strategy.entry);

    // The points: each scene, or each of its frames, by kinds of rays; then its image.
    std::vector<std::optional<uint32_t>> frames = {std::nullopt};
    if (!options.frames.empty()) {
        const FrameRange range = parse_frames(options.frames);
        frames.clear();
        for (uint64_t k = 0; k < range.count(); ++k) {
            frames.emplace_back(range.first + static_cast<uint32_t>(k));
        }
    }
    std::vector<std::string> keys;
    for (const std::string& scene : options.scenes) {
        for (const std::optional<uint32_t>& frame : frames) {
            const std::string name = frame ? frame_name(scene, *frame) : scene;
            for (const std::string& kind : options.rays.kinds) {
                keys.push_back(case_key(name, kind));
            }
            if (options.image) keys.push_back(case_key(name, kImage));
        }
    }

    CheckRun check{session,
                   options,
                   std::move(selected),
                   size,
                   hit_options,
                   PictureSet(options.pictures, options.study.json),
                   open_study(session, options.study, std::move(keys), entries)};
    {
        ProgressBar bar("check");
        for (const std::string& scene : options.scenes) {
            for (const std::optional<uint32_t>& frame : frames) {
                if (!stop_requested()) check.check_scene(scene, frame, bar);
            }
        }
    }
    Results results = check.study.results();
    check.print(results);
    session.exit_code = passed(results) ? kPassed : kFailed;
    check.pictures.report();
    finish_study(session, check.study, results, options.study);
}

}  // namespace

void add_check(CLI::App& app, Session& session) {
    CLI::App* command = app.add_subcommand(
        "check", "Checks strategies against Embree: hits by class, and the image");
    auto options = std::make_shared<CheckCommand>();
    command->add_option("scenes", options->scenes, "Scene names or files")->required();
    add_strategy_options(*command, options->strategy);
    add_sizing_options(*command, options->sizing);
    add_ray_options(*command, options->rays);
    command
        ->add_option("--allow", options->allow,
                     fmt::format("Bound of a class instead of the default; may be repeated. "
                                 "Defaults: false_miss, false_hit, wrong_surface and t_error 0; "
                                 "edge {} of the rays",
                                 kEdgeShare))
        ->type_name("CLASS=N")
        ->allow_extra_args(false);
    command
        ->add_option("--sample", options->sample,
                     "Share of the rays on which tracer and oracle agree that is judged "
                     "nevertheless; 1 judges every ray")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command->add_flag("--image,!--no-image", options->image,
                      "Also compares the rendered image with Embree's (default: yes)");
    CLI::Option* frames =
        command->add_option("--frames", options->frames,
                            "Checks these frames of a moving scene, each as a scene of its own, "
                            "instead of the scene at rest; see render --frames");
    frames->type_name("A..B");
    command->add_option("--fps", options->fps, "Frames a second")
        ->check(CLI::PositiveNumber)
        ->needs(frames)
        ->capture_default_str();
    command->add_flag(
        "--attribute", options->attribute,
        "Also casts the wrong rays again with each deviation of the strategy switched "
        "off, and counts them by the first that each disappears without");
    add_study_options(*command, options->study);
    command
        ->add_option("--pictures", options->pictures,
                     "Folder for PNGs of images, differences, cells and classes. Default: "
                     "beside the JSON; without one, none")
        ->type_name("DIR");
    command->callback([&session, options] { run(session, *options); });
}

}  // namespace onepass::cli
