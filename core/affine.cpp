#include "core/affine.h"

#include <cmath>

namespace onepass {

Affine compose(const Affine& a, const Affine& b) {
    const DAffine da(a);
    const DAffine db(b);
    return Affine(vec3(transform_vector(da, db[0])), vec3(transform_vector(da, db[1])),
                  vec3(transform_vector(da, db[2])), vec3(transform_point(da, db[3])));
}

double determinant(const Affine& m) {
    return glm::dot(dvec3(m[0]), glm::cross(dvec3(m[1]), dvec3(m[2])));
}

DAffine inverse(const Affine& m) {
    const dvec3 a(m[0]);
    const dvec3 b(m[1]);
    const dvec3 c(m[2]);
    const dvec3 t(m[3]);
    const double inverse_determinant = 1.0 / glm::dot(a, glm::cross(b, c));
    // The rows of the inverse of [a b c] are the scaled cross products of its columns.
    const dvec3 row0 = glm::cross(b, c) * inverse_determinant;
    const dvec3 row1 = glm::cross(c, a) * inverse_determinant;
    const dvec3 row2 = glm::cross(a, b) * inverse_determinant;
    return DAffine(dvec3(row0.x, row1.x, row2.x), dvec3(row0.y, row1.y, row2.y),
                   dvec3(row0.z, row1.z, row2.z),
                   dvec3(-glm::dot(row0, t), -glm::dot(row1, t), -glm::dot(row2, t)));
}

bool is_invertible(const Affine& m) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!std::isfinite(m[column][row])) return false;
        }
    }
    constexpr double kLeastRelativeVolume = 1e-12;
    // Squares of volumes: the columns' lengths need no roots. Floats' sixth powers fit a double.
    const auto squared = [](const dvec3& v) { return glm::dot(v, v); };
    const double volume = determinant(m) / kLeastRelativeVolume;
    return volume * volume > squared(dvec3(m[0])) * squared(dvec3(m[1])) * squared(dvec3(m[2]));
}

Bounds transform_bounds(const Affine& m, const Bounds& b) {
    // The least sum has the least terms: rounded sums grow with their terms, too. Terms are added
    // as transform_point() adds them, so these are the extremes of the eight transformed corners.
    // Source: Arvo 1990.
    const DAffine dm(m);
    dvec3 lower(0.0);
    dvec3 upper(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const dvec3 at_lower = dm[axis] * double{b.lower[axis]};
        const dvec3 at_upper = dm[axis] * double{b.upper[axis]};
        lower += glm::min(at_lower, at_upper);
        upper += glm::max(at_lower, at_upper);
    }
    lower += dm[3];
    upper += dm[3];
    // Rounding to float errs by half an ulp of the coordinate, the double sums by far less.
    Bounds result{vec3(lower), vec3(upper)};
    const float ulp = result.magnitude() * std::numeric_limits<float>::epsilon();
    result.lower -= vec3(ulp);
    result.upper += vec3(ulp);
    return result;
}

}  // namespace onepass
