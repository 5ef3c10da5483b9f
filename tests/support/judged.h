// Answers judged exactly, and the scenes and rays on which that is worth while: for strategies that
// promise not one wrong hit.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/shapes.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {

/// A closed ball about `centre`, in one instance.
inline ScenePtr ball_at(const vec3& centre, float scale) {
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

/// The ball as a needle or a pancake, small beside the first, sheared, mirrored, nearly flat.
inline ScenePtr squeezed_balls() {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    const auto add = [&](vec3 x, vec3 y, vec3 z, vec3 place) {
        scene.instances.push_back({.name = fmt::format("ball {}", scene.instances.size()),
                                   .object = 0,
                                   .world_from_object = Affine(x, y, z, place),
                                   .materials = {0}});
    };
    add({1e3f, 0, 0}, {0, 1e-3f, 0}, {0, 0, 1}, {0, 3, 0});
    add({1, 0, 0}, {0, 1e-6f, 0}, {0, 0, 1}, {0, -3, 0});
    add({1e-4f, 0, 0}, {0, 1e-4f, 0}, {0, 0, 1e-4f}, {1.5f, 0, 0});
    add({1, 0, 0}, {3, 1, 0}, {-2, 5, 1}, {-20, 0, 0});
    add({-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {20, 0, 0});
    add({1, 2, 3}, {2, 4.0001f, 6}, {3, 5, 7.5f}, {50, 0, 9});
    validate(scene);
    return share(std::move(scene));
}

inline std::vector<Ray> rays_of_kind(const std::string& kind, const Scene& scene, uint32_t side) {
    const auto oracle = embree_tracers().front().make(share(scene), {});
    return make_ray_set(kind, scene, *oracle, {.width = side, .height = side, .seed = 5}).rays;
}

inline std::string judged(const Ray& ray, const Hit& hit, const Verdict& verdict) {
    return fmt::format(
        "{}: org ({:a}, {:a}, {:a}) dir ({:a}, {:a}, {:a}) t [{:a}, {:a}]; answered t {:.9g} prim "
        "{} "
        "inst {}, truly t {:.17g} prim {} inst {}; t off by {} ulps",
        to_string(verdict.hit_class), ray.org.x, ray.org.y, ray.org.z, ray.dir.x, ray.dir.y,
        ray.dir.z, ray.tmin, ray.tmax, hit.t, hit.prim_id, hit.inst_id, verdict.true_t,
        verdict.true_prim_id, verdict.true_inst_id, verdict.t_error_ulps);
}

/// Every answer judged exactly, agreements too.
inline void expect_no_error(Tracer& tracer, const ScenePtr& scene, const std::vector<Ray>& rays,
                            const std::string& what) {
    const auto judge = make_exact_judge(scene);
    const CastResult result = cast(tracer, rays);
    std::array<size_t, kHitClassCount> counts{};
    for (size_t i = 0; i < rays.size(); ++i) {
        const Verdict verdict =
            judge->judge(rays[i], Query::closest, std::span(&result.hits[i], 1)).front();
        if (++counts[static_cast<size_t>(verdict.hit_class)] == 1 && is_error(verdict.hit_class)) {
            ADD_FAILURE() << what << ", first " << judged(rays[i], result.hits[i], verdict);
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

}  // namespace onepass::test
