// The built-in scenes, by name: generated ones, and real meshes from Debian packages.
#pragma once

#include <string>
#include <vector>

#include "core/io/load.h"

namespace onepass {

struct SceneInfo {
    std::string name;
    std::string summary;
    std::string source;  ///< recipe or Debian package and licence
};

/// All built-in names, in the order they are listed.
const std::vector<SceneInfo>& builtin_scenes();

/// The command that fetches the mesh of a built-in scene; empty if its file is at hand, or if it
/// needs none.
std::string how_to_fetch(const std::string& name);

/// Resolves SCENE of the command line: a built-in name, else a file.
///
/// Real meshes are looked for in $ONEPASS_SCENE_DIR, in `.cache/scenes` below the current folder,
/// and under /usr/share, where Debian's packages put them.
/// Throws: Error listing the names if it is neither; naming the package if a mesh is not there.
LoadedScene load_scene(const std::string& name_or_path);

/// Said wherever the stand-ins are listed.
inline constexpr const char* kStandInNote =
    "The paper's models, cameras and materials are not public: its scenes are stand-ins with the "
    "published triangle, instance and light counts (hind24 has no published counts), so frame "
    "rates are not comparable scene by scene.";

// ---- Stand-ins for the paper's scenes, with its counts of triangles as instanced, instances and
// lights.

/// Balls-1, 31,200 / 10 / 2: instances of a 40 x 40 sphere; two are mirrors that see each other.
/// Moves as orbiting_mirrors() says.
Scene make_balls_1();
/// Chair_wood, 33,404 / 11 / 1: a turned wooden chair on a floor.
Scene make_chair_wood();
/// PalmPC, 13,532 / 7 / 1: a handheld computer and its stylus on a table; the screen mirrors.
Scene make_palm_pc();
/// Knife, 1,676 / 1 / 1: a blade that mirrors and a dark handle, in one mesh.
Scene make_knife();
/// SR71A, 4,446 / 1 / 1: the aircraft in one mesh, seen from above in flight.
Scene make_sr71a();
/// Palace, 33,000 / 36 / 1: columns, walls and domes on steps.
Scene make_palace();
/// Hind24 of the paper's figure 1, which gives no counts: 24 instances of one helicopter of 13,222
/// triangles in formation.
Scene make_hind24();
/// The same squadron in 72 instances, so that rotors can turn: "hull 07", "main rotor 07" (about
/// its y axis) and "tail rotor 07" (about its x axis), from 01 to 24. Rotor objects are centred on
/// their axes.
Scene make_hind24_flying();

// ---- Scenes of our own.

/// Rotated, non-uniformly scaled, sheared and mirrored instances of several objects.
Scene make_instances();
/// A closed surface of about `triangles` triangles (8 m^2, m the nearest whole number): a ball with
/// lumps, the same shape whatever the count, for studies of how cost grows. One object in one
/// instance, named after its count.
///
/// Triangles are counter-clockwise seen from outside and of like sizes (areas within a factor of
/// about 8); no vertex has more than six.
/// Throws: Error for fewer than 8 triangles or more than 2^31.
Scene make_lumpy_ball(uint64_t triangles);
/// Six large triangles over a field of many small ones: a large triangle is referenced by many
/// cells, and a hit outside the current cell must not be accepted early.
Scene make_big_small();
/// A ball of 69,696 triangles on a ground of 128 that is 500 of its radii wide, in one object: what
/// a grid of one cell size serves badly. The camera sees the ball from near by.
Scene make_ball_on_ground();

}  // namespace onepass
