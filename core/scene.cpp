// The scene's derived values (boxes, counts, cameras) and the one check that all others rely on.
#include "core/scene.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "core/error.h"

namespace onepass {
namespace {

bool is_finite(const vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string text(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

/// "object 3 ('wheel')", or "object 3" if it has no name.
std::string label(const char* kind, size_t index, const std::string& name) {
    return name.empty() ? fmt::format("{} {}", kind, index)
                        : fmt::format("{} {} ('{}')", kind, index, name);
}

/// The triangle's place as a user can find it: object, group, number within both.
std::string triangle_label(const Object& object, size_t object_index, size_t prim_id) {
    const std::string where =
        fmt::format("{}, triangle {}", label("object", object_index, object.name), prim_id);
    for (size_t g = 0; g < object.groups.size(); ++g) {
        const TriangleGroup& group = object.groups[g];
        if (prim_id < group.first_triangle ||
            prim_id - group.first_triangle >= group.triangle_count)
            continue;
        return fmt::format("{} (triangle {} of {})", where, prim_id - group.first_triangle,
                           label("group", g, group.name));
    }
    return where;
}

void check_vectors(const std::vector<vec3>& vectors, const char* kind, const std::string& object) {
    for (size_t i = 0; i < vectors.size(); ++i) {
        if (is_finite(vectors[i])) continue;
        throw Error({fmt::format("{}, {} {}", object, kind, i), text(vectors[i]), "finite numbers",
                     "Mend the mesh, or export it again."});
    }
}

void check_groups(const Object& object, const std::string& where) {
    uint64_t next = 0;
    for (size_t g = 0; g < object.groups.size(); ++g) {
        const TriangleGroup& group = object.groups[g];
        const std::string group_label = where + ", " + label("group", g, group.name);
        if (group.triangle_count == 0) {
            throw Error({group_label, "no triangles", "at least one", "Leave the group out."});
        }
        if (group.first_triangle != next) {
            throw Error({group_label, fmt::format("first triangle {}", group.first_triangle),
                         fmt::format("{}", next), "Groups follow each other without gaps."});
        }
        next += group.triangle_count;
    }
    if (next != object.triangles.size()) {
        throw Error({where, fmt::format("groups of {} triangles in all", next),
                     fmt::format("{}", object.triangles.size()),
                     "Give every triangle exactly one group."});
    }
}

void check_object(const Object& object, size_t index) {
    const std::string where = label("object", index, object.name);
    if (object.triangles.empty()) {
        throw Error({where, "no triangles", "at least one", "Leave the object out."});
    }
    if (object.triangles.size() >= kNoId || object.positions.size() >= kNoId) {
        throw Error({where,
                     fmt::format("{} triangles and {} vertices", object.triangles.size(),
                                 object.positions.size()),
                     fmt::format("fewer than {} of each", kNoId), "Split the mesh."});
    }
    if (!object.normals.empty() && object.normals.size() != object.positions.size()) {
        throw Error({where, fmt::format("{} normals", object.normals.size()),
                     fmt::format("none, or one for each of {} positions", object.positions.size()),
                     "Export the mesh with one normal a vertex, or without normals."});
    }
    check_vectors(object.positions, "vertex", where);
    check_vectors(object.normals, "normal", where);
    for (size_t t = 0; t < object.triangles.size(); ++t) {
        const uvec3& triangle = object.triangles[t];
        const uint32_t largest = std::max({triangle.x, triangle.y, triangle.z});
        if (largest < object.positions.size()) continue;
        throw Error({triangle_label(object, index, t), fmt::format("vertex index {}", largest),
                     fmt::format("below {}, the number of vertices", object.positions.size()),
                     "Mend the mesh, or export it again."});
    }
    check_groups(object, where);
}

void check_unit_range(const std::string& where, const char* what, float value) {
    if (value >= 0.0f && value <= 1.0f) return;
    throw Error(
        {where, fmt::format("{} {}", what, value), "a number from 0 to 1", "Change the material."});
}

void check_material(const Material& material, size_t index) {
    const std::string where = label("material", index, material.name);
    for (int channel = 0; channel < 3; ++channel) {
        check_unit_range(where, "diffuse", material.diffuse[channel]);
        check_unit_range(where, "specular", material.specular[channel]);
    }
    check_unit_range(where, "reflectivity", material.reflectivity);
    if (!(material.shininess >= 0.0f && std::isfinite(material.shininess))) {
        throw Error({where, fmt::format("shininess {}", material.shininess),
                     "a finite number, 0 or more", "Change the material."});
    }
}

void check_transform(const std::string& where, const Affine& m) {
    if (is_invertible(m)) return;
    const bool finite = is_finite(m[0]) && is_finite(m[1]) && is_finite(m[2]) && is_finite(m[3]);
    throw Error({where, finite ? "a transform that flattens space" : "a transform with NaN or inf",
                 "one that can be inverted", "Give it finite, non-zero scales along three axes."});
}

void check_instance(const Scene& scene, size_t index) {
    const Instance& instance = scene.instances[index];
    const std::string where = label("instance", index, instance.name);
    if (instance.object >= scene.objects.size()) {
        throw Error({where, fmt::format("object {}", instance.object),
                     fmt::format("below {}, the number of objects", scene.objects.size()),
                     "Point the node to a mesh of the file."});
    }
    const Object& object = scene.objects[instance.object];
    if (instance.materials.size() != object.groups.size()) {
        throw Error({where, fmt::format("{} materials", instance.materials.size()),
                     fmt::format("one for each of the object's {} groups", object.groups.size()),
                     "Give every group a material."});
    }
    for (uint32_t material : instance.materials) {
        if (material < scene.materials.size()) continue;
        throw Error({where, fmt::format("material {}", material),
                     fmt::format("below {}, the number of materials", scene.materials.size()),
                     "Point the group to a material of the file."});
    }
    check_transform(where, instance.world_from_object);
}

/// A scene's box must be finite as well: large coordinates times large scales can overflow.
void check_extent(const Scene& scene) {
    const std::vector<Bounds> boxes = instance_bounds(scene);
    for (size_t i = 0; i < boxes.size(); ++i) {
        if (is_finite(boxes[i].lower) && is_finite(boxes[i].upper) && is_finite(boxes[i].extent()))
            continue;
        throw Error({label("instance", i, scene.instances[i].name),
                     fmt::format("a box from {} to {}", text(boxes[i].lower), text(boxes[i].upper)),
                     "one whose size is a finite float", "Scale the scene down."});
    }
}

void check_light(const PointLight& light, size_t index) {
    const std::string where = label("light", index, light.name);
    if (!is_finite(light.position)) {
        throw Error(
            {where, "position " + text(light.position), "finite numbers", "Move the light."});
    }
    const vec3& i = light.intensity;
    if (!is_finite(i) || i.x < 0.0f || i.y < 0.0f || i.z < 0.0f) {
        throw Error(
            {where, "intensity " + text(i), "finite numbers, 0 or more", "Change the light."});
    }
}

void check_camera(const Camera& camera, size_t index) {
    const std::string where = label("camera", index, camera.name);
    check_transform(where, camera.world_from_camera);
    constexpr float kPi = 3.14159265f;
    if (!(camera.vertical_fov > 0.0f && camera.vertical_fov < kPi)) {
        throw Error({where, fmt::format("a vertical field of view of {}", camera.vertical_fov),
                     "an angle between 0 and pi radians", "Change the camera."});
    }
}

// ---- One object of all.

/// "instance/group", or what there is of it.
std::string group_label(const Instance& instance, const TriangleGroup& group) {
    const bool both = !instance.name.empty() && !group.name.empty();
    return instance.name + (both ? "/" : "") + group.name;
}

/// Appends an instance's triangles to `target`, in world space and in the object's order.
///
/// `with_normals`: an object without normals gets those of its triangles, which then share no
/// vertices. A mirrored instance keeps the order of its corners, so that (u, v) stay what they
/// were; its triangles then face inwards, which no tracer asks about.
void append_in_world(Object& target, const Object& object, const Instance& instance,
                     bool with_normals) {
    const DAffine world_from_object(instance.world_from_object);
    const auto in_world = [&](uint32_t vertex) {
        return vec3(transform_point(world_from_object, dvec3(object.positions[vertex])));
    };
    for (TriangleGroup group : object.groups) {
        group.first_triangle += static_cast<uint32_t>(target.triangles.size());
        group.name = group_label(instance, group);
        target.groups.push_back(group);
    }

    if (with_normals && object.normals.empty()) {
        for (const uvec3& triangle : object.triangles) {
            const auto first = static_cast<uint32_t>(target.positions.size());
            target.triangles.emplace_back(first, first + 1, first + 2);
            for (int k = 0; k < 3; ++k) target.positions.push_back(in_world(triangle[k]));
            const dvec3 v0(target.positions[first]);
            const dvec3 normal = glm::cross(dvec3(target.positions[first + 1]) - v0,
                                            dvec3(target.positions[first + 2]) - v0);
            // A triangle without area has no normal, and is never hit.
            const double length = glm::length(normal);
            target.normals.insert(target.normals.end(), 3,
                                  length > 0.0 ? vec3(normal / length) : vec3(0, 0, 1));
        }
        return;
    }

    const uvec3 first(static_cast<uint32_t>(target.positions.size()));
    for (const uvec3& triangle : object.triangles) target.triangles.push_back(first + triangle);
    for (uint32_t v = 0; v < object.positions.size(); ++v) target.positions.push_back(in_world(v));

    // By the inverse transpose. Normals keep their lengths relative to each other, because these
    // weight what is interpolated; the factor they share only keeps them within a float's range.
    const DAffine object_from_world = inverse(instance.world_from_object);
    double largest = 0.0;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) {
            largest = std::max(largest, std::abs(object_from_world[column][row]));
        }
    }
    for (const vec3& normal : object.normals) {
        dvec3 turned;
        for (int column = 0; column < 3; ++column) {
            turned[column] = glm::dot(object_from_world[column] / largest, dvec3(normal));
        }
        target.normals.emplace_back(turned);
    }
}

}  // namespace

Scene flattened(const Scene& scene) {
    const uint64_t triangles = instanced_triangle_count(scene);
    // Three vertices a triangle at most must have an index each.
    constexpr uint64_t kMost = kNoId / 3;
    if (triangles > kMost) {
        throw Error({"scene", fmt::format("{} triangles in all instances", triangles),
                     fmt::format("at most {} in one object", kMost),
                     "Use the scene with its instances."});
    }
    const bool with_normals = std::any_of(
        scene.instances.begin(), scene.instances.end(),
        [&](const Instance& instance) { return !scene.objects[instance.object].normals.empty(); });

    Scene flat = scene;
    flat.animation = {};
    Object all;
    all.name = scene.name;
    Instance only;
    only.name = scene.name;
    for (const Instance& instance : scene.instances) {
        append_in_world(all, scene.objects[instance.object], instance, with_normals);
        only.materials.insert(only.materials.end(), instance.materials.begin(),
                              instance.materials.end());
    }
    flat.objects = {std::move(all)};
    flat.instances = {std::move(only)};
    return flat;
}

Scene unshared(const Scene& scene) {
    Scene result = scene;
    result.objects.clear();
    for (Instance& instance : result.instances) {
        result.objects.push_back(scene.objects[instance.object]);
        instance.object = static_cast<uint32_t>(result.objects.size()) - 1;
    }
    return result;
}

uint64_t instanced_triangle_count(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) {
        count += scene.objects[instance.object].triangles.size();
    }
    return count;
}

