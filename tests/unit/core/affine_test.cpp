// Affine maps: inverses, products, normals and boxes.
#include "core/affine.h"

#include <random>

#include <gtest/gtest.h>

namespace onepass {
namespace {

Affine random_affine(std::mt19937& random) {
    std::uniform_real_distribution<float> uniform(-2.0f, 2.0f);
    Affine m;
    do {
        for (int column = 0; column < 4; ++column) {
            m[column] = vec3(uniform(random), uniform(random), uniform(random));
        }
    } while (std::abs(determinant(m)) < 0.1);  // well conditioned
    return m;
}

TEST(Affine, inverse_undoes_the_map) {
    std::mt19937 random(1);
    // Double arithmetic; |m|^2 / det < 12 / 0.1 amplifies its 2^-53.
    constexpr double kTolerance = 1e-12;
    for (int i = 0; i < 200; ++i) {
        const Affine m = random_affine(random);
        const dvec3 p(0.3, -1.7, 2.9);
        const dvec3 q = transform_point(inverse(m), transform_point(DAffine(m), p));
        EXPECT_LT(glm::length(q - p), kTolerance);
    }
}

TEST(Affine, compose_applies_the_second_map_first) {
    const Affine move(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 0, 0));
    const Affine grow(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2), vec3(0));
    EXPECT_EQ(transform_point(compose(move, grow), vec3(3, 1, 0)), vec3(7, 2, 0));
    EXPECT_EQ(transform_point(compose(grow, move), vec3(3, 1, 0)), vec3(8, 2, 0));
}

TEST(Affine, normals_stay_perpendicular_to_their_surface) {
    std::mt19937 random(2);
    constexpr float kTolerance = 1e-4f;  // float, entries below 40 after inversion
    for (int i = 0; i < 200; ++i) {
        const Affine m = random_affine(random);
        const vec3 tangent(0.6f, -0.8f, 0.0f);
        const vec3 normal(0.8f, 0.6f, 0.0f);
        const vec3 n = transform_normal(Affine(inverse(m)), normal);
        EXPECT_NEAR(glm::dot(glm::normalize(n), glm::normalize(transform_vector(m, tangent))), 0.0f,
                    kTolerance);
    }
}

TEST(Affine, tells_maps_that_cannot_be_inverted) {
    Affine m = affine_identity();
    EXPECT_TRUE(is_invertible(m));
    m[0] *= 1e-20f;  // small, but not flat
    EXPECT_TRUE(is_invertible(m));
    m[0] = -m[0];  // mirrored
    EXPECT_TRUE(is_invertible(m));
    m[2] = m[1];
    EXPECT_FALSE(is_invertible(m));
    m[2] = vec3(0);
    EXPECT_FALSE(is_invertible(m));
    m = affine_identity();
    m[3].x = kInfinity;
    EXPECT_FALSE(is_invertible(m));
}

TEST(Affine, transformed_bounds_hold_every_transformed_point) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const Bounds box{vec3(-1, 2, 1000), vec3(4, 2, 1003)};
    for (int i = 0; i < 100; ++i) {
        const Affine m = random_affine(random);
        const Bounds transformed = transform_bounds(m, box);
        for (int k = 0; k < 50; ++k) {
            const vec3 mix(unit(random) < 0.3f ? 0.0f : unit(random), unit(random),
                           unit(random) < 0.3f ? 1.0f : unit(random));
            const vec3 p = glm::clamp(box.lower + box.extent() * mix, box.lower, box.upper);
            const dvec3 q = transform_point(DAffine(m), dvec3(p));
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(q[axis], double{transformed.lower[axis]});
                EXPECT_LE(q[axis], double{transformed.upper[axis]});
            }
        }
    }
}

}  // namespace
}  // namespace onepass
