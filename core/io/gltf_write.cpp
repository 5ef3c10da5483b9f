// The glTF 2.0 writer. What it writes reads back as an equal scene, bit by bit.
//
// Mesh k is object k, with the materials of its first instance; further meshes share the accessors
// of one of those and differ in materials only, because glTF puts materials on primitives. Numbers
// survive JSON because a float becomes a double exactly, and the shortest text of a double reads
// back as that double. Sheared instances are written as `matrix` too, although glTF asks for
// matrices that decompose into translation, rotation and scale. In an animated scene nodes state
// the places of their instances and animated nodes, because a tree has an order of its own.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"
#include "core/io/formats.h"
#include "core/io/gltf_extras.h"
#include "core/io/import.h"

namespace onepass {
namespace {

using tinygltf::Value;

// ---- Values ----

std::vector<double> numbers(const vec3& v) { return {v.x, v.y, v.z}; }

Value value(const vec3& v) {
    return Value(Value::Array{Value(double{v.x}), Value(double{v.y}), Value(double{v.z})});
}

Value our_extras(Value::Object members) {
    return Value(Value::Object{{kExtrasKey, Value(std::move(members))}});
}

std::vector<double> matrix_numbers(const Affine& m) {
    std::vector<double> result;
    for (int column = 0; column < 4; ++column) {
        result.insert(result.end(),
                      {m[column].x, m[column].y, m[column].z, column == 3 ? 1.0 : 0.0});
    }
    return result;
}

// ---- Meshes ----

/// Appends the bytes as a new buffer view, whose index is returned.
template <class T>
int add_view(tinygltf::Model& model, const std::vector<T>& elements, int target) {
    static_assert(sizeof(T) % sizeof(uint32_t) == 0);  // so views stay aligned to 4 bytes
    std::vector<unsigned char>& data = model.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = elements.size() * sizeof(T);
    view.target = target;
    data.resize(data.size() + view.byteLength);
    std::memcpy(data.data() + view.byteOffset, elements.data(), view.byteLength);
    model.bufferViews.push_back(view);
    return static_cast<int>(model.bufferViews.size()) - 1;
}

int add_accessor(tinygltf::Model& model, tinygltf::Accessor accessor) {
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size()) - 1;
}

int add_vectors(tinygltf::Model& model, const std::vector<vec3>& vectors) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(model, vectors, TINYGLTF_TARGET_ARRAY_BUFFER);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = TINYGLTF_TYPE_VEC3;
    accessor.count = vectors.size();
    Bounds bounds;
    for (const vec3& v : vectors) bounds.extend(v);
    accessor.minValues = numbers(bounds.lower);
    accessor.maxValues = numbers(bounds.upper);
    return add_accessor(model, accessor);
}

