// Twins tell their walks, and wrong answers of real strategies get their reasons.
#include "compare/explain.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "compare/reproduction.h"
#include "core/grid/two_level_grid.h"
#include "core/io/load.h"
#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/strategy_fixture.h"
#include "tests/support/temporary_folder.h"

namespace onepass::test {
namespace {

std::vector<std::string> twin_names(const Catalogue& catalogue) {
    std::vector<std::string> names;
    for (const CatalogueEntry& entry : catalogue.entries()) {
        if (entry.info.is_twin) names.push_back(entry.info.name);
    }
    return names;
}

std::vector<Ray> rays_of_kind(const std::string& kind, const ScenePtr& scene, uint32_t side) {
    const auto oracle = embree_tracers().front().make(scene, {});
    return make_ray_set(kind, *scene, *oracle, {.width = side, .height = side, .seed = 5}).rays;
}

/// A step is a cell; but a flat grid's are the world's, and each instance that is met in one has a
/// step beside it.
size_t cells_of(const RayWalk& walk, const std::string& tracer) {
    if (!tracer.starts_with("flat_grid/")) return walk.steps.size();
    return static_cast<size_t>(
        std::ranges::count(walk.steps, kNoId, [](const WalkStep& step) { return step.inst_id; }));
}

TEST(Walk, of_every_twin_lists_what_its_counters_count) {
    const Catalogue catalogue = catalogue_of(nullptr);
    EXPECT_GE(twin_names(catalogue).size(), 6u);
    for (const Scene& made : {make_instances(), make_big_small()}) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = random_rays(scene_bounds(*scene), 150, 7);
        const std::vector<Ray> awkward = awkward_rays(*scene);
        rays.insert(rays.end(), awkward.begin(), awkward.end());
        for (const std::string& name : twin_names(catalogue)) {
            const auto twin = catalogue.at(name).make(scene, {});
            EXPECT_TRUE(twin->capabilities().walks);
            const CastResult result = cast(*twin, rays, {.counters = true});
            size_t all_tests = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                const std::optional<RayWalk> walk = twin->walk(rays[i]);
                ASSERT_TRUE(walk.has_value());
                expect_same_bits({walk->hit}, {result.hits[i]}, name);
                EXPECT_EQ(walk->flags, result.flags[i]);
                EXPECT_EQ(walk->counters, result.counters[i]);
                EXPECT_EQ(cells_of(*walk, name), result.counters[i].cells) << name;
                size_t tests = 0;
                bool answer_accepted = false;
                for (const WalkStep& step : walk->steps) {
                    tests += step.tests.size();
                    for (const WalkTest& test : step.tests) {
                        answer_accepted |= test.accepted && step.inst_id == walk->hit.inst_id &&
                                           test.prim_id == walk->hit.prim_id;
                    }
                }
                EXPECT_EQ(tests, result.counters[i].tests) << name;
                EXPECT_EQ(answer_accepted, walk->hit.is_hit()) << name;
                all_tests += tests;
            }
            EXPECT_GT(all_tests, rays.size()) << name;
        }
    }
}

/// Whether the cells that a step leaves behind hold nothing: the box from `from` on, without what
/// lies as far along the longest axis as `to`.
bool crosses_empty_cells(const UniformGrid& grid, const ivec3& from, const ivec3& to) {
    const ivec3 stride = glm::abs(to - from);
    const int longest = std::max({stride.x, stride.y, stride.z});
    const ivec3 end = glm::min(stride, ivec3(longest - 1)) + 1;
    const ivec3 ahead = glm::sign(to - from);
    for (int k = 0; k < end.x * end.y * end.z; ++k) {
        const ivec3 offset(k % end.x, k / end.x % end.y, k / (end.x * end.y));
        if (!grid.cell_references(uvec3(from + ahead * offset)).empty()) return false;
    }
    return true;
}

