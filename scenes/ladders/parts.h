// The ladders by theme, and the words they are described in: scenes of bare meshes, and rays that
// are aimed at them. Internal to scenes.
//
// All places are computed in double and rounded once, so that what makes a rung hard is what its
// ladder says, and not how it was generated.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/ladder.h"
#include "core/random.h"
#include "scenes/shapes.h"

namespace onepass::ladder {

// ---- The ladders, by theme.

std::vector<Ladder> place_ladders();      ///< where things are, and how large
std::vector<Ladder> shape_ladders();      ///< triangles and surfaces that are hard to hit
std::vector<Ladder> aim_ladders();        ///< rays along axes, and through corners and planes
std::vector<Ladder> transform_ladders();  ///< what instances' matrices can do
std::vector<Ladder> limit_ladders();      ///< parameters of the grid strategies

// ---- Scenes.

/// The object without normals: nothing is shaded.
Object bare(Object object);

/// Every vertex moved by `map` in double, and rounded once.
Object mapped(Object object, const std::function<dvec3(const dvec3&)>& map);

/// A rotation after which no edge of a box and no ring of a lathe lies along an axis.
Affine aslant();

/// One object in one instance, or in several.
Scene scene_of(Object object, const std::vector<Affine>& world_from_object = {affine_identity()});

/// The mesh of most ladders: a closed ball of diameter 1, 720 triangles.
Object ball();

// ---- Rays.

/// A point inside of a triangle, in the world.
struct Target {
    dvec3 point{0.0};
    dvec3 normal{0.0};  ///< unit, to either side; 0 of a triangle without area
};

/// Of a uniform instance's uniform triangle; with `last_triangles` > 0 only of so many at the end.
Target random_target(const Scene& scene, Random& random, size_t last_triangles = 0);

/// Uniform in the box, grown about its centre by `factor`.
dvec3 point_around(const Bounds& box, double factor, Random& random);

dvec3 random_unit_vector(Random& random);

/// From the rounded origin towards the point; by turns of length 1, or so long that t is 1 there.
Ray ray_towards(const dvec3& origin, const dvec3& point, Random& random);

/// From around the scene's box to its surfaces: the rays of most ladders.
std::vector<Ray> rays_at_surfaces(const Scene& scene, size_t count, uint64_t seed);

// ---- Ladders.

/// Rounded as decimal numbers are.
double power_of_ten(int power);
/// From 10^first to 10^last, decade by decade, up or down.
std::vector<double> powers_of_ten(int first, int last);

using RayMaker = std::function<std::vector<Ray>(const Scene&, size_t, uint64_t)>;

/// One rung a knob; `make_scene` and `make_rays` are given the knob.
std::vector<Rung> rungs_of(
    const std::vector<double>& knobs, const std::function<Scene(double)>& make_scene,
    const std::function<RayMaker(double)>& make_rays = [](double) { return rays_at_surfaces; });

}  // namespace onepass::ladder
