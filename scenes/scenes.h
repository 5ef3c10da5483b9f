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

/// Resolves SCENE of the command line: a built-in name, else a file.
///
/// Real meshes are looked for in $ONEPASS_SCENE_DIR, in `.cache/scenes` below the current folder,
/// and under /usr/share, where Debian's packages put them.
/// Throws: Error listing the names if it is neither; naming the package if a mesh is not there.
LoadedScene load_scene(const std::string& name_or_path);

/// balls-1, a stand-in with the paper's counts: 10 instances of a 40 x 40 sphere, 2 lights.
/// Moves as orbiting_mirrors() says.
Scene make_balls_1();
/// Rotated, non-uniformly scaled, sheared and mirrored instances of several objects.
Scene make_instances();
/// Six large triangles over a field of many small ones: a large triangle is referenced by many
/// cells, and a hit outside the current cell must not be accepted early.
Scene make_big_small();

}  // namespace onepass