/// Mesh k: the accessors and groups of object k; materials are set later.
void add_mesh(tinygltf::Model& model, const Object& object) {
    tinygltf::Mesh mesh;
    mesh.name = object.name;
    const int positions = add_vectors(model, object.positions);
    const int normals = object.normals.empty() ? -1 : add_vectors(model, object.normals);
    const int view = add_view(model, object.triangles, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    for (const TriangleGroup& group : object.groups) {
        tinygltf::Accessor indices;
        indices.bufferView = view;
        indices.byteOffset = group.first_triangle * sizeof(uvec3);
        indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        indices.type = TINYGLTF_TYPE_SCALAR;
        indices.count = size_t{group.triangle_count} * 3;

        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.attributes["POSITION"] = positions;
        if (normals >= 0) primitive.attributes["NORMAL"] = normals;
        primitive.indices = add_accessor(model, indices);
        primitive.material = 0;
        if (!group.name.empty()) primitive.extras = our_extras({{"name", Value(group.name)}});
        mesh.primitives.push_back(std::move(primitive));
    }
    model.meshes.push_back(std::move(mesh));
}

void set_materials(tinygltf::Mesh& mesh, const std::vector<uint32_t>& materials) {
    for (size_t g = 0; g < materials.size(); ++g) {
        mesh.primitives[g].material = static_cast<int>(materials[g]);
    }
}

// ---- Nodes ----

constexpr int kRoot = -1;

/// Puts a node below node `parent` of the file, or at the root, and returns its index.
int add_node(tinygltf::Model& model, tinygltf::Node node, int parent = kRoot) {
    const auto added = static_cast<int>(model.nodes.size());
    model.nodes.push_back(std::move(node));
    std::vector<int>& siblings =
        parent == kRoot ? model.scenes[0].nodes : model.nodes[static_cast<size_t>(parent)].children;
    siblings.push_back(added);
    return added;
}

bool same_bits(const Affine& a, const Affine& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

/// A node for each animated one, under one more for its base where that is not the identity.
/// Returns their indices in the file.
std::vector<int> add_animated_nodes(tinygltf::Model& model, const Animation& animation) {
    std::vector<int> added;
    for (size_t i = 0; i < animation.nodes.size(); ++i) {
        const AnimatedNode& source = animation.nodes[i];
        int parent = source.parent == kNoId ? kRoot : added[source.parent];
        if (!same_bits(source.parent_from_base, affine_identity())) {
            tinygltf::Node base;
            base.matrix = matrix_numbers(source.parent_from_base);
            parent = add_node(model, std::move(base), parent);
        }
        const vec4& q = source.rotation;
        tinygltf::Node node;
        node.name = source.name;
        node.translation = numbers(source.translation);
        node.rotation = {q.x, q.y, q.z, q.w};
        node.scale = numbers(source.scale);
        node.extras = our_extras({{kNodePlaceKey, Value(static_cast<int>(i))}});
        added.push_back(add_node(model, std::move(node), parent));
    }
    return added;
}

/// Puts an instance's node under the animated node that carries it.
void add_carried(tinygltf::Model& model, const CarriedInstance& carried, const DAffine& rest,
                 const Instance& instance, int parent, tinygltf::Node node) {
    Value::Object extras = {{kInstancePlaceKey, Value(static_cast<int>(carried.instance))}};
    const Affine at_rest = carried_transform(rest, carried.node_from_object);
    if (!same_bits(at_rest, instance.world_from_object)) {
        Value::Array values;
        for (int i = 0; i < 12; ++i) {
            values.push_back(Value(double{instance.world_from_object[i / 3][i % 3]}));
        }
        extras[kRestTransformKey] = Value(std::move(values));
    }
    node.matrix.clear();
    if (!same_bits(carried.node_from_object, affine_identity())) {
        node.matrix = matrix_numbers(carried.node_from_object);
    }
    node.extras = our_extras(std::move(extras));
    add_node(model, std::move(node), parent);
}

/// `animated`: where the animated nodes stand in the file.
void add_instances(tinygltf::Model& model, const Scene& scene, const std::vector<int>& animated) {
    std::map<std::pair<uint32_t, std::vector<uint32_t>>, int> mesh_of;
    std::vector<bool> used(scene.objects.size(), false);
    const std::vector<DAffine> rest = rest_transforms(scene.animation);
    auto next_carried = scene.animation.carried.begin();
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        // One mesh for each pair of object and materials; the object's own mesh for the first.
        const auto next = static_cast<int>(model.meshes.size());
        const auto [known, is_new] =
            mesh_of.try_emplace({instance.object, instance.materials}, next);
        if (is_new && !used[instance.object]) {
            known->second = static_cast<int>(instance.object);
            used[instance.object] = true;
        } else if (is_new) {
            model.meshes.push_back(tinygltf::Mesh(model.meshes[instance.object]));
        }
        set_materials(model.meshes[static_cast<size_t>(known->second)], instance.materials);

        tinygltf::Node node;
        node.name = instance.name;
        node.mesh = known->second;
        node.matrix = matrix_numbers(instance.world_from_object);
        if (!scene.animation.empty()) {
            node.extras = our_extras({{kInstancePlaceKey, Value(static_cast<int>(i))}});
        }
        if (next_carried != scene.animation.carried.end() && next_carried->instance == i) {
            add_carried(model, *next_carried, rest[next_carried->node], instance,
                        animated[next_carried->node], std::move(node));
            ++next_carried;
        } else {
            add_node(model, std::move(node));
        }
    }
}

/// Colours lie in [0, 1], so a brighter light's scale goes into `intensity`. Dividing and
/// multiplying in double err by less than a float can tell.
void add_light(tinygltf::Model& model, const PointLight& source) {
    const vec3& i = source.intensity;
    const double scale = std::max({i.x, i.y, i.z, 1.0f});
    tinygltf::Light light;
    light.name = source.name;
    light.type = "point";
    light.color = {i.x / scale, i.y / scale, i.z / scale};
    light.intensity = scale;

    tinygltf::Node node;
    node.name = source.name;
    node.translation = numbers(source.position);
    node.extensions["KHR_lights_punctual"] =
        Value(Value::Object{{"light", Value(static_cast<int>(model.lights.size()))}});
    model.lights.push_back(std::move(light));
    add_node(model, std::move(node));
}

void add_camera(tinygltf::Model& model, const Camera& source) {
    constexpr double kNear = 1e-3;  // glTF asks for one; nothing here reads it
    tinygltf::Camera camera;
    camera.name = source.name;
    camera.type = "perspective";
    camera.perspective.yfov = source.vertical_fov;
    camera.perspective.znear = kNear;

    tinygltf::Node node;
    node.name = source.name;
    node.camera = static_cast<int>(model.cameras.size());
    node.matrix = matrix_numbers(source.world_from_camera);
    model.cameras.push_back(std::move(camera));
    add_node(model, std::move(node));
}

// ---- Animation ----

int add_times(tinygltf::Model& model, const std::vector<float>& times) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(model, times, 0);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.count = times.size();
    accessor.minValues = {times.front()};
    accessor.maxValues = {times.back()};
    return add_accessor(model, accessor);
}

