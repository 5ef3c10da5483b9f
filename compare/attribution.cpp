#include "compare/attribution.h"

#include <utility>

#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

/// Whether the suspect's absence makes each of the rays right.
std::vector<bool> mended_without(const Suspect& suspect, std::span<const Ray> rays, Query query,
                                 const Judge& judge) {
    const CastResult answers = suspect.cast_without(rays, query);
    ONEPASS_CHECK_EQ(answers.hits.size(), rays.size());
    std::vector<HitClass> classes(rays.size());
    tbb::parallel_for(size_t{0}, rays.size(), [&](size_t i) {
        classes[i] = judge.judge(rays[i], query, std::span(&answers.hits[i], 1)).front().hit_class;
    });
    std::vector<bool> mended;
    for (const HitClass c : classes) mended.push_back(!is_error(c));
    return mended;
}

}  // namespace

std::vector<Suspect> suspects_of(const CatalogueEntry& tracer, const ScenePtr& scene,
                                 const ParamValues& params) {
    std::vector<Suspect> suspects;
    for (const Deviation& deviation : tracer.info.deviations) {
        ParamValues without = params;
        std::string& value = without[deviation.param];
        if (value == deviation.value) continue;  // off already
        value = deviation.value;
        suspects.push_back({deviation.id, [make = tracer.make, scene, without](
                                              std::span<const Ray> rays, Query query) {
                                const std::unique_ptr<Tracer> mended = make(scene, without);
                                return mended->cast(mended->upload(rays), {.query = query});
                            }});
    }
    return suspects;
}

Attribution attribute_errors(std::span<const WorstRay> wrong, Query query, const Judge& judge,
                             std::span<const Suspect> suspects) {
    Attribution attribution;
    attribution.record.asked = true;
    attribution.culprits.resize(wrong.size());
    std::vector<size_t> left(wrong.size());
    for (size_t i = 0; i < left.size(); ++i) left[i] = i;

    // One suspect after the other, over the rays that none before it explains.
    for (const Suspect& suspect : suspects) {
        std::vector<Ray> rays;
        for (const size_t i : left) rays.push_back(wrong[i].ray);
        std::vector<bool> mended;
        if (!rays.empty()) mended = mended_without(suspect, rays, query, judge);
        std::vector<size_t> still_left;
        for (size_t k = 0; k < left.size(); ++k) {
            if (mended[k]) {
                attribution.culprits[left[k]] = suspect.id;
            } else {
                still_left.push_back(left[k]);
            }
        }
        attribution.record.by_deviation.emplace_back(suspect.id, left.size() - still_left.size());
        left = std::move(still_left);
    }

    // What remains is shown, the worst ray first.
    attribution.record.unattributed = left.size();
    for (const size_t i : left) {
        std::optional<WorstRay>& worst = attribution.worst_unattributed;
        if (!worst || is_worse(wrong[i].verdict, worst->verdict)) worst = wrong[i];
    }
    return attribution;
}

}  // namespace onepass