TEST(Walk, tests_a_triangle_only_in_cells_that_hold_it_and_passes_by_no_cell_that_holds_one) {
    const Catalogue catalogue = catalogue_of(nullptr);
    const ScenePtr scene = share(make_instances());
    const TwoLevelGrid built = build_two_level_grid(*scene, {.object = {.density = 3.0}});
    size_t jumps = 0;
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 120, 9);
    for (const char* name : {"paper/texture2d/twin32", "paper_claims/texture2d_virtual/twin64",
                             "grid/buffer/twin32"}) {
        const auto twin = catalogue.at(name).make(scene, {{"density", "3"}});
        size_t checked = 0;
        for (const Ray& ray : rays) {
            const RayWalk walk = *twin->walk(ray);
            for (size_t i = 0; i < walk.steps.size(); ++i) {
                const WalkStep& step = walk.steps[i];
                if (i > 0 && walk.steps[i - 1].inst_id == step.inst_id && step.inst_id != kNoId) {
                    // Only `grid` may cross several cells at once.
                    const ivec3 last = walk.steps[i - 1].cell;
                    const ivec3 stride = glm::abs(step.cell - last);
                    if (std::max({stride.x, stride.y, stride.z}) > 1) {
                        const uint32_t object = scene->instances[step.inst_id].object;
                        EXPECT_TRUE(name == std::string("grid/buffer/twin32") &&
                                    crosses_empty_cells(built.objects[object], last, step.cell))
                            << name;
                        ++jumps;
                    }
                }
                for (size_t k = 0; k < std::min<size_t>(step.tests.size(), 2); ++k) {
                    const std::vector<ivec3> cells =
                        twin->cells_of(step.inst_id, step.tests[k].prim_id);
                    EXPECT_NE(std::find(cells.begin(), cells.end(), step.cell), cells.end())
                        << name;
                    ++checked;
                }
            }
        }
        EXPECT_GT(checked, 50u) << name;
    }
    EXPECT_GT(jumps, 10u);
}

TEST(Walk, is_not_told_by_those_who_cannot) {
    const ScenePtr scene = share(make_balls_1());
    const auto embree = embree_tracers().front().make(scene, {});
    EXPECT_FALSE(embree->capabilities().walks);
    EXPECT_FALSE(embree->walk(Ray{}).has_value());
    EXPECT_TRUE(embree->cells_of(0, 0).empty());
}

/// The explanation of the first of the rays on which a tracer errs in that class.
struct Found {
    std::optional<Explanation> explanation;
    std::string reasons;
};
Found first_of_class(HitClass wanted, const ScenePtr& scene, Tracer& tracer,
                     const std::vector<Ray>& rays) {
    const auto judge = make_exact_judge(scene);
    const CastResult result = cast(tracer, rays);
    for (size_t i = 0; i < rays.size(); ++i) {
        const Verdict verdict =
            judge->judge(rays[i], Query::closest, std::span(&result.hits[i], 1)).front();
        if (verdict.hit_class != wanted) continue;
        Tracer* const tracers[] = {&tracer};
        Found found{explain_ray(rays[i], *judge, tracers), ""};
        for (const std::string& reason : found.explanation->statements[0].reasons) {
            found.reasons += reason + "\n";
        }
        EXPECT_EQ(found.explanation->statements[0].verdict.hit_class, wanted);
        return found;
    }
    ADD_FAILURE() << "no ray of class " << to_string(wanted);
    return {};
}

TEST(Reasons, the_papers_slack_accepts_a_triangle_that_the_ray_passes) {
    const Catalogue catalogue = catalogue_of(nullptr);
    const ScenePtr scene = share(make_balls_1());
    const auto paper = catalogue.at("paper/texture2d/twin32").make(scene, {});
    const Found found =
        first_of_class(HitClass::wrong_surface, scene, *paper, primary_rays(*scene, 128, 128));
    ASSERT_TRUE(found.explanation);
    EXPECT_NE(found.reasons.find("the ray passes its triangle"), std::string::npos)
        << found.reasons;
    EXPECT_NE(found.reasons.find("and accepted at t"), std::string::npos) << found.reasons;
    const Hit& hit = found.explanation->statements[0].hit;
    for (const Meeting& m : found.explanation->truth.passed) {
        if (m.inst_id != hit.inst_id || m.prim_id != hit.prim_id) continue;
        // D11: la + lb up to 1.004, so the weight of v0 is as low as -0.004.
        EXPECT_LT(1.0 - m.u - m.v, 0.0);
        EXPECT_GT(1.0 - m.u - m.v, -0.00401);
        EXPECT_GT(m.edge_moves, 1.0);
    }
}

