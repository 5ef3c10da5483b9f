// The reader of all formats but glTF, through Assimp.
//
// Whatever the node tree, the result is one object and one instance: meshes are appended in the
// order in which the tree names them (for OBJ that is file order), with their transforms applied.
// No post-process reorders, merges or invents anything; vertices are welded here, bit by bit.
#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "core/io/formats.h"

#ifdef ONEPASS_WITH_ASSIMP

#include <fstream>
#include <sstream>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/io/gzip.h"
#include "core/io/import.h"
#include "core/io/obj_check.h"

namespace onepass {
namespace {

vec3 to_vec3(const aiVector3D& v) { return vec3(v.x, v.y, v.z); }

Affine to_affine(const aiMatrix4x4& m) {
    return Affine(vec3(m.a1, m.b1, m.c1), vec3(m.a2, m.b2, m.c2), vec3(m.a3, m.b3, m.c3),
                  vec3(m.a4, m.b4, m.c4));
}

/// A mesh of the file at one place of its node tree.
struct PlacedMesh {
    const aiMesh* mesh = nullptr;
    Affine world_from_mesh = affine_identity();
};

void collect_meshes(const aiScene& scene, const aiNode& node, const Affine* world_from_parent,
                    std::vector<PlacedMesh>& result) {
    const Affine local = to_affine(node.mTransformation);
    const Affine world = world_from_parent != nullptr ? compose(*world_from_parent, local) : local;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        result.push_back({scene.mMeshes[node.mMeshes[i]], world});
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
        collect_meshes(scene, *node.mChildren[i], &world, result);
    }
}

VertexSet read_vertices(const PlacedMesh& placed, bool with_normals) {
    const aiMesh& mesh = *placed.mesh;
    VertexSet set;
    set.positions.reserve(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        set.positions.push_back(to_vec3(mesh.mVertices[i]));
    }
    if (with_normals && mesh.HasNormals()) {
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            set.normals.push_back(to_vec3(mesh.mNormals[i]));
        }
    }
    if (placed.world_from_mesh == affine_identity()) return set;

    if (!is_invertible(placed.world_from_mesh)) {
        throw Error({fmt::format("node of mesh '{}'", clean_text(mesh.mName.C_Str())),
                     "a transform that cannot be inverted", "finite, non-zero scales",
                     "Mend the node, or export the file again."});
    }
    const Affine mesh_from_world(inverse(placed.world_from_mesh));
    for (vec3& p : set.positions) p = transform_point(placed.world_from_mesh, p);
    for (vec3& n : set.normals) n = transform_normal(mesh_from_world, n);
    return set;
}

/// What is left of an import's faces, for the notes.
struct FaceCounts {
    uint64_t polygons = 0;  ///< more than three corners, before they are split
    uint64_t dropped = 0;   ///< points and lines
};

uint64_t count_polygons(const aiScene& scene) {
    uint64_t count = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[m];
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) count += mesh.mFaces[f].mNumIndices > 3;
    }
    return count;
}

std::vector<uvec3> read_triangles(const aiMesh& mesh, FaceCounts& counts) {
    std::vector<uvec3> triangles;
    triangles.reserve(mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices == 3) {
            triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
        } else {
            ++counts.dropped;
        }
    }
    return triangles;
}

vec3 material_color(const aiMaterial& source, const char* key, unsigned type, unsigned index,
                    const vec3& missing) {
    aiColor3D color;
    if (source.Get(key, type, index, color) != AI_SUCCESS) return missing;
    return glm::clamp(vec3(color.r, color.g, color.b), vec3(0), vec3(1));
}

Material read_material(const aiMaterial& source) {
    Material material;
    aiString name;
    source.Get(AI_MATKEY_NAME, name);
    material.name = clean_text(name.C_Str());
    if (material.name == AI_DEFAULT_MATERIAL_NAME) return material;
    material.diffuse = material_color(source, AI_MATKEY_COLOR_DIFFUSE, material.diffuse);
    material.specular = material_color(source, AI_MATKEY_COLOR_SPECULAR, material.specular);
    float shininess = 0.0f;
    // 0 is what Assimp says where a file says nothing.
    if (source.Get(AI_MATKEY_SHININESS, shininess) == AI_SUCCESS && shininess > 0.0f) {
        material.shininess = shininess;
    }
    return material;
}

