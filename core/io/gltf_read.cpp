// The glTF 2.0 reader. tinygltf parses JSON and buffers; everything it hands over is checked here.
//
// A mesh of the file becomes an object, unless an earlier mesh uses the same accessors (that is how
// the writer says "the same object, other materials"); a node with a mesh becomes an instance; a
// node that the first animation moves becomes an animated node, with what stands still up to the
// next one above it as its base.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "core/error.h"
#include "core/io/formats.h"
#include "core/io/gltf_accessor.h"
#include "core/io/gltf_extras.h"
#include "core/io/import.h"

namespace onepass {
namespace {

/// A primitive by its accessors: POSITION, NORMAL, indices (-1: none) and its drawing mode.
using PrimitiveKey = std::tuple<int, int, int, int>;

/// What a mesh of the file became.
struct ImportedMesh {
    std::optional<uint32_t> object;   ///< none if the mesh has no triangles
    std::vector<uint32_t> materials;  ///< one a group
};

/// A light met in the node tree, before brightnesses are known.
struct PlacedLight {
    std::string name;
    DAffine world_from_node;
    const tinygltf::Light* light = nullptr;
};

/// A part of the node tree that an animated node carries along.
struct Carrier {
    uint32_t node = kNoId;             ///< of Animation::nodes; kNoId: nothing moves
    std::optional<DAffine> from_node;  ///< the parent's frame in the carrier's; none: the same
};

struct Importer {
    explicit Importer(const tinygltf::Model& source) : model(source) {}

    const tinygltf::Model& model;
    bool ours = false;  ///< written by write_gltf
    Scene scene;
    std::vector<std::string> notes;
    std::vector<ImportedMesh> meshes;
    std::vector<PlacedLight> lights;
    std::vector<bool> is_animated;  ///< one a node of the file
    /// One a node of the file: its place in Animation::nodes, or kNoId.
    std::vector<uint32_t> animated_nodes;
    /// Those whose place at rest is to be computed.
    std::vector<CarriedInstance> placed_by_carrier;
    std::vector<uint32_t> stated_nodes;      ///< see stated_place; one an animated node
    std::vector<uint32_t> stated_instances;  ///< likewise; one an instance
    std::optional<uint32_t> default_material;
    uint64_t dropped_primitives = 0;
    uint64_t morphed_primitives = 0;
    uint64_t orthographic_cameras = 0;
    uint64_t still_cameras = 0;  ///< under an animated node
    uint64_t still_lights = 0;
};

[[noreturn]] void throw_broken(const std::string& where, const std::string& got,
                               const std::string& expected) {
    throw Error({where, got, expected, "Export the file again."});
}

std::string label(const char* kind, size_t index, const std::string& name) {
    return name.empty() ? fmt::format("{} {}", kind, index)
                        : fmt::format("{} {} ('{}')", kind, index, clean_text(name));
}

void check_index(int index, size_t count, const std::string& where, const char* kind) {
    if (index >= 0 && static_cast<size_t>(index) < count) return;
    throw_broken(where, fmt::format("{} {}", kind, index),
                 fmt::format("one of the file's {}", count));
}

void add_note(Importer& in, uint64_t count, const char* singular, const char* plural,
              const char* what) {
    if (count > 0) in.notes.push_back(fmt::format("{} {}", counted(count, singular, plural), what));
}

// ---- Extras ----

/// Our entry of an `extras`; nothing if it has none.
const tinygltf::Value* our_extras(const tinygltf::Value& extras) {
    return extras.Has(kExtrasKey) ? &extras.Get(kExtrasKey) : nullptr;
}

float float_value(const tinygltf::Value& value, const std::string& where) {
    if (!value.IsNumber()) throw_broken(where, "something else", "a number");
    return static_cast<float>(value.GetNumberAsDouble());
}

vec3 vec3_value(const tinygltf::Value& value, const std::string& where) {
    if (value.ArrayLen() != 3) throw_broken(where, "something else", "three numbers");
    return vec3(float_value(value.Get(0), where), float_value(value.Get(1), where),
                float_value(value.Get(2), where));
}

// ---- Parsing ----

/// Images are not part of the scene model: they are neither decoded nor missed.
bool ignore_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
                  int, void*) {
    return true;
}

/// Extensions that change how something looks may be ignored; those that change how a file is to be
/// read may not.
void check_required_extensions(const tinygltf::Model& model) {
    for (const std::string& name : model.extensionsRequired) {
        if (name == "KHR_lights_punctual" || name.starts_with("KHR_materials_") ||
            name.starts_with("KHR_texture_") || name.starts_with("EXT_texture_")) {
            continue;
        }
        throw Error({"extensionsRequired", clean_text(name),
                     "KHR_lights_punctual, or extensions of materials and textures",
                     "Export without compression, quantization and other extensions."});
    }
}

/// What tinygltf leaves out of a file that it takes, it says as errors: those become notes.
tinygltf::Model parse(const std::filesystem::path& path, bool binary,
                      std::vector<std::string>& notes) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(ignore_image, nullptr);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool loaded = binary ? parser.LoadBinaryFromFile(&model, &error, &warning, path.string())
                               : parser.LoadASCIIFromFile(&model, &error, &warning, path.string());
    check_required_extensions(model);  // first, since they are why tinygltf may refuse the file
    if (!loaded) {
        throw Error({"", "a file that tinygltf refuses: " + clean_text(error),
                     "a complete glTF 2.0 file", "Export it again, with all of its files."});
    }
    if (!error.empty()) notes.push_back("tinygltf left something out: " + clean_text(error));
    return model;
}

