#include "core/io/import.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

bool is_finite(const vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_part(const MeshPart& part, const VertexSet& set) {
    const auto check_vector = [&](const char* kind, const vec3& v, size_t triangle,
                                  uint32_t vertex) {
        if (is_finite(v)) return;
        throw Error({fmt::format("{}, triangle {}, vertex {}", part.where, triangle, vertex),
                     fmt::format("a {} of ({}, {}, {})", kind, v.x, v.y, v.z), "finite numbers",
                     "Mend the mesh, or export it again."});
    };
    for (size_t t = 0; t < part.triangles.size(); ++t) {
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t index = part.triangles[t][corner];
            if (index >= set.positions.size()) {
                throw Error(
                    {fmt::format("{}, triangle {}", part.where, t),
                     fmt::format("vertex index {}", index),
                     fmt::format("one below {}, the number of vertices", set.positions.size()),
                     "Mend the mesh, or export it again."});
            }
            check_vector("position", set.positions[index], t, index);
            if (!set.normals.empty()) check_vector("normal", set.normals[index], t, index);
        }
    }
}

/// The normal by area, in double; 0 for a degenerate triangle.
dvec3 area_normal(const std::vector<vec3>& positions, const uvec3& triangle) {
    const dvec3 a(positions[triangle.x]);
    return glm::cross(dvec3(positions[triangle.y]) - a, dvec3(positions[triangle.z]) - a);
}

vec3 unit_or_up(const dvec3& n) {
    const double length = glm::length(n);
    return length > 0.0 ? vec3(n / length) : vec3(0, 0, 1);
}

/// Gives the set one vertex a triangle corner, with the triangle's own normal.
void facet(VertexSet& set, size_t set_index, std::vector<MeshPart>& parts) {
    VertexSet faceted;
    for (MeshPart& part : parts) {
        if (part.vertices != set_index) continue;
        for (uvec3& triangle : part.triangles) {
            const vec3 normal = unit_or_up(area_normal(set.positions, triangle));
            const auto first = static_cast<uint32_t>(faceted.positions.size());
            for (int corner = 0; corner < 3; ++corner) {
                faceted.positions.push_back(set.positions[triangle[corner]]);
                faceted.normals.push_back(normal);
            }
            triangle = uvec3(first, first + 1, first + 2);
        }
    }
    set = std::move(faceted);
}

using VertexKey = std::array<uint32_t, 6>;

struct VertexKeyHash {
    size_t operator()(const VertexKey& key) const {
        uint64_t hash = 0;
        for (uint32_t word : key) hash = (std::rotl(hash, 23) ^ word) * 0x9E3779B97F4A7C15ull;
        return hash ^ (hash >> 32);
    }
};

VertexKey vertex_key(const Object& object, uint32_t index) {
    const vec3 p = object.positions[index];
    const vec3 n = object.normals.empty() ? vec3(0) : object.normals[index];
    VertexKey key{};
    for (int axis = 0; axis < 3; ++axis) {
        key[axis] = std::bit_cast<uint32_t>(p[axis]);
        key[3 + axis] = std::bit_cast<uint32_t>(n[axis]);
    }
    return key;
}

}  // namespace