Bounds object_bounds(const Object& object) {
    constexpr size_t kTrianglesATask = size_t{1} << 14;
    return tbb::parallel_reduce(
        tbb::blocked_range<size_t>(0, object.triangles.size(), kTrianglesATask), Bounds{},
        [&](const auto& range, Bounds bounds) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                const uvec3& triangle = object.triangles[i];
                bounds.extend(object.positions[triangle.x]);
                bounds.extend(object.positions[triangle.y]);
                bounds.extend(object.positions[triangle.z]);
            }
            return bounds;
        },
        [](Bounds a, const Bounds& b) {
            a.extend(b);
            return a;
        });
}

std::vector<Bounds> instance_bounds(const Scene& scene) {
    std::vector<Bounds> boxes;
    boxes.reserve(scene.objects.size());
    for (const Object& object : scene.objects) boxes.push_back(object_bounds(object));
    return instance_bounds(scene, boxes);
}

std::vector<Bounds> instance_bounds(const Scene& scene, std::span<const Bounds> object_boxes) {
    std::vector<Bounds> result;
    result.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances) {
        const Bounds& box = object_boxes[instance.object];
        result.push_back(transform_bounds(instance.world_from_object, box));
    }
    return result;
}

Bounds scene_bounds(const Scene& scene) {
    Bounds bounds;
    for (const Bounds& box : instance_bounds(scene)) bounds.extend(box);
    return bounds;
}

