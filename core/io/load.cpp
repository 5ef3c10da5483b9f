// The one way from a file to a scene: chooses the reader, supplies what a file leaves out, and
// checks the result.
#include "core/io/load.h"

#include <cctype>
#include <fstream>
#include <new>

#include <fmt/format.h>

#include "core/error.h"
#include "core/io/formats.h"
#include "core/io/import.h"

namespace onepass {
namespace {

void check_is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (!std::filesystem::exists(status)) {
        throw Error({path.string(), "no such file", "a scene file",
                     "Check the name, or see `onepass list scenes`."});
    }
    if (std::filesystem::is_directory(status)) {
        throw Error({path.string(), "a directory", "a scene file", "Name a file in it."});
    }
    if (!std::ifstream(path, std::ios::binary)) {
        throw Error({path.string(), "a file that cannot be opened", "a readable file",
                     "Check its permissions."});
    }
}

LoadedScene read_any(const std::filesystem::path& path) {
    const std::string extension = scene_extension(path);
    if (extension == ".gltf" || extension == ".glb") return read_gltf(path);
    if (is_mesh_extension(extension)) return read_mesh_file(path, extension);
    throw Error({"", extension.empty() ? "no extension" : "the extension '" + extension + "'",
                 ".gltf, .glb, .obj, .obj.gz, .ply, .stl or another that Assimp reads",
                 "Convert the file."});
}

/// Lights the scene from above the first camera's right shoulder, and a little from everywhere.
void add_headlight(LoadedScene& loaded) {
    Scene& scene = loaded.scene;
    constexpr float kUp = 0.8f;     // of the camera's distance from the scene's centre
    constexpr float kRight = 0.8f;  // likewise
    const vec3 ambient(0.1f);
    const Affine& m = scene.cameras[0].world_from_camera;
    const float distance = glm::length(scene_bounds(scene).centre() - m[3]);
    PointLight light;
    light.name = "automatic";
    light.intensity = vec3(0.9f);
    light.position =
        m[3] + glm::normalize(m[1]) * (kUp * distance) + glm::normalize(m[0]) * (kRight * distance);
    scene.lights.push_back(light);
    if (scene.ambient == vec3(0)) scene.ambient = ambient;
    loaded.notes.push_back(
        "no light in the file: one above the camera to the right, and ambient light");
}

void note_degenerate(LoadedScene& loaded) {
    uint64_t count = 0;
    for (const Object& object : loaded.scene.objects) count += count_degenerate(object);
    if (count > 0) {
        loaded.notes.push_back(counted(count, "degenerate triangle", "degenerate triangles") +
                               " kept");
    }
}

}  // namespace

std::string scene_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    if (extension == ".gz" || extension == ".GZ") {
        extension = path.stem().extension().string() + extension;
    }
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

LoadedScene read_scene_file(const std::filesystem::path& path) {
    check_is_file(path);
    try {
        LoadedScene loaded = read_any(path);
        validate(loaded.scene);
        note_degenerate(loaded);
        return loaded;
    } catch (const Error& e) {
        // Readers name the place within the file; here it gets the file's name.
        Error::Parts parts = e.parts();
        parts.where = path.string() + (parts.where.empty() ? "" : ", " + parts.where);
        throw Error(parts, e.kind());
    } catch (const std::bad_alloc&) {
        throw Error({path.string(), "a scene that does not fit into memory", "a smaller one",
                     "Simplify the mesh, or use a larger machine."});
    }
}

void supply_missing(LoadedScene& loaded) {
    if (loaded.scene.cameras.empty()) {
        Camera camera = automatic_camera(scene_bounds(loaded.scene));
        camera.name = "automatic";
        loaded.scene.cameras.push_back(camera);
        loaded.notes.push_back("no camera in the file: automatic one");
    }
    if (loaded.scene.lights.empty()) add_headlight(loaded);
    validate(loaded.scene);
}

LoadedScene load_scene_file(const std::filesystem::path& path) {
    LoadedScene loaded = read_scene_file(path);
    supply_missing(loaded);
    return loaded;
}

bool mesh_files_supported() {
#ifdef ONEPASS_WITH_ASSIMP
    return true;
#else
    return false;
#endif
}

}  // namespace onepass
