// A tracer broken on purpose in six ways: the exact judge gives each the class that is its name, on
// every ray that the fault touches, and finds no error without it.
#include <array>

#include <gtest/gtest.h>

#include "compare/hits.h"
#include "compare/rays.h"
#include "cpu_ref/exact_judge.h"
#include "scenes/shapes.h"
#include "tests/support/brute_tracer.h"

namespace onepass {

void PrintTo(HitClass hit_class, std::ostream* out) { *out << to_string(hit_class); }

namespace test {
namespace {

constexpr uint32_t kBall = 0;
constexpr uint32_t kInnerBall = 1;
constexpr uint32_t kCopyOfBall = 2;

/// A ball, a smaller one in it, and the first once more in the same place.
ScenePtr nested_balls() {
    Scene scene;
    scene.objects = {make_sphere(16, 12)};
    scene.materials.push_back({});
    for (const float size : {1.0f, 0.5f, 1.0f}) {
        scene.instances.push_back({.name = "ball", .object = 0, .materials = {0}});
        scene.instances.back().world_from_object = scaling(vec3(size));
    }
    validate(scene);
    return std::make_shared<const Scene>(std::move(scene));
}

/// From outside to points within the inner ball; and past both.
std::vector<Ray> rays_at_balls(size_t count) {
    std::vector<Ray> rays = random_rays({vec3(-0.25f), vec3(0.25f)}, count, 3);
    for (size_t i = 0; i < count; ++i) {
        rays[i].dir = rays[i].org + vec3(0.0f, 0.0f, 3.0f);
        rays[i].org = vec3(0.0f, 0.0f, -3.0f);
        if (i % 4 == 0) rays[i].dir.x += 10.0f;
    }
    return rays;
}

struct Fault {
    const char* what;
    HitClass expected;
    bool touches_hits;  ///< or misses
    Sabotage sabotage;
};

std::vector<Fault> faults() {
    const auto spoils_hits = [](auto change) {
        Sabotage sabotage;
        sabotage.spoils = [=](const Scene& scene, const Ray&, Hit& hit, uint32_t&) {
            if (hit.is_hit()) change(scene, hit);
        };
        return sabotage;
    };
    Sabotage invents;
    invents.spoils = [](const Scene&, const Ray&, Hit& hit, uint32_t&) {
        if (!hit.is_hit()) hit = {1.0f, 0.2f, 0.2f, 5, kBall};
    };
    Sabotage sees_through;
    sees_through.drops = [](const Hit& hit) { return hit.inst_id != kInnerBall; };
    return {
        {"loses hits", HitClass::false_miss, true,
         spoils_hits([](const Scene&, Hit& hit) { hit = Hit{}; })},
        {"invents hits", HitClass::false_hit, false, invents},
        {"sees through the nearest", HitClass::wrong_surface, true, sees_through},
        {"names a triangle on the other side", HitClass::wrong_surface, true,
         spoils_hits([](const Scene& scene, Hit& hit) {
             const auto count = static_cast<uint32_t>(scene.objects[0].triangles.size());
             hit.prim_id = (hit.prim_id + count / 2) % count;
         })},
        {"is off in t", HitClass::t_error, true,
         spoils_hits([](const Scene&, Hit& hit) { hit.t *= 1.001f; })},
        {"names the copy", HitClass::tie, true,
         spoils_hits([](const Scene&, Hit& hit) { hit.inst_id = kCopyOfBall; })},
    };
}

std::array<uint64_t, kHitClassCount> classes_of(const Sabotage& sabotage,
                                                const std::vector<Ray>& rays, bool of_hits) {
    const ScenePtr scene = nested_balls();
    const auto judge = make_exact_judge(scene);
    BruteTracer honest(scene, {});
    BruteTracer broken(scene, sabotage);
    const CastResult truth = honest.cast(honest.upload(rays), {});
    const CastResult answers = broken.cast(broken.upload(rays), {});
    std::array<uint64_t, kHitClassCount> counts{};
    for (size_t i = 0; i < rays.size(); ++i) {
        if (truth.hits[i].is_hit() != of_hits) continue;
        const std::span<const Hit> answer(&answers.hits[i], 1);
        const HitClass hit_class = judge->judge(rays[i], Query::closest, answer).front().hit_class;
        ++counts[static_cast<size_t>(hit_class)];
    }
    return counts;
}

TEST(BrokenTracer, gets_the_class_of_its_fault_on_every_ray) {
    const std::vector<Ray> rays = rays_at_balls(2000);
    for (const Fault& fault : faults()) {
        const auto counts = classes_of(fault.sabotage, rays, fault.touches_hits);
        for (size_t c = 0; c < kHitClassCount; ++c) {
            const uint64_t expected = static_cast<HitClass>(c) != fault.expected ? 0
                                      : fault.touches_hits                       ? 1500
                                                                                 : 500;
            EXPECT_EQ(counts[c], expected)
                << fault.what << ": " << to_string(static_cast<HitClass>(c));
        }
    }
}

TEST(BrokenTracer, has_no_error_when_it_is_not_broken) {
    for (const bool of_hits : {true, false}) {
        const auto counts = classes_of({}, rays_at_balls(2000), of_hits);
        for (size_t c = 0; c < kHitClassCount; ++c) {
            if (is_error(static_cast<HitClass>(c))) {
                EXPECT_EQ(counts[c], 0u);
            }
        }
    }
}

}  // namespace
}  // namespace test
}  // namespace onepass