// ---- Materials ----

/// The Phong reading of a physically based material. Shininess inverts roughness =
/// sqrt(2 / (shininess + 2)). A foreign file has no Phong highlight and no mirrors: smooth surfaces
/// get a highlight, and a metal mirrors as far as it is smooth (glTF's default is a rough metal).
Material foreign_material(const tinygltf::Material& source, const vec3& diffuse) {
    constexpr double kLeastRoughness = 0.05;  // a shininess of 798
    const double roughness =
        std::clamp(source.pbrMetallicRoughness.roughnessFactor, kLeastRoughness, 1.0);
    const double metallic = std::clamp(source.pbrMetallicRoughness.metallicFactor, 0.0, 1.0);
    Material material;
    material.diffuse = glm::clamp(diffuse, vec3(0), vec3(1));
    material.specular = vec3(static_cast<float>(0.5 * (1.0 - roughness)));
    material.shininess = static_cast<float>(2.0 / (roughness * roughness) - 2.0);
    material.reflectivity = static_cast<float>(metallic * (1.0 - roughness));
    return material;
}

void read_materials(Importer& in) {
    uint64_t textured = 0;
    for (size_t i = 0; i < in.model.materials.size(); ++i) {
        const tinygltf::Material& source = in.model.materials[i];
        const std::string where = label("material", i, source.name);
        const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
        if (pbr.baseColorTexture.index >= 0) ++textured;
        if (pbr.baseColorFactor.size() != 4) {
            throw_broken(where, fmt::format("{} base colour numbers", pbr.baseColorFactor.size()),
                         "4");
        }
        const vec3 diffuse(
            dvec3(pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2]));
        Material material;
        if (const tinygltf::Value* extras = our_extras(source.extras)) {
            material.diffuse = diffuse;
            material.specular = vec3_value(extras->Get("specular"), where + ", specular");
            material.shininess = float_value(extras->Get("shininess"), where + ", shininess");
            material.reflectivity = static_cast<float>(pbr.metallicFactor);
        } else {
            material = foreign_material(source, diffuse);
        }
        material.name = source.name;
        in.scene.materials.push_back(std::move(material));
    }
    add_note(in, textured, "texture", "textures", "of base colours ignored");
}

uint32_t material_index(Importer& in, int index, const std::string& where) {
    if (index >= 0) {
        check_index(index, in.model.materials.size(), where, "material");
        return static_cast<uint32_t>(index);
    }
    if (!in.default_material) {
        in.default_material = static_cast<uint32_t>(in.scene.materials.size());
        Material material;
        material.name = "default";
        in.scene.materials.push_back(material);
        in.notes.push_back("no material on some primitives: default one");
    }
    return *in.default_material;
}

// ---- Meshes ----

