// Whether there is a hit, asked as such: the same answer as the nearest hit gives, for less work.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <gtest/gtest.h>

#include "core/params.h"
#include "scenes/shapes.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr CastOptions kAny = {.query = Query::any, .counters = true};
constexpr CastOptions kClosest = {.query = Query::closest, .counters = true};
const ParamValues kOff = {{"any_hit", "0"}};

class AnyHit : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (!IsSkipped() && !HasFatalFailure()) catalogue = catalogue_of(context);
    }

    /// The tracers that have the switch, in one storage each: the others' text is the same.
    std::vector<const CatalogueEntry*> entries() const {
        std::vector<const CatalogueEntry*> found;
        for (const CatalogueEntry& entry : catalogue->entries()) {
            if (entry.info.name.find("/buffer/") == std::string::npos) continue;
            const auto& params = entry.info.params;
            const bool has_switch = std::any_of(params.begin(), params.end(),
                                                [](const auto& p) { return p.name == "any_hit"; });
            if (has_switch) found.push_back(&entry);
        }
        return found;
    }

    std::optional<Catalogue> catalogue;
};

/// The rays, and of each that hits the part that ends at the hit, just before it, begins there and
/// just after it.
std::vector<Ray> cut_at_their_hits(const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
    std::vector<Ray> all = rays;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].is_hit()) continue;
        const auto add = [&](float tmin, float tmax) {
            Ray part = rays[i];
            part.tmin = std::max(part.tmin, tmin);
            part.tmax = std::min(part.tmax, tmax);
            all.push_back(part);
        };
        add(0.0f, hits[i].t);
        add(0.0f, std::nextafter(hits[i].t, 0.0f));
        add(hits[i].t, kInfinity);
        add(std::nextafter(hits[i].t, kInfinity), kInfinity);
    }
    return all;
}

std::vector<Ray> many_kinds_of_rays(const ScenePtr& scene) {
    std::vector<Ray> rays = awkward_rays(*scene);
    for (const char* kind : {"primary", "vertex", "edge", "random"}) {
        const std::vector<Ray> of_kind = rays_of_kind(kind, *scene, 24);
        rays.insert(rays.end(), of_kind.begin(), of_kind.end());
    }
    return rays;
}

std::vector<Ray> with_shadow_rays(std::vector<Ray> rays, const ScenePtr& scene) {
    const std::vector<Ray> shadows = rays_of_kind("shadow", *scene, 24);
    rays.insert(rays.end(), shadows.begin(), shadows.end());
    return rays;
}

TEST_F(AnyHit, there_is_a_hit_exactly_where_there_is_a_nearest_one) {
    struct Subject {
        std::string name;
        ScenePtr scene;
        std::vector<Ray> rays;
        bool shaders;  // and not their twins alone
    };
    std::vector<Subject> subjects;
    for (const Scene& made : {make_balls_1(), make_palace(), make_big_small()}) {
        const ScenePtr scene = share(made);
        subjects.push_back({made.name, scene, with_shadow_rays(many_kinds_of_rays(scene), scene),
                            made.name == "balls-1"});
    }
    const ScenePtr far_ball = ball_at(vec3(3e3f, -2e3f, 1e3f), 1.0f);
    subjects.push_back({"a ball far away", far_ball, many_kinds_of_rays(far_ball), true});
    const ScenePtr squeezed = squeezed_balls();
    subjects.push_back({"squeezed balls", squeezed, many_kinds_of_rays(squeezed), false});

    ASSERT_FALSE(entries().empty());
    for (Subject& subject : subjects) {
        const auto twin = catalogue->at("grid/buffer/twin32").make(subject.scene, {});
        const std::vector<Ray> rays =
            cut_at_their_hits(subject.rays, cast(*twin, subject.rays).hits);
        for (const CatalogueEntry* entry : entries()) {
            if (!entry->info.is_twin && !subject.shaders) continue;
            const std::string what = subject.name + ", " + entry->info.name;
            const auto tracer = entry->make(subject.scene, {});
            const CastResult any = cast(*tracer, rays, {.query = Query::any});
            const CastResult closest = cast(*tracer, rays);
            EXPECT_EQ(any.flags, closest.flags) << what;
            for (size_t i = 0; i < rays.size(); ++i) {
                ASSERT_EQ(any.hits[i].is_hit(), closest.hits[i].is_hit()) << what << ", ray " << i;
            }
            EXPECT_GT(hit_count(any.hits), rays.size() / 4) << what;
            EXPECT_LT(hit_count(any.hits), rays.size()) << what;
        }
    }
}

uint64_t tests_of(const CastResult& result) {
    return std::accumulate(
        result.counters.begin(), result.counters.end(), uint64_t{0},
        [](uint64_t sum, const RayCounters& counters) { return sum + counters.tests; });
}

TEST_F(AnyHit, a_ray_never_tests_more_triangles_than_for_its_nearest_hit_and_all_together_fewer) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = rays_of_kind("random", *scene, 48);
    for (const CatalogueEntry* entry : entries()) {
        const auto tracer = entry->make(scene, {});
        const CastResult any = cast(*tracer, rays, kAny);
        const CastResult closest = cast(*tracer, rays, kClosest);
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_LE(any.counters[i].tests, closest.counters[i].tests)
                << entry->info.name << ", ray " << i;
        }
        EXPECT_LT(tests_of(any), tests_of(closest)) << entry->info.name;
    }
}

TEST_F(AnyHit, switched_off_it_is_the_nearest_hit) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = rays_of_kind("random", *scene, 32);
    for (const CatalogueEntry* entry : entries()) {
        const auto tracer = entry->make(scene, kOff);
        const CastResult any = cast(*tracer, rays, kAny);
        const CastResult closest = cast(*tracer, rays, kClosest);
        expect_same_bits(any.hits, closest.hits, entry->info.name);
        EXPECT_EQ(any.counters, closest.counters) << entry->info.name;
    }
}

TEST_F(AnyHit, frames_are_the_same_with_it_and_without_and_cost_less_with_it_in_software) {
    const ScenePtr scene = share(make_palace());
    const RenderSettings settings{.width = 64, .height = 48};
    for (const CatalogueEntry* entry : entries()) {
        const Frame with = entry->make(scene, {})->render(scene->cameras.front(), settings);
        const Frame without = entry->make(scene, kOff)->render(scene->cameras.front(), settings);
        EXPECT_EQ(with.color, without.color) << entry->info.name;
        expect_same_bits(with.hits, without.hits, entry->info.name);
        uint64_t tests_with = 0, tests_without = 0;
        for (size_t i = 0; i < with.counters.size(); ++i) {
            tests_with += with.counters[i].tests;
            tests_without += without.counters[i].tests;
            EXPECT_EQ(with.counters[i].rays, without.counters[i].rays);
        }
        // On a GPU frames do without it, and so do the twins, which are as on a GPU.
        if (context->description().software && !entry->info.is_twin) {
            EXPECT_LT(tests_with, tests_without) << entry->info.name;
        } else {
            EXPECT_EQ(tests_with, tests_without) << entry->info.name;
        }
    }
}

}  // namespace
}  // namespace onepass::test
