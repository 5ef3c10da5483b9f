// Affine transforms, with every sum spelled out so that all modules round alike.
#pragma once

#include <glm/mat4x3.hpp>

#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// An affine map: four columns of three rows, point' = m[0] x + m[1] y + m[2] z + m[3].
using Affine = glm::mat4x3;
using DAffine = glm::dmat4x3;

inline Affine affine_identity() {
    return Affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(0, 0, 0));
}

/// Column order x, y, z, then the translation.
inline vec3 transform_point(const Affine& m, const vec3& p) {
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}
inline vec3 transform_vector(const Affine& m, const vec3& d) {
    return m[0] * d.x + m[1] * d.y + m[2] * d.z;
}
inline dvec3 transform_point(const DAffine& m, const dvec3& p) {
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}
inline dvec3 transform_vector(const DAffine& m, const dvec3& d) {
    return m[0] * d.x + m[1] * d.y + m[2] * d.z;
}

/// Transforms a normal given the inverse map (object_from_world for an object-space normal).
inline vec3 transform_normal(const Affine& inverse, const vec3& n) {
    return vec3(inverse[0].x * n.x + inverse[0].y * n.y + inverse[0].z * n.z,
                inverse[1].x * n.x + inverse[1].y * n.y + inverse[1].z * n.z,
                inverse[2].x * n.x + inverse[2].y * n.y + inverse[2].z * n.z);
}

/// The product a * b: first b, then a. Computed in double, rounded once.
Affine compose(const Affine& a, const Affine& b);

double determinant(const Affine& m);

/// The inverse in double; the caller rounds if it must. The map must be invertible (see
/// is_invertible).
DAffine inverse(const Affine& m);

/// True if all entries are finite and the determinant is not 0 beside the columns' lengths: a map
/// whose column vectors span less than 1e-12 of the volume of a box with the same edge lengths
/// counts as flat, because its inverse would hold no correct digit in float.
bool is_invertible(const Affine& m);

/// The box of the transformed corners, rounded outwards by one ulp of its largest coordinate, so
/// that it holds every exactly transformed point of `b`.
Bounds transform_bounds(const Affine& m, const Bounds& b);

}  // namespace onepass