bool is_triangle_mode(int mode) {
    return mode == -1 || mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

std::vector<uvec3> assemble_triangles(const std::vector<uint32_t>& indices, int mode,
                                      const std::string& where) {
    const size_t n = indices.size();
    std::vector<uvec3> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (size_t i = 0; i + 2 < n; ++i) {  // every other triangle is turned round
            triangles.emplace_back(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
        }
    } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        for (size_t i = 0; i + 2 < n; ++i) {
            triangles.emplace_back(indices[i + 1], indices[i + 2], indices[0]);
        }
    } else {
        if (n % 3 != 0) throw_broken(where, fmt::format("{} indices", n), "a multiple of 3");
        triangles.reserve(n / 3);
        for (size_t i = 0; i < n; i += 3) {
            triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
        }
    }
    return triangles;
}

int attribute(const tinygltf::Primitive& primitive, const char* name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

PrimitiveKey primitive_key(const tinygltf::Primitive& primitive) {
    return {attribute(primitive, "POSITION"), attribute(primitive, "NORMAL"), primitive.indices,
            primitive.mode};
}

VertexSet read_vertices(const tinygltf::Model& model, int positions, int normals,
                        const std::string& where) {
    VertexSet set;
    set.positions = read_vec3_accessor(model, positions, where + ", POSITION");
    if (normals < 0) return set;
    set.normals = read_vec3_accessor(model, normals, where + ", NORMAL");
    if (set.normals.size() != set.positions.size()) {
        throw_broken(where, fmt::format("{} normals", set.normals.size()),
                     fmt::format("one for each of {} positions", set.positions.size()));
    }
    return set;
}

std::string group_name(const Importer& in, const tinygltf::Primitive& primitive) {
    if (const tinygltf::Value* extras = our_extras(primitive.extras)) {
        const tinygltf::Value& name = extras->Get("name");
        return name.IsString() ? name.Get<std::string>() : std::string();
    }
    const bool named_by_material =
        !in.ours && primitive.material >= 0 &&
        static_cast<size_t>(primitive.material) < in.model.materials.size();
    return named_by_material ? in.model.materials[static_cast<size_t>(primitive.material)].name
                             : std::string();
}

/// A primitive and its place in the file.
using PlacedPrimitive = std::pair<const tinygltf::Primitive*, std::string>;

/// False for points, lines, and too few vertices. Accessors are checked later, when they are read.
bool has_triangles(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    if (!is_triangle_mode(primitive.mode)) return false;
    const int positions = attribute(primitive, "POSITION");
    if (positions < 0) return false;
    const auto accessor =
        static_cast<size_t>(primitive.indices >= 0 ? primitive.indices : positions);
    return accessor >= model.accessors.size() || model.accessors[accessor].count >= 3;
}

std::vector<PlacedPrimitive> triangle_primitives(Importer& in, const tinygltf::Mesh& mesh,
                                                 const std::string& where) {
    std::vector<PlacedPrimitive> result;
    for (size_t p = 0; p < mesh.primitives.size(); ++p) {
        const tinygltf::Primitive& primitive = mesh.primitives[p];
        if (!has_triangles(in.model, primitive)) {
            ++in.dropped_primitives;
            continue;
        }
        if (!primitive.targets.empty()) ++in.morphed_primitives;
        result.emplace_back(&primitive, fmt::format("{}, primitive {}", where, p));
    }
    return result;
}

Object read_object(const Importer& in, const tinygltf::Mesh& mesh,
                   const std::vector<PlacedPrimitive>& primitives) {
    std::map<std::pair<int, int>, size_t> set_of_accessors;
    std::vector<VertexSet> sets;
    std::vector<MeshPart> parts;
    for (const auto& [primitive, where] : primitives) {
        // Primitives that share their vertices in the file share them here.
        const std::pair accessors(attribute(*primitive, "POSITION"),
                                  attribute(*primitive, "NORMAL"));
        const auto [known, is_new] = set_of_accessors.try_emplace(accessors, sets.size());
        if (is_new) {
            sets.push_back(read_vertices(in.model, accessors.first, accessors.second, where));
        }

        std::vector<uint32_t> indices;
        if (primitive->indices >= 0) {
            indices = read_index_accessor(in.model, primitive->indices, where + ", indices");
        } else {
            indices.resize(sets[known->second].positions.size());
            for (size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<uint32_t>(i);
        }
        parts.push_back({group_name(in, *primitive), where, known->second,
                         assemble_triangles(indices, primitive->mode, where)});
    }
    return build_object(mesh.name, std::move(sets), std::move(parts));
}

void read_meshes(Importer& in) {
    std::map<std::vector<PrimitiveKey>, uint32_t> known_objects;
    uint64_t empty_meshes = 0;
    uint64_t repaired_normals = 0;
    for (size_t m = 0; m < in.model.meshes.size(); ++m) {
        const tinygltf::Mesh& mesh = in.model.meshes[m];
        const std::vector<PlacedPrimitive> primitives =
            triangle_primitives(in, mesh, label("mesh", m, mesh.name));
        ImportedMesh imported;
        if (primitives.empty()) {
            ++empty_meshes;
            in.meshes.push_back(imported);
            continue;
        }

        // The object: a new one, unless an earlier mesh had the same accessors.
        std::vector<PrimitiveKey> key;
        for (const auto& [primitive, where] : primitives) key.push_back(primitive_key(*primitive));
        const auto next = static_cast<uint32_t>(in.scene.objects.size());
        const auto [known, is_new] = known_objects.try_emplace(key, next);
        if (is_new) {
            Object object = read_object(in, mesh, primitives);
            repaired_normals += repair_normals(object);
            in.scene.objects.push_back(std::move(object));
        }

        imported.object = known->second;
        for (const auto& [primitive, where] : primitives) {
            imported.materials.push_back(material_index(in, primitive->material, where));
        }
        in.meshes.push_back(std::move(imported));
    }
    add_note(in, empty_meshes, "mesh", "meshes", "without triangles left out");
    add_note(in, repaired_normals, "normal", "normals", "of length 0 replaced");
    add_note(in, in.dropped_primitives, "primitive", "primitives", "without triangles left out");
    add_note(in, in.morphed_primitives, "primitive", "primitives", "taken without morph targets");
}

// ---- Nodes ----

void check_length(const std::vector<double>& numbers, size_t length, const std::string& where) {
    if (numbers.empty() || numbers.size() == length) return;
    throw_broken(where, fmt::format("{} numbers", numbers.size()), fmt::format("{}", length));
}

DAffine parent_from_node(const tinygltf::Node& node, const std::string& where) {
    check_length(node.matrix, 16, where + ", matrix");
    check_length(node.translation, 3, where + ", translation");
    check_length(node.rotation, 4, where + ", rotation");
    check_length(node.scale, 3, where + ", scale");
    if (!node.matrix.empty()) {
        const std::vector<double>& m = node.matrix;
        if (m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] != 1.0) {
            throw_broken(where + ", matrix",
                         fmt::format("a last row of {}, {}, {}, {}", m[3], m[7], m[11], m[15]),
                         "0, 0, 0, 1");
        }
        return DAffine(dvec3(m[0], m[1], m[2]), dvec3(m[4], m[5], m[6]), dvec3(m[8], m[9], m[10]),
                       dvec3(m[12], m[13], m[14]));
    }
    glm::dmat3 linear(1.0);
    if (!node.rotation.empty()) {
        const std::vector<double>& q = node.rotation;
        linear = rotation_matrix(glm::dvec4(q[0], q[1], q[2], q[3]));
    }
    for (int axis = 0; axis < 3 && !node.scale.empty(); ++axis) {
        linear[axis] *= node.scale[static_cast<size_t>(axis)];
    }
    dvec3 translation(0.0);
    if (!node.translation.empty()) {
        translation = dvec3(node.translation[0], node.translation[1], node.translation[2]);
    }
    return DAffine(linear[0], linear[1], linear[2], translation);
}

/// A map from a parent's frame, and one below it. Without the first, the second is taken as it
/// stands: multiplying by 1 would turn -0 into 0.
DAffine composed(const std::optional<DAffine>& parent, const DAffine& b) {
    if (!parent) return b;
    const DAffine& a = *parent;
    return DAffine(transform_vector(a, b[0]), transform_vector(a, b[1]), transform_vector(a, b[2]),
                   transform_point(a, b[3]));
}

int light_index(const tinygltf::Node& node) {
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end() || !extension->second.Has("light")) return -1;
    return extension->second.Get("light").GetNumberAsInt();
}

