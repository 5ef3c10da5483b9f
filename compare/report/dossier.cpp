#include "compare/report/dossier.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

namespace onepass::report {
namespace {

SceneDossier& scene_named(Dossier& dossier, const std::string& name) {
    for (SceneDossier& scene : dossier.scenes) {
        if (scene.name == name) return scene;
    }
    dossier.scenes.emplace_back().name = name;
    return dossier.scenes.back();
}

const TracerRecord* find_tracer(const Results& run, const std::string& scene,
                                const std::string& name) {
    for (const TracerRecord& tracer : run.tracers) {
        if (tracer.scene == scene && tracer.name == name) return &tracer;
    }
    return nullptr;
}

bool same_params(const TracerRecord* a, const TracerRecord* b) {
    if (!a || !b) return a == b;
    return a->params == b->params;
}

/// The same rays (an empty hash is nobody's), the same tracer, the same counts.
bool same_check(const Entry<CheckRecord>& a, const Entry<CheckRecord>& b) {
    const auto counts = [](const CheckRecord& check) {
        std::array<uint64_t, kHitClassCount> all{};
        for (size_t c = 0; c < kHitClassCount; ++c) all[c] = check.classes[c].count;
        return all;
    };
    return !a->ray_hash.empty() && a->ray_hash == b->ray_hash && a->rays == b->rays &&
           a->tracer == b->tracer && a->oracle == b->oracle && a->judge == b->judge &&
           counts(*a.record) == counts(*b.record) && a->exhausted == b->exhausted &&
           a->allowed == b->allowed && same_params(a.tracer, b.tracer);
}

void add_check(SceneDossier& scene, const Entry<CheckRecord>& check) {
    for (Entry<CheckRecord>& known : scene.checks) {
        if (!same_check(known, check)) continue;
        if (known->picture.empty()) known = check;
        return;
    }
    scene.checks.push_back(check);
}

void add_reference(SceneDossier& scene, const Entry<CheckRecord>& check) {
    for (Entry<CheckRecord>& known : scene.references) {
        if (known->tracer != check->tracer || known->rays != check->rays) continue;
        if (check->ray_count > known->ray_count) known = check;
        return;
    }
    scene.references.push_back(check);
}

void add_version(SceneDossier& scene, const Entry<SceneRecord>& version) {
    const bool known = std::any_of(scene.versions.begin(), scene.versions.end(),
                                   [&](const auto& v) { return v->hash == version->hash; });
    if (!known) scene.versions.push_back(version);
}

void add_tracer(SceneDossier& scene, const Entry<TracerRecord>& tracer) {
    const auto same = [&](const Entry<TracerRecord>& known) {
        return known->name == tracer->name &&
               (known.run == tracer.run ||
                (known->params == tracer->params && known->device == tracer->device));
    };
    if (std::none_of(scene.tracers.begin(), scene.tracers.end(), same)) {
        scene.tracers.push_back(tracer);
    }
}

/// The same tracer, with the same parameters, on the same kind of rays.
bool same_question(const Entry<CheckRecord>& a, const Entry<CheckRecord>& b) {
    return a->tracer == b->tracer && a->rays == b->rays && a->oracle == b->oracle &&
           same_params(a.tracer, b.tracer);
}

void set_lesser_checks_apart(SceneDossier& scene) {
    std::vector<Entry<CheckRecord>> kept;
    for (const Entry<CheckRecord>& check : scene.checks) {
        const auto known = std::find_if(kept.begin(), kept.end(), [&](const auto& other) {
            return same_question(other, check);
        });
        if (known == kept.end()) {
            kept.push_back(check);
        } else {
            Entry<CheckRecord> lesser = check;
            if (check->ray_count > (*known)->ray_count) std::swap(*known, lesser);
            scene.lesser_checks.push_back(lesser);
        }
    }
    scene.checks = std::move(kept);
}

}  // namespace

Dossier gather(const std::vector<Results>& runs,
               const std::vector<std::filesystem::path>& folders) {
    Dossier dossier;
    dossier.runs = &runs;
    dossier.folders = &folders;
    for (size_t r = 0; r < runs.size(); ++r) {
        const Results& run = runs[r];
        dossier.software_renderer |= run.manifest.software_renderer;
        const auto entry = [&](const auto& record) {
            using Record = std::decay_t<decltype(record)>;
            return Entry<Record>{&record, find_tracer(run, record.scene, record.tracer), r};
        };

        for (const SceneRecord& scene : run.scenes) {
            add_version(scene_named(dossier, scene.name), {&scene, nullptr, r});
        }
        for (const TracerRecord& tracer : run.tracers) {
            add_tracer(scene_named(dossier, tracer.scene), {&tracer, &tracer, r});
            dossier.software_renderer |= tracer.software_renderer;
        }
        for (const auto& check : run.checks) {
            SceneDossier& scene = scene_named(dossier, check.scene);
            check.reference ? add_reference(scene, entry(check)) : add_check(scene, entry(check));
        }
        for (const auto& image : run.images) {
            scene_named(dossier, image.scene).images.push_back(entry(image));
        }
        for (const auto& timing : run.timings) {
            scene_named(dossier, timing.scene).timings.push_back(entry(timing));
        }
        for (const auto& point : run.sweeps) {
            scene_named(dossier, point.scene).sweeps.push_back(entry(point));
        }
        for (const auto& point : run.tradeoffs) {
            scene_named(dossier, point.scene).tradeoffs.push_back(entry(point));
        }
    }
    for (SceneDossier& scene : dossier.scenes) set_lesser_checks_apart(scene);
    return dossier;
}

std::string label(const std::string& name, const TracerRecord* tracer,
                  const std::vector<const TracerRecord*>& peers) {
    if (!tracer) return name;
    std::string values;
    for (const auto& [param, value] : tracer->params) {
        const auto differs = [&, param = &param, value = &value](const TracerRecord* peer) {
            if (!peer || peer->name != name) return false;
            const auto other = peer->params.find(*param);
            return other == peer->params.end() || other->second != *value;
        };
        if (std::none_of(peers.begin(), peers.end(), differs)) continue;
        values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", param, value);
    }
    return values.empty() ? name : fmt::format("{} ({})", name, values);
}

double param_value(const TracerRecord* tracer, const std::string& name) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (!tracer) return kNone;
    const auto value = tracer->params.find(name);
    if (value == tracer->params.end()) return kNone;
    char* end = nullptr;
    const double number = std::strtod(value->second.c_str(), &end);
    return end == value->second.c_str() ? kNone : number;
}

std::string strategy_of(const std::string& tracer_name) {
    return tracer_name.substr(0, tracer_name.find('/'));
}

}  // namespace onepass::report