/// "a 0..11, b 12..13": which prim_id lies in which group of the file.
std::string group_map(const Object& object) {
    constexpr size_t kMost = 100;  // groups listed
    std::string text;
    for (size_t g = 0; g < std::min(object.groups.size(), kMost); ++g) {
        const TriangleGroup& group = object.groups[g];
        text += fmt::format("{}{} {}..{}", g == 0 ? "" : ", ",
                            group.name.empty() ? "(no name)" : group.name, group.first_triangle,
                            group.first_triangle + group.triangle_count - 1);
    }
    if (object.groups.size() > kMost) {
        text += fmt::format(", and {} more", object.groups.size() - kMost);
    }
    return text;
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) {
        throw Error(
            {"", "a file that cannot be read", "a readable file", "Check its permissions."});
    }
    return std::move(text).str();
}

/// Assimp does not say when a material library is not there.
void note_missing_libraries(const std::string& text, const std::filesystem::path& folder,
                            std::vector<std::string>& notes) {
    constexpr std::string_view kKeyword = "mtllib ";
    for (size_t at = text.find(kKeyword); at != text.npos; at = text.find(kKeyword, at + 1)) {
        if (at > 0 && text[at - 1] != '\n') continue;
        const size_t begin = at + kKeyword.size();
        const std::string name =
            clean_text(std::string_view(text).substr(begin, text.find('\n', begin) - begin));
        if (std::error_code ignored; !std::filesystem::exists(folder / name, ignored)) {
            notes.push_back(fmt::format("material library '{}' not found", name));
        }
    }
}

/// Turns the lines "o NAME" of OBJ text into "g NAME". Assimp returns to an object that is named a
/// second time, and file order would be lost; a group that is named again is a new one.
void turn_objects_into_groups(std::string& text) {
    for (size_t at = 0; at < text.size(); ++at) {
        if (text[at] == 'o' && at + 1 < text.size() &&
            (text[at + 1] == ' ' || text[at + 1] == '\t')) {
            text[at] = 'g';
        }
        at = std::min(text.find('\n', at), text.size() - 1);
    }
}

/// Assimp believes the counts in an OFF file's head and asks for that much memory.
void check_off_counts(const std::string& text) {
    std::istringstream head(text.substr(0, 4096));
    std::string keyword;
    uint64_t vertices = 0;
    uint64_t faces = 0;
    // What does not look like a plain head is left to Assimp.
    if (!(head >> keyword >> vertices >> faces) || !keyword.ends_with("OFF")) return;
    if (vertices <= text.size() && faces <= text.size()) return;
    throw Error({"line 2", fmt::format("{} vertices and {} faces", vertices, faces),
                 fmt::format("no more than fit into its {} bytes", text.size()),
                 "Mend the head, or export the mesh again."});
}

/// Files that an in-memory OBJ refers to, its material libraries, are looked for in `folder`.
class FolderFiles : public Assimp::DefaultIOSystem {
  public:
    explicit FolderFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    bool Exists(const char* name) const override {
        return DefaultIOSystem::Exists((folder_ / name).c_str());
    }
    Assimp::IOStream* Open(const char* name, const char* mode) override {
        return DefaultIOSystem::Open((folder_ / name).c_str(), mode);
    }

  private:
    std::filesystem::path folder_;
};

/// The file as Assimp has it, polygons not yet split; null if Assimp refuses it.
const aiScene* read_assimp_scene(Assimp::Importer& importer, const std::filesystem::path& path,
                                 const std::string& extension, std::vector<std::string>& notes) {
    const bool compressed = extension.ends_with(".gz");
    const bool is_obj = extension.starts_with(".obj");
    if (extension == ".off") check_off_counts(read_text(path));
    if (!compressed && !is_obj) {
        return importer.ReadFile(path.string(), aiProcess_ValidateDataStructure);
    }
    std::string text = compressed ? read_gzip(path) : read_text(path);
    if (is_obj) {
        check_obj_text(text);
        turn_objects_into_groups(text);
        note_missing_libraries(text, path.parent_path(), notes);
        importer.SetIOHandler(new FolderFiles(path.parent_path()));  // which the importer owns
    }
    const std::string format = extension.substr(1, extension.find('.', 1) - 1);
    return importer.ReadFileFromMemory(text.data(), text.size(), aiProcess_ValidateDataStructure,
                                       format.c_str());
}