void read_camera(Importer& in, const tinygltf::Node& node, const DAffine& world_from_node,
                 const std::string& where) {
    check_index(node.camera, in.model.cameras.size(), where, "camera");
    const tinygltf::Camera& source = in.model.cameras[static_cast<size_t>(node.camera)];
    if (source.type != "perspective") {
        ++in.orthographic_cameras;
        return;
    }
    Camera camera;
    camera.name = source.name.empty() ? node.name : source.name;
    camera.world_from_camera = Affine(world_from_node);
    camera.vertical_fov = static_cast<float>(source.perspective.yfov);
    in.scene.cameras.push_back(camera);
}

/// The place that our writer states of an instance or an animated node; kNoId if it states none.
uint32_t stated_place(const tinygltf::Node& node, const char* key) {
    const tinygltf::Value* extras = our_extras(node.extras);
    if (extras == nullptr || !extras->Get(key).IsInt()) return kNoId;
    return static_cast<uint32_t>(extras->Get(key).GetNumberAsInt());
}

/// The node's place in Animation::nodes, whose parent is the carrier's.
uint32_t add_animated_node(Importer& in, const tinygltf::Node& node, const Carrier& carrier,
                           const std::string& where) {
    if (!node.matrix.empty()) {
        throw_broken(where, "an animation of a node with a matrix",
                     "an animated node with translation, rotation and scale");
    }
    AnimatedNode animated;
    animated.name = node.name;
    animated.parent = carrier.node;
    if (carrier.from_node) animated.parent_from_base = Affine(*carrier.from_node);
    const auto number = [](const std::vector<double>& numbers, int i) {
        return static_cast<float>(numbers[static_cast<size_t>(i)]);
    };
    for (int i = 0; i < 3; ++i) {
        if (!node.translation.empty()) animated.translation[i] = number(node.translation, i);
        if (!node.scale.empty()) animated.scale[i] = number(node.scale, i);
    }
    for (int i = 0; i < 4 && !node.rotation.empty(); ++i) {
        animated.rotation[i] = number(node.rotation, i);
    }
    in.scene.animation.nodes.push_back(std::move(animated));
    in.stated_nodes.push_back(stated_place(node, kNodePlaceKey));
    return static_cast<uint32_t>(in.scene.animation.nodes.size()) - 1;
}

