// Where things are, and how large: translation, scale, far rays, a small thing in a large one.
#include <cmath>

#include "scenes/ladders/parts.h"
#include "scenes/modelling.h"

namespace onepass::ladder {
namespace {

/// Away from the origin, along no axis.
dvec3 away(double distance) { return distance * glm::normalize(dvec3(1.0, -0.3, 0.7)); }

Ladder translation_ladder() {
    return {.id = "translation",
            .title = "Far from the origin",
            .question =
                "A ball of size 1 whose vertices lie far from the origin. Its coordinates "
                "keep few digits, and what is computed from absolute coordinates loses "
                "those that are left.",
            .knob = "distance from the origin",
            .unit = "scene sizes",
            .rungs = rungs_of(powers_of_ten(0, 6), [](double knob) {
                return scene_of(mapped(ball(), [&](const dvec3& p) { return p + away(knob); }));
            })};
}

Ladder there_and_back_ladder() {
    return {.id = "there-and-back",
            .title = "Far from its own origin",
            .question =
                "The same ball, and an instance that moves it back to the origin: the "
                "world's coordinates are small and exact, the object's are not. A ray that "
                "is rounded to the object's frame misses what it is aimed at.",
            .knob = "distance from the object's origin",
            .unit = "scene sizes",
            .rungs = rungs_of(powers_of_ten(0, 6), [](double knob) {
                const vec3 offset = vec3(away(knob));
                return scene_of(mapped(ball(), [&](const dvec3& p) { return p + dvec3(offset); }),
                                {translation(-offset)});
            })};
}

/// `sign`: 1 to large scenes, -1 to small ones. Close steps where floats begin to fail.
Ladder scale_ladder(const char* id, const char* title, const char* question, int sign) {
    std::vector<double> knobs;
    for (const int power : {0, 3, 6, 9, 10, 11, 12, 13, 14, 15, 18}) {
        knobs.push_back(power_of_ten(sign * power));
    }
    return {.id = id,
            .title = title,
            .question = question,
            .knob = "size of the scene",
            .unit = "scene units",
            .rungs = rungs_of(knobs, [](double knob) {
                return scene_of(mapped(ball(), [&](const dvec3& p) { return p * knob; }));
            })};
}

Ladder far_rays_ladder() {
    const auto rays_from = [](double distance) {
        return [=](const Scene& scene, size_t count, uint64_t seed) {
            Random random(seed);
            std::vector<Ray> rays;
            for (size_t i = 0; i < count; ++i) {
                const Target target = random_target(scene, random);
                const dvec3 origin = target.point + distance * random_unit_vector(random);
                rays.push_back(ray_towards(origin, target.point, random));
            }
            return rays;
        };
    };
    return {.id = "far-rays",
            .title = "Rays from afar",
            .question =
                "A ball of size 1 at the origin, seen from ever farther away: t is large, "
                "and its rounding is soon coarser than the ball.",
            .knob = "distance of the rays' origins",
            .unit = "scene sizes",
            .rungs = rungs_of(
                powers_of_ten(0, 6), [](double) { return scene_of(ball()); }, rays_from)};
}

// ---- A teapot in a stadium

/// A turned pot with belly and lid, standing on y = 0; height and width about 1.
Object pot() {
    const vec2 keys[] = {{0.0f, 0.0f},  {0.3f, 0.0f},   {0.5f, 0.25f},  {0.46f, 0.5f}, {0.3f, 0.7f},
                         {0.1f, 0.78f}, {0.05f, 0.85f}, {0.08f, 0.92f}, {0.0f, 0.95f}};
    return bare(turned(keys, 20, 16));
}

/// A closed dish with a floor on y = 0, and tiers of seats about it; its floor has radius 1.
Object dish() {
    std::vector<vec2> profile = {{0.0f, -0.2f}, {1.0f, -0.2f}, {1.9f, 0.6f}};
    constexpr int kTiers = 5;
    for (int tier = kTiers; tier >= 1; --tier) {
        const float share = static_cast<float>(tier) / kTiers;
        profile.emplace_back(1.0f + 0.8f * share, 0.6f * share);
        profile.emplace_back(1.0f + 0.8f * (share - 1.0f / kTiers), 0.6f * share);
    }
    profile.emplace_back(1.0f, 0.0f);
    profile.emplace_back(0.0f, 0.0f);
    return bare(make_lathe(profile, 36));
}

Scene stadium(double ratio) {
    const dvec3 place = ratio * dvec3(0.37, 0.0, 0.21);
    Object all;
    all.name = "stadium";
    append_shape(all, mapped(dish(), [&](const dvec3& p) { return ratio * p; }), affine_identity(),
                 "stadium");
    append_shape(all, mapped(pot(), [&](const dvec3& p) { return p + place; }), affine_identity(),
                 "pot");
    return scene_of(std::move(all));
}

/// At the pot: most from beside it, some from the tiers.
std::vector<Ray> rays_at_pot(const Scene& scene, size_t count, uint64_t seed) {
    constexpr uint64_t kOneInSoManyFromAfar = 4;
    constexpr double kBeside = 2.0;
    const Bounds box = scene_bounds(scene);
    const size_t pot_triangles = scene.objects[0].groups.back().triangle_count;
    Random random(seed);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Target target = random_target(scene, random, pot_triangles);
        dvec3 origin = target.point + kBeside * random_unit_vector(random);
        if (random.below(kOneInSoManyFromAfar) == 0) {
            origin = point_around(box, 1.0, random);
            origin.y = std::abs(origin.y);
        }
        const Ray ray = ray_towards(origin, target.point, random);
        if (ray.dir != vec3(0.0f)) rays.push_back(ray);
    }
    return rays;
}

Ladder stadium_ladder() {
    return {.id = "stadium",
            .title = "A teapot in a stadium",
            .question =
                "A pot of size 1 stands in a stadium, in one mesh. All of its triangles "
                "fall into few cells of a grid, and its coordinates, boxes and t have the "
                "stadium's rounding.",
            .knob = "stadium / pot",
            .unit = "",
            .rungs = rungs_of(powers_of_ten(0, 6), stadium, [](double) { return rays_at_pot; })};
}

}  // namespace

std::vector<Ladder> place_ladders() {
    return {translation_ladder(),
            there_and_back_ladder(),
            far_rays_ladder(),
            scale_ladder("scale-up", "Large scenes",
                         "Products of three lengths, as in determinants, leave the range of a "
                         "float when lengths are near 1e13; squares when they are near 1e19.",
                         1),
            scale_ladder("scale-down", "Small scenes",
                         "Products of three lengths become denormal numbers, and then 0, when "
                         "lengths are near 1e-13. A constant epsilon is larger than such a scene.",
                         -1),
            stadium_ladder()};
}

}  // namespace onepass::ladder