int add_values(tinygltf::Model& model, const AnimationChannel& channel) {
    const bool is_rotation = channel.path == AnimationChannel::Path::rotation;
    std::vector<float> floats;
    for (const vec4& v : channel.values) {
        floats.insert(floats.end(), {v.x, v.y, v.z});
        if (is_rotation) floats.push_back(v.w);
    }
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(model, floats, 0);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = is_rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
    accessor.count = channel.values.size();
    return add_accessor(model, accessor);
}

void add_animation(tinygltf::Model& model, const Animation& source,
                   const std::vector<int>& animated) {
    constexpr const char* kPaths[] = {"translation", "rotation", "scale"};
    constexpr const char* kInterpolations[] = {"STEP", "LINEAR", "CUBICSPLINE"};
    tinygltf::Animation animation;
    animation.name = source.name;
    for (const AnimationChannel& channel : source.channels) {
        tinygltf::AnimationSampler sampler;
        sampler.input = add_times(model, channel.times);
        sampler.output = add_values(model, channel);
        sampler.interpolation = kInterpolations[static_cast<size_t>(channel.interpolation)];

        tinygltf::AnimationChannel target;
        target.sampler = static_cast<int>(animation.samplers.size());
        target.target_node = animated[channel.node];
        target.target_path = kPaths[static_cast<size_t>(channel.path)];
        animation.samplers.push_back(std::move(sampler));
        animation.channels.push_back(std::move(target));
    }
    model.animations.push_back(std::move(animation));
}

void add_material(tinygltf::Model& model, const Material& source) {
    const vec3& d = source.diffuse;
    tinygltf::Material material;
    material.name = source.name;
    material.doubleSided = true;
    material.pbrMetallicRoughness.baseColorFactor = {d.x, d.y, d.z, 1.0};
    material.pbrMetallicRoughness.metallicFactor = source.reflectivity;
    material.pbrMetallicRoughness.roughnessFactor = std::sqrt(2.0 / (source.shininess + 2.0));
    material.extras = our_extras(
        {{"specular", value(source.specular)}, {"shininess", Value(double{source.shininess})}});
    model.materials.push_back(std::move(material));
}

