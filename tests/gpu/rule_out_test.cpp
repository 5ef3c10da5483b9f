// The bounds on rounding of the triangle test in floats, over triangles of all sizes and shapes: a
// ray through a point of the triangle is never ruled out, none but those are surely hits, and t is
// known as well as it is said to be.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "tests/gpu/rule_out_text.h"

namespace onepass {
namespace {

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
    int sure = 0;
    int ruled_out = 0;
    for (int i = 0; i < kCases; ++i) {
        const double half = i % 2 == 0 ? 0.5 : 1.0;
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
}

INSTANTIATE_TEST_SUITE_P(Records, RuleOutForms,
                         testing::Values(PlanesForm::floats, PlanesForm::fixed),
                         [](const auto& form) {
                             return form.param == PlanesForm::floats ? "floats" : "fixed";
                         });

}  // namespace
}  // namespace onepass
