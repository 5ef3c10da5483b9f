// Climbing ladders (core/ladder.h): ever harder scenes and rays, every answer judged.
//
// Knows tracers by the catalogue only; where judge and oracle come from is the caller's business,
// so that fakes can stand in for them. A failure here is data, and never an error.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "compare/progress.h"
#include "compare/results.h"
#include "core/catalogue.h"
#include "core/judge.h"
#include "core/ladder.h"

namespace onepass {

/// One tracer with one setting.
struct Contestant {
    const CatalogueEntry* entry = nullptr;
    ParamValues params{};
};

/// What every experiment is made with.
struct StressSetup {
    std::vector<Contestant> contestants;
    std::function<std::unique_ptr<Judge>(ScenePtr)> make_judge;
    /// For ray kinds that start where other rays hit (compare/rays.h).
    std::function<std::unique_ptr<Tracer>(ScenePtr)> make_oracle;
    size_t rays = 4096;  ///< of one rung
    uint64_t seed = 1;
};

/// Something that leaves a ladder's record. Stopped by `progress`, it returns the rungs that were
/// finished.
struct StressExperiment {
    std::string id;
    std::string title;
    std::function<LadderRecord(const StressSetup&, const Progress&)> run;
};

/// Casts the rays of every rung with every contestant and judges every answer.
///
/// A ray fails once: kind "exhausted" if the tracer flags kFlagExhausted, else its error class;
/// "gave_up" if the cast ended with an error.
/// Ties and edges are counted apart and never fail. Rays that a tracer flags kFlagOracleInvalid are
/// no trials; RungRecord::refusal says how many. A contestant that throws Error for a rung refuses
/// it, so make sure beforehand that its device is there; one that has none of the rung's parameters
/// has no record there.
/// Cost: the truth about a ray is computed once for all contestants, and equal answers are judged
/// once; parallel over rays. The result does not depend on the number of threads.
/// Throws: Error for a rung without rays.
LadderRecord climb(const Ladder& ladder, const StressSetup& setup, const Progress& progress = {});

/// The experiment that climbs this ladder.
StressExperiment ladder_experiment(const Ladder& ladder);

/// Those who outlast a tracer: on the rung where it first fails they take part, and have not failed
/// yet. None if it never fails.
std::vector<const RungRecord*> outlasting(const LadderRecord& ladder, const std::string& tracer,
                                          const std::string& setting);

}  // namespace onepass
