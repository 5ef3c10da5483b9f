// The record that shaders/lib/triangle/rule_out.glsl tests: a triangle's plane, and two planes on
// which a barycentric coordinate is 0.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/types.h"

namespace onepass {

/// How the planes are stored: 48 bytes of floats, or 32 of fixed-point numbers.
enum class PlanesForm { floats, fixed };

/// Words of a record.
size_t planes_words(PlanesForm form);

/// Writes a record. `floats` (shaders/lib/triangle/float_planes.glsl): face, (n, d) with dot(n, p)
/// = d on the triangle; first and second, (m, e) with dot(m, p) + e the weight of v1 and of v2.
/// `fixed` (fixed_planes.glsl; layout in shaders/shared/planes_layout.h): the same, seen along an
/// axis.
///
/// Either is scaled so that one bound on rounding serves all triangles. A triangle that is too thin
/// for planes (area below 2^-20 of its longest edge squared), or for `fixed` too low (2^-28), gets
/// those of a wider one around it, and is marked: rays near it may hit it, none surely does.
/// Corners: from the centre of their box, of edges of at most 2. (A frame that ends before it has
/// brought an object to that size, frames.h, may leave more. `fixed` then says of a triangle for
/// which it has no room that any ray may hit it.) Source: after Havel & Herout 2010; Wald 2004,
/// Baldwin & Weber 2016.
void put_barycentric_planes(uint32_t* out, PlanesForm form, const dvec3& v0, const dvec3& v1,
                            const dvec3& v2);

}  // namespace onepass