/// Notes that the instance is carried. Where it stands at rest is known once all nodes are read,
/// unless our writer says it, because it differs by a rounding.
void add_carried(Importer& in, const tinygltf::Node& node, uint32_t instance,
                 const Carrier& carrier, const std::string& where) {
    CarriedInstance carried{.instance = instance, .node = carrier.node};
    if (carrier.from_node) carried.node_from_object = Affine(*carrier.from_node);
    in.scene.animation.carried.push_back(carried);

    const tinygltf::Value* extras = our_extras(node.extras);
    if (extras == nullptr || !extras->Has(kRestTransformKey)) {
        in.placed_by_carrier.push_back(carried);
        return;
    }
    const tinygltf::Value& numbers = extras->Get(kRestTransformKey);
    const std::string numbers_label = where + ", " + kRestTransformKey;
    if (numbers.ArrayLen() != 12) throw_broken(numbers_label, "something else", "12 numbers");
    Affine& stated = in.scene.instances[instance].world_from_object;
    for (int i = 0; i < 12; ++i) stated[i / 3][i % 3] = float_value(numbers.Get(i), numbers_label);
}

/// `world_from_node` is the node's at rest; `carrier` is what carries the node itself along.
void read_node(Importer& in, const tinygltf::Node& node, const DAffine& world_from_node,
               const Carrier& carrier, const std::string& where) {
    const bool is_carried = carrier.node != kNoId;
    if (node.mesh >= 0) {
        check_index(node.mesh, in.meshes.size(), where, "mesh");
        const ImportedMesh& mesh = in.meshes[static_cast<size_t>(node.mesh)];
        if (mesh.object) {
            const auto instance = static_cast<uint32_t>(in.scene.instances.size());
            in.scene.instances.push_back(
                {node.name, *mesh.object, Affine(world_from_node), mesh.materials});
            in.stated_instances.push_back(stated_place(node, kInstancePlaceKey));
            if (is_carried) add_carried(in, node, instance, carrier, where);
        }
    }
    if (node.camera >= 0) {
        read_camera(in, node, world_from_node, where);
        in.still_cameras += is_carried;
    }
    if (const int light = light_index(node); light >= 0) {
        check_index(light, in.model.lights.size(), where, "light");
        const tinygltf::Light& source = in.model.lights[static_cast<size_t>(light)];
        in.lights.push_back(
            {source.name.empty() ? node.name : source.name, world_from_node, &source});
        in.still_lights += is_carried;
    }
}

