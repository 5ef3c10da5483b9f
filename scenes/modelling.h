// What is done to shapes to make them look like things: curves through a few given points, normals,
// and groups by place. The triangles of a shape stay as many as they were.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scenes/shapes.h"

namespace onepass {

/// `count` points on a smooth curve through `keys`, every key among them; the others are spread
/// over the pieces by length. Between two keys each coordinate is monotone, so that nothing
/// overshoots: a radius that is not negative in the keys is nowhere negative. Source: Fritsch &
/// Butland 1984 (slopes by the harmonic mean).
std::vector<vec2> curve_through(std::span<const vec2> keys, size_t count);
std::vector<Section> curve_through(std::span<const Section> keys, size_t count);

/// make_lathe, make_loft and make_blade of such a curve: S(slices, stacks) and K(segments) from a
/// few keys.
Object turned(std::span<const vec2> keys, uint32_t slices, uint32_t stacks);
Object lofted(std::span<const Section> keys, uint32_t slices, uint32_t stacks);
Object bladed(std::span<const Section> keys, uint32_t segments);

/// Gives the object normals: smooth where triangles of a vertex differ by less than
/// `crease_degrees`, and else sharp, with a vertex for either side. Triangles keep their order.
void set_normals(Object& object, float crease_degrees);

/// Divides the triangles into groups: `group_of` turns the centre of a face into an index into
/// `names`. The two triangles of a quad are one face. Within a group triangles keep their order.
/// Every group must get some.
void set_groups(Object& object, const std::vector<std::string>& names,
                const std::function<size_t(const vec3& centre)>& group_of);

}  // namespace onepass
