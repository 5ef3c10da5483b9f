#include "compare/cli/paper_steps.h"

#include <array>
#include <cstdio>

#include <fmt/format.h>

#include "compare/attribution.h"
#include "compare/cli/options.h"
#include "compare/frame_timing.h"
#include "compare/image_io.h"
#include "compare/images.h"
#include "compare/manifest.h"
#include "compare/paper_figures.h"
#include "core/error.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace onepass::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array kRayKinds = {"primary", "shadow", "reflection"};

/// One of the paper's scenes, being measured.
struct PaperSceneRun {
    Session& session;
    const PaperEffort& effort;
    const fs::path& folder;
    Results& results;
    Court court;
    uint32_t side = 0;
    std::vector<const CatalogueEntry*> entries;
    std::vector<std::unique_ptr<Tracer>> owned;
    std::vector<Tracer*> tracers;  ///< the oracle first, then those of `entries`

    void make_tracers(const std::vector<std::string>& names) {
        const CatalogueEntry& oracle = session.catalogue.at(kOracleName);
        tracers.push_back(court.oracle.get());
        results.tracers.push_back(
            make_tracer_record(court.open.name, *court.oracle, oracle.info, {}));
        for (const std::string& name : names) {
            const CatalogueEntry& entry = session.catalogue.at("paper/texture2d/" + name);
            entries.push_back(&entry);
            owned.push_back(entry.make(court.open.scene, {}));
            tracers.push_back(owned.back().get());
            results.tracers.push_back(
                make_tracer_record(court.open.name, *owned.back(), entry.info, {}));
        }
    }

    CheckRecord check(const Case& subject, size_t tracer) {
        HitComparison comparison =
            check_tracer(court, subject, *tracers[tracer], {.seed = session.globals.seed});
        if (tracer > 0) {  // the oracle declares no deviation
            comparison.record.attribution =
                attribute_errors(comparison.wrong, subject.rays.query, *court.judge,
                                 suspects_of(*entries[tracer - 1], court.open.scene, {}))
                    .record;
        }
        return comparison.record;
    }

    void measure_rays(const std::string& kind, const Progress& progress) {
        const Case subject = open_case(court, kind, {side, side, 0, session.globals.seed});
        std::vector<TimingRecord> timings =
            time_casts(tracers, 0, subject.rays, timing(), progress);
        for (size_t i = 0; i < timings.size(); ++i) {
            const CheckRecord record = check(subject, i);
            timings[i].scene = court.open.name;
            timings[i].errors = record.errors();
            timings[i].edges = record.classes[static_cast<size_t>(HitClass::edge)].count;
            if (i > 0) results.checks.push_back(record);
        }
        results.timings.insert(results.timings.end(), timings.begin(), timings.end());
    }

    void measure_frames(const Progress& progress) {
        const FrameRequest request{camera(), settings(), {}};
        for (FrameTimingRecord& record : time_frames(tracers, 0, request, timing(), progress)) {
            record.scene = court.open.name;
            results.frame_timings.push_back(std::move(record));
        }
    }

    /// The pictures are the first entry's: the others' are to look the same.
    void compare_pictures() {
        const Frame truth = court.oracle->render(camera(), settings());
        for (size_t i = 1; i < tracers.size(); ++i) {
            const Frame frame = tracers[i]->render(camera(), settings());
            ImageRecord record = compare_images(frame, truth);
            record.scene = court.open.name;
            record.tracer = tracers[i]->name();
            record.oracle = court.oracle->name();
            if (i == 1 && !folder.empty() && image_files_supported()) {
                save(record, "image", tone_mapped(frame));
                save(record, "oracle", tone_mapped(truth));
                save(record, "difference", difference_picture(frame, truth, record.tolerance));
            }
            results.images.push_back(std::move(record));
        }
    }

    void save(ImageRecord& record, const std::string& role, const Picture& picture) const {
        const std::string name =
            "pictures/" + file_name_part(fmt::format("{}_{}.png", court.open.name, role));
        write_png(folder / name, picture);
        record.pictures.emplace_back(role, name);
    }

    TimingOptions timing() const {
        TimingOptions options = effort.timing;
        options.seed = session.globals.seed;
        return options;
    }
    const Camera& camera() const { return court.open.scene->cameras.at(0); }
    RenderSettings settings() const { return {.width = side, .height = side}; }
};

