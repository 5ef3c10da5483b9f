#include "scenes/shapes.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "core/error.h"

namespace onepass {
namespace {

void add_single_group(Object& object) {
    object.groups = {{object.name, 0, static_cast<uint32_t>(object.triangles.size())}};
}

/// Normals (radius, height) of a profile: its tangents, turned outwards.
std::vector<dvec3> profile_normals(std::span<const vec2> profile) {
    std::vector<dvec3> normals;
    for (size_t i = 0; i < profile.size(); ++i) {
        const bool pole = i == 0 || i + 1 == profile.size();
        const vec2 before = profile[i == 0 ? 0 : i - 1];
        const vec2 after = profile[std::min(i + 1, profile.size() - 1)];
        const dvec3 outwards(double{after.y} - before.y, double{before.x} - after.x, 0.0);
        normals.push_back(pole ? dvec3(0, i == 0 ? -1 : 1, 0) : glm::normalize(outwards));
    }
    return normals;
}

/// Triangles over a pole, stacks - 1 rings of `slices` vertices, and a pole: a fan, bands of quads,
/// a fan. Rings run counter-clockwise seen from the last pole.
void add_ring_triangles(Object& object, uint32_t slices, uint32_t stacks) {
    const auto vertex = [&](uint32_t ring, uint32_t s) {
        return 1 + (ring - 1) * slices + s % slices;
    };
    const uint32_t last = vertex(stacks, 0);
    for (uint32_t s = 0; s < slices; ++s) {
        object.triangles.emplace_back(0, vertex(1, s + 1), vertex(1, s));
    }
    for (uint32_t ring = 1; ring + 1 < stacks; ++ring) {
        for (uint32_t s = 0; s < slices; ++s) {
            const uint32_t a = vertex(ring, s), b = vertex(ring, s + 1);
            const uint32_t c = vertex(ring + 1, s + 1), d = vertex(ring + 1, s);
            object.triangles.emplace_back(a, b, c);
            object.triangles.emplace_back(a, c, d);
        }
    }
    for (uint32_t s = 0; s < slices; ++s) {
        object.triangles.emplace_back(vertex(stacks - 1, s), vertex(stacks - 1, s + 1), last);
    }
}

/// The point of a section's outline at `angle`, counter-clockwise seen from +z.
vec3 outline_point(const Section& section, double angle) {
    // |x|^e + |y|^e = 1. What should be 0 comes out as 1e-16, and a small power would enlarge it.
    constexpr double kZero = 1e-12;
    const auto power = [&](double c) {
        if (std::abs(c) < kZero) return 0.0;
        return std::copysign(std::pow(std::abs(c), 2.0 / section.exponent), c);
    };
    const double x = section.half_width * power(std::cos(angle));
    const double s = power(std::sin(angle));
    const double height = s > 0.0 ? section.top - section.waist : section.waist - section.bottom;
    return vec3(dvec3(x, section.waist + height * s, section.at));
}

void append_mesh(Object& target, const Object& part, const Affine& target_from_part) {
    ONEPASS_CHECK(target.positions.empty() || target.normals.empty() == part.normals.empty());
    const uvec3 first(static_cast<uint32_t>(target.positions.size()));
    for (const vec3& p : part.positions) {
        target.positions.push_back(transform_point(target_from_part, p));
    }
    const Affine part_from_target(inverse(target_from_part));
    for (const vec3& n : part.normals) {
        target.normals.push_back(transform_normal(part_from_target, n));
    }
    for (const uvec3& triangle : part.triangles) target.triangles.push_back(first + triangle);
}

}  // namespace

Object make_lathe(std::span<const vec2> profile, uint32_t slices) {
    ONEPASS_CHECK_LE(3u, slices);
    ONEPASS_CHECK_LE(size_t{3}, profile.size());
    ONEPASS_CHECK(profile.front().x == 0.0f && profile.back().x == 0.0f);
    const auto stacks = static_cast<uint32_t>(profile.size() - 1);
    const std::vector<dvec3> normals = profile_normals(profile);

    // Vertices: the lower pole, stacks - 1 rings of `slices` vertices, the upper pole.
    Object object;
    object.name = "lathe";
    const auto add_vertex = [&](size_t point, double angle) {
        const double x = std::cos(angle);
        const double z = -std::sin(angle);  // so that rings run counter-clockwise seen from above
        const double radius = profile[point].x;
        const dvec3& n = normals[point];
        object.positions.emplace_back(dvec3(radius * x, profile[point].y, radius * z));
        object.normals.emplace_back(dvec3(n.x * x, n.y, n.x * z));
    };
    add_vertex(0, 0.0);
    for (uint32_t ring = 1; ring < stacks; ++ring) {
        for (uint32_t s = 0; s < slices; ++s) add_vertex(ring, 2.0 * std::numbers::pi * s / slices);
    }
    add_vertex(stacks, 0.0);

    add_ring_triangles(object, slices, stacks);
    add_single_group(object);
    return object;
}

Object make_sphere(uint32_t slices, uint32_t stacks) {
    ONEPASS_CHECK_LE(2u, stacks);
    std::vector<vec2> profile;
    for (uint32_t i = 0; i <= stacks; ++i) {
        const bool pole = i == 0 || i == stacks;
        const double angle = std::numbers::pi * (static_cast<double>(i) / stacks - 0.5);
        profile.emplace_back(pole ? 0.0 : std::cos(angle), std::sin(angle));
    }
    Object sphere = make_lathe(profile, slices);
    sphere.name = "sphere";
    sphere.normals = sphere.positions;
    add_single_group(sphere);
    return sphere;
}

Object make_loft(std::span<const Section> sections, uint32_t slices) {
    ONEPASS_CHECK_LE(3u, slices);
    ONEPASS_CHECK_LE(size_t{3}, sections.size());
    const auto stacks = static_cast<uint32_t>(sections.size() - 1);
    Object object;
    object.name = "loft";
    object.positions.emplace_back(0.0f, sections.front().waist, sections.front().at);
    for (const Section& section : sections.subspan(1, stacks - 1)) {
        for (uint32_t s = 0; s < slices; ++s) {
            object.positions.push_back(outline_point(section, 2.0 * std::numbers::pi * s / slices));
        }
    }
    object.positions.emplace_back(0.0f, sections.back().waist, sections.back().at);
    add_ring_triangles(object, slices, stacks);
    add_single_group(object);
    return object;
}

Object make_blade(std::span<const Section> sections) {
    ONEPASS_CHECK_LE(size_t{2}, sections.size());
    const auto rings = static_cast<uint32_t>(sections.size() - 1);
    Object object;
    object.name = "blade";
    for (const Section& section : sections.first(rings)) {
        object.positions.emplace_back(section.half_width, section.waist, section.at);
        object.positions.emplace_back(0.0f, section.top, section.at);
        object.positions.emplace_back(-section.half_width, section.waist, section.at);
        object.positions.emplace_back(0.0f, section.bottom, section.at);
    }
    const auto point = static_cast<uint32_t>(object.positions.size());
    object.positions.emplace_back(0.0f, sections.back().waist, sections.back().at);

    // Triangles: the cap, bands of quads, the point.
    object.triangles = {{0, 3, 2}, {0, 2, 1}};
    for (uint32_t first = 0; first < 4 * rings; first += 4) {
        for (uint32_t s = 0; s < 4; ++s) {
            const uint32_t a = first + s, b = first + (s + 1) % 4;
            if (first + 4 == point) {
                object.triangles.emplace_back(a, b, point);
            } else {
                object.triangles.emplace_back(a, b, b + 4);
                object.triangles.emplace_back(a, b + 4, a + 4);
            }
        }
    }
    add_single_group(object);
    return object;
}

Object make_box(uint32_t a, uint32_t b, uint32_t c) {
    ONEPASS_CHECK(a > 0 && b > 0 && c > 0);
    const uvec3 cells(a, b, c);
    Object object;
    object.name = "box";

    // Faces share the lattice points on their edges, so that the box is closed.
    std::map<std::array<uint32_t, 3>, uint32_t> vertex_of;
    const auto vertex = [&](const uvec3& p) {
        const auto next = static_cast<uint32_t>(object.positions.size());
        const auto [known, is_new] = vertex_of.try_emplace({p.x, p.y, p.z}, next);
        if (is_new) object.positions.push_back(vec3(p) / vec3(cells) - vec3(0.5f));
        return known->second;
    };
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;  // u x v = axis
        for (const bool upper : {false, true}) {
            for (uint32_t i = 0; i < cells[u]; ++i) {
                for (uint32_t j = 0; j < cells[v]; ++j) {
                    std::array<uint32_t, 4> corner{};  // (0,0) (1,0) (1,1) (0,1) in (u, v)
                    for (uint32_t k = 0; k < 4; ++k) {
                        uvec3 p(0);
                        p[axis] = upper ? cells[axis] : 0;
                        p[u] = i + (k == 1 || k == 2);
                        p[v] = j + (k >= 2);
                        corner[k] = vertex(p);
                    }
                    if (!upper) std::swap(corner[1], corner[3]);
                    object.triangles.emplace_back(corner[0], corner[1], corner[2]);
                    object.triangles.emplace_back(corner[0], corner[2], corner[3]);
                }
            }
        }
    }
    add_single_group(object);
    return object;
}

