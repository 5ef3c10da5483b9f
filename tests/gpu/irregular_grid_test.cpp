// The irregular grid: bit-identical to its twin, the same answers as the uniform grid bit by bit,
// and without one wrong hit.
#include "core/irregular_grid/irregular_grid.h"

#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/motions.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"irregular_grid/buffer/fragment",
                                    "irregular_grid/buffer/compute", "irregular_grid/ssbo/fragment",
                                    "irregular_grid/ssbo/compute"};
constexpr const char* kTwin = "irregular_grid/buffer/twin32";

class IrregularGridStrategy : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, params);
    }

    std::optional<Catalogue> catalogue;
};

std::vector<Ray> mixed_rays(const Scene& scene) {
    std::vector<Ray> rays = primary_rays(scene, 32, 32);
    for (const std::vector<Ray>& more :
         {random_rays(scene_bounds(scene), 1500, 7), awkward_rays(scene)}) {
        rays.insert(rays.end(), more.begin(), more.end());
    }
    return rays;
}

TEST_F(IrregularGridStrategy, hits_are_bit_identical_to_its_twin_on_a_software_renderer) {
    if (!context->description().software) GTEST_SKIP() << "promised on software renderers only";
    for (const auto& [made, records] :
         in_both_records({make_balls_1(), make_instances(), make_ball_on_ground()})) {
        const ScenePtr scene = share(made);
        const std::vector<Ray> rays = mixed_rays(*scene);
        const auto twin = make(kTwin, scene, {{"records", records}});
        const CastResult cpu = cast(*twin, rays, {.counters = true});
        for (const char* entry : kEntries) {
            const CastResult gpu =
                cast(*make(entry, scene, {{"records", records}}), rays, {.counters = true});
            expect_same_bits(gpu.hits, cpu.hits, made.name + " " + records + " " + entry);
            EXPECT_EQ(gpu.flags, cpu.flags) << made.name << " " << records << " " << entry;
            EXPECT_EQ(gpu.counters, cpu.counters) << made.name << " " << records << " " << entry;
        }
    }
}

TEST_F(IrregularGridStrategy, answers_as_the_uniform_grid_does_whatever_its_cells) {
    for (const Scene& made : {make_instances(), make_big_small()}) {
        const ScenePtr scene = share(made);
        const std::vector<Ray> rays = mixed_rays(*scene);
        const std::vector<Hit> expected = cast(*make("grid/buffer/twin32", scene), rays).hits;
        for (const ParamValues& params :
             {ParamValues{}, ParamValues{{"root_density", "3"}, {"cell_cost", "0.5"}},
              ParamValues{{"root_density", "0.0001"}, {"density", "20"}, {"expansions", "0"}}}) {
            expect_same_bits(cast(*make(kTwin, scene, params), rays).hits, expected, made.name);
        }
    }
}

TEST_F(IrregularGridStrategy, no_ray_aimed_at_corners_or_edges_is_answered_wrongly) {
    for (const Scene& made : {make_balls_1(), make_instances(), make_ball_on_ground()}) {
        const ScenePtr scene = share(made);
        for (const char* kind : {"vertex", "edge"}) {
            const std::vector<Ray> rays = rays_of_kind(kind, *scene, 32);
            expect_no_error(*make("irregular_grid/buffer/compute", scene), scene, rays,
                            made.name + ", " + kind);
        }
    }
}

TEST_F(IrregularGridStrategy, a_scene_far_from_the_origin_or_of_any_size_is_as_right_as_any) {
    for (const float distance : {0.0f, -1e6f}) {
        for (const float scale : {1e-12f, 1.0f, 1e12f}) {
            const ScenePtr scene = ball_at(scale * distance * vec3(1.0f, -0.3f, 0.7f), scale);
            for (const char* kind : {"vertex", "random"}) {
                expect_no_error(*make(kTwin, scene), scene, rays_of_kind(kind, *scene, 32),
                                std::to_string(distance) + " sizes away, " + kind);
            }
        }
    }
}

TEST_F(IrregularGridStrategy, instances_of_extreme_shape_and_size_are_hit_rightly) {
    const ScenePtr scene = squeezed_balls();
    std::vector<Ray> rays;
    const Object& ball = scene->objects.front();
    for (const Instance& instance : scene->instances) {
        for (size_t i = 0; i < ball.positions.size(); i += 7) {
            const vec3 target = transform_point(instance.world_from_object, ball.positions[i]);
            const vec3 from = transform_point(
                instance.world_from_object, 3.0f * ball.positions[(i * 7) % ball.positions.size()]);
            rays.push_back({from, 0.0f, target - from, kInfinity});
        }
    }
    expect_no_error(*make(kTwin, scene), scene, rays, "squeezed balls");
}