/// "sphere-NxM" as N and M; nothing for any other name.
std::optional<std::pair<uint32_t, uint32_t>> parse_sphere(const std::string& name) {
    unsigned slices = 0, stacks = 0;
    char rest = 0;
    if (std::sscanf(name.c_str(), "sphere-%ux%u%c", &slices, &stacks, &rest) != 2) return {};
    if (slices < 3 || stacks < 2) return {};
    return std::pair{slices, stacks};
}

Scene sphere_scene(uint32_t slices, uint32_t stacks) {
    Scene scene;
    scene.name = fmt::format("sphere-{}x{}", slices, stacks);
    scene.objects = {make_sphere(slices, stacks)};
    scene.materials.resize(1);
    scene.instances = {{"ball", 0, affine_identity(), {0}}};
    LoadedScene loaded{std::move(scene), {}};
    supply_missing(loaded);
    validate(loaded.scene);
    return std::move(loaded.scene);
}

Scene in_form(Scene scene, SceneForm form) {
    switch (form) {
        case SceneForm::as_is:
            break;
        case SceneForm::flattened:
            return flattened(scene);
        case SceneForm::unshared:
            return unshared(scene);
    }
    return scene;
}

std::vector<std::vector<Affine>> evenly_posed(const Scene& scene, uint32_t frames) {
    if (scene.animation.empty()) {
        throw Error({scene.name, "a scene without an animation", "one in which something moves",
                     "'onepass list scenes' shows which do."});
    }
    std::vector<std::vector<Affine>> poses;
    for (uint32_t f = 0; f < frames; ++f) {
        poses.push_back(
            instance_transforms(scene, double{scene.animation.duration()} * f / frames));
    }
    return poses;
}

}  // namespace

PaperEffort paper_effort(bool software_renderer, bool quick) {
    PaperEffort effort;
    if (quick) {
        effort.timing.repetitions = kLeastRepetitions;
        effort.timing.warm_up_rounds = 0;
        effort.timing.warm_up_ms = 0.0;
        effort.frames = 2;
        effort.shrink = 16;
    } else if (!software_renderer) {
        effort.timing.warm_up_ms = 1000.0;  // an idle chip clocks low
        effort.grow = 4;
    }
    return effort;
}

bool measure_paper_scene(Session& session, const std::string& scene,
                         const std::vector<std::string>& entries, const PaperEffort& effort,
                         const fs::path& folder, const Progress& progress, Results& results) {
    PaperSceneRun run{session,
                      effort,
                      folder,
                      results,
                      open_court(session, scene),
                      kPaperImageSide / effort.shrink,
                      {},
                      {},
                      {}};
    results.manifest.judge = run.court.judge->name();
    results.scenes.push_back(run.court.open.record);
    run.make_tracers(entries);

    // Hits and speed by ray kind, then whole frames, in equal shares of the progress.
    constexpr double kShare = 1.0 / (kRayKinds.size() + 1);
    double done = 0.0;
    const Progress part = [&](double share) { return go_on(progress, done + kShare * share); };
    for (const char* kind : kRayKinds) {
        run.measure_rays(kind, part);
        done += kShare;
        if (!part(0.0)) return false;
    }
    run.measure_frames(part);
    if (!part(1.0)) return false;
    run.compare_pictures();
    return true;
}

Workshop make_workshop(const Session& session, const PaperEffort& effort) {
    Workshop workshop;
    workshop.catalogue = &session.catalogue;
    workshop.scene = [](const std::string& name, SceneForm form) {
        const auto sphere = parse_sphere(name);
        Scene scene = sphere ? sphere_scene(sphere->first, sphere->second) : load_scene(name).scene;
        return std::make_shared<const Scene>(in_form(std::move(scene), form));
    };
    workshop.referees = [&session](const ScenePtr& scene) {
        return Referees{session.catalogue.at(kOracleName).make(scene, {}), make_exact_judge(scene)};
    };
    workshop.poses = evenly_posed;
    workshop.timing = effort.timing;
    workshop.timing.seed = session.globals.seed;
    workshop.frames = effort.frames;
    workshop.grow = effort.grow;
    workshop.shrink = effort.shrink;
    return workshop;
}

}  // namespace onepass::cli