/// The root nodes of the scene that is shown by default.
std::vector<int> root_nodes(Importer& in) {
    const tinygltf::Model& model = in.model;
    if (!model.scenes.empty()) {
        const int index = std::max(model.defaultScene, 0);
        check_index(index, model.scenes.size(), "scene", "scene");
        if (model.scenes.size() > 1) {
            in.notes.push_back(fmt::format("scene {} of {} taken", index, model.scenes.size()));
        }
        return model.scenes[static_cast<size_t>(index)].nodes;
    }
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes) {
        for (int child : node.children) {
            check_index(child, model.nodes.size(), "nodes", "child node");
            is_child[static_cast<size_t>(child)] = true;
        }
    }
    std::vector<int> roots;
    for (size_t i = 0; i < is_child.size(); ++i) {
        if (!is_child[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

/// Depth first, children in order, on a stack of our own: files may nest deeper than ours reaches.
void read_nodes(Importer& in) {
    struct Visit {
        int node;
        std::optional<DAffine> world_from_parent;  ///< at rest
        Carrier carrier;                           ///< of the parent's frame
    };
    std::vector<Visit> stack;
    const std::vector<int> roots = root_nodes(in);
    for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
        stack.push_back({*root, {}, {}});
    }

    std::vector<bool> visited(in.model.nodes.size(), false);
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        check_index(visit.node, in.model.nodes.size(), "nodes", "node");
        const auto index = static_cast<size_t>(visit.node);
        const tinygltf::Node& node = in.model.nodes[index];
        const std::string where = label("node", index, node.name);
        if (visited[index]) {
            throw_broken(where, "a node that is reached twice, or is its own descendant",
                         "a tree: every node below one parent at most");
        }
        visited[index] = true;

        const DAffine local = parent_from_node(node, where);
        const DAffine world = composed(visit.world_from_parent, local);
        Carrier carrier{visit.carrier.node, composed(visit.carrier.from_node, local)};
        if (in.is_animated[index]) {
            carrier = {add_animated_node(in, node, visit.carrier, where), {}};
            in.animated_nodes[index] = carrier.node;
        }
        read_node(in, node, world, carrier, where);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
            stack.push_back({*child, world, carrier});
        }
    }
    add_note(in, in.orthographic_cameras, "orthographic camera", "orthographic cameras",
             "left out");
}

// ---- Animation ----

std::optional<AnimationChannel::Path> path_of(const std::string& name) {
    if (name == "translation") return AnimationChannel::Path::translation;
    if (name == "rotation") return AnimationChannel::Path::rotation;
    if (name == "scale") return AnimationChannel::Path::scale;
    return {};
}

AnimationChannel::Interpolation interpolation_of(const std::string& name,
                                                 const std::string& where) {
    if (name == "LINEAR") return AnimationChannel::Interpolation::linear;
    if (name == "STEP") return AnimationChannel::Interpolation::step;
    if (name == "CUBICSPLINE") return AnimationChannel::Interpolation::cubic_spline;
    throw_broken(where, "the interpolation '" + clean_text(name) + "'",
                 "LINEAR, STEP or CUBICSPLINE");
}

/// Finds which nodes move, before the tree is read: those that a channel of the first animation
/// aims at, and those that our writer marks.
void find_animated_nodes(Importer& in) {
    const tinygltf::Model& model = in.model;
    in.is_animated.assign(model.nodes.size(), false);
    in.animated_nodes.assign(model.nodes.size(), kNoId);
    if (model.animations.empty()) return;
    for (const tinygltf::AnimationChannel& channel : model.animations[0].channels) {
        if (!path_of(channel.target_path)) continue;
        check_index(channel.target_node, model.nodes.size(),
                    label("animation", 0, model.animations[0].name), "target node");
        in.is_animated[static_cast<size_t>(channel.target_node)] = true;
    }
    for (size_t i = 0; i < model.nodes.size() && in.ours; ++i) {
        if (stated_place(model.nodes[i], kNodePlaceKey) != kNoId) in.is_animated[i] = true;
    }
}

