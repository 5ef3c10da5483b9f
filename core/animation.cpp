// Where the nodes stand at a time: keyframes to translation, rotation and scale, those to
// transforms, down the tree in double. glTF 2.0, appendix C, defines the interpolations.
#include "core/animation.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/error.h"
#include "core/scene.h"

namespace onepass {
namespace {

using glm::dvec4;

// ---- Channels ----

/// The way between two keys, and how far along it a time is.
struct Segment {
    size_t from = 0;
    double along = 0.0;     ///< in (0, 1); 0: exactly at `from`
    double duration = 0.0;  ///< s; 0 where `along` is
};

Segment segment_at(const std::vector<float>& times, double time_s) {
    const auto after = std::upper_bound(times.begin(), times.end(), time_s);
    if (after == times.begin()) return {};
    const auto from = static_cast<size_t>(after - times.begin()) - 1;
    if (after == times.end() || time_s == times[from]) return {.from = from};
    const double duration = double{*after} - times[from];
    return {from, (time_s - times[from]) / duration, duration};
}

/// Spherical interpolation between unit quaternions, the short way round.
dvec4 slerp(const dvec4& from, const dvec4& to, double along) {
    const double cosine = glm::dot(from, to);
    const double sign = cosine < 0.0 ? -1.0 : 1.0;  // q and -q are one rotation
    const double angle = std::acos(std::min(std::abs(cosine), 1.0));
    // Below this the chord is the arc to within double's rounding, and sin(angle) may be 0.
    constexpr double kLeastAngle = 1e-8;
    if (angle < kLeastAngle) return glm::mix(from, sign * to, along);
    return (std::sin(angle * (1.0 - along)) * from + sign * std::sin(angle * along) * to) /
           std::sin(angle);
}

dvec4 cubic_spline(const AnimationChannel& channel, const Segment& segment) {
    // Three values a key: in-tangent, value, out-tangent.
    const size_t k = 3 * segment.from;
    const dvec4 value(channel.values[k + 1]);
    const dvec4 out_tangent(channel.values[k + 2]);
    const dvec4 next_in_tangent(channel.values[k + 3]);
    const dvec4 next_value(channel.values[k + 4]);
    const double t = segment.along;
    const double t2 = t * t;
    const double t3 = t2 * t;
    return (2.0 * t3 - 3.0 * t2 + 1.0) * value +
           segment.duration * (t3 - 2.0 * t2 + t) * out_tangent +
           (3.0 * t2 - 2.0 * t3) * next_value + segment.duration * (t3 - t2) * next_in_tangent;
}

/// The channel's value. At a key it is the key's, to the bit; quaternions need not be unit.
dvec4 value_at(const AnimationChannel& channel, double time_s) {
    using Interpolation = AnimationChannel::Interpolation;
    const Segment segment = segment_at(channel.times, time_s);
    const bool is_spline = channel.interpolation == Interpolation::cubic_spline;
    const dvec4 from(channel.values[is_spline ? 3 * segment.from + 1 : segment.from]);
    if (segment.along == 0.0 || channel.interpolation == Interpolation::step) return from;
    if (is_spline) return cubic_spline(channel, segment);
    const dvec4 to(channel.values[segment.from + 1]);
    if (channel.path != AnimationChannel::Path::rotation) return glm::mix(from, to, segment.along);
    return slerp(glm::normalize(from), glm::normalize(to), segment.along);
}

// ---- Nodes ----

/// A node's own properties at a time.
struct Pose {
    dvec3 translation;
    dvec4 rotation;
    dvec3 scale;
};

/// The product a * b in double. Identities are left out, so that they keep even the sign of a 0.
DAffine product(const DAffine& a, const DAffine& b) {
    const DAffine identity(affine_identity());
    if (b == identity) return a;
    if (a == identity) return b;
    return DAffine(transform_vector(a, b[0]), transform_vector(a, b[1]), transform_vector(a, b[2]),
                   transform_point(a, b[3]));
}

DAffine base_from_node(const Pose& pose) {
    const glm::dmat3 rotation = rotation_matrix(pose.rotation);
    return DAffine(rotation[0] * pose.scale.x, rotation[1] * pose.scale.y,
                   rotation[2] * pose.scale.z, pose.translation);
}

std::vector<Pose> rest_poses(const Animation& animation) {
    std::vector<Pose> poses;
    poses.reserve(animation.nodes.size());
    for (const AnimatedNode& node : animation.nodes) {
        poses.push_back({dvec3(node.translation), dvec4(node.rotation), dvec3(node.scale)});
    }
    return poses;
}

std::vector<Pose> poses_at(const Animation& animation, double time_s) {
    std::vector<Pose> poses = rest_poses(animation);
    for (const AnimationChannel& channel : animation.channels) {
        Pose& pose = poses[channel.node];
        const dvec4 value = value_at(channel, time_s);
        switch (channel.path) {
            case AnimationChannel::Path::translation:
                pose.translation = dvec3(value);
                break;
            case AnimationChannel::Path::rotation:
                pose.rotation = value;
                break;
            case AnimationChannel::Path::scale:
                pose.scale = dvec3(value);
                break;
        }
    }
    return poses;
}

std::vector<DAffine> world_from_nodes(const Animation& animation, const std::vector<Pose>& poses) {
    std::vector<DAffine> world;
    world.reserve(poses.size());
    for (size_t i = 0; i < poses.size(); ++i) {
        const AnimatedNode& node = animation.nodes[i];
        const DAffine parent =
            node.parent == kNoId ? DAffine(affine_identity()) : world[node.parent];
        world.push_back(
            product(product(parent, DAffine(node.parent_from_base)), base_from_node(poses[i])));
    }
    return world;
}

// ---- Checks ----

std::string label(const char* kind, size_t index, const std::string& name) {
    return name.empty() ? fmt::format("{} {}", kind, index)
                        : fmt::format("{} {} ('{}')", kind, index, name);
}

std::string node_label(const Animation& animation, size_t node) {
    return label("animated node", node, animation.nodes[node].name);
}

std::string instance_label(const Scene& scene, size_t instance) {
    return label("instance", instance, scene.instances[instance].name);
}

std::string channel_label(const Animation& animation, size_t index) {
    constexpr const char* kPaths[] = {"translation", "rotation", "scale"};
    const AnimationChannel& channel = animation.channels[index];
    return fmt::format("animation channel {}, {} of {}", index,
                       kPaths[static_cast<size_t>(channel.path)],
                       node_label(animation, channel.node));
}

template <class Vector>
bool is_finite(const Vector& v) {
    for (int i = 0; i < Vector::length(); ++i) {
        if (!std::isfinite(v[i])) return false;
    }
    return true;
}

void check_index(const std::string& where, const char* kind, uint64_t index, uint64_t count) {
    if (index < count) return;
    throw Error({where, fmt::format("{} {}", kind, index), fmt::format("one below {}", count),
                 "Mend the animation, or leave it out."});
}

bool is_rotation(const vec4& q) { return is_finite(q) && glm::dot(dvec4(q), dvec4(q)) > 0.0; }

void check_invertible(const std::string& where, const Affine& m) {
    if (is_invertible(m)) return;
    throw Error({where, "a transform that flattens space, or is not finite",
                 "one that can be inverted", "Give it finite, non-zero scales along three axes."});
}

void check_node(const Animation& animation, size_t index) {
    const AnimatedNode& node = animation.nodes[index];
    const std::string where = node_label(animation, index);
    if (node.parent != kNoId && node.parent >= index) {
        throw Error({where, fmt::format("parent {}", node.parent), "an earlier node, or none",
                     "Put parents before their children."});
    }
    check_invertible(where, node.parent_from_base);
    if (is_rotation(node.rotation) && is_finite(node.translation) && is_finite(node.scale)) return;
    throw Error({where, "a translation, rotation or scale with NaN or inf, or a rotation of 0",
                 "finite numbers, and a rotation by a quaternion", "Mend the animation."});
}

void check_channel(const Animation& animation, size_t index) {
    const AnimationChannel& channel = animation.channels[index];
    check_index(fmt::format("animation channel {}", index), "animated node", channel.node,
                animation.nodes.size());
    const std::string where = channel_label(animation, index);

    // Times.
    if (channel.times.empty()) {
        throw Error({where, "no keys", "at least one", "Leave the channel out."});
    }
    float before = -1.0f;
    for (size_t k = 0; k < channel.times.size(); ++k) {
        const float time = channel.times[k];
        if (std::isfinite(time) && time >= 0.0f && time > before) {
            before = time;
            continue;
        }
        throw Error(
            {fmt::format("{}, key {}", where, k), fmt::format("the time {} s", time),
             k == 0 ? std::string("0 or more") : fmt::format("a finite time after {} s", before),
             "Sort the keys, and keep one of each time."});
    }

    // Values.
    const bool is_spline = channel.interpolation == AnimationChannel::Interpolation::cubic_spline;
    const size_t expected = channel.times.size() * (is_spline ? 3 : 1);
    if (channel.values.size() != expected) {
        throw Error({where, fmt::format("{} values", channel.values.size()),
                     fmt::format("{} for {} times{}", expected, channel.times.size(),
                                 is_spline ? ", of a cubic spline" : ""),
                     "Export the animation again."});
    }
    const bool rotates = channel.path == AnimationChannel::Path::rotation;
    for (size_t i = 0; i < channel.values.size(); ++i) {
        const vec4& value = channel.values[i];
        const bool is_tangent = is_spline && i % 3 != 1;
        const bool is_sound = rotates && !is_tangent
                                  ? is_rotation(value)
                                  : is_finite(value) && (rotates || value.w == 0);
        if (is_sound) continue;
        throw Error({fmt::format("{}, value {}", where, i),
                     fmt::format("({}, {}, {}, {})", value.x, value.y, value.z, value.w),
                     rotates ? "finite numbers, not all 0" : "three finite numbers, then 0",
                     "Mend the animation."});
    }
}

/// Each property of a node has one channel at most: two would contradict each other.
void check_targets(const Animation& animation) {
    std::map<std::pair<uint32_t, AnimationChannel::Path>, size_t> known;
    for (size_t i = 0; i < animation.channels.size(); ++i) {
        const AnimationChannel& channel = animation.channels[i];
        const auto [first, is_new] = known.try_emplace({channel.node, channel.path}, i);
        if (is_new) continue;
        throw Error({channel_label(animation, i), "a second channel of this property",
                     fmt::format("channel {} alone", first->second), "Leave one of them out."});
    }
}

void check_at_rest(const Scene& scene, const CarriedInstance& carried, const DAffine& node) {
    const DAffine rest = product(node, DAffine(carried.node_from_object));
    const Affine& stated = scene.instances[carried.instance].world_from_object;
    constexpr double kFloatRounding = 0x1p-24;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            double summed = column == 3 ? std::abs(node[3][row]) : 0.0;
            for (int k = 0; k < 3; ++k) {
                summed += std::abs(node[k][row] * double{carried.node_from_object[column][k]});
            }
            const double difference = std::abs(rest[column][row] - double{stated[column][row]});
            if (difference <= kRestRoundings * kFloatRounding * summed) continue;
            throw Error({instance_label(scene, carried.instance),
                         fmt::format("{} in column {}, row {} of its transform",
                                     stated[column][row], column, row),
                         fmt::format("{}, where {} carries it at rest", rest[column][row],
                                     node_label(scene.animation, carried.node)),
                         "Place the instance where its node has it at rest."});
        }
    }
}

