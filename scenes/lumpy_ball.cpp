// The lumpy ball: one shape in as many triangles as asked for.
//
// An octahedron unfolds into a square (Praun & Hoppe 2003): its upper half lies inside the diamond
// |u| + |v| <= 1, the faces of the lower half fill the corners, and points of the square's border
// meet in pairs. A lattice over the square is thus a closed mesh without a pole, made in linear
// time. Each of its points is moved along its direction onto the lumpy surface.
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "scenes/describe.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

/// The point of the octahedron |x| + |y| + |z| = 1 at (u, v) in the square from -1 to 1.
dvec3 folded(double u, double v) {
    const double z = 1.0 - std::abs(u) - std::abs(v);
    if (z >= 0.0) return {u, v, z};
    return {std::copysign(1.0 - std::abs(v), u), std::copysign(1.0 - std::abs(u), v), z};
}

/// Lumps some ten times as large as the triangles of the smallest mesh of a study, 10,000: every
/// size shows the same shape.
vec3 on_lumpy_ball(const dvec3& direction) {
    const dvec3 d = glm::normalize(direction);
    const double lumps = std::sin(5.0 * d.x + 1.0) * std::cos(4.0 * d.y) +
                         0.6 * std::sin(7.0 * d.z + 3.0 * d.x) * std::cos(6.0 * d.y + 0.5);
    return vec3(d * (1.0 + 0.2 * lumps));
}

/// The lattice of 2m x 2m cells over the square, its border points merged in pairs.
Object make_object(uint32_t m) {
    const uint32_t side = 2 * m;
    Object object;
    std::vector<uint32_t> vertex_of(size_t{side + 1} * (side + 1), kNoId);
    const auto vertex = [&](uint32_t i, uint32_t j) {
        // On the border a point meets its mirror image; the four corners are one point.
        if (i % side == 0) j = std::min(j, side - j);
        if (j % side == 0) i = std::min(i, side - i);
        uint32_t& index = vertex_of[i + size_t{side + 1} * j];
        if (index == kNoId) {
            index = static_cast<uint32_t>(object.positions.size());
            const auto coordinate = [&](uint32_t k) {
                return (static_cast<double>(k) - m) / static_cast<double>(m);
            };
            object.positions.push_back(on_lumpy_ball(folded(coordinate(i), coordinate(j))));
        }
        return index;
    };

    object.positions.reserve(size_t{4} * m * m + 2);
    object.triangles.reserve(size_t{8} * m * m);
    for (uint32_t j = 0; j < side; ++j) {
        for (uint32_t i = 0; i < side; ++i) {
            const uint32_t a = vertex(i, j), b = vertex(i + 1, j);
            const uint32_t c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
            // The diagonal runs along the octahedron's edges |u| + |v| = 1.
            const bool falling = (i < m) == (j < m);
            if (falling) {
                object.triangles.emplace_back(a, b, d);
                object.triangles.emplace_back(b, c, d);
            } else {
                object.triangles.emplace_back(a, b, c);
                object.triangles.emplace_back(a, c, d);
            }
        }
    }
    object.groups = {{"all", 0, static_cast<uint32_t>(object.triangles.size())}};
    return object;
}

}  // namespace

Scene make_lumpy_ball(uint64_t triangles) {
    constexpr uint64_t kFewest = 8, kMost = uint64_t{1} << 31;
    if (triangles < kFewest || triangles > kMost) {
        throw Error({"the lumpy ball", fmt::format("{} triangles", triangles),
                     fmt::format("{} to {}", kFewest, kMost), "Ask for another number."});
    }
    const auto m =
        static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 8)));
    Scene scene;
    scene.name = fmt::format("lumpy-ball-{}", uint64_t{8} * m * m);
    scene.background = vec3(0.2f, 0.23f, 0.28f);
    scene.ambient = vec3(0.12f);
    const uint32_t clay = add_material(scene, matte("clay", vec3(0.75f, 0.4f, 0.25f)));
    add_instance(scene, "ball", add_object(scene, "lumpy ball", make_object(m)), affine_identity(),
                 {clay});
    scene.lights = {light("key", vec3(4, 8, 6), vec3(0.8f, 0.78f, 0.72f))};
    scene.cameras = {automatic_camera(scene_bounds(scene))};
    return scene;
}

}  // namespace onepass