TEST(Reasons, a_crack_is_a_true_triangle_tested_and_rejected) {
    const Catalogue catalogue = catalogue_of(nullptr);
    const ScenePtr scene = share(make_balls_1());
    const auto paper =
        catalogue.at("paper/texture2d/twin32").make(scene, {{"edge_tolerance", "1"}});
    const Found found =
        first_of_class(HitClass::wrong_surface, scene, *paper, rays_of_kind("edge", scene, 64));
    ASSERT_TRUE(found.explanation);
    EXPECT_NE(found.reasons.find("the true triangle"), std::string::npos) << found.reasons;
    EXPECT_NE(found.reasons.find("and rejected"), std::string::npos) << found.reasons;
}

TEST(ReproductionOfARealRay, keeps_the_verdicts_after_reloading) {
    const Catalogue catalogue = catalogue_of(nullptr);
    for (const Scene& made : {make_balls_1(), make_instances()}) {
        const ScenePtr scene = share(made);
        const auto judge = make_exact_judge(scene);
        // One ray a call: which triangle a packet takes at an edge depends on the rest of the
        // scene.
        std::vector<CatalogueEntry> embree = embree_tracers();
        std::erase_if(embree, [](const CatalogueEntry& e) { return !e.info.by_default; });
        size_t doubtful = 0;
        for (const Ray& ray : rays_of_kind("vertex", scene, 5)) {
            std::vector<std::unique_ptr<Tracer>> tracers;
            const auto explain = [&](const ScenePtr& where) {
                tracers.clear();
                std::vector<Tracer*> pointers;
                for (const CatalogueEntry& entry : embree) {
                    tracers.push_back(entry.make(where, {}));
                    pointers.push_back(tracers.back().get());
                }
                return explain_ray(ray, *make_exact_judge(where), pointers);
            };
            const Explanation large = explain(scene);
            const Reproduction reproduction = make_reproduction(*scene, large);
            const TemporaryFolder folder;
            write_reproduction(reproduction, folder.path());
            const ScenePtr reloaded = share(load_scene_file(folder.path() / "scene.glb").scene);
            EXPECT_LT(instanced_triangle_count(*reloaded), instanced_triangle_count(*scene) / 20);
            const Explanation small = explain(reloaded);

            // The truth is the same, number by number.
            EXPECT_EQ(small.truth.org_reach, large.truth.org_reach);
            ASSERT_EQ(small.truth.hits.size(), large.truth.hits.size());
            for (size_t i = 0; i < small.truth.hits.size(); ++i) {
                const Meeting& a = small.truth.hits[i];
                const Meeting& b = large.truth.hits[i];
                const Hit there = reproduction.in_large({1, 0, 0, a.prim_id, a.inst_id});
                EXPECT_EQ(there.prim_id, b.prim_id);
                EXPECT_EQ(there.inst_id, b.inst_id);
                EXPECT_EQ(a.t_digits, b.t_digits);
                EXPECT_EQ(a.edge_moves, b.edge_moves);
                EXPECT_EQ(a.is_right, b.is_right);
            }
            // A tracer's tie may fall the other way; an error or its absence may not.
            for (const Recurrence& r : compare_statements(reproduction, large, small)) {
                EXPECT_EQ(is_error(r.small.verdict.hit_class), is_error(r.large.verdict.hit_class));
                doubtful += r.large.verdict.hit_class == HitClass::agree ? 0 : 1;
                EXPECT_TRUE(r.holds()) << recurrence_text({r});
            }
        }
        EXPECT_GT(doubtful, 0u) << made.name;
    }
}

}  // namespace
}  // namespace onepass::test
