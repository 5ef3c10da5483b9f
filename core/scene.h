// The scene: an immutable value that every structure, tracer and judge is built from.
//
// A scene is checked once, by validate(), when it is loaded or generated; everything downstream
// relies on what validate() promises.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/affine.h"
#include "core/animation.h"
#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// A run of consecutive triangles of an object that shares one material slot.
struct TriangleGroup {
    std::string name;
    uint32_t first_triangle = 0;
    uint32_t triangle_count = 0;
    bool operator==(const TriangleGroup&) const = default;
};

/// A triangle mesh in object space. `prim_id` indexes `triangles`.
struct Object {
    std::string name;
    std::vector<vec3> positions;
    std::vector<vec3> normals;  ///< empty, or one per position; need not be unit length
    std::vector<uvec3> triangles;
    std::vector<TriangleGroup> groups;  ///< cover `triangles` in order, without gaps

    bool operator==(const Object&) const = default;
};

/// An object placed in the world.
struct Instance {
    std::string name;
    uint32_t object = 0;
    Affine world_from_object = affine_identity();
    std::vector<uint32_t> materials;  ///< one per group of the object

    bool operator==(const Instance&) const = default;
};

/// Phong coefficients. Colours are linear RGB in [0, 1]; `reflectivity` is the mirror's share.
struct Material {
    std::string name;
    vec3 diffuse{0.8f};
    vec3 specular{0.0f};
    float shininess = 32.0f;
    float reflectivity = 0.0f;

    bool operator==(const Material&) const = default;
};

/// A point light without falloff, as in the paper's Phong model.
struct PointLight {
    std::string name;
    vec3 position{0.0f};
    vec3 intensity{1.0f};

    bool operator==(const PointLight&) const = default;
};

/// A pinhole camera, glTF's convention: it looks along its -z, +y is up.
struct Camera {
    std::string name;
    Affine world_from_camera = affine_identity();
    float vertical_fov = 0.785398163f;  ///< full angle, radians

    bool operator==(const Camera&) const = default;
};

struct Scene {
    std::string name;
    std::vector<Object> objects;
    std::vector<Instance> instances;
    std::vector<Material> materials;
    std::vector<PointLight> lights;
    std::vector<Camera> cameras;
    Animation animation;    ///< of the instances' transforms; empty: nothing moves
    vec3 background{0.0f};  ///< colour of a ray that misses
    vec3 ambient{0.0f};     ///< light that reaches every surface, multiplied by `diffuse`

    bool operator==(const Scene&) const = default;
};

/// The scene as one object in one instance, its triangles in world space: instance by instance,
/// each in the object's order. Nothing moves any more. `prim_id` then counts through the instances.
/// Cost: memory of instanced_triangle_count().
Scene flattened(const Scene& scene);

/// The scene with an object of its own for every instance: what instancing saves.
Scene unshared(const Scene& scene);

/// Triangles counted once an instance, as the paper counts them.
uint64_t instanced_triangle_count(const Scene& scene);

Bounds object_bounds(const Object& object);

/// World-space boxes of all instances, in order. `object_boxes`: where they are known already.
std::vector<Bounds> instance_bounds(const Scene& scene);
std::vector<Bounds> instance_bounds(const Scene& scene, std::span<const Bounds> object_boxes);
Bounds scene_bounds(const Scene& scene);

/// The index of the group that holds triangle `prim_id`. Cost: O(log groups).
uint32_t group_of_triangle(const Object& object, uint32_t prim_id);

/// Checks everything the rest of the program relies on.
///
/// Afterwards: at least one instance; every object has triangles; all indices are in range; all
/// positions, normals and other numbers are finite; groups cover the triangles; transforms are
/// invertible; every scene has at least one material; the animation is as check_animation() says.
/// Throws: Error naming the object, triangle or node at fault.
void validate(const Scene& scene);

/// A camera that sees the whole box: from the direction (0.3, 0.25, 1), y up, 45 degrees, at the
/// least distance that shows all corners in a square image, with a margin of 5 %.
Camera automatic_camera(const Bounds& bounds);

/// A camera at `eye` that looks at `target`.
/// Throws: Error if eye equals target or `up` is parallel to the view direction.
Camera look_at(const vec3& eye, const vec3& target, const vec3& up, float vertical_fov);

}  // namespace onepass
