// The list of built-in scenes, and where the real meshes among them are found.
#include "scenes/scenes.h"

#include <cstdlib>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "core/error.h"
#include "scenes/shapes.h"

namespace onepass {
namespace {

/// A mesh that a Debian package brings.
struct MeshFile {
    const char* name;    ///< of the file in the cache folder
    const char* folder;  ///< where the package installs it
    const char* package;
    const char* fetch = "./dev meshes all";  ///< the command that brings it
};

constexpr MeshFile kBunny{"bunny.obj", "/usr/share/glmark2/models", "glmark2-data"};
constexpr MeshFile kCornell{"cornell_box.obj", "/usr/share/doc/embree3/models", "embree-tools"};
constexpr MeshFile kMotorbike{"motorBike.obj.gz",
                              "/usr/share/doc/openfoam-examples/examples/resources/geometry",
                              "openfoam-examples"};
constexpr MeshFile kBuildings{"buildings.obj.gz",
                              "/usr/share/doc/openfoam-examples/examples/incompressible/"
                              "simpleFoam/windAroundBuildings/constant/triSurface",
                              "openfoam-examples"};
constexpr MeshFile kSr71a{"Blackbird-SR71A-lowpoly.ac",
                          "/usr/share/games/flightgear/AI/Aircraft/SR-71", "flightgear-data-ai",
                          "./dev meshes sr71a"};

std::vector<std::filesystem::path> mesh_folders(const MeshFile& mesh) {
    std::vector<std::filesystem::path> folders;
    if (const char* folder = std::getenv("ONEPASS_SCENE_DIR")) folders.emplace_back(folder);
    folders.emplace_back(".cache/scenes");
    folders.emplace_back(mesh.folder);
    return folders;
}

/// Empty if no folder has it.
std::filesystem::path find_mesh(const MeshFile& mesh) {
    for (const std::filesystem::path& folder : mesh_folders(mesh)) {
        std::error_code ignored;
        if (std::filesystem::is_regular_file(folder / mesh.name, ignored))
            return folder / mesh.name;
    }
    return {};
}

LoadedScene read_mesh(const MeshFile& mesh) {
    const std::filesystem::path path = find_mesh(mesh);
    if (!path.empty()) return read_scene_file(path);
    std::string tried;
    for (const std::filesystem::path& folder : mesh_folders(mesh)) {
        tried += (tried.empty() ? "" : ", ") + folder.string();
    }
    throw Error({mesh.name, "no such file in " + tried,
                 fmt::format("the mesh of Debian's package {}", mesh.package),
                 fmt::format("Run `{}`, or `apt-get install {}`.", mesh.fetch, mesh.package)});
}

/// The views of the published figures of GPU tracers on these meshes: 0.75 diagonals of the box
/// from its centre, looking at it, 45 degrees from top to bottom.
Camera published_view(const Bounds& bounds, const vec3& direction, const vec3& up) {
    constexpr float kDistance = 0.75f;
    constexpr float kFov = 0.785398163f;
    const vec3 eye = bounds.centre() + glm::normalize(direction) * (kDistance * bounds.diagonal());
    Camera camera = look_at(eye, bounds.centre(), up, kFov);
    camera.name = "published view";
    return camera;
}

LoadedScene load_bunny() {
    LoadedScene loaded = read_mesh(kBunny);
    loaded.scene.background = vec3(0.2f, 0.23f, 0.28f);
    loaded.scene.cameras = {
        published_view(scene_bounds(loaded.scene), vec3(0.3f, 0.25f, 1.0f), vec3(0, 1, 0))};
    supply_missing(loaded);
    return loaded;
}

LoadedScene load_motorbike() {
    LoadedScene loaded = read_mesh(kMotorbike);
    loaded.scene.background = vec3(0.2f, 0.23f, 0.28f);
    loaded.scene.cameras = {
        published_view(scene_bounds(loaded.scene), vec3(-0.5f, -1.0f, 0.35f), vec3(0, 0, 1))};
    supply_missing(loaded);
    return loaded;
}

/// All of the town, from above.
LoadedScene load_buildings() {
    LoadedScene loaded = read_mesh(kBuildings);
    loaded.scene.background = vec3(0.35f, 0.45f, 0.6f);
    loaded.scene.cameras = {
        published_view(scene_bounds(loaded.scene), vec3(-0.8f, -1.0f, 0.7f), vec3(0, 0, 1))};
    supply_missing(loaded);
    return loaded;
}

LoadedScene load_cornell() {
    LoadedScene loaded = read_mesh(kCornell);
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

/// The real aircraft, placed, lit and seen as its stand-in is.

LoadedScene load_sr71a_real() {
    LoadedScene loaded = read_mesh(kSr71a);
    Scene& scene = loaded.scene;
    const Scene stand_in = make_sr71a();
    scene.background = stand_in.background;
    scene.ambient = stand_in.ambient;
    scene.lights = stand_in.lights;
    scene.cameras = stand_in.cameras;

    // The file's nose points along -x, the stand-in's along +z; the middles go together.
    const Affine turn = rotation(vec3(0, 1, 0), 90);
    const float ahead =
        scene_bounds(stand_in).centre().z - transform_bounds(turn, scene_bounds(scene)).centre().z;
    scene.instances[0].world_from_object = compose(translation(vec3(0, 0, ahead)), turn);

    // What is black in a texture is white in the file's materials: it gets the stand-in's paint.
    for (Material& material : scene.materials) {
        if (material.diffuse != vec3(1)) continue;
        const std::string name = material.name;
        material = stand_in.materials[stand_in.instances[0].materials[0]];
        material.name = name;
    }
    supply_missing(loaded);

    return loaded;
}

struct BuiltinScene {
    SceneInfo info;
    std::function<LoadedScene()> load;
    const MeshFile* mesh = nullptr;  ///< what it is read from; null: it is generated
};

BuiltinScene generated(SceneInfo info, Scene (*make)()) {
    return {std::move(info), [make] {
                LoadedScene loaded{make(), {}};
                validate(loaded.scene);
                return loaded;
            }};
}

const std::vector<BuiltinScene>& scene_table() {
    static const std::vector<BuiltinScene> table = {
        // The paper's.
        generated({"balls-1", "ten balls, two of them mirrors that see each other",
                   "stand-in for Balls-1 of the paper's table 1"},
                  make_balls_1),
        generated({"chair-wood", "a turned wooden chair on a floor",
                   "stand-in for Chair_wood of the paper's table 1"},
                  make_chair_wood),
        generated({"palm-pc", "a handheld computer with a mirroring screen, and its stylus",
                   "stand-in for PalmPC of the paper's table 1"},
                  make_palm_pc),
        generated({"knife", "a knife with a mirroring blade, one mesh",
                   "stand-in for Knife of the paper's table 1"},
                  make_knife),
        generated({"sr71a", "the aircraft in flight, one mesh",
                   "stand-in for SR71A of the paper's table 1"},
                  make_sr71a),
        generated({"palace", "columns, walls and domes on steps",
                   "stand-in for Palace of the paper's table 1"},
                  make_palace),
        generated({"hind24", "24 helicopters in formation, instances of one mesh",
                   "stand-in for Hind24 of the paper's figure 1"},
                  make_hind24),
        generated({"hind24-flying", "the same squadron, its rotors instances of their own",
                   "stand-in for Hind24 of the paper's figure 1"},
                  make_hind24_flying),

        // Our own.
        generated({"instances", "rotated, stretched, sheared and mirrored instances", "generated"},
                  make_instances),
        generated(
            {"big-small", "6 large triangles over 20,000 small ones in one object", "generated"},
            make_big_small),
        generated(
            {"ball-on-ground", "a dense ball on a ground of 500 radii in one object", "generated"},
            make_ball_on_ground),

        // Real meshes.
        {{"bunny", "closed scanned mesh", "Debian glmark2-data, GPL-3+"}, load_bunny, &kBunny},
        {{"cornell", "the Cornell box", "Debian embree-tools, Apache-2.0"},
         load_cornell,
         &kCornell},
        {{"motorbike", "motorcycle with rider, 67,326 triangles are duplicates",
          "Debian openfoam-examples, GPL-3+"},
         load_motorbike,
         &kMotorbike},
        {{"buildings", "a town: large walls beside small parts of houses",
          "Debian openfoam-examples, GPL-3+"},
         load_buildings,
         &kBuildings},
        {{"sr71a-real", "the aircraft in 148 parts", "Debian flightgear-data-ai, GPL-2+"},
         load_sr71a_real,
         &kSr71a},
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

std::string how_to_fetch(const std::string& name) {
    for (const BuiltinScene& scene : scene_table()) {
        if (scene.info.name != name || scene.mesh == nullptr) continue;
        return find_mesh(*scene.mesh).empty() ? scene.mesh->fetch : "";
    }
    return "";
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
