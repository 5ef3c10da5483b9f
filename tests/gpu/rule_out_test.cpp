// The bounds on rounding of the triangle test in floats, over triangles of all sizes and shapes: a
// ray through a point of the triangle is never ruled out, none but those are surely hits, and t is
// known as well as it is said to be.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "tests/gpu/rule_out_text.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/planes_layout.h"

using Corners = std::array<dvec3, 3>;

enum class Place { inside, edge, corner, outside };

/// A triangle, and a ray that meets its plane at a point that is known.
struct Case {
    Place place = Place::inside;
    Corners corners;
    dvec3 org;
    dvec3 dir;
    double t = 0.0;  ///< at the point
};

class Cases {
  public:
    /// In a box of edges of 2 `half`.
    Case next(double half) {
        Case c;
        c.place = static_cast<Place>(random_() % 4);
        c.corners = corners(half);
        const std::array<double, 3> w = weights(c.place);
        const dvec3 point = (w[0] * c.corners[0] + w[1] * c.corners[1] + w[2] * c.corners[2]) /
                            (w[0] + w[1] + w[2]);
        const double distance = std::exp2(10.0 * one() - 10.0);
        c.org = clamp(point + distance * half * any(), dvec3(-half), dvec3(half));
        const dvec3 way = point - c.org;
        const double largest = std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
        c.t = largest > 0.0 ? std::exp2(std::ceil(std::log2(largest))) : 1.0;
        c.dir = largest > 0.0 ? way / c.t : dvec3(1.0, 0.0, 0.0);
        if (largest == 0.0) c.t = 0.0;
        return c;
    }

  private:
    double one() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
    dvec3 any() { return {one(), one(), one()}; }

    /// Edges of 2^-24 to 1 times the box's; a third corner that is 2^-22 to 1 of one off; some lie
    /// across an axis, some are seen along two axes alike, some have corners that coincide.
    Corners corners(double half) {
        const double size = std::exp2(12.0 * one() - 12.0);
        const double shape = std::exp2(11.0 * one() - 11.0);
        Corners at;
        at[0] = any();
        at[1] = at[0] + size * any();
        at[2] = mix(at[0], at[1], 0.5 + one()) + shape * size * any();
        if (random_() % 8 == 0) at[2].z = at[1].z = at[0].z;
        if (random_() % 8 == 0) {
            for (dvec3& p : at) p.y = p.x;
        }
        for (dvec3& p : at) p = dvec3(vec3(half * clamp(p, dvec3(-1.0), dvec3(1.0))));
        return at;
    }

    std::array<double, 3> weights(Place place) {
        std::array<double, 3> w = {std::abs(one()), std::abs(one()), std::abs(one())};
        const size_t k = random_() % 3;
        if (place == Place::edge) w[k] = 0.0;
        if (place == Place::corner) w[k] = w[(k + 1) % 3] = 0.0;
        if (place == Place::outside) w[k] *= -std::exp2(10.0 * one() - 11.0);
        return w;
    }

    std::mt19937 random_{1};
};

std::string described(const Case& c) {
    std::string text = fmt::format("place {}", static_cast<int>(c.place));
    for (const dvec3& p : {c.corners[0], c.corners[1], c.corners[2], c.org, c.dir}) {
        text += fmt::format(" ({:a} {:a} {:a})", p.x, p.y, p.z);
    }
    return text;
}

class RuleOutForms : public testing::TestWithParam<PlanesForm> {};

TEST_P(RuleOutForms, no_hit_is_ruled_out_and_no_miss_is_sure) {
    constexpr int kCases = 2'000'000;
    Cases cases;
    constexpr double kHalves[] = {0.5, 0.5 + 0x1p-20, 0.667, 1.0};
    int sure = 0;
    float most_disagreement = 0.0f;
    int ruled_out = 0;
    for (int i = 0; i < kCases; ++i) {
        const double half = kHalves[i % 4];
        const Case c = cases.next(half);
        std::array<uint32_t, 12> record{};
        put_barycentric_planes(record.data(), GetParam(), c.corners[0], c.corners[1], c.corners[2]);
        const test::RuleOut r = test::rule_out(record.data(), GetParam(), vec3(c.org), vec3(c.dir),
                                               vec3(static_cast<float>(half)));
        if (c.place == Place::outside) {
            ruled_out += !r.may_cross;
            ASSERT_FALSE(r.may_cross && r.is_sure) << described(c);
            continue;
        }
        ASSERT_TRUE(r.may_cross) << described(c);
        most_disagreement = std::max(most_disagreement, r.disagreement);
        sure += r.is_sure;
        if (c.place != Place::inside) {
            ASSERT_FALSE(r.is_sure) << described(c);
        }
        if (r.is_known) {
            ASSERT_LE(std::abs(r.t - c.t), r.error) << described(c);
        }
    }
    EXPECT_GT(sure, kCases / 100);
    EXPECT_GT(ruled_out, kCases / 200);
    // The bounds are for the worst of all roundings at once; those met come to a twentieth and
    // more.
    EXPECT_GT(most_disagreement, 0.05f);
}

