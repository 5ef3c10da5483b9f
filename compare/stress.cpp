#include "compare/stress.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "compare/hits.h"
#include "compare/rays.h"
#include "compare/rungs.h"
#include "core/error.h"

namespace onepass {
namespace {

/// One contestant on one rung.
struct Climber {
    RungRecord record;
    CastResult answers;  ///< empty after a refusal, or if it gave up
};

// ---- Casting

/// The contestant's parameters, and those of the rung that its tracer has.
ParamValues params_on(const Rung& rung, const Contestant& contestant) {
    ParamValues params = contestant.params;
    for (const ParamInfo& info : contestant.entry->info.params) {
        const auto given = rung.params.find(info.name);
        if (given != rung.params.end()) params[info.name] = given->second;
    }
    return params;
}

bool takes_part(const Rung& rung, const Contestant& contestant) {
    const std::vector<ParamInfo>& infos = contestant.entry->info.params;
    return rung.params.empty() || std::any_of(infos.begin(), infos.end(), [&](const auto& info) {
               return rung.params.contains(info.name);
           });
}

Climber cast_rung(const Rung& rung, const Contestant& contestant, const ScenePtr& scene,
                  const RaySet& rays) {
    Climber climber{empty_record(rung.knob, rung.label, contestant), {}};
    std::unique_ptr<Tracer> tracer;
    RayBatch batch;
    try {
        tracer = contestant.entry->make(scene, params_on(rung, contestant));
        batch = tracer->upload(rays.rays);
    } catch (const Error& error) {
        if (error.kind() == Error::Kind::device) throw;
        climber.record.refusal = refusal_text(error);
        return climber;
    }
    try {
        climber.answers = tracer->cast(batch, {.query = rays.query});
    } catch (const Error&) {
        give_up(climber.record, rays.rays.size());
        return climber;
    }
    ONEPASS_CHECK_EQ(climber.answers.hits.size(), rays.rays.size());
    ONEPASS_CHECK_EQ(climber.answers.flags.size(), rays.rays.size());
    return climber;
}

RaySet rays_of(const Rung& rung, const ScenePtr& scene, const StressSetup& setup) {
    RaySet set;
    if (rung.ray_kind.empty()) {
        set.rays = rung.make_rays(*scene, setup.rays, setup.seed);
    } else {
        const auto oracle = setup.make_oracle(scene);
        const RayRequest request{
            .width = static_cast<uint32_t>(setup.rays), .height = 1, .seed = setup.seed};
        set = make_ray_set(rung.ray_kind, *scene, *oracle, request);
    }
    if (set.rays.empty()) {
        throw Error({fmt::format("scene '{}'", scene->name), "no ray", "at least one",
                     "Ask for more rays, or mend the ladder."});
    }
    return set;
}

// ---- Judging

/// One verdict a climber; a default one for those that did not answer.
std::vector<Verdict> judge_ray(const Judge& judge, const Ray& ray, Query query, size_t index,
                               const std::vector<Climber>& climbers) {
    std::vector<Hit> answers;
    for (const Climber& climber : climbers) {
        if (!climber.answers.hits.empty()) answers.push_back(climber.answers.hits[index]);
    }
    const std::vector<Verdict> judged = judge_distinct(judge, ray, query, answers);
    std::vector<Verdict> verdicts(climbers.size());
    auto next = judged.begin();
    for (size_t c = 0; c < climbers.size(); ++c) {
        if (!climbers[c].answers.hits.empty()) verdicts[c] = *next++;
    }
    return verdicts;
}

/// Counts one answer. `index` and `ray` are kept if it is the worst failure so far.
void tally(Climber& climber, size_t index, const Ray& ray, const Verdict& verdict) {
    RungRecord& record = climber.record;
    ++record.trials;
    record.ties += verdict.hit_class == HitClass::tie;
    record.edges += verdict.hit_class == HitClass::edge;
    const bool exhausted = (climber.answers.flags[index] & kFlagExhausted) != 0;
    if (!exhausted && !is_error(verdict.hit_class)) return;
    add_failure(record, exhausted ? kExhausted : to_string(verdict.hit_class));
    if (!record.worst || is_worse(verdict, record.worst->verdict)) {
        record.worst =
            WorstRay{index, ray, climber.answers.hits[index], true_hit(verdict), verdict};
    }
}

void judge_rung(const Judge& judge, const RaySet& rays, std::vector<Climber>& climbers) {
    const bool anybody = std::any_of(climbers.begin(), climbers.end(), [](const Climber& climber) {
        return !climber.answers.hits.empty();
    });
    if (!anybody) return;

    // Judge, in parallel.
    std::vector<std::vector<Verdict>> verdicts(rays.rays.size());
    tbb::parallel_for(size_t{0}, rays.rays.size(), [&](size_t i) {
        verdicts[i] = judge_ray(judge, rays.rays[i], rays.query, i, climbers);
    });

    // Tally, in the order of the rays.
    for (size_t c = 0; c < climbers.size(); ++c) {
        Climber& climber = climbers[c];
        if (climber.answers.hits.empty()) continue;
        size_t not_taken = 0;
        for (size_t i = 0; i < rays.rays.size(); ++i) {
            if (climber.answers.flags[i] & kFlagOracleInvalid) {
                ++not_taken;
            } else {
                tally(climber, i, rays.rays[i], verdicts[i][c]);
            }
        }
        if (not_taken > 0) {
            climber.record.refusal =
                fmt::format("takes {} of {} rays", climber.record.trials, rays.rays.size());
        }
    }
}

bool on_same_rung(const RungRecord& a, const RungRecord& b) {
    return a.knob == b.knob && a.label == b.label;
}

}  // namespace

LadderRecord climb(const Ladder& ladder, const StressSetup& setup, const Progress& progress) {
    LadderRecord record{.id = ladder.id,
                        .title = ladder.title,
                        .question = ladder.question,
                        .knob = ladder.knob,
                        .unit = ladder.unit,
                        .log_axis = ladder.log_axis,
                        .judge = {},
                        .command = {},
                        .rungs = {}};
    // A rung's judging counts as one more cast.
    const double steps = static_cast<double>(ladder.rungs.size() * (setup.contestants.size() + 1));
    double done = 0.0;
    for (const Rung& rung : ladder.rungs) {
        // Set up.
        if (!go_on(progress, done / steps)) return record;
        const auto scene = std::make_shared<const Scene>(rung.make_scene());
        const RaySet rays = rays_of(rung, scene, setup);

        // Cast.
        std::vector<Climber> climbers;
        for (const Contestant& contestant : setup.contestants) {
            if (takes_part(rung, contestant)) {
                climbers.push_back(cast_rung(rung, contestant, scene, rays));
            }
            done += 1.0;
            if (!go_on(progress, done / steps)) return record;
        }

        // Judge.
        const std::unique_ptr<Judge> judge = setup.make_judge(scene);
        record.judge = judge->name();
        judge_rung(*judge, rays, climbers);
        for (Climber& climber : climbers) record.rungs.push_back(std::move(climber.record));
        done += 1.0;
    }
    go_on(progress, 1.0);
    return record;
}

StressExperiment ladder_experiment(const Ladder& ladder) {
    return {ladder.id, ladder.title, [ladder](const StressSetup& setup, const Progress& progress) {
                return climb(ladder, setup, progress);
            }};
}

std::vector<const RungRecord*> outlasting(const LadderRecord& ladder, const std::string& tracer,
                                          const std::string& setting) {
    std::vector<const RungRecord*> others;
    const RungRecord* broken = breaks_at(ladder, tracer, setting);
    if (broken == nullptr) return others;
    for (const RungRecord& rung : ladder.rungs) {
        if (!on_same_rung(rung, *broken) || rung.trials == 0) continue;
        const RungRecord* end = breaks_at(ladder, rung.tracer, rung.setting);
        if (end == nullptr || end > &rung) others.push_back(&rung);  // records are in rung order
    }
    return others;
}

}  // namespace onepass
