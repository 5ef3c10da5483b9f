#include "gpu_glsl/pack/barycentric_planes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/glm.hpp>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/planes_layout.h"

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
    constexpr double kNoHeight = 1.0 / (1 << 30);  // beside the longest edge
    std::array<Corners, 3> turns = {
        {{thin.a, thin.b, thin.c}, {thin.b, thin.c, thin.a}, {thin.c, thin.a, thin.b}}};
    const auto [from, to, third] =
        *std::ranges::max_element(turns, {}, [](const Corners& t) { return distance(t.a, t.b); });
    const double length = distance(from, to);
    const dvec3 along = length > 0.0 ? (to - from) / length : dvec3(1.0, 0.0, 0.0);
    const dvec3 offset = third - from - dot(third - from, along) * along;
    const bool has_height = glm::length(offset) > kNoHeight * length;
    const dvec3 up = has_height ? normalize(offset) : across(along);
    const dvec3 overhang = std::max(0.5 * length, kHeight) * along;
    return {from - overhang - kHeight * up, to + overhang - kHeight * up,
            0.5 * (from + to) + 6.0 * kHeight * up};
}

/// A triangle's plane, not scaled; and of v1 and v2, the planes (m, e) on which their weight is 0.
struct Planes {
    dvec3 normal;
    dvec3 corner;  // a point of the plane
    dvec3 first;
    dvec3 second;
    double first_e = 0.0;
    double second_e = 0.0;
};

Planes planes_of(const Corners& t) {
    const dvec3 normal = cross(t.b - t.a, t.c - t.a);
    const double share = 1.0 / dot(normal, normal);
    const dvec3 first = share * cross(t.c - t.a, normal);
    const dvec3 second = share * cross(normal, t.b - t.a);
    return {normal, t.a, first, second, -dot(first, t.a), -dot(second, t.a)};
}

/// Too thin or too low for planes.
bool is_thin(const Corners& t, PlanesForm form) {
    constexpr double kThin = 0x1p-20;
    constexpr double kLow = 0x1p-28;  // scales down to 2^-31 have a byte
    const double longest_squared =
        std::max({dot(t.b - t.a, t.b - t.a), dot(t.c - t.b, t.c - t.b), dot(t.a - t.c, t.a - t.c)});
    const dvec3 normal = cross(t.b - t.a, t.c - t.a);
    const double area_squared = dot(normal, normal);
    const bool is_low = !(area_squared > kLow * kLow * longest_squared);
    return !(area_squared > kThin * kThin * longest_squared * longest_squared) ||
           (form == PlanesForm::fixed && is_low);
}

/// The bounds on rounding are for corners in the box. Those of the one around a thin triangle lie
/// up to half a box outside: first.d and second.d are up to A and B, and errors by a sixth larger.
constexpr double kThinScale = 0.75;

void put_floats(uint32_t* out, const Planes& planes, bool is_thin) {
    double scale = 1.0 / (sum_of_sizes(planes.normal) *
                          (sum_of_sizes(planes.first) + sum_of_sizes(planes.second) + 1.0));
    if (is_thin) scale *= kThinScale;
    // Of the two ways round, that of d >= 0; the other one for thin triangles.
    if (dot(planes.normal, planes.corner) < 0.0) scale = -scale;
    const auto put = [&](uint32_t* texel, const dvec3& n, double d) {
        for (int axis = 0; axis < 3; ++axis) {
            texel[axis] = std::bit_cast<uint32_t>(static_cast<float>(n[axis]));
        }
        texel[3] = std::bit_cast<uint32_t>(static_cast<float>(d));
    };
    put(out, scale * planes.normal, std::abs(scale * dot(planes.normal, planes.corner)));
    put(out + 4, planes.first, planes.first_e);
    put(out + 8, planes.second, planes.second_e);
    constexpr uint32_t kSign = 0x80000000u;
    for (int k = 0; is_thin && k < 4; ++k) out[k] ^= kSign;
}