uint32_t group_of_triangle(const Object& object, uint32_t prim_id) {
    const auto after = std::upper_bound(
        object.groups.begin(), object.groups.end(), prim_id,
        [](uint32_t id, const TriangleGroup& group) { return id < group.first_triangle; });
    return static_cast<uint32_t>(after - object.groups.begin()) - 1;
}

void validate(const Scene& scene) {
    // Objects first: what refers to them is easier to understand once they are known to be sound.
    for (size_t i = 0; i < scene.objects.size(); ++i) check_object(scene.objects[i], i);
    for (size_t i = 0; i < scene.materials.size(); ++i) check_material(scene.materials[i], i);
    if (scene.materials.empty()) {
        throw Error({"scene", "no materials", "at least one", "Add a material."});
    }
    if (scene.instances.empty()) {
        throw Error({"scene", "no instances", "at least one", "Place an object in the scene."});
    }
    for (size_t i = 0; i < scene.instances.size(); ++i) check_instance(scene, i);
    check_extent(scene);
    check_animation(scene);

    for (size_t i = 0; i < scene.lights.size(); ++i) check_light(scene.lights[i], i);
    for (size_t i = 0; i < scene.cameras.size(); ++i) check_camera(scene.cameras[i], i);
    for (const vec3& color : {scene.background, scene.ambient}) {
        if (is_finite(color)) continue;
        throw Error({"scene", "background or ambient light " + text(color), "finite numbers",
                     "Change the colour."});
    }
}