tinygltf::Model to_model(const Scene& scene) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "onepass";
    model.defaultScene = 0;
    model.scenes.resize(1);
    model.scenes[0].name = scene.name;
    model.scenes[0].extras = our_extras({{"version", Value(kExtrasVersion)},
                                         {"background", value(scene.background)},
                                         {"ambient", value(scene.ambient)}});
    model.buffers.resize(1);
    for (const Material& material : scene.materials) add_material(model, material);
    for (const Object& object : scene.objects) add_mesh(model, object);
    const std::vector<int> animated = add_animated_nodes(model, scene.animation);
    add_instances(model, scene, animated);
    if (!scene.animation.empty()) add_animation(model, scene.animation, animated);
    for (const PointLight& light : scene.lights) add_light(model, light);
    for (const Camera& camera : scene.cameras) add_camera(model, camera);
    return model;
}

// ---- Files ----

/// A folder beside the target, gone when this is.
class TemporaryFolder {
  public:
    explicit TemporaryFolder(const std::filesystem::path& target)
        : path_(target.parent_path() /
                fmt::format(".{}.{}.tmp", target.filename().string(), getpid())) {
        std::error_code failed;
        std::filesystem::create_directory(path_, failed);
        if (failed) {
            throw Error({target.string(), failed.message(), "a folder that can be written",
                         "Create the folder, or choose another."});
        }
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

void move_file(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code failed;
    std::filesystem::rename(from, to, failed);
    if (failed) {
        throw Error(
            {to.string(), failed.message(), "a file that can be written", "Choose another name."});
    }
}

/// tinygltf reports some failures as false, others by exceptions of its JSON library.
void write_model(tinygltf::Model& model, const std::filesystem::path& path, bool binary) {
    std::string problem = "a failed write";
    try {
        tinygltf::TinyGLTF writer;
        if (writer.WriteGltfSceneToFile(&model, path.string(), false, false, !binary, binary))
            return;
    } catch (const std::exception& e) {
        problem = clean_text(e.what());
    }
    throw Error({path.filename().string(), problem, "a written file",
                 "Free some space; names in the scene must be UTF-8."});
}

/// A file name as a URI: everything but unreserved characters as %XX.
std::string uri_of(const std::string& file_name) {
    std::string uri;
    for (const char c : file_name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || std::strchr("-._~", c) != nullptr;
        uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return uri;
}

}  // namespace

void write_gltf(const Scene& scene, const std::filesystem::path& path) {
    validate(scene);
    const std::string extension = scene_extension(path);
    if (extension != ".glb" && extension != ".gltf") {
        throw Error({path.string(), "the extension '" + extension + "'", ".glb or .gltf",
                     "Rename the output file."});
    }
    const bool binary = extension == ".glb";
    const std::string name = path.filename().string();
    const std::string buffer_name = path.stem().string() + ".bin";
    tinygltf::Model model = to_model(scene);
    if (!binary) model.buffers[0].uri = uri_of(buffer_name);

    // Everything is written in a folder of its own first. tinygltf names the buffer by its URI.
    const TemporaryFolder folder(path);
    const std::filesystem::path written = folder.path() / name;
    const std::filesystem::path written_buffer = folder.path() / buffer_name;
    write_model(model, written, binary);
    if (!binary) move_file(folder.path() / model.buffers[0].uri, written_buffer);

    // tinygltf does not look whether its writes succeed: reading back does, and proves the promise.
    if (read_gltf(written).scene != scene) {
        throw Error({path.string(), "a file that reads back as another scene",
                     "an equal one after writing", "Free some space; else report it as a bug."});
    }
    if (!binary) move_file(written_buffer, path.parent_path() / buffer_name);
    move_file(written, path);
}

}  // namespace onepass