TEST_F(IrregularGridStrategy, a_walk_tests_all_of_each_cells_list_and_leaves_its_box_behind) {
    const ScenePtr scene = share(make_ball_on_ground());
    const IrregularGrid grid = build_irregular_grid(scene->objects.front(), {});
    const auto twin = make(kTwin, scene);
    size_t cells = 0;
    for (const Ray& ray : primary_rays(*scene, 24, 24)) {
        const RayWalk walk = *twin->walk(ray);
        const IrregularCell* last = nullptr;
        for (size_t k = 0; k < walk.steps.size(); ++k) {
            const WalkStep& step = walk.steps[k];
            const IrregularCell& cell = grid.cells[grid.cell_at(uvec3(step.cell))];
            // A list that was put aside for a decision is taken up where it stopped, in another
            // step.
            std::set<uint32_t> tested;
            for (const WalkTest& test : step.tests) tested.insert(test.prim_id);
            for (; k + 1 < walk.steps.size() && walk.steps[k + 1].cell == step.cell; ++k) {
                for (const WalkTest& test : walk.steps[k + 1].tests) tested.insert(test.prim_id);
            }
            const auto list = grid.cell_references(cell);
            ASSERT_EQ(tested, std::set<uint32_t>(list.begin(), list.end()));
            if (last != nullptr) {
                const bool is_inside =
                    glm::all(glm::lessThanEqual(last->lower, uvec3(step.cell))) &&
                    glm::all(glm::lessThanEqual(uvec3(step.cell), last->last));
                ASSERT_FALSE(is_inside) << "the walk stays in a box";
            }
            last = &cell;
            ++cells;
        }
    }
    EXPECT_GT(cells, 1000u);
}

TEST_F(IrregularGridStrategy, serves_a_dense_ball_on_a_wide_ground_where_one_cell_size_does_not) {
    const ScenePtr scene = share(make_ball_on_ground());
    const std::vector<Ray> rays = primary_rays(*scene, 24, 24);
    const auto tests_of = [&](const char* name) {
        uint64_t tests = 0;
        for (const RayCounters& counters :
             cast(*make(name, scene), rays, {.counters = true}).counters) {
            tests += counters.tests;
        }
        return tests;
    };
    const uint64_t ours = tests_of(kTwin);
    EXPECT_GT(ours, rays.size());
    EXPECT_LT(50 * ours, tests_of("grid/buffer/twin32"));
}

TEST_F(IrregularGridStrategy, instances_that_moved_are_hit_as_if_they_had_been_there) {
    const Scene swarm = make_swarm(40, 3);
    const std::vector<Affine> places = instance_transforms(swarm, 0.9);
    Scene there = swarm;
    for (size_t i = 0; i < places.size(); ++i) there.instances[i].world_from_object = places[i];
    const std::vector<Ray> rays = random_rays(scene_bounds(there), 4000, 17);
    for (const char* entry : {kTwin, "irregular_grid/ssbo/compute"}) {
        const auto tracer = make(entry, share(swarm));
        const std::vector<Hit> before = cast(*tracer, rays).hits;
        tracer->update(places);
        const std::vector<Hit> moved = cast(*tracer, rays).hits;
        expect_same_bits(moved, cast(*make(entry, share(there)), rays).hits, entry);
        EXPECT_GT(bit_difference(before, moved).count, 50u) << entry;
    }
}

TEST_F(IrregularGridStrategy, a_buffer_that_the_device_cannot_hold_is_refused_by_name) {
    const gl::ShaderLibrary library = gl::ShaderLibrary::embedded();
    for (const gl::StrategyInfo& info : library.strategies()) {
        if (info.name != "irregular_grid") continue;
        try {
            prepare_strategy(info, "buffer", share(make_balls_1()), {},
                             {.limits = {.max_buffer = 1000}});
            FAIL() << "1000 texels were enough";
        } catch (const Error& error) {
            EXPECT_NE(error.parts().where.find("nodes"), std::string::npos) << error.what();
            EXPECT_NE(error.parts().expected.find("1000"), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(make(kTwin, share(make_balls_1()), {{"cell_cost", "0"}}), Error);
}

}  // namespace
}  // namespace onepass::test