AnimationChannel read_channel(const Importer& in, const tinygltf::Animation& animation,
                              const tinygltf::AnimationChannel& source, const std::string& where) {
    check_index(source.sampler, animation.samplers.size(), where, "sampler");
    const tinygltf::AnimationSampler& sampler =
        animation.samplers[static_cast<size_t>(source.sampler)];
    AnimationChannel channel;
    channel.node = in.animated_nodes[static_cast<size_t>(source.target_node)];
    channel.path = *path_of(source.target_path);
    channel.interpolation = interpolation_of(sampler.interpolation, where);
    channel.times = read_scalar_accessor(in.model, sampler.input, where + ", input");
    if (channel.path == AnimationChannel::Path::rotation) {
        channel.values = read_rotation_accessor(in.model, sampler.output, where + ", output");
        return channel;
    }
    for (const vec3& v : read_vec3_accessor(in.model, sampler.output, where + ", output")) {
        channel.values.emplace_back(v, 0.0f);
    }
    return channel;
}

void read_channels(Importer& in) {
    const tinygltf::Animation& animation = in.model.animations[0];
    uint64_t morphs = 0, others = 0, outside = 0;
    for (size_t c = 0; c < animation.channels.size(); ++c) {
        const tinygltf::AnimationChannel& source = animation.channels[c];
        if (!path_of(source.target_path)) {
            ++(source.target_path == "weights" ? morphs : others);
        } else if (in.animated_nodes[static_cast<size_t>(source.target_node)] == kNoId) {
            ++outside;
        } else {
            const std::string where =
                fmt::format("{}, channel {}", label("animation", 0, animation.name), c);
            in.scene.animation.channels.push_back(read_channel(in, animation, source, where));
        }
    }
    add_note(in, morphs, "animation channel", "animation channels", "of morph targets ignored");
    add_note(in, others, "animation channel", "animation channels", "of other properties ignored");
    add_note(in, outside, "animation channel", "animation channels",
             "of nodes outside the scene ignored");
}

/// Brings items to the places that our writer stated. Foreign files state none, and keep the order
/// of their tree.
template <class T>
void reorder(std::vector<T>& items, std::vector<uint32_t>& places, const char* kind) {
    if (std::all_of(places.begin(), places.end(), [](uint32_t p) { return p == kNoId; })) {
        for (size_t i = 0; i < places.size(); ++i) places[i] = static_cast<uint32_t>(i);
        return;
    }
    std::vector<bool> taken(items.size(), false);
    std::vector<T> ordered(items.size());
    for (size_t i = 0; i < items.size(); ++i) {
        if (places[i] >= items.size() || taken[places[i]]) {
            throw_broken(
                fmt::format("extras of {} {}", kind, i),
                places[i] == kNoId ? std::string("no place") : fmt::format("place {}", places[i]),
                fmt::format("another place below {} for each", items.size()));
        }
        taken[places[i]] = true;
        ordered[places[i]] = std::move(items[i]);
    }
    items = std::move(ordered);
}

void read_animation(Importer& in) {
    Animation& animation = in.scene.animation;
    const std::vector<tinygltf::Animation>& sources = in.model.animations;
    if (sources.empty()) return;

    // Where carried instances stand at rest.
    const std::vector<DAffine> nodes = rest_transforms(animation);
    for (const CarriedInstance& carried : in.placed_by_carrier) {
        in.scene.instances[carried.instance].world_from_object =
            carried_transform(nodes[carried.node], carried.node_from_object);
    }

    // Our own order.
    read_channels(in);
    reorder(in.scene.instances, in.stated_instances, "instance");
    reorder(animation.nodes, in.stated_nodes, "animated node");
    for (AnimatedNode& node : animation.nodes) {
        if (node.parent != kNoId) node.parent = in.stated_nodes[node.parent];
    }
    for (AnimationChannel& channel : animation.channels) {
        channel.node = in.stated_nodes[channel.node];
    }
    for (CarriedInstance& carried : animation.carried) {
        carried = {in.stated_instances[carried.instance], in.stated_nodes[carried.node],
                   carried.node_from_object};
    }
    std::sort(
        animation.carried.begin(), animation.carried.end(),
        [](const CarriedInstance& a, const CarriedInstance& b) { return a.instance < b.instance; });

    // What is left out.
    animation.name = sources[0].name;
    if (animation.channels.empty() || animation.carried.empty()) {
        animation = {};
        in.notes.push_back(label("animation", 0, sources[0].name) + " moves no mesh: ignored");
    }
    add_note(in, sources.size() - 1, "animation", "animations", "after the first ignored");
    add_note(in, in.still_cameras, "camera", "cameras", "of moving nodes stand still here");
    add_note(in, in.still_lights, "light", "lights", "of moving nodes stand still here");
}