Object make_grid(uint32_t a, uint32_t b) {
    ONEPASS_CHECK(a > 0 && b > 0);
    Object object;
    object.name = "grid";
    for (uint32_t j = 0; j <= b; ++j) {
        for (uint32_t i = 0; i <= a; ++i) {
            object.positions.emplace_back(static_cast<float>(i) / static_cast<float>(a) - 0.5f,
                                          0.0f,
                                          static_cast<float>(j) / static_cast<float>(b) - 0.5f);
        }
    }
    for (uint32_t j = 0; j < b; ++j) {
        for (uint32_t i = 0; i < a; ++i) {
            const uint32_t first = j * (a + 1) + i;
            const uint32_t below = first + a + 1;
            object.triangles.emplace_back(first, below, below + 1);
            object.triangles.emplace_back(first, below + 1, first + 1);
        }
    }
    add_single_group(object);
    return object;
}

void append_shape(Object& target, const Object& part, const Affine& target_from_part,
                  const std::string& group_name) {
    if (target.groups.empty() || target.groups.back().name != group_name) {
        target.groups.push_back({group_name, static_cast<uint32_t>(target.triangles.size()), 0});
    }
    target.groups.back().triangle_count += static_cast<uint32_t>(part.triangles.size());
    append_mesh(target, part, target_from_part);
}

