// Motions for built-in scenes: they add an animation to a scene and change nothing else of it, so
// that the scene at rest, and at time 0, stays the one that was built.
#pragma once

#include <cstdint>

#include "core/scene.h"

namespace onepass {

/// balls-1 as a roundabout, one turn in 2 s: the two mirrors orbit each other, all other balls but
/// the red one between them go round with them, and the coloured balls hop. None touches another,
/// none passes through the floor.
///
/// Instances are found by the names "left mirror", "right mirror", "red" and "floor"; all are
/// spheres on the floor, an ellipsoid.
/// Throws: Error for a scene without one of them.
void orbiting_mirrors(Scene& scene);

/// A squadron of helicopters in a loop of 2 s: "hull NN" bobs and drifts forward and back gently,
/// and takes along "main rotor NN", which turns about its object's +y axis, and "tail rotor NN",
/// which turns about its object's +x axis. Forward is from the tail rotor to the main rotor.
///
/// Instances are found by these names; NN is any text, and joins the three of one helicopter.
/// Throws: Error for a scene without hulls, or a hull without one of its rotors.
void turning_rotors(Scene& scene);

/// Small shapes swarming in a cube, each turning about an axis of its own and circling its place in
/// a loop of 2 s: the load of benchmarks of moving instances. Their density does not depend on
/// `instances`. The same seed gives the same scene on every machine.
///
/// Objects: one sphere of 176 triangles.
Scene make_swarm(uint32_t instances, uint64_t seed);

}  // namespace onepass