void check_carried(const Scene& scene) {
    const Animation& animation = scene.animation;
    const std::vector<DAffine> nodes = rest_transforms(animation);
    for (size_t i = 0; i < animation.carried.size(); ++i) {
        const CarriedInstance& carried = animation.carried[i];
        const std::string where = fmt::format("carried instance {} of the animation", i);
        check_index(where, "instance", carried.instance, scene.instances.size());
        check_index(where, "animated node", carried.node, animation.nodes.size());
        if (i > 0 && carried.instance <= animation.carried[i - 1].instance) {
            throw Error({where, fmt::format("instance {}", carried.instance),
                         fmt::format("one after {}", animation.carried[i - 1].instance),
                         "Sort them by instance, and carry each once."});
        }
        check_invertible(instance_label(scene, carried.instance), carried.node_from_object);
        check_at_rest(scene, carried, nodes[carried.node]);
    }
}

}  // namespace

void check_animation(const Scene& scene) {
    const Animation& animation = scene.animation;
    if (animation.carried.empty() || animation.channels.empty()) {
        if (animation == Animation{}) return;
        throw Error({fmt::format("animation '{}'", animation.name),
                     fmt::format("{} channels that carry {} instances", animation.channels.size(),
                                 animation.carried.size()),
                     "at least one of each", "Leave the animation out."});
    }
    for (size_t i = 0; i < animation.nodes.size(); ++i) check_node(animation, i);
    for (size_t i = 0; i < animation.channels.size(); ++i) check_channel(animation, i);
    check_targets(animation);
    check_carried(scene);
}

