// The list of built-in scenes, and where the real meshes among them are found.
#include "scenes/scenes.h"

#include <cstdlib>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// A mesh that a Debian package brings.
struct MeshFile {
    const char* name;    ///< of the file in the cache folder
    const char* folder;  ///< where the package installs it
    const char* package;
};

std::filesystem::path find_mesh(const MeshFile& mesh) {
    std::vector<std::filesystem::path> folders;
    if (const char* folder = std::getenv("ONEPASS_SCENE_DIR")) folders.emplace_back(folder);
    folders.emplace_back(".cache/scenes");
    folders.emplace_back(mesh.folder);
    std::string tried;
    for (const std::filesystem::path& folder : folders) {
        std::error_code ignored;
        if (std::filesystem::is_regular_file(folder / mesh.name, ignored))
            return folder / mesh.name;
        tried += (tried.empty() ? "" : ", ") + folder.string();
    }
    throw Error({mesh.name, "no such file in " + tried,
                 fmt::format("the mesh of Debian's package {}", mesh.package),
                 fmt::format("Run `./dev meshes all`, or `apt-get install {}`.", mesh.package)});
}

/// The views of the published figures: 0.75 diagonals from the centre, 45 degrees.
Camera published_view(const Bounds& bounds, const vec3& direction, const vec3& up) {
    constexpr float kDistance = 0.75f;
    constexpr float kFov = 0.785398163f;
    const vec3 eye = bounds.centre() + glm::normalize(direction) * (kDistance * bounds.diagonal());
    Camera camera = look_at(eye, bounds.centre(), up, kFov);
    camera.name = "published view";
    return camera;
}

LoadedScene load_bunny() {
    LoadedScene loaded =
        read_scene_file(find_mesh({"bunny.obj", "/usr/share/glmark2/models", "glmark2-data"}));
    loaded.scene.background = vec3(0.2f, 0.23f, 0.28f);
    loaded.scene.cameras = {
        published_view(scene_bounds(loaded.scene), vec3(0.3f, 0.25f, 1.0f), vec3(0, 1, 0))};
    supply_missing(loaded);
    return loaded;
}

LoadedScene load_motorbike() {
    LoadedScene loaded = read_scene_file(find_mesh(
        {"motorBike.obj.gz", "/usr/share/doc/openfoam-examples/examples/resources/geometry",
         "openfoam-examples"}));
    loaded.scene.background = vec3(0.2f, 0.23f, 0.28f);
    loaded.scene.cameras = {
        published_view(scene_bounds(loaded.scene), vec3(-0.5f, -1.0f, 0.35f), vec3(0, 0, 1))};
    supply_missing(loaded);
    return loaded;
}

LoadedScene load_cornell() {
    LoadedScene loaded = read_scene_file(
        find_mesh({"cornell_box.obj", "/usr/share/doc/embree3/models", "embree-tools"}));
    // The view of the original data (http://www.graphics.cornell.edu/online/box/data.html). The one
    // light hangs before the original lamp's place, so that the blocks' fronts are not all dark.
    constexpr float kFov = 0.685f;  // 39.3 degrees: 0.025 wide at a focal length of 0.035
    Camera camera = look_at(vec3(278, 273, -800), vec3(278, 273, 0), vec3(0, 1, 0), kFov);
    camera.name = "original view";
    loaded.scene.cameras = {camera};
    loaded.scene.lights = {
        {.name = "lamp", .position = vec3(278, 510, 130), .intensity = vec3(0.75f)}};
    loaded.scene.ambient = vec3(0.2f);
    supply_missing(loaded);
    return loaded;
}

struct BuiltinScene {
    SceneInfo info;
    std::function<LoadedScene()> load;
};

LoadedScene generated(Scene scene) {
    validate(scene);
    return {std::move(scene), {}};
}

const std::vector<BuiltinScene>& scene_table() {
    static const std::vector<BuiltinScene> table = {
        {{"balls-1", "10 balls, two of them mirrors that see each other; 31,200 triangles",
          "stand-in with the counts of the paper's Balls-1"},
         [] { return generated(make_balls_1()); }},
        {{"instances", "rotated, stretched, sheared and mirrored instances of four objects",
          "generated"},
         [] { return generated(make_instances()); }},
        {{"big-small", "6 large triangles over 20,000 small ones in one object", "generated"},
         [] { return generated(make_big_small()); }},
        {{"bunny", "closed scanned mesh, 69,666 triangles", "Debian glmark2-data, GPL-3+"},
         load_bunny},
        {{"cornell", "the Cornell box, 34 triangles", "Debian embree-tools, Apache-2.0"},
         load_cornell},
        {{"motorbike", "motorcycle with rider, 331,653 triangles, 67,326 of them duplicates",
          "Debian openfoam-examples, GPL-3+"},
         load_motorbike},
    };
    return table;
}

}  // namespace

const std::vector<SceneInfo>& builtin_scenes() {
    static const std::vector<SceneInfo> infos = [] {
        std::vector<SceneInfo> result;
        for (const BuiltinScene& scene : scene_table()) result.push_back(scene.info);
        return result;
    }();
    return infos;
}

LoadedScene load_scene(const std::string& name_or_path) {
    std::string names;
    for (const BuiltinScene& scene : scene_table()) {
        if (scene.info.name != name_or_path) {
            names += (names.empty() ? "" : ", ") + scene.info.name;
            continue;
        }
        LoadedScene loaded = scene.load();
        loaded.scene.name = scene.info.name;
        return loaded;
    }
    std::error_code ignored;
    if (!std::filesystem::exists(name_or_path, ignored)) {
        throw Error({fmt::format("scene '{}'", name_or_path), "neither a built-in name nor a file",
                     "a scene file, or one of " + names, "Check the name."});
    }
    return load_scene_file(name_or_path);
}

}  // namespace onepass
