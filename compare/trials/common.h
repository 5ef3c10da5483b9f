// What all trials share: rays from outside, triangles in the world, and one record a contestant.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "compare/rungs.h"
#include "compare/trials.h"
#include "core/error.h"

namespace onepass::trials {

/// Rays from uniform directions, `distance` diagonals of the scene's box from its centre, to
/// uniform points of the box; the share `at_corners` of them to corners of uniform triangles
/// instead.
std::vector<Ray> rays_from_outside(const Scene& scene, size_t count, float distance,
                                   double at_corners, uint64_t seed);

/// Corners in the world, in double.
std::array<dvec3, 3> world_corners(const Scene& scene, uint32_t inst_id, uint32_t prim_id);
/// Of a triangle that is counter-clockwise seen from outside, in mirrored instances too; not unit.
dvec3 outward_normal(const Scene& scene, uint32_t inst_id, uint32_t prim_id);

/// Answers to rays, and what the judge says of each.
struct JudgedCast {
    CastResult cast;
    std::vector<Verdict> verdicts;
};
/// Cost: parallel; a judgement a ray. Throws: as cast_closest().
JudgedCast cast_and_judge(Tracer& tracer, const Judge& judge, const std::vector<Ray>& rays);

/// Thrown where a cast ends with an Error, which is a failure; an Error before that is a refusal.
struct GaveUp {};

/// Throws: GaveUp; Error if the tracer cannot take the rays.
CastResult cast_closest(Tracer& tracer, const std::vector<Ray>& rays);

/// The first failure of a record, to be shown as its worst ray.
void keep_first(RungRecord& record, size_t index, const Ray& ray, const Hit& answer,
                const Verdict& verdict);

/// The record of a trial without its rungs.
LadderRecord empty_record(const TrialTitle& title);

/// Counts casts of contestants on rungs, for the progress of a trial.
class Steps {
  public:
    Steps(const Progress& progress, size_t rungs, const StressSetup& setup)
        : progress_(progress), total_(static_cast<double>(rungs * setup.contestants.size())) {}
    /// One more; false if it was asked to stop.
    bool operator()() { return go_on(progress_, static_cast<double>(done_++) / total_); }

  private:
    const Progress& progress_;
    double total_;
    size_t done_ = 0;
};

/// Calls work(contestant, record) for each contestant and appends the records. After GaveUp all of
/// the rung's rays have failed; an Error is a refusal, unless there is no device at all. False,
/// appending nothing, if it was asked to stop.
template <class Work>
bool for_each_contestant(const StressSetup& setup, double knob, const std::string& label,
                         LadderRecord& ladder, Steps& step, const Work& work) {
    std::vector<RungRecord> records;
    for (const Contestant& contestant : setup.contestants) {
        if (!step()) return false;
        RungRecord& record = records.emplace_back(empty_record(knob, label, contestant));
        try {
            work(contestant, record);
        } catch (const GaveUp&) {
            record = empty_record(knob, label, contestant);
            give_up(record, setup.rays);
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::device) throw;
            record = empty_record(knob, label, contestant);
            record.refusal = refusal_text(error);
        }
    }
    ladder.rungs.insert(ladder.rungs.end(), records.begin(), records.end());
    return true;
}

}  // namespace onepass::trials