glm::dmat3 rotation_matrix(const dvec4& q) {
    const double norm = glm::dot(q, q);
    const double s = norm > 0.0 ? 2.0 / norm : 0.0;
    const double x = q.x, y = q.y, z = q.z, w = q.w;
    return glm::dmat3(dvec3(1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
                      dvec3(s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)),
                      dvec3(s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)));
}

float Animation::duration() const {
    float last = 0.0f;
    for (const AnimationChannel& channel : channels) last = std::max(last, channel.times.back());
    return last;
}

std::vector<DAffine> rest_transforms(const Animation& animation) {
    return world_from_nodes(animation, rest_poses(animation));
}

Affine carried_transform(const DAffine& world_from_node, const Affine& node_from_object) {
    return Affine(product(world_from_node, DAffine(node_from_object)));
}

std::vector<Affine> instance_transforms(const Scene& scene, double time_s) {
    std::vector<Affine> transforms;
    transforms.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances) {
        transforms.push_back(instance.world_from_object);
    }

    const Animation& animation = scene.animation;
    const std::vector<DAffine> world = world_from_nodes(animation, poses_at(animation, time_s));
    for (const CarriedInstance& carried : animation.carried) {
        const Affine moved = carried_transform(world[carried.node], carried.node_from_object);
        if (!is_invertible(moved)) {
            throw Error(
                {fmt::format("{} at {} s",
                             label("node", carried.node, animation.nodes[carried.node].name),
                             time_s),
                 fmt::format(
                     "a transform of {} that flattens space, or is not finite",
                     label("instance", carried.instance, scene.instances[carried.instance].name)),
                 "one that can be inverted", "Keep the scales of the animation away from 0."});
        }
        transforms[carried.instance] = moved;
    }
    return transforms;
}

Scene scene_at(const Scene& scene, double time_s) {
    const std::vector<Affine> transforms = instance_transforms(scene, time_s);
    Scene moved = scene;
    for (size_t i = 0; i < transforms.size(); ++i) {
        moved.instances[i].world_from_object = transforms[i];
    }
    return moved;
}

}  // namespace onepass
