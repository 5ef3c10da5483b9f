// What tests ask of meshes: are they closed, do they face outwards, part by part.
#pragma once

#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "core/scene.h"

namespace onepass::test {

/// The triangles with vertices numbered by position: those at the same place, told apart by normals
/// only, get the same number.
inline std::vector<uvec3> triangles_by_position(const Object& object) {
    std::map<std::tuple<float, float, float>, uint32_t> number_of;
    std::vector<uvec3> result;
    for (const uvec3& t : object.triangles) {
        uvec3 numbers(0);
        for (int k = 0; k < 3; ++k) {
            const vec3& p = object.positions[t[k]];
            const auto next = static_cast<uint32_t>(number_of.size());
            numbers[k] = number_of.try_emplace({p.x, p.y, p.z}, next).first->second;
        }
        result.push_back(numbers);
    }
    return result;
}

/// Every edge belongs to two triangles, once in each direction.
inline bool is_closed(const Object& object) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const uvec3& t : triangles_by_position(object)) {
        for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        if (count != 1 || opposite == edges.end() || opposite->second != 1) return false;
    }
    return true;
}

/// The volume of each part of a mesh; parts share no vertex. Positive if a part's triangles are
/// counter-clockwise seen from outside.
inline std::vector<double> signed_volumes(const Object& object) {
    const std::vector<uvec3> triangles = triangles_by_position(object);
    std::vector<uint32_t> part(3 * triangles.size());
    std::iota(part.begin(), part.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (part[v] != v) v = part[v] = part[part[v]];
        return v;
    };
    for (const uvec3& t : triangles) {
        part[root(t.y)] = root(t.x);
        part[root(t.z)] = root(t.x);
    }
    std::map<uint32_t, double> volume_of;
    for (size_t i = 0; i < triangles.size(); ++i) {
        const uvec3& t = object.triangles[i];
        volume_of[root(triangles[i].x)] +=
            glm::dot(dvec3(object.positions[t.x]),
                     glm::cross(dvec3(object.positions[t.y]), dvec3(object.positions[t.z]))) /
            6.0;
    }
    std::vector<double> volumes;
    for (const auto& [first, volume] : volume_of) volumes.push_back(volume);
    return volumes;
}

}  // namespace onepass::test
