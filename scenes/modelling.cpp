#include "scenes/modelling.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "core/error.h"

namespace onepass {
namespace {

/// A point of a curve: its coordinates, whatever they mean.
template <size_t N>
using Point = std::array<double, N>;

/// How many steps each piece of the curve is given: one at least, the rest by length.
std::vector<size_t> steps_by_length(const std::vector<double>& lengths, size_t steps) {
    ONEPASS_CHECK_LE(lengths.size(), steps);
    std::vector<size_t> result(lengths.size(), 1);
    for (size_t spare = steps - lengths.size(); spare > 0; --spare) {
        // The piece whose steps are longest gets one more.
        size_t longest = 0;
        for (size_t i = 1; i < lengths.size(); ++i) {
            const auto step = [&](size_t k) { return lengths[k] / static_cast<double>(result[k]); };
            if (step(i) > step(longest)) longest = i;
        }
        ++result[longest];
    }
    return result;
}

template <size_t N>
std::vector<Point<N>> monotone_curve(const std::vector<Point<N>>& keys, size_t count) {
    const size_t pieces = keys.size() - 1;
    std::vector<double> lengths(pieces);
    for (size_t i = 0; i < pieces; ++i) {
        double squared = 0.0;
        for (size_t c = 0; c < N; ++c) squared += std::pow(keys[i + 1][c] - keys[i][c], 2);
        lengths[i] = std::sqrt(squared);
        ONEPASS_CHECK(lengths[i] > 0.0);
    }
    const auto secant = [&](size_t i, size_t c) {
        return (keys[i + 1][c] - keys[i][c]) / lengths[i];
    };
    const auto slope = [&](size_t key, size_t c) {
        if (key == 0) return secant(0, c);
        if (key == pieces) return secant(pieces - 1, c);
        const double before = secant(key - 1, c);
        const double after = secant(key, c);
        return before * after <= 0.0 ? 0.0 : 2.0 * before * after / (before + after);
    };

    std::vector<Point<N>> points = {keys.front()};
    const std::vector<size_t> steps = steps_by_length(lengths, count - 1);
    for (size_t i = 0; i < pieces; ++i) {
        for (size_t step = 1; step < steps[i]; ++step) {
            const double s = static_cast<double>(step) / static_cast<double>(steps[i]);
            Point<N> point;
            for (size_t c = 0; c < N; ++c) {  // cubic Hermite
                point[c] = keys[i][c] * (1 + 2 * s) * (1 - s) * (1 - s) +
                           keys[i + 1][c] * s * s * (3 - 2 * s) +
                           lengths[i] * s * (1 - s) * (slope(i, c) * (1 - s) - slope(i + 1, c) * s);
            }
            points.push_back(point);
        }
        points.push_back(keys[i + 1]);
    }
    return points;
}

}  // namespace

std::vector<vec2> curve_through(std::span<const vec2> keys, size_t count) {
    std::vector<Point<2>> points;
    for (const vec2& key : keys) points.push_back({key.x, key.y});
    std::vector<vec2> result;
    for (const Point<2>& p : monotone_curve(points, count)) result.emplace_back(p[0], p[1]);
    return result;
}

std::vector<Section> curve_through(std::span<const Section> keys, size_t count) {
    std::vector<Point<6>> points;
    for (const Section& k : keys) {
        points.push_back({k.at, k.half_width, k.bottom, k.waist, k.top, k.exponent});
    }
    std::vector<Section> result;
    for (const Point<6>& p : monotone_curve(points, count)) {
        const auto f = [&](size_t c) { return static_cast<float>(p[c]); };
        result.push_back({f(0), f(1), f(2), f(3), f(4), f(5)});
    }
    return result;
}

Object turned(std::span<const vec2> keys, uint32_t slices, uint32_t stacks) {
    return make_lathe(curve_through(keys, stacks + 1), slices);
}

Object lofted(std::span<const Section> keys, uint32_t slices, uint32_t stacks) {
    return make_loft(curve_through(keys, stacks + 1), slices);
}

Object bladed(std::span<const Section> keys, uint32_t segments) {
    return make_blade(curve_through(keys, segments + 1));
}

void set_normals(Object& object, float crease_degrees) {
    const double least_cosine = std::cos(double{crease_degrees} * std::numbers::pi / 180.0);

    // Triangles' normals (as long as twice their area), and the triangles of each vertex.
    std::vector<dvec3> area_normals;
    std::vector<std::vector<uint32_t>> triangles_of(object.positions.size());
    for (uint32_t t = 0; t < object.triangles.size(); ++t) {
        const uvec3& triangle = object.triangles[t];
        const dvec3 v0(object.positions[triangle.x]);
        area_normals.push_back(glm::cross(dvec3(object.positions[triangle.y]) - v0,
                                          dvec3(object.positions[triangle.z]) - v0));
        for (int k = 0; k < 3; ++k) triangles_of[triangle[k]].push_back(t);
    }

    // A corner's normal is the sum over its side of the crease; corners of one vertex with equal
    // sums share it.
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::map<std::tuple<uint32_t, float, float, float>, uint32_t> vertex_of;
    std::vector<uvec3> triangles = object.triangles;
    for (uint32_t t = 0; t < triangles.size(); ++t) {
        const dvec3 own = glm::normalize(area_normals[t]);
        for (int k = 0; k < 3; ++k) {
            const uint32_t old = object.triangles[t][k];
            dvec3 sum(0.0);
            for (uint32_t other : triangles_of[old]) {
                const dvec3& n = area_normals[other];
                if (other == t || glm::dot(own, n) >= least_cosine * glm::length(n)) sum += n;
            }
            const vec3 normal(glm::normalize(sum));
            const auto [known, is_new] = vertex_of.try_emplace(
                {old, normal.x, normal.y, normal.z}, static_cast<uint32_t>(positions.size()));
            if (is_new) {
                positions.push_back(object.positions[old]);
                normals.push_back(normal);
            }
            triangles[t][k] = known->second;
        }
    }
    object.positions = std::move(positions);
    object.normals = std::move(normals);
    object.triangles = std::move(triangles);
}

void set_groups(Object& object, const std::vector<std::string>& names,
                const std::function<size_t(const vec3& centre)>& group_of) {
    std::vector<std::vector<uvec3>> members(names.size());
    const std::vector<uvec3>& triangles = object.triangles;
    for (size_t t = 0; t < triangles.size();) {
        // Shapes give a quad as (a, b, c), (a, c, d).
        const bool quad = t + 1 < triangles.size() && triangles[t].x == triangles[t + 1].x &&
                          triangles[t].z == triangles[t + 1].y;
        const size_t corners = quad ? 4 : 3;
        vec3 sum(0.0f);
        for (int k = 0; k < 3; ++k) sum += object.positions[triangles[t][k]];
        if (quad) sum += object.positions[triangles[t + 1].z];
        const size_t group = group_of(sum / static_cast<float>(corners));
        ONEPASS_CHECK_LT(group, names.size());
        for (size_t end = t + corners - 2; t < end; ++t) members[group].push_back(triangles[t]);
    }
    object.triangles.clear();
    object.groups.clear();
    for (size_t g = 0; g < names.size(); ++g) {
        ONEPASS_CHECK(!members[g].empty());
        object.groups.push_back({names[g], static_cast<uint32_t>(object.triangles.size()),
                                 static_cast<uint32_t>(members[g].size())});
        object.triangles.insert(object.triangles.end(), members[g].begin(), members[g].end());
    }
}

}  // namespace onepass