int32_t rounded(double x) { return static_cast<int32_t>(x + std::copysign(0.5, x)); }

/// A word that is read as 2^31 times a number in [-1, 1], with other bits in its low byte.
uint32_t fixed_word(double number, uint32_t low_byte) {
    ONEPASS_CHECK_LE(std::abs(number), 1.0);
    constexpr int32_t kOne = 1 << 23;
    const int32_t high = rounded((number * 0x1p31 - low_byte) / 256.0);
    return (static_cast<uint32_t>(std::clamp(high, -kOne, kOne - 1)) << 8) | low_byte;
}

void put_fixed(uint32_t* out, const Planes& planes, bool is_thin) {
    // For corners in the box d is at most 3, and room is for 4.
    constexpr double kMostD = 3.5;
    // On the plane, p[k] = d - slope.x p[i] - slope.y p[j].
    const dvec3 n = planes.normal;
    const dvec3 size = abs(n);
    const int k = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const int i = k == 0 ? 1 : 0;
    const int j = k == 2 ? 1 : 2;
    const glm::dvec2 slope = glm::dvec2(n[i], n[j]) / n[k];
    const double d = dot(n, planes.corner) / n[k];
    if (!(std::abs(d) < kMostD)) {
        std::fill_n(out, planes_words(PlanesForm::fixed), 0u);
        out[5] = kNoPlanes;
        return;
    }
    const auto seen = [&](const dvec3& m, double e) {  // weights, by p[i], p[j] and 1
        return dvec3(m[i] - m[k] * slope.x, m[j] - m[k] * slope.y, e + m[k] * d);
    };
    dvec3 first = seen(planes.first, planes.first_e);
    dvec3 second = seen(planes.second, planes.second_e);

    // A byte says a scale of eighths of an octave, no larger than what the bounds on rounding ask
    // for and than all numbers have room for.
    const double sum =
        std::abs(first.x) + std::abs(first.y) + std::abs(second.x) + std::abs(second.y) + 1.0;
    const double most =
        std::max({is_thin ? sum / kThinScale : sum, std::abs(first.z), std::abs(second.z)});
    constexpr double kRoundingOfFloats = 1.0 - 0x1p-23;
    const auto units = static_cast<float>(kRoundingOfFloats * 0x1p31 / most);
    const uint32_t scale_byte = (std::bit_cast<uint32_t>(units) - kLeastScale) >> kScaleShift;
    ONEPASS_CHECK_LT(scale_byte, 256u);
    const double scale = std::bit_cast<float>((scale_byte << kScaleShift) + kLeastScale) * 0x1p-31;
    first *= scale;
    second *= scale;

    const uint32_t ninth = fixed_word(second.z, 0);
    const uint32_t along = k == 0 ? kAlongX : k == 2 ? kAlongZ : 0;
    out[0] = fixed_word(slope.x, ninth >> 24);
    out[1] = fixed_word(slope.y, (ninth >> 16) & 255u);
    out[2] = static_cast<uint32_t>(rounded(d * 0x1p29));
    out[3] = fixed_word(first.x, (ninth >> 8) & 255u);
    out[4] = fixed_word(first.y, scale_byte);
    out[5] = fixed_word(first.z, along | (is_thin ? kThinPlanes : 0));
    out[6] = fixed_word(second.x, 0);
    out[7] = fixed_word(second.y, 0);
}

}  // namespace

size_t planes_words(PlanesForm form) {
    return 4 *
           static_cast<size_t>(form == PlanesForm::fixed ? kFixedPlanesTexels : kFloatPlanesTexels);
}

void put_barycentric_planes(uint32_t* out, PlanesForm form, const dvec3& v0, const dvec3& v1,
                            const dvec3& v2) {
    const Corners t{v0, v1, v2};
    const bool thin = is_thin(t, form);
    const Planes planes = planes_of(thin ? widened(t) : t);
    (form == PlanesForm::fixed ? put_fixed : put_floats)(out, planes, thin);
}

}  // namespace onepass