/// The file split into triangles; polygons are counted on the way.
const aiScene& read_triangulated(Assimp::Importer& importer, const std::filesystem::path& path,
                                 const std::string& extension, FaceCounts& counts,
                                 std::vector<std::string>& notes) {
    const aiScene* scene = read_assimp_scene(importer, path, extension, notes);
    if (scene != nullptr) {
        counts.polygons = count_polygons(*scene);
        scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    }
    if (scene == nullptr || scene->mRootNode == nullptr) {
        throw Error({"", "a file that Assimp refuses: " + clean_text(importer.GetErrorString()),
                     "a complete mesh file of its format", "Export the mesh again."});
    }
    return *scene;
}

}  // namespace

bool is_mesh_extension(const std::string& extension) {
    const std::string inner =
        extension.ends_with(".gz") ? extension.substr(0, extension.size() - 3) : extension;
    return Assimp::Importer().IsExtensionSupported(inner);
}

LoadedScene read_mesh_file(const std::filesystem::path& path, const std::string& extension) {
    LoadedScene loaded;
    FaceCounts counts;
    Assimp::Importer importer;
    const aiScene& source = read_triangulated(importer, path, extension, counts, loaded.notes);

    // Meshes in order. Assimp computes normals for 3DS itself, and STL's are those of its facets.
    const bool with_normals = !extension.starts_with(".3ds") && !extension.starts_with(".stl");
    std::vector<PlacedMesh> meshes;
    collect_meshes(source, *source.mRootNode, nullptr, meshes);
    std::vector<VertexSet> sets;
    std::vector<MeshPart> parts;
    std::vector<uint32_t> materials;
    for (const PlacedMesh& placed : meshes) {
        const aiMesh& mesh = *placed.mesh;
        const std::string name = clean_text(mesh.mName.C_Str());
        std::vector<uvec3> triangles = read_triangles(mesh, counts);
        if (triangles.empty()) continue;
        parts.push_back({name, fmt::format("group {} ('{}')", parts.size(), name), sets.size(),
                         std::move(triangles)});
        sets.push_back(read_vertices(placed, with_normals));
        materials.push_back(mesh.mMaterialIndex);
    }
    if (parts.empty()) {
        throw Error({"", "no triangles", "at least one", "Check that it is the right file."});
    }

    // One object, one instance.
    loaded.scene.name = path.stem().string();
    if (extension.ends_with(".gz")) {
        loaded.scene.name = std::filesystem::path(loaded.scene.name).stem().string();
    }
    Object object = build_object(loaded.scene.name, std::move(sets), std::move(parts));
    weld(object);
    const size_t repaired = repair_normals(object);
    if (counts.polygons > 0) {
        loaded.notes.push_back(counted(counts.polygons, "polygon", "polygons") +
                               " split into triangles");
    }
    if (counts.dropped > 0) {
        loaded.notes.push_back(counted(counts.dropped, "point or line", "points and lines") +
                               " left out");
    }
    if (repaired > 0) {
        loaded.notes.push_back(counted(repaired, "normal", "normals") + " of length 0 replaced");
    }
    if (object.groups.size() > 1) {
        loaded.notes.push_back(
            fmt::format("prim_ids of the {} groups: {}", object.groups.size(), group_map(object)));
    }
    for (unsigned i = 0; i < source.mNumMaterials; ++i) {
        loaded.scene.materials.push_back(read_material(*source.mMaterials[i]));
    }
    if (loaded.scene.materials.empty()) loaded.scene.materials.push_back(Material{});
    loaded.scene.instances.push_back({object.name, 0, affine_identity(), std::move(materials)});
    loaded.scene.objects.push_back(std::move(object));
    return loaded;
}

}  // namespace onepass

#else  // a build that reads glTF only

namespace onepass {

bool is_mesh_extension(const std::string& extension) {
    for (const char* known : {".obj", ".ply", ".stl", ".off", ".3ds", ".ac"}) {
        if (extension.starts_with(known)) return true;
    }
    return false;
}

LoadedScene read_mesh_file(const std::filesystem::path&, const std::string& extension) {
    throw Error({"", "a " + extension + " file",
                 ".glb or .gltf, all that a build without Assimp reads",
                 "Convert it with `onepass scenes export` elsewhere, or build with "
                 "-DONEPASS_WITH_ASSIMP=ON."});
}

}  // namespace onepass

#endif
