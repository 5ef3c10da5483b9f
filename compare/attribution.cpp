#include "compare/attribution.h"

#include <memory>
#include <utility>

#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

/// The rays of `wrong` that are still unexplained, and what has been found out about the others.
class Inquiry {
  public:
    Inquiry(std::span<const WorstRay> wrong, Query query, const Judge& judge,
            const Suspects& suspects)
        : wrong_(wrong), query_(query), judge_(judge), suspects_(suspects) {
        for (size_t i = 0; i < wrong.size(); ++i) left_.push_back(i);
        culprits_.resize(wrong.size());
    }

    /// Takes off the list what is right without the suspects `off`. Returns how many rays that is.
    uint64_t accuse(const std::vector<size_t>& off) {
        if (left_.empty()) return 0;
        std::vector<Ray> rays;
        for (const size_t i : left_) rays.push_back(wrong_[i].ray);
        const CastResult answers = suspects_.cast_without(off, rays, query_);
        ONEPASS_CHECK_EQ(answers.hits.size(), rays.size());
        std::vector<HitClass> classes(rays.size());
        tbb::parallel_for(size_t{0}, rays.size(), [&](size_t k) {
            const std::span<const Hit> answer(&answers.hits[k], 1);
            classes[k] = judge_.judge(rays[k], query_, answer).front().hit_class;
        });

        Culprit culprit;
        for (const size_t s : off) culprit.off.push_back(suspects_.deviations[s]);
        std::vector<size_t> still_left;
        for (size_t k = 0; k < rays.size(); ++k) {
            if (is_error(classes[k])) {
                still_left.push_back(left_[k]);
            } else {
                culprits_[left_[k]] = culprit;
            }
        }
        const uint64_t mended = left_.size() - still_left.size();
        left_ = std::move(still_left);
        return mended;
    }

    const std::vector<size_t>& left() const { return left_; }
    std::vector<Culprit> take_culprits() { return std::move(culprits_); }

  private:
    std::span<const WorstRay> wrong_;
    Query query_;
    const Judge& judge_;
    const Suspects& suspects_;
    std::vector<size_t> left_;
    std::vector<Culprit> culprits_;
};

}  // namespace

Suspects suspects_of(const CatalogueEntry& tracer, const ScenePtr& scene,
                     const ParamValues& params) {
    Suspects suspects;
    for (const Deviation& deviation : tracer.info.deviations) {
        const auto given = params.find(deviation.param);
        const bool is_off = given != params.end() && given->second == deviation.value;
        if (!is_off) suspects.deviations.push_back(deviation);
    }
    suspects.cast_without = [make = tracer.make, scene, params, all = suspects.deviations](
                                std::span<const size_t> off, std::span<const Ray> rays,
                                Query query) {
        ParamValues without = params;
        for (const size_t s : off) without[all[s].param] = all[s].value;
        const std::unique_ptr<Tracer> mended = make(scene, without);
        return mended->cast(mended->upload(rays), {.query = query});
    };
    return suspects;
}

std::string Culprit::id() const {
    std::string text;
    for (const Deviation& deviation : off) text += (text.empty() ? "" : "+") + deviation.id;
    return text;
}

Attribution attribute_errors(std::span<const WorstRay> wrong, Query query, const Judge& judge,
                             const Suspects& suspects) {
    Attribution attribution;
    attribution.record.asked = true;
    auto& counts = attribution.record.by_deviation;
    Inquiry inquiry(wrong, query, judge, suspects);
    const size_t count = suspects.deviations.size();

    // One deviation after the other, over the rays that none before it explains.
    for (size_t s = 0; s < count; ++s) {
        counts.emplace_back(suspects.deviations[s].id, inquiry.accuse({s}));
    }

    // Two at once, where two faults meet on one ray.
    for (size_t a = 0; a < count; ++a) {
        for (size_t b = a + 1; b < count; ++b) {
            const uint64_t mended = inquiry.accuse({a, b});
            if (mended == 0) continue;
            counts.emplace_back(suspects.deviations[a].id + "+" + suspects.deviations[b].id,
                                mended);
        }
    }

    // What remains is shown, the worst ray first.
    attribution.record.unattributed = inquiry.left().size();
    for (const size_t i : inquiry.left()) {
        std::optional<WorstRay>& worst = attribution.worst_unattributed;
        if (!worst || is_worse(wrong[i].verdict, worst->verdict)) worst = wrong[i];
    }
    attribution.culprits = inquiry.take_culprits();
    return attribution;
}

}  // namespace onepass