void append_shape(Object& target, const Object& part, const Affine& target_from_part) {
    for (TriangleGroup group : part.groups) {
        group.first_triangle += static_cast<uint32_t>(target.triangles.size());
        target.groups.push_back(group);
    }
    append_mesh(target, part, target_from_part);
}

Affine translation(const vec3& offset) {
    Affine m = affine_identity();
    m[3] = offset;
    return m;
}

Affine scaling(const vec3& factors) {
    return Affine(vec3(factors.x, 0, 0), vec3(0, factors.y, 0), vec3(0, 0, factors.z), vec3(0));
}

Affine rotation(const vec3& axis, float degrees) {
    const dvec3 a = glm::normalize(dvec3(axis));
    const double angle = double{degrees} * std::numbers::pi / 180.0;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const auto rotated = [&](const dvec3& v) {  // Rodrigues
        return vec3(v * c + glm::cross(a, v) * s + a * (glm::dot(a, v) * (1.0 - c)));
    };
    return Affine(rotated(dvec3(1, 0, 0)), rotated(dvec3(0, 1, 0)), rotated(dvec3(0, 0, 1)),
                  vec3(0));
}

Affine shear_x_by_y(float factor) {
    Affine m = affine_identity();
    m[1].x = factor;
    return m;
}

Affine spanning(const vec3& from, const vec3& to) {
    const dvec3 axis = dvec3(to) - dvec3(from);
    const dvec3 y = glm::normalize(axis);
    const dvec3 aside = std::abs(y.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 0, 1);
    const dvec3 z = glm::normalize(glm::cross(aside, y));
    return Affine(vec3(glm::cross(y, z)), vec3(axis), vec3(z), from);
}

Scene in_one_instance(const std::string& name, Object object) {
    Scene scene;
    scene.name = name;
    scene.objects.push_back(std::move(object));
    scene.instances.push_back({.name = name, .object = 0, .materials = {0}});
    scene.materials.push_back({});
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    scene.lights.push_back({.name = "lamp", .position = scene.cameras[0].world_from_camera[3]});
    validate(scene);
    return scene;
}

}  // namespace onepass
