#include "gpu_glsl/pack/barycentric_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

namespace onepass {
namespace {

struct Corners {
    dvec3 a;
    dvec3 b;
    dvec3 c;
};

double sum_of_sizes(const dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// A unit vector across v, which is one.
dvec3 across(const dvec3& v) {
    const dvec3 size = abs(v);
    const int least = size.x <= size.y ? (size.x <= size.z ? 0 : 2) : (size.y <= size.z ? 1 : 2);
    dvec3 axis(0.0);
    axis[least] = 1.0;
    return normalize(cross(v, axis));
}

/// A triangle with room to spare around a thin one, in its plane. Its base runs below the longest
/// edge, by a half longer at both ends; lower and narrower it would be lost in the rounding of the
/// test.
Corners widened(const Corners& thin) {
    constexpr double kHeight = 1.0 / 4096.0;
    std::array<Corners, 3> turns = {
        {{thin.a, thin.b, thin.c}, {thin.b, thin.c, thin.a}, {thin.c, thin.a, thin.b}}};
    const auto [from, to, third] =
        *std::ranges::max_element(turns, {}, [](const Corners& t) { return distance(t.a, t.b); });
    const double length = distance(from, to);
    const dvec3 along = length > 0.0 ? (to - from) / length : dvec3(1.0, 0.0, 0.0);
    const dvec3 offset = third - from - dot(third - from, along) * along;
    const dvec3 up = glm::length(offset) > 0.0 ? normalize(offset) : across(along);
    const dvec3 overhang = std::max(0.5 * length, kHeight) * along;
    return {from - overhang - kHeight * up, to + overhang - kHeight * up,
            0.5 * (from + to) + 6.0 * kHeight * up};
}

}  // namespace

void put_barycentric_planes(float* out, const dvec3& v0, const dvec3& v1, const dvec3& v2) {
    constexpr double kThin = 1.0 / (1 << 20);
    const auto edges_squared = [](const Corners& t) {
        return std::max(
            {dot(t.b - t.a, t.b - t.a), dot(t.c - t.b, t.c - t.b), dot(t.a - t.c, t.a - t.c)});
    };
    Corners t{v0, v1, v2};
    const bool is_thin = !(glm::length(cross(t.b - t.a, t.c - t.a)) > kThin * edges_squared(t));
    if (is_thin) t = widened(t);

    const dvec3 normal = cross(t.b - t.a, t.c - t.a);
    const double area_squared = dot(normal, normal);
    const dvec3 first = cross(t.c - t.a, normal) / area_squared;
    const dvec3 second = cross(normal, t.b - t.a) / area_squared;
    double scale =
        1.0 / (sum_of_sizes(normal) * (sum_of_sizes(first) + sum_of_sizes(second) + 1.0));
    if (dot(normal, t.a) < 0.0) scale = -scale;
    const auto put = [&](float* texel, const dvec3& n, double d) {
        for (int axis = 0; axis < 3; ++axis) texel[axis] = static_cast<float>(n[axis]);
        texel[3] = static_cast<float>(d);
    };
    put(out, scale * normal, std::abs(scale * dot(normal, t.a)));
    put(out + 4, first, -dot(first, t.a));
    put(out + 8, second, -dot(second, t.a));
    // Turned the other way round, it is the same plane, and the sign of d tells.
    for (int k = 0; is_thin && k < 4; ++k) out[k] = -out[k];
}

}  // namespace onepass
