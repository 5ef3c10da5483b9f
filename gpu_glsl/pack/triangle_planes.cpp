#include "gpu_glsl/pack/triangle_planes.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/two_level_layout.h"

struct Planes {
    glm::dvec4 rows[kTriangleTexels];
};

/// The triangle's plane and its three sides, in double, of corners relative to `base`.
Planes triangle_planes(const dvec3& v0, const dvec3& v1, const dvec3& v2, const dvec3& base) {
    const dvec3 e1 = v1 - v0;
    const dvec3 e2 = v2 - v0;
    const dvec3 n = glm::cross(e1, e2);
    const double n2 = glm::dot(n, n);
    const dvec3 unit = n / std::sqrt(n2);
    const dvec3 u = glm::cross(e2, n) / n2;
    const dvec3 v = glm::cross(n, e1) / n2;
    const dvec3 w = -(u + v);
    const dvec3 corner = v0 - base;
    return {{glm::dvec4(unit, -glm::dot(unit, corner)), glm::dvec4(u, -glm::dot(u, corner)),
             glm::dvec4(v, -glm::dot(v, corner)), glm::dvec4(w, 1.0 - glm::dot(w, corner))}};
}

Planes planes_of(const Object& object, size_t i, bool local) {
    const uvec3 tri = object.triangles[i];
    const dvec3 v0(object.positions[tri.x]);
    Planes planes = triangle_planes(v0, dvec3(object.positions[tri.y]),
                                    dvec3(object.positions[tri.z]), local ? v0 : dvec3(0.0));
    if (local) planes.rows[3] = glm::dvec4(v0, 0.0);
    return planes;
}

/// As a texture of that format holds it.
float stored(double value, ChannelFormat format) {
    const auto single = static_cast<float>(value);
    if (format == ChannelFormat::single) return single;
    return glm::unpackHalf1x16(glm::packHalf1x16(single));
}

}  // namespace

std::vector<uint64_t> first_triangles(const Scene& scene) {
    std::vector<uint64_t> first = {0};
    for (const Object& object : scene.objects) {
        first.push_back(first.back() + object.triangles.size());
    }
    return first;
}

TextureData pack_triangle_planes(const Scene& scene, const TrianglePlanesOptions& options,
                                 uint32_t max_side) {
    const std::vector<uint64_t> first = first_triangles(scene);
    TextureData texture =
        make_record_texture("triangles", "triangles", first.back(), kTriangleTexels, max_side);
    texture.format = options.format;
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Object& object = scene.objects[k];
        tbb::parallel_for(
            tbb::blocked_range<size_t>(0, object.triangles.size()), [&](const auto& range) {
                for (size_t i = range.begin(); i != range.end(); ++i) {
                    float* out =
                        texel_at(texture, record_texel(texture, first[k] + i, kTriangleTexels));
                    for (const glm::dvec4& row : planes_of(object, i, options.local).rows) {
                        for (int c = 0; c < 4; ++c) *out++ = stored(row[c], options.format);
                    }
                }
            });
    }
    return texture;
}

}  // namespace onepass
