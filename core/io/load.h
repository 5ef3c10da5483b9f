// Scene files in: one function for every format, and the writer for the project's own (glTF 2.0).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene.h"

namespace onepass {

/// A loaded scene, and what had to be supplied or repaired to make it usable: each note is one
/// sentence with a count ("3 degenerate triangles kept", "no camera in the file: automatic one").
struct LoadedScene {
    Scene scene;
    std::vector<std::string> notes;
};

/// Reads .gltf, .glb (tinygltf), and .obj, .obj.gz, .ply, .stl, .off, .3ds and other mesh files
/// (Assimp). A file without a node tree becomes one object and one instance: triangles in file
/// order, groups appended in order.
///
/// The result has passed validate(), and has at least one camera and one light.
/// Throws: Error for a missing or unreadable file, a directory, an unknown format, an empty scene,
/// indices out of range, numbers that are not finite, transforms that cannot be inverted.
LoadedScene load_scene_file(const std::filesystem::path& path);

/// The two halves of load_scene_file, for who has a camera or light of his own to put between:
/// the scene as the file has it (it has passed validate()) ...
LoadedScene read_scene_file(const std::filesystem::path& path);
/// ... and an automatic camera, a light and their notes where it has none.
void supply_missing(LoadedScene& loaded);

/// Writes glTF 2.0: .glb, or .gltf with its buffer beside it as .bin. Scene -> file -> Scene gives
/// an equal value. Written whole or not at all (temporary file, then rename).
/// Throws: Error if the path cannot be written.
void write_gltf(const Scene& scene, const std::filesystem::path& path);

/// Whether this build reads mesh files other than glTF (built with Assimp).
bool mesh_files_supported();

}  // namespace onepass
