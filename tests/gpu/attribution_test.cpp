// The paper's errors, attributed: each wrong ray is right once the one deviation it is attributed
// to is switched off, and no ray is left over.
#include "compare/attribution.h"

#include <map>

#include <gtest/gtest.h>

#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

/// A scene, its oracle and its judge.
struct Subject {
    explicit Subject(const std::string& name)
        : scene(share(load_scene(name).scene)),
          oracle(embree_tracers().front().make(scene, {})),
          judge(make_exact_judge(scene)) {}

    RaySet rays(const std::string& kind) const {
        return make_ray_set(kind, *scene, *oracle, {.width = 160, .height = 160, .seed = 1});
    }
    HitComparison compare(Tracer& tracer, const RaySet& rays) const {
        const CastOptions options{.query = rays.query};
        return compare_hits(rays.rays, rays.query, cast(tracer, rays.rays, options),
                            cast(*oracle, rays.rays, options), *judge);
    }

    ScenePtr scene;
    std::unique_ptr<Tracer> oracle;
    std::unique_ptr<Judge> judge;
};

class PaperErrors : public GlTest {};

TEST_F(PaperErrors, each_disappears_without_the_deviation_it_is_attributed_to) {
    const Catalogue catalogue = catalogue_of(context);
    for (const char* name : {"balls-1", "bunny", "palace"}) {
        const Subject subject(name);
        for (const char* entry : {"paper/texture2d/fragment", "paper/texture2d/compute"}) {
            const CatalogueEntry& paper = catalogue.at(entry);
            const auto tracer = paper.make(subject.scene, {});
            uint64_t wrong_rays = 0;
            for (const char* kind : {"primary", "shadow", "reflection", "random"}) {
                SCOPED_TRACE(std::string(name) + ", " + kind + ", " + entry);
                const RaySet rays = subject.rays(kind);
                const HitComparison comparison = subject.compare(*tracer, rays);
                ASSERT_EQ(comparison.wrong.size(), comparison.record.errors());
                wrong_rays += comparison.wrong.size();
                const Attribution attribution =
                    attribute_errors(comparison.wrong, rays.query, *subject.judge,
                                     suspects_of(paper, subject.scene, {}));

                // Every wrong ray is counted once, and none is left.
                uint64_t sum = attribution.record.unattributed;
                for (const auto& [id, count] : attribution.record.by_deviation) sum += count;
                EXPECT_EQ(sum, comparison.wrong.size());
                EXPECT_EQ(attribution.record.unattributed, 0u);
                EXPECT_FALSE(attribution.worst_unattributed);

                // Each is right in a whole new check with that switch changed.
                std::map<std::string, Culprit> by_id;
                for (const Culprit& c : attribution.culprits) by_id[c.id()] = c;
                for (const auto& [id, culprit] : by_id) {
                    ParamValues off;
                    for (const Deviation& d : culprit.off) off[d.param] = d.value;
                    const HitComparison without =
                        subject.compare(*paper.make(subject.scene, off), rays);
                    for (size_t i = 0; i < attribution.culprits.size(); ++i) {
                        if (attribution.culprits[i].id() != id) continue;
                        const auto hit_class = without.classes[comparison.wrong[i].index];
                        EXPECT_TRUE(hit_class && !is_error(*hit_class))
                            << id << ", ray " << comparison.wrong[i].index;
                    }
                }
            }
            EXPECT_GT(wrong_rays, 20u) << "nothing was attributed";
        }
    }
}

TEST_F(PaperErrors, are_left_over_and_shown_if_their_deviation_is_not_declared) {
    const Subject subject("balls-1");
    CatalogueEntry paper = catalogue_of(context).at("paper/texture2d/fragment");
    const RaySet rays = subject.rays("primary");
    const HitComparison comparison = subject.compare(*paper.make(subject.scene, {}), rays);
    std::erase_if(paper.info.deviations, [](const Deviation& d) { return d.id == "D11"; });
    const Attribution attribution = attribute_errors(comparison.wrong, rays.query, *subject.judge,
                                                     suspects_of(paper, subject.scene, {}));
    EXPECT_GT(attribution.record.unattributed, comparison.wrong.size() / 2);
    ASSERT_TRUE(attribution.worst_unattributed);
    EXPECT_TRUE(is_error(attribution.worst_unattributed->verdict.hit_class));
}

}  // namespace
}  // namespace onepass::test
