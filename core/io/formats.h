// The readers behind load_scene_file, one a library. Internal to core/io.
//
// A reader gives what the file says, checked index by index; it adds neither camera nor light, and
// its errors name the place within the file, not the file.
#pragma once

#include <filesystem>

#include "core/io/load.h"

namespace onepass {

/// Reads .gltf and .glb through tinygltf. Node trees are flattened: one instance for every node
/// with a mesh, its transform composed in double and rounded once. Nodes that the first animation
/// moves become animated nodes, and carry the instances below them; what else an animation may move
/// stands still, with a note.
LoadedScene read_gltf(const std::filesystem::path& path);

/// True if read_mesh_file knows the extension; ".gz" is looked through. `extension` is lower case.
bool is_mesh_extension(const std::string& extension);

/// Reads every other format through Assimp, as one object and one instance: triangles in file
/// order, groups appended in order.
/// Throws: Error that names the build option if this build has no Assimp.
LoadedScene read_mesh_file(const std::filesystem::path& path, const std::string& extension);

/// The extension, lower case; that of "a.OBJ.gz" is ".obj.gz".
std::string scene_extension(const std::filesystem::path& path);

}  // namespace onepass