Camera look_at(const vec3& eye, const vec3& target, const vec3& up, float vertical_fov) {
    const dvec3 back = dvec3(eye) - dvec3(target);
    const dvec3 right = glm::cross(dvec3(up), back);
    // An `up` closer to the view direction than this leaves no correct digit of `right` in float.
    constexpr double kLeastSine = 1e-6;
    if (!(glm::length(right) > kLeastSine * glm::length(dvec3(up)) * glm::length(back))) {
        throw Error({"camera",
                     fmt::format("eye {}, target {}, up {}", text(eye), text(target), text(up)),
                     "eye and target apart, and up not along the view direction",
                     "Move the eye or choose another up."});
    }
    const dvec3 z = glm::normalize(back);
    const dvec3 x = glm::normalize(right);
    Camera camera;
    camera.world_from_camera = Affine(vec3(x), vec3(glm::cross(z, x)), vec3(z), eye);
    camera.vertical_fov = vertical_fov;
    return camera;
}

Camera automatic_camera(const Bounds& bounds) {
    const vec3 centre = bounds.centre();
    const vec3 up(0, 1, 0);
    const vec3 towards_eye = glm::normalize(vec3(0.3f, 0.25f, 1.0f));
    constexpr float kFov = 0.785398163f;
    constexpr double kMargin = 1.05;  // the scene fills at most 1 / kMargin of a square image

    // A corner q from the centre is seen from distance d if |q.x| and |q.y|, in camera axes, are at
    // most tan(fov / 2) of its depth d - q.z.
    const Affine axes = look_at(towards_eye, vec3(0), up, kFov).world_from_camera;
    const double slope = std::tan(0.5 * kFov) / kMargin;
    double distance = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x,
                      corner & 2 ? bounds.upper.y : bounds.lower.y,
                      corner & 4 ? bounds.upper.z : bounds.lower.z);
        const dvec3 q = p - dvec3(centre);
        const double side =
            std::max(std::abs(glm::dot(q, dvec3(axes[0]))), std::abs(glm::dot(q, dvec3(axes[1]))));
        distance = std::max(distance, side / slope + glm::dot(q, dvec3(axes[2])));
    }

    // A scene that is one point still gets an eye that is another.
    constexpr double kLeastRelativeDistance = 1e-3;
    distance = std::max(distance, kLeastRelativeDistance * bounds.magnitude());
    if (distance == 0.0) distance = 1.0;
    return look_at(vec3(dvec3(centre) + dvec3(towards_eye) * distance), centre, up, kFov);
}

}  // namespace onepass
