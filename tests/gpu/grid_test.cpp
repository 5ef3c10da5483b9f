// The robust strategy: bit-identical to its twin, and without one wrong hit where others err.
#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/shapes.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"grid/buffer/fragment", "grid/buffer/compute"};

class GridStrategy : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, params);
    }

    std::optional<Catalogue> catalogue;
};

/// A closed ball about `centre`, in one instance.
ScenePtr ball_at(const vec3& centre, float scale) {
    Scene scene;
    Object ball = make_sphere(48, 32);
    for (vec3& p : ball.positions) p = p * scale + centre;
    scene.objects.push_back(ball);
    scene.instances.push_back({.name = "ball", .object = 0, .materials = {0}});
    scene.materials.push_back({});
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    scene.lights.push_back({});
    validate(scene);
    return share(std::move(scene));
}

std::vector<Ray> rays_of_kind(const std::string& kind, const Scene& scene, uint32_t side) {
    const auto oracle = embree_tracers().front().make(share(scene), {});
    return make_ray_set(kind, scene, *oracle, {.width = side, .height = side, .seed = 5}).rays;
}

std::string describe(const Ray& ray, const Hit& hit, const Verdict& verdict) {
    return fmt::format(
        "{}: org ({:a}, {:a}, {:a}) dir ({:a}, {:a}, {:a}) t [{:a}, {:a}]; answered t {:.9g} prim {} "
        "inst {}, truly t {:.17g} prim {} inst {}; t off by {} ulps",
        to_string(verdict.hit_class), ray.org.x, ray.org.y, ray.org.z, ray.dir.x, ray.dir.y,
        ray.dir.z, ray.tmin, ray.tmax, hit.t, hit.prim_id, hit.inst_id, verdict.true_t,
        verdict.true_prim_id, verdict.true_inst_id, verdict.t_error_ulps);
}

/// Every answer judged exactly, agreements too.
void expect_no_error(Tracer& tracer, const ScenePtr& scene, const std::vector<Ray>& rays,
                     const std::string& what) {
    const auto judge = make_exact_judge(scene);
    const CastResult result = cast(tracer, rays);
    std::array<size_t, kHitClassCount> counts{};
    for (size_t i = 0; i < rays.size(); ++i) {
        const Verdict verdict =
            judge->judge(rays[i], Query::closest, std::span(&result.hits[i], 1)).front();
        if (++counts[static_cast<size_t>(verdict.hit_class)] == 1 && is_error(verdict.hit_class)) {
            ADD_FAILURE() << what << ", first " << describe(rays[i], result.hits[i], verdict);
        }
        EXPECT_EQ(result.flags[i] & kFlagExhausted, 0u);
    }
    for (size_t c = 0; c < kHitClassCount; ++c) {
        const auto hit_class = static_cast<HitClass>(c);
        if (!is_error(hit_class)) continue;
        EXPECT_EQ(counts[c], 0u) << to_string(hit_class) << ", " << what;
    }
    EXPECT_GT(hit_count(result.hits), rays.size() / 2) << what;
}

TEST_F(GridStrategy, hits_are_bit_identical_to_its_twin_on_a_software_renderer) {
    if (!context->description().software) GTEST_SKIP() << "promised on software renderers only";
    for (const Scene& made : {make_balls_1(), make_instances(), make_big_small(), make_knife()}) {
        const ScenePtr scene = share(made);
        const std::vector<std::vector<Ray>> ray_sets = {primary_rays(*scene, 64, 64),
                                                        random_rays(scene_bounds(*scene), 5000, 7),
                                                        awkward_rays(*scene)};
        const auto twin = make("grid/buffer/twin32", scene);
        for (const char* entry : kEntries) {
            const auto tracer = make(entry, scene);
            for (const std::vector<Ray>& rays : ray_sets) {
                const CastResult gpu = cast(*tracer, rays, {.counters = true});
                const CastResult cpu = cast(*twin, rays, {.counters = true});
                expect_same_bits(gpu.hits, cpu.hits, made.name + " " + entry);
                EXPECT_EQ(gpu.flags, cpu.flags) << made.name << " " << entry;
                const auto [theirs, ours] =
                    std::mismatch(gpu.counters.begin(), gpu.counters.end(), cpu.counters.begin());
                EXPECT_EQ(theirs - gpu.counters.begin(), std::ptrdiff_t(rays.size()))
                    << made.name << " " << entry << ": the first ray that costs another number of "
                    << "cells, tests or references";
            }
        }
    }
}

TEST_F(GridStrategy, no_ray_aimed_at_corners_or_edges_is_answered_wrongly) {
    for (const Scene& made : {make_balls_1(), make_instances(), make_palace()}) {
        const ScenePtr scene = share(made);
        for (const char* kind : {"vertex", "edge"}) {
            const std::vector<Ray> rays = rays_of_kind(kind, *scene, 64);
            for (const char* entry : kEntries) {
                expect_no_error(*make(entry, scene), scene, rays, made.name + ", " + kind);
            }
        }
    }
}

TEST_F(GridStrategy, a_scene_far_from_the_origin_is_as_right_as_one_around_it) {
    for (const float distance : {0.0f, 1e2f, 1e4f, -1e6f}) {
        for (const float scale : {1e-3f, 1.0f, 1e3f}) {
            const ScenePtr scene = ball_at(scale * distance * vec3(1.0f, -0.3f, 0.7f), scale);
            for (const char* kind : {"vertex", "random"}) {
                std::vector<Ray> rays = rays_of_kind(kind, *scene, 32);
                expect_no_error(*make("grid/buffer/twin32", scene), scene, rays,
                                std::to_string(distance) + " sizes away, " + kind);
            }
        }
    }
}

TEST_F(GridStrategy, any_resolution_gives_the_same_hits) {
    const ScenePtr scene = share(make_big_small());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 3000, 12);
    const std::vector<Hit> coarse =
        cast(*make("grid/buffer/twin32", scene, {{"resolution", "1x1x1"}}), rays).hits;
    for (const char* resolution : {"2x3x5", "64x8x64", "200x200x200"}) {
        const auto tracer = make("grid/buffer/twin32", scene, {{"resolution", resolution}});
        expect_same_bits(cast(*tracer, rays).hits, coarse, resolution);
    }
}

TEST_F(GridStrategy, a_buffer_that_the_device_cannot_hold_is_refused_by_name) {
    const ScenePtr scene = share(make_balls_1());
    for (const gl::StrategyInfo& info : gl::ShaderLibrary::embedded().strategies()) {
        if (info.name != "grid") continue;
        try {
            prepare_strategy(info, "buffer", scene, {}, {.max_buffer = 1000});
            FAIL() << "1000 texels were enough";
        } catch (const Error& error) {
            EXPECT_NE(error.parts().where.find("cells"), std::string::npos) << error.what();
            EXPECT_NE(error.parts().expected.find("1000"), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace onepass::test