// ---- Lights ----

dvec3 brightness(const tinygltf::Light& light, const std::string& where) {
    check_length(light.color, 3, where + ", color");
    const dvec3 color =
        light.color.empty() ? dvec3(1) : dvec3(light.color[0], light.color[1], light.color[2]);
    return color * light.intensity;
}

/// Lights of `directional` kind or not, as point lights. A foreign file's candela and lux are
/// scaled so that the brightest channel of the kind is 1: the shading model knows no falloff.
void add_lights(Importer& in, bool directional) {
    std::vector<const PlacedLight*> chosen;
    double brightest = 0.0;
    for (const PlacedLight& placed : in.lights) {
        if ((placed.light->type == "directional") != directional) continue;
        chosen.push_back(&placed);
        const dvec3 b = brightness(*placed.light, "light '" + placed.name + "'");
        brightest = std::max({brightest, b.x, b.y, b.z});
    }
    const bool rescale = !in.ours && brightest > 0.0 && brightest != 1.0;

    // A directional light is moved this far, in diagonals of the scene, against its direction.
    constexpr float kDistance = 100.0f;
    const Bounds bounds = scene_bounds(in.scene);
    for (const PlacedLight* placed : chosen) {
        PointLight light;
        light.name = placed->name;
        light.intensity =
            vec3(brightness(*placed->light, placed->name) / (rescale ? brightest : 1.0));
        light.position = vec3(placed->world_from_node[3]);
        if (directional) {
            const vec3 towards_light(glm::normalize(placed->world_from_node[2]));
            light.position = bounds.centre() + towards_light * (kDistance * bounds.diagonal());
        }
        in.scene.lights.push_back(light);
    }

    if (directional) {
        add_note(in, chosen.size(), "directional light", "directional lights",
                 "replaced by a point light 100 scene diagonals away");
    }
    if (rescale) {
        in.notes.push_back(
            fmt::format("{} divided by {:.6g}, so that the brightest channel is 1 (lights have no "
                        "falloff here)",
                        directional ? "directional lights" : "point and spot lights", brightest));
    }
}

void read_lights(Importer& in) {
    const auto spots = std::count_if(in.lights.begin(), in.lights.end(),
                                     [](const PlacedLight& l) { return l.light->type == "spot"; });
    add_note(in, static_cast<uint64_t>(spots), "spot light", "spot lights",
             "taken as point lights");
    add_lights(in, false);
    add_lights(in, true);
}

// ---- The scene ----

/// Name, and what only our own files say; returns whether this is one.
bool read_scene_extras(const tinygltf::Model& model, Scene& scene) {
    if (model.scenes.empty()) return false;
    const int last = static_cast<int>(model.scenes.size()) - 1;
    const tinygltf::Scene& source =
        model.scenes[static_cast<size_t>(std::clamp(model.defaultScene, 0, last))];
    scene.name = source.name;
    const tinygltf::Value* extras = our_extras(source.extras);
    if (extras == nullptr) return false;
    if (const double version = float_value(extras->Get("version"), "scene, version");
        version != kExtrasVersion) {
        throw Error({"scene", fmt::format("extras of version {}", version),
                     fmt::format("version {}", kExtrasVersion),
                     "Read the file with the release that wrote it."});
    }
    scene.background = vec3_value(extras->Get("background"), "scene, background");
    scene.ambient = vec3_value(extras->Get("ambient"), "scene, ambient");
    return true;
}

}  // namespace

LoadedScene read_gltf(const std::filesystem::path& path) {
    std::vector<std::string> notes;
    const tinygltf::Model model = parse(path, scene_extension(path) == ".glb", notes);
    Importer in(model);
    in.notes = std::move(notes);
    in.ours = read_scene_extras(model, in.scene);
    read_materials(in);
    read_meshes(in);
    find_animated_nodes(in);
    read_nodes(in);
    read_animation(in);
    read_lights(in);
    if (in.scene.materials.empty()) in.scene.materials.push_back(Material{});
    add_note(in, model.skins.size(), "skin", "skins", "ignored");
    return {std::move(in.scene), std::move(in.notes)};
}

}  // namespace onepass
