// The record that shaders/lib/triangle/rule_out.glsl tests: a triangle's plane, and two planes on
// which a barycentric coordinate is 0.
#pragma once

#include "core/types.h"

namespace onepass {

/// Writes 12 floats (struct Planes of rule_out.glsl): face, (n, d) with dot(n, p) = d on the
/// triangle; first and second, (m, e) with dot(m, p) + e the weight of v1 and of v2.
///
/// `face` is scaled so that its |n| is 1 / (|m1| + |m2| + 1), in sums of absolute components, for
/// then one bound on rounding serves all triangles; and turned so that d >= 0. A triangle too thin
/// for planes (area below 2^-20 of its longest edge squared) gets those of a wider one around it,
/// turned so that d has its sign bit set: rays near it may hit it, none surely does. Corners: from
/// the centre of their box, of edges of at most 2. Source: after Havel & Herout 2010.
void put_barycentric_planes(float* out, const dvec3& v0, const dvec3& v1, const dvec3& v2);

}  // namespace onepass
