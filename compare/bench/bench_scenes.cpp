// A sphere of latitude and longitude with bumps: closed, uneven triangles, thin ones at the poles.
#include "compare/bench/bench_scenes.h"

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace onepass {
namespace {

/// S(slices, stacks): poles are single vertices; 2 slices (stacks - 1) triangles.
struct Tessellation {
    uint32_t slices;
    uint32_t stacks;

    uint32_t triangle_count() const { return 2 * slices * (stacks - 1); }
    /// Ring 0 and ring `stacks` are the poles; slices wrap around.
    uint32_t vertex(uint32_t slice, uint32_t ring) const {
        if (ring == 0) return 0;
        if (ring == stacks) return 1;
        return 2 + (ring - 1) * slices + slice % slices;
    }
};

vec3 bumpy_point(double longitude, double latitude) {
    // Bumps of a tenth of the radius, a few dozen around: enough that neighbouring cells differ.
    const double radius = 1.0 + 0.1 * std::sin(17.0 * longitude) * std::sin(19.0 * latitude);
    return vec3(radius * std::sin(latitude) * std::cos(longitude), radius * std::cos(latitude),
                radius * std::sin(latitude) * std::sin(longitude));
}

Object bumpy_sphere(const Tessellation& t) {
    Object object;
    object.name = "bumpy sphere";
    constexpr double kPi = std::numbers::pi;
    object.positions = {bumpy_point(0.0, 0.0), bumpy_point(0.0, kPi)};
    for (uint32_t ring = 1; ring < t.stacks; ++ring) {
        for (uint32_t slice = 0; slice < t.slices; ++slice) {
            object.positions.push_back(
                bumpy_point(2.0 * kPi * slice / t.slices, kPi * ring / t.stacks));
        }
    }
    for (uint32_t ring = 0; ring < t.stacks; ++ring) {
        for (uint32_t slice = 0; slice < t.slices; ++slice) {
            const uint32_t a = t.vertex(slice, ring);
            const uint32_t b = t.vertex(slice + 1, ring);
            const uint32_t c = t.vertex(slice + 1, ring + 1);
            const uint32_t d = t.vertex(slice, ring + 1);
            if (ring > 0) object.triangles.emplace_back(a, b, c);
            if (ring + 1 < t.stacks) object.triangles.emplace_back(a, c, d);
        }
    }
    ONEPASS_CHECK_EQ(object.triangles.size(), t.triangle_count());
    object.groups = {{"all", 0, t.triangle_count()}};
    return object;
}

Scene scene_of(Object object) {
    Scene scene;
    scene.name = object.name;
    scene.objects = {std::move(object)};
    scene.instances = {Instance{.name = "only", .materials = {0}}};
    scene.materials = {Material{}};
    return scene;
}

}  // namespace

std::vector<BenchScene> make_bench_scenes() {
    return {{"70k", scene_of(bumpy_sphere({.slices = 250, .stacks = 141}))},
            {"1M", scene_of(bumpy_sphere({.slices = 1000, .stacks = 501}))}};
}

Scene make_large_bench_scene() { return scene_of(bumpy_sphere({.slices = 2500, .stacks = 2001})); }

}  // namespace onepass
