// What all importers share: building an Object from parts that cannot be trusted, and texts for
// notes and errors. Internal to core/io.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"

namespace onepass {

/// Vertices as a file gives them. `normals` is empty or holds one a position.
struct VertexSet {
    std::vector<vec3> positions;
    std::vector<vec3> normals;
};

/// A group of triangles before it is checked: indices into vertex set number `vertices`.
struct MeshPart {
    std::string name;
    std::string where;  ///< the part's place in the file, for errors
    size_t vertices = 0;
    std::vector<uvec3> triangles;
};

/// Joins parts into one object: each part becomes a group, vertex sets are appended in order.
///
/// Where only some sets have normals, the others get the normals of their triangles, which then no
/// longer share vertices. Parts without triangles are left out.
/// Throws: Error naming the part and the triangle or vertex for an index out of range or a number
/// that is not finite.
Object build_object(std::string name, std::vector<VertexSet> sets, std::vector<MeshPart> parts);

/// Makes triangles share vertices whose position and normal are equal bit by bit; vertices are
/// numbered by their first use. Triangles keep their order.
void weld(Object& object);

/// Replaces normals of length 0 by the sum of their triangles' normals. Returns how many.
size_t repair_normals(Object& object);

/// Triangles without area: two equal corners, or three in a line (in double precision).
uint64_t count_degenerate(const Object& object);

/// "1 triangle", "2 triangles", "3 vertices".
std::string counted(uint64_t count, std::string_view singular, std::string_view plural);

/// Text of a foreign library or file as one line of valid UTF-8.
std::string clean_text(std::string_view text);

}  // namespace onepass
