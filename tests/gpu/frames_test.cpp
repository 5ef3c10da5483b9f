// The map that takes rays to an instance, against the exact inverse in rational numbers.
#include "gpu_glsl/pack/frames.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

namespace onepass::test {
namespace {

using Rational = boost::multiprecision::cpp_rational;

/// Entry (row, column) of the inverse of the linear part.
Rational exact_inverse(const Affine& m, int row, int column) {
    const auto at = [&](int c, int r) { return Rational(m[c % 3][r % 3]); };
    const auto cofactor = [&](int c, int r) -> Rational {
        return at(c + 1, r + 1) * at(c + 2, r + 2) - at(c + 1, r + 2) * at(c + 2, r + 1);
    };
    const Rational determinant =
        at(0, 0) * cofactor(0, 0) + at(0, 1) * cofactor(0, 1) + at(0, 2) * cofactor(0, 2);
    return cofactor(row, column) / determinant;
}

/// Three columns of any direction, the last so near to the others' plane that the determinant is
/// about 2^-flatness of their lengths' product; lengths from 2^-20 to 2^20.
Affine random_map(std::mt19937& engine, int flatness) {
    std::uniform_real_distribution<float> within(-1.0f, 1.0f);
    const auto vector = [&] {
        const float x = within(engine);
        const float y = within(engine);
        return vec3(x, y, within(engine));
    };
    Affine m(vector(), vector(), vector(), 100.0f * vector());
    m[2] = within(engine) * m[0] + within(engine) * m[1] + std::ldexp(1.0f, -flatness) * m[2];
    for (int column = 0; column < 3; ++column) m[column] *= std::exp2(20.0f * within(engine));
    return m;
}

TEST(InstanceRows, are_the_inverse_to_48_digits_however_flat_the_map) {
    // The pair of floats rounds to 2^-48 of the number, and the number itself is right to 2^-51.
    const Rational tolerance = Rational(1, uint64_t{1} << 48) + Rational(1, uint64_t{1} << 51);
    std::mt19937 engine(5);
    const GridFrame frame{.origin = dvec3(3.0, 0.0, -5.0), .scale = 0x1p-3};
    for (const int flatness : {0, 4, 10, 16, 22}) {
        int tested = 0;
        for (int i = 0; i < 300; ++i) {
            const Affine m = random_map(engine, flatness);
            if (!is_invertible(m)) continue;
            ++tested;
            std::array<float, 24> rows;
            put_instance_rows(rows.data(), m, frame);
            Rational worst = 0;
            for (int row = 0; row < 3; ++row) {
                for (int column = 0; column < 3; ++column) {
                    const auto at = static_cast<size_t>(4 * row + column);
                    const Rational exact = exact_inverse(m, row, column) * Rational(frame.scale);
                    const Rational error = Rational(rows[at]) + Rational(rows[at + 12]) - exact;
                    if (exact != 0) worst = std::max(worst, Rational(abs(error / exact)));
                }
            }
            EXPECT_LE(worst, tolerance) << "flatness " << flatness << ", map " << i << ": 2^"
                                        << std::log2(worst.convert_to<double>());
        }
        EXPECT_GT(tested, 200) << flatness;
    }
}

TEST(InstanceRows, hold_the_place_of_the_instance_and_the_origin_of_the_frame_as_they_are) {
    std::mt19937 engine(6);
    const Affine m = random_map(engine, 0);
    const GridFrame frame{.origin = dvec3(3.0, 0.0, -5.0), .scale = 0x1p-3};
    std::array<float, 24> rows;
    put_instance_rows(rows.data(), m, frame);
    for (int row = 0; row < 3; ++row) {
        const auto at = static_cast<size_t>(4 * row + 3);
        EXPECT_EQ(rows[at], m[3][row]);
        EXPECT_EQ(double{rows[at + 12]}, frame.origin[row] * frame.scale);
    }
}

TEST(WorldPoint, keeps_its_digits_where_place_and_map_cancel) {
    // Far corners, brought back by the place: what is left is down to 2^-70 of what it is made of.
    std::mt19937 engine(7);
    std::uniform_real_distribution<float> within(-1.0f, 1.0f);
    double smallest = 1.0;
    for (int i = 0; i < 1000; ++i) {
        Affine m = random_map(engine, 0);
        const vec3 p(std::exp2(30.0f * within(engine)), within(engine),
                     std::exp2(30.0f * within(engine)));
        const dvec3 rough = transform_point(DAffine(m), dvec3(p));
        m[3] -= vec3(rough);
        const dvec3 from(transform_point(DAffine(m), dvec3(p)) + 1e-12 * dvec3(within(engine)));
        const dvec3 found = world_point(m, p, from);
        for (int axis = 0; axis < 3; ++axis) {
            Rational exact = Rational(m[3][axis]) - Rational(from[axis]);
            double made_of = 0.0;
            for (int k = 0; k < 3; ++k) {
                exact += Rational(m[k][axis]) * Rational(p[k]);
                made_of = std::max(made_of, std::abs(double{m[k][axis]} * p[k]));
            }
            const Rational error = abs(Rational(found[axis]) - exact);
            const Rational bound = abs(exact) * Rational(0x1p-52) + Rational(made_of * 0x1p-100);
            ASSERT_LE(error, bound) << i;
            smallest = std::min(smallest, abs(exact).convert_to<double>() / made_of);
        }
    }
    EXPECT_LT(smallest, 0x1p-55) << "something cancelled";
}

}  // namespace
}  // namespace onepass::test