TEST(FixedPlanes, of_a_triangle_out_of_all_proportion_may_be_hit_anywhere) {
    // (Frames end where floats do: frames.h.)
    std::array<uint32_t, 12> record{};
    put_barycentric_planes(record.data(), PlanesForm::fixed, {7, 0, 0}, {7, 1, 0}, {7, 0, 1});
    for (const vec3& dir : {vec3(1, 0, 0), vec3(0.25f, -1, 0.5f), vec3(0, 1, 0)}) {
        const test::RuleOut r =
            test::rule_out(record.data(), PlanesForm::fixed, vec3(0.1f, 0.2f, 0), dir, vec3(8.0f));
        EXPECT_TRUE(r.may_cross);
        EXPECT_FALSE(r.is_known || r.is_sure);
    }
}

/// A record's numbers, read as the shaders read them.
std::array<double, 9> numbers_of(const std::array<uint32_t, 12>& record) {
    const auto fixed = [](uint32_t word) { return static_cast<int32_t>(word) / 0x1p31; };
    const uint32_t ninth =
        (record[0] << 24) | ((record[1] & 255u) << 16) | ((record[3] & 255u) << 8);
    return {fixed(record[0]), fixed(record[1]), 4.0 * fixed(record[2]),
            fixed(record[3]), fixed(record[4]), fixed(record[5]),
            fixed(record[6]), fixed(record[7]), fixed(ninth)};
}

TEST(FixedPlanes, say_the_triangle_to_24_bits) {
    Cases cases;
    for (int i = 0; i < 100'000; ++i) {
        const Corners corners = cases.next(1.0).corners;
        std::array<uint32_t, 12> record{};
        put_barycentric_planes(record.data(), PlanesForm::fixed, corners[0], corners[1],
                               corners[2]);
        const uint32_t flags = record[5] & 255u;
        if ((flags & kThinPlanes) != 0) continue;
        const int k = (flags & kAlongX) != 0 ? 0 : (flags & kAlongZ) != 0 ? 2 : 1;
        const std::array<double, 9> n = numbers_of(record);
        const double scale =
            std::bit_cast<float>(((record[4] & 255u) << kScaleShift) + kLeastScale) * 0x1p-31;
        const double sum =
            std::abs(n[3]) + std::abs(n[4]) + std::abs(n[6]) + std::abs(n[7]) + scale;
        EXPECT_GT(sum, 0.43) << "a scale of eighths of an octave, and room for second.d";
        EXPECT_LT(sum, 1.0 + 4 * 0x1p-23);
        for (int v = 0; v < 3; ++v) {
            const dvec3& p = corners[static_cast<size_t>(v)];
            const double p_i = k == 0 ? p.y : p.x;
            const double p_j = k == 2 ? p.y : p.z;
            EXPECT_NEAR(p[k] + n[0] * p_i + n[1] * p_j, n[2], 3 * 0x1p-23);
            EXPECT_NEAR(n[3] * p_i + n[4] * p_j + n[5], v == 1 ? scale : 0.0, 3 * 0x1p-23);
            EXPECT_NEAR(n[6] * p_i + n[7] * p_j + n[8], v == 2 ? scale : 0.0, 3 * 0x1p-23);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Records, RuleOutForms,
                         testing::Values(PlanesForm::floats, PlanesForm::fixed),
                         [](const auto& form) {
                             return form.param == PlanesForm::floats ? "floats" : "fixed";
                         });

}  // namespace
}  // namespace onepass