Object build_object(std::string name, std::vector<VertexSet> sets, std::vector<MeshPart> parts) {
    // Nothing is trusted before it is checked.
    for (const MeshPart& part : parts) check_part(part, sets[part.vertices]);
    const auto has_normals = [](const VertexSet& set) { return !set.normals.empty(); };
    if (std::any_of(sets.begin(), sets.end(), has_normals)) {
        for (size_t i = 0; i < sets.size(); ++i) {
            if (!has_normals(sets[i])) facet(sets[i], i, parts);
        }
    }

    // Vertices of all sets in order; what each set's indices must be moved by.
    Object object;
    object.name = std::move(name);
    std::vector<size_t> first_vertex;
    for (const VertexSet& set : sets) {
        first_vertex.push_back(object.positions.size());
        object.positions.insert(object.positions.end(), set.positions.begin(), set.positions.end());
        object.normals.insert(object.normals.end(), set.normals.begin(), set.normals.end());
    }
    size_t triangle_count = 0;
    for (const MeshPart& part : parts) triangle_count += part.triangles.size();
    if (object.positions.size() >= kNoId || triangle_count >= kNoId) {
        throw Error(
            {"object '" + object.name + "'",
             fmt::format("{} vertices and {} triangles", object.positions.size(), triangle_count),
             fmt::format("fewer than {} of each", kNoId), "Split the mesh."});
    }

    // Groups of triangles in order.
    object.triangles.reserve(triangle_count);
    for (MeshPart& part : parts) {
        if (part.triangles.empty()) continue;
        object.groups.push_back({std::move(part.name),
                                 static_cast<uint32_t>(object.triangles.size()),
                                 static_cast<uint32_t>(part.triangles.size())});
        const uvec3 first(static_cast<uint32_t>(first_vertex[part.vertices]));
        for (const uvec3& triangle : part.triangles) object.triangles.push_back(first + triangle);
    }
    return object;
}

void weld(Object& object) {
    std::unordered_map<VertexKey, uint32_t, VertexKeyHash> known;
    known.reserve(object.positions.size());
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    for (uvec3& triangle : object.triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            const uint32_t index = triangle[corner];
            const auto next = static_cast<uint32_t>(positions.size());
            const auto [found, is_new] = known.try_emplace(vertex_key(object, index), next);
            if (is_new) {
                positions.push_back(object.positions[index]);
                if (!object.normals.empty()) normals.push_back(object.normals[index]);
            }
            triangle[corner] = found->second;
        }
    }
    object.positions = std::move(positions);
    object.normals = std::move(normals);
}

size_t repair_normals(Object& object) {
    const auto is_zero = [](const vec3& n) { return !(glm::dot(dvec3(n), dvec3(n)) > 0.0); };
    const auto zero_count =
        static_cast<size_t>(std::count_if(object.normals.begin(), object.normals.end(), is_zero));
    if (zero_count == 0) return 0;

    std::vector<dvec3> sums(object.positions.size(), dvec3(0));
    for (const uvec3& triangle : object.triangles) {
        const dvec3 normal = area_normal(object.positions, triangle);
        for (int corner = 0; corner < 3; ++corner) sums[triangle[corner]] += normal;
    }
    for (size_t i = 0; i < object.normals.size(); ++i) {
        if (is_zero(object.normals[i])) object.normals[i] = unit_or_up(sums[i]);
    }
    return zero_count;
}

uint64_t count_degenerate(const Object& object) {
    return static_cast<uint64_t>(
        std::count_if(object.triangles.begin(), object.triangles.end(), [&](const uvec3& triangle) {
            return area_normal(object.positions, triangle) == dvec3(0);
        }));
}

std::string counted(uint64_t count, std::string_view singular, std::string_view plural) {
    return fmt::format("{} {}", count, count == 1 ? singular : plural);
}

std::string clean_text(std::string_view text) {
    // Length of a UTF-8 sequence by its first byte; 0 where none may start.
    const auto sequence_length = [](unsigned char c) -> size_t {
        if (c < 0x80) return 1;
        if (c >= 0xC2 && c < 0xE0) return 2;
        if (c >= 0xE0 && c < 0xF0) return 3;
        if (c >= 0xF0 && c < 0xF5) return 4;
        return 0;
    };
    std::string result;
    for (size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const size_t length = sequence_length(byte);
        bool valid = length > 0 && i + length <= text.size();
        for (size_t k = 1; valid && k < length; ++k) {
            valid = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
        }
        if (!valid) {
            result += '?';
            ++i;
        } else if (length == 1 && byte < 0x20) {
            result += ' ';
            ++i;
        } else {
            result.append(text.substr(i, length));
            i += length;
        }
    }
    while (!result.empty() && result.back() == ' ') result.pop_back();
    return result;
}

}  // namespace onepass
