// The shapes that scenes are generated from, with the triangle counts of the recipes: S(n, m),
// B(a, b, c), G(a, b) and K(k).
//
// S, B and K are closed (every edge belongs to two triangles, once in each direction), and all
// triangles are counter-clockwise seen from outside, G's from above. modelling.h bends them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/scene.h"

namespace onepass {

/// S(n, m): a profile of m + 1 points (radius, height) turned about the y axis in n slices.
///
/// The profile runs from bottom to top; its first and last radius must be 0: the poles are single
/// vertices. 2 n (m - 1) triangles with smooth normals, one group.
Object make_lathe(std::span<const vec2> profile, uint32_t slices);

/// S(n, m) as the unit sphere about the origin; its normals are its positions.
Object make_sphere(uint32_t slices, uint32_t stacks);

/// A cross-section of a loft, in a plane z = const: a superellipse whose upper and lower half may
/// differ in height.
struct Section {
    float at = 0.0f;          ///< z
    float half_width = 0.0f;  ///< along x
    float bottom = 0.0f;      ///< lowest y
    float waist = 0.0f;       ///< y where it is widest
    float top = 0.0f;         ///< highest y
    float exponent = 2.0f;    ///< 1: diamond, 2: ellipse, larger: towards a rectangle
};

/// S(n, m) with cross-sections of its own: m + 1 sections along ascending z.
///
/// The first and the last are single vertices at (0, waist, at). 2 n (m - 1) triangles without
/// normals, one group.
Object make_loft(std::span<const Section> sections, uint32_t slices);

/// K(k): a four-sided blade of k + 1 sections along ascending z. The first is capped flat, the last
/// is its point, at (0, waist, at); sections are diamonds whatever their exponent.
/// 8 k - 2 triangles without normals, one group.
Object make_blade(std::span<const Section> sections);

/// B(a, b, c): the cube from -1/2 to 1/2, its faces divided into a, b and c cells along x, y and z.
/// 4 (ab + bc + ca) triangles without normals (its edges are sharp), one group.
Object make_box(uint32_t a, uint32_t b, uint32_t c);

/// G(a, b): the square from -1/2 to 1/2 in the plane y = 0, a cells along x and b along z.
/// 2 a b triangles without normals, one group.
Object make_grid(uint32_t a, uint32_t b);

/// Appends a transformed copy of `part` as one more group, or to the last group if that has the
/// same name. Normals are kept if both have them (or `target` is empty); else neither may.
void append_shape(Object& target, const Object& part, const Affine& target_from_part,
                  const std::string& group_name);

/// The same, but the part's groups stay apart.
void append_shape(Object& target, const Object& part, const Affine& target_from_part);

/// Transforms that read well in scene descriptions. Angles in degrees, about the axis by the
/// right-hand rule.
Affine translation(const vec3& offset);
Affine scaling(const vec3& factors);
Affine rotation(const vec3& axis, float degrees);
/// Moves x by factor * y.
Affine shear_x_by_y(float factor);
/// Takes the y axis from (0, 0, 0) to (0, 1, 0) onto the line from `from` to `to`. Lengths across
/// it stay: it places legs, rails and other lathes of height 1.
Affine spanning(const vec3& from, const vec3& to);

/// A scene of this object: one instance of one matte material, a camera that sees it, a lamp there.
Scene in_one_instance(const std::string& name, Object object);

}  // namespace onepass
