// Rays along axes, through corners and edges, and in the very planes that grids are cut by.
#include <cmath>

#include "scenes/ladders/parts.h"

namespace onepass::ladder {
namespace {

// ---- One small component

/// A ball and a box along the axes beside each other, in one mesh.
Scene ball_and_box() {
    Object both;
    both.name = "ball and box";
    append_shape(both, ball(), translation(vec3(-0.6f, 0.0f, 0.0f)), "ball");
    append_shape(both, make_box(5, 5, 5), translation(vec3(0.6f, 0.1f, 0.05f)), "box");
    return scene_of(std::move(both));
}

/// Rays with one component, or by turns two, at `share` of the largest. With a share of 0 its sign
/// tells 0 from -0.
RayMaker rays_with_small_component(double share) {
    return [=](const Scene& scene, size_t count, uint64_t seed) {
        Random random(seed);
        std::vector<Ray> rays;
        while (rays.size() < count) {
            const Target target = random_target(scene, random);
            dvec3 dir = random_unit_vector(random);
            const int axis = static_cast<int>(random.below(3));
            const int second = random.below(2) ? axis : (axis + 1) % 3;
            const double large = std::abs(dir[(axis + 2) % 3]);
            for (const int small : {axis, second}) {
                const double sign = share == 0.0 ? 1.0 : std::copysign(1.0, dir[small]);
                dir[small] = sign * share * large;
            }
            Ray ray;
            ray.dir = vec3(dir);
            const double distance = 0.2 + 1.8 * random.unit();
            ray.org = vec3(target.point - distance * dvec3(ray.dir));
            if (ray.dir != vec3(0.0f)) rays.push_back(ray);
        }
        return rays;
    };
}

Ladder direction_ladder() {
    Ladder ladder{.id = "direction",
                  .title = "Rays almost along a plane of the axes",
                  .question =
                      "One component of the direction, by turns two, is ever smaller than "
                      "the others, at last denormal, 0 and -0. Its inverse leaves the "
                      "range of a float, and 0 times infinity is no number.",
                  .knob = "smallest / largest component",
                  .unit = "",
                  .rungs = {}};
    const std::vector<double> knobs = {1.0,   1e-2,  1e-4,  1e-8, 1e-12, 1e-20,
                                       1e-30, 1e-37, 1e-41, 0.0,  -0.0};
    ladder.rungs = rungs_of(
        knobs, [](double) { return ball_and_box(); }, rays_with_small_component);
    ladder.rungs[8].label = "denormal";
    ladder.rungs[9].label = "0";
    ladder.rungs[10].label = "-0";
    return ladder;
}

// ---- Corners and edges

Ladder aimed_ladder(const char* id, const char* title, const char* question, const char* ray_kind) {
    Ladder ladder{.id = id,
                  .title = title,
                  .question = question,
                  .knob = "triangles of the ball",
                  .unit = "",
                  .rungs = {}};
    const uvec2 sizes[] = {{4, 2}, {8, 4}, {16, 8}, {24, 16}, {40, 26}, {64, 36}, {100, 51}};
    for (const uvec2& size : sizes) {
        Rung rung;
        rung.knob = 2.0 * size.x * (size.y - 1);
        rung.make_scene = [=] {
            const DAffine slanted(aslant());
            return scene_of(mapped(make_sphere(size.x, size.y),
                                   [&](const dvec3& p) { return transform_point(slanted, p); }));
        };
        rung.ray_kind = ray_kind;
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

// ---- Lattices

/// The cube from -1 to 1 with n cells a side, closed, its outermost vertices at `outer` instead;
/// and in it a terrain of heights 0 and one cell up or down. Every vertex is a point of the lattice
/// of 2 / n, exactly if n is a power of two.
Scene lattice(uint32_t n, double outer) {
    const auto clamped = [=](const dvec3& p) { return glm::clamp(2.0 * p, -outer, outer); };
    Object terrain = mapped(make_grid(n, n), clamped);
    for (size_t i = 0; i < terrain.positions.size(); ++i) {
        terrain.positions[i].y =
            (static_cast<float>(i * i % 3) - 1.0f) * 2.0f / static_cast<float>(n);
        if (n == 1) terrain.positions[i].y = 0.0f;  // its heights would be those of the cube
    }
    Object all;
    all.name = "lattice";
    append_shape(all, mapped(make_box(n, n, n), clamped), affine_identity(), "cube");
    append_shape(all, terrain, affine_identity(), "terrain");
    return scene_of(std::move(all));
}

/// Rays through points of the lattice of `step` inside of the cube, exactly: along an axis, within
/// a plane of the lattice, and from point to point.
RayMaker lattice_rays(double step) {
    return [=](const Scene&, size_t count, uint64_t seed) {
        Random random(seed);
        const auto inner_points = static_cast<uint64_t>(2.0 / step) - 1;
        const auto coordinate = [&] {
            return -1.0 + step * static_cast<double>(1 + random.below(inner_points));
        };
        const auto sign = [&] { return random.below(2) ? 1.0 : -1.0; };
        std::vector<Ray> rays;
        while (rays.size() < count) {
            dvec3 through(0.0);
            for (int k = 0; k < 3; ++k) through[k] = coordinate();
            const int axis = static_cast<int>(random.below(3));
            dvec3 dir(0.0);
            switch (random.below(3)) {
                case 0:  // along an axis
                    dir[axis] = sign();
                    break;
                case 1:  // within a plane
                    dir = random_unit_vector(random);
                    dir[axis] = 0.0;
                    break;
                default:  // from point to point, in whole numbers
                    for (int k = 0; k < 3; ++k) dir[k] = static_cast<double>(random.below(5)) - 2.0;
            }
            // From inside, from the cube's far side or from outside.
            const double back = static_cast<double>(random.below(3));
            Ray ray;
            ray.org = vec3(through - back * dir);
            ray.dir = vec3(dir);
            if (ray.dir != vec3(0.0f)) rays.push_back(ray);
        }
        return rays;
    };
}

Ladder lattice_ladder() {
    return {
        .id = "lattice",
        .title = "Meshes on a lattice",
        .question =
            "A cube with a terrain in it, all vertices on a lattice of powers of two, "
            "and rays exactly along its lines, in its planes and through its points: "
            "what modelled and voxel scenes are full of. They run along edges and "
            "through corners, and halfway planes of grids are among those planes.",
        .knob = "cells a side",
        .unit = "",
        .rungs = rungs_of(
            {1, 2, 4, 8, 16, 32}, [](double n) { return lattice(static_cast<uint32_t>(n), 1.0); },
            [](double n) { return lattice_rays(1.0 / n); })};
}

Ladder cell_planes_ladder() {
    // A grid pads its box by 2^-20 of its extent on either side, so that a cube of this half side
    // gets the box from -1 to 1, and planes that are exact.
    constexpr double kOuter = 1.0 - 0x1p-19;
    Ladder ladder{.id = "cell-planes",
                  .title = "Rays in cell planes",
                  .question =
                      "The same cube, a hair smaller, so that the planes of its grid are "
                      "exact powers of two, and rays in these planes and through corners "
                      "of cells. Which cells such a ray visits is a matter of convention; "
                      "that it misses no triangle is not.",
                  .knob = "cells a side",
                  .unit = "",
                  .rungs = rungs_of(
                      {2, 4, 8, 16, 32, 64, 128}, [](double) { return lattice(8, kOuter); },
                      [](double n) { return lattice_rays(2.0 / n); })};
    for (Rung& rung : ladder.rungs) {
        const std::string n = std::to_string(static_cast<int>(rung.knob));
        rung.params = {{"resolution", n + "x" + n + "x" + n}};
    }
    return ladder;
}

}  // namespace

std::vector<Ladder> aim_ladders() {
    return {direction_ladder(),
            aimed_ladder("vertices", "Rays at corners",
                         "Rays aimed at corners of a closed ball, where several triangles meet: "
                         "one that passes between all of them falls through.",
                         "vertex"),
            aimed_ladder("edges", "Rays at edges",
                         "Rays aimed at edges of a closed ball: rounding may let both triangles "
                         "say that the ray is the other's.",
                         "edge"),
            lattice_ladder(), cell_planes_ladder()};
}

}  // namespace onepass::ladder
