// Moving instances: nodes, keyframes, and where they put the instances at a time. glTF 2.0's
// animation model, and no more of it than rigid instances need: no skins, no morph targets.
//
// A scene without animated nodes is static. Only transforms move; objects never change.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/affine.h"
#include "core/types.h"

namespace onepass {

struct Scene;

/// A node whose translation, rotation or scale changes.
///
/// world_from_node = world_from_parent * parent_from_base * T * R * S.
struct AnimatedNode {
    std::string name;
    uint32_t parent = kNoId;                      ///< an earlier node; kNoId: the world
    Affine parent_from_base = affine_identity();  ///< what stands still between parent and node
    vec3 translation{0.0f};                       ///< at rest, like the next two
    vec4 rotation{0.0f, 0.0f, 0.0f, 1.0f};        ///< unit quaternion (x, y, z, w)
    vec3 scale{1.0f};

    bool operator==(const AnimatedNode&) const = default;
};

/// Keyframes of one property of one node. Before the first key and after the last, the value stays.
struct AnimationChannel {
    enum class Path { translation, rotation, scale };
    enum class Interpolation { step, linear, cubic_spline };
    uint32_t node = 0;
    Path path = Path::translation;
    Interpolation interpolation =
        Interpolation::linear;  ///< linear rotations go the short way round
    std::vector<float> times;   ///< s, strictly ascending, from 0 on
    /// One a time; of cubic splines three: in-tangent, value, out-tangent. w is 0 but for
    /// rotations.
    std::vector<vec4> values;

    bool operator==(const AnimationChannel&) const = default;
};

/// An instance that a node carries along: world_from_object = world_from_node * node_from_object.
struct CarriedInstance {
    uint32_t instance = 0;
    uint32_t node = 0;
    Affine node_from_object = affine_identity();

    bool operator==(const CarriedInstance&) const = default;
};

struct Animation {
    std::string name;
    std::vector<AnimatedNode> nodes;  ///< parents before children
    std::vector<AnimationChannel> channels;
    std::vector<CarriedInstance> carried;  ///< ascending by instance, each at most once

    bool empty() const { return carried.empty(); }
    /// The last key's time, s; 0 if nothing moves.
    float duration() const;

    bool operator==(const Animation&) const = default;
};

/// Scene::instances' world_from_object at `time_s`, one an instance; those that nothing carries
/// keep theirs. Times outside [0, duration] take the value at the nearer end.
///
/// Composed in double and rounded once. Cost: O(nodes + keys + instances).
/// Throws: Error naming the node if a transform cannot be inverted at this time (a scale of 0).
std::vector<Affine> instance_transforms(const Scene& scene, double time_s);

/// A copy of the scene, its instances as they are at `time_s`. It keeps the animation, so
/// validate() refuses it where `time_s` is not at rest.
Scene scene_at(const Scene& scene, double time_s);

/// world_from_node of all nodes at rest, in double.
std::vector<DAffine> rest_transforms(const Animation& animation);

/// world_from_node * node_from_object, rounded once. A factor of 1 changes no bit of the other.
Affine carried_transform(const DAffine& world_from_node, const Affine& node_from_object);

/// validate()'s part for the animation. The scene's objects and instances must be sound.
///
/// Afterwards: parents stand before their children; indices are in range; numbers are finite and
/// rotations not 0; each property has at most one channel, with ascending times and as many values
/// as its interpolation asks for; each carried instance is placed where the rest pose puts it,
/// apart from kRestRoundings. An animation that carries nothing is empty altogether. Throws: Error
/// naming the node, channel or instance at fault.
void check_animation(const Scene& scene);

/// How far an instance may stand from its rest pose, entry by entry, in float roundings (2^-24) of
/// the sum of the absolute values that the entry is summed from. A builder rounds node_from_object
/// once, after an inverse in double, and world_from_object once; 4 leaves it a step of its own.
inline constexpr double kRestRoundings = 4.0;

/// The rotation by a quaternion (x, y, z, w), which need not be of unit length; 1 for (0, 0, 0, 0).
glm::dmat3 rotation_matrix(const glm::dvec4& quaternion);

}  // namespace onepass
