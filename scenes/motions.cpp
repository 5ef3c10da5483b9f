// Motions as keyframes: smooth paths through cubic splines, even turns through linear rotations.
#include "scenes/motions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "scenes/shapes.h"

namespace onepass {
namespace {

using Interpolation = AnimationChannel::Interpolation;
using Path = AnimationChannel::Path;

constexpr float kLoop = 2.0f;  // s, of every motion here
constexpr double kTwoPi = 2.0 * std::numbers::pi;

// ---- Building animations ----

uint32_t add_node(Animation& animation, AnimatedNode node) {
    animation.nodes.push_back(std::move(node));
    return static_cast<uint32_t>(animation.nodes.size()) - 1;
}

/// A translation along a smooth path: position(t) at `keys` + 1 times of a loop, joined by cubic
/// splines through the path's own speed there. The first and last key are `rest`, to the bit.
template <class Position>
AnimationChannel smooth_path(uint32_t node, const vec3& rest, int keys, Position&& position) {
    AnimationChannel channel{.node = node,
                             .path = Path::translation,
                             .interpolation = Interpolation::cubic_spline,
                             .times = {},
                             .values = {}};
    constexpr double kStep = 1e-4;  // s, of the central difference: errs by 1e-8 of the curvature
    for (int k = 0; k <= keys; ++k) {
        const double t = double{kLoop} * k / keys;
        const bool is_rest = k == 0 || k == keys;
        const dvec3 speed = (position(t + kStep) - position(t - kStep)) / (2.0 * kStep);
        channel.times.push_back(static_cast<float>(t));
        channel.values.emplace_back(vec3(speed), 0.0f);
        channel.values.emplace_back(is_rest ? rest : vec3(position(t)), 0.0f);
        channel.values.emplace_back(vec3(speed), 0.0f);
    }
    return channel;
}

/// Whole turns about an axis in a loop, at even speed: a key every third of a turn, because linear
/// rotations go the short way round.
AnimationChannel steady_turn(uint32_t node, const vec3& axis, int turns) {
    AnimationChannel channel{.node = node,
                             .path = Path::rotation,
                             .interpolation = Interpolation::linear,
                             .times = {},
                             .values = {}};
    const dvec3 unit = glm::normalize(dvec3(axis));
    const int keys = 3 * std::abs(turns);
    for (int k = 0; k <= keys; ++k) {
        const double half_angle = 0.5 * kTwoPi * turns * k / keys;
        channel.times.push_back(static_cast<float>(double{kLoop} * k / keys));
        channel.values.emplace_back(
            glm::vec4(glm::dvec4(unit * std::sin(half_angle), std::cos(half_angle))));
    }
    channel.values.front() = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    channel.values.back() = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    return channel;
}

/// std::mt19937_64 is specified to the bit; the standard's distributions are not.
class Random {
  public:
    explicit Random(uint64_t seed) : engine_(seed) {}
    /// Uniform in [low, high).
    float between(float low, float high) {
        return low + (high - low) * (static_cast<float>(engine_() >> 40) * 0x1p-24f);
    }
    vec3 inside_cube(float half) {
        const float x = between(-half, half);
        const float y = between(-half, half);
        return vec3(x, y, between(-half, half));
    }

  private:
    std::mt19937_64 engine_;
};

uint32_t find_instance(const Scene& scene, const std::string& name) {
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].name == name) return i;
    }
    throw Error({"scene '" + scene.name + "'", "no instance '" + name + "'",
                 "all instances that its motion is made for", "Name them as motions.h says."});
}

/// Sorts what was carried in the order of nodes by instance, as Animation asks for.
void sort_carried(Animation& animation) {
    std::sort(
        animation.carried.begin(), animation.carried.end(),
        [](const CarriedInstance& a, const CarriedInstance& b) { return a.instance < b.instance; });
}

// ---- A roundabout of balls ----

/// The top of the flattened ball that is the floor, below or above (x, z).
double floor_height(const Affine& floor, double x, double z) {
    const double u = (x - floor[3].x) / floor[0].x;
    const double v = (z - floor[3].z) / floor[2].z;
    return floor[3].y + floor[1].y * std::sqrt(1.0 - u * u - v * v);
}

/// A ball's way round: from `start` about the pivot, at even speed, hopping.
struct Round {
    dvec3 start;
    dvec3 pivot;
    double radius = 0.0;  ///< of the ball
    double turns = 0.0;   ///< in a loop
    double hop_height = 0.0;
    int hops = 0;  ///< in a loop

    dvec3 at(double t, const Affine& floor) const {
        const double angle = kTwoPi * turns * t / kLoop;
        const dvec3 arm = start - pivot;
        const double x = pivot.x + arm.x * std::cos(angle) + arm.z * std::sin(angle);
        const double z = pivot.z - arm.x * std::sin(angle) + arm.z * std::cos(angle);
        const double bounce = std::sin(0.5 * kTwoPi * hops * t / kLoop);
        return dvec3(x, floor_height(floor, x, z) + radius + hop_height * bounce * bounce, z);
    }
};

// ---- A squadron of helicopters ----

struct Helicopter {
    uint32_t hull = 0;
    uint32_t main_rotor = 0;
    uint32_t tail_rotor = 0;
};

std::vector<Helicopter> find_helicopters(const Scene& scene) {
    const std::string prefix = "hull ";
    std::vector<Helicopter> found;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        if (!scene.instances[i].name.starts_with(prefix)) continue;
        const std::string number = scene.instances[i].name.substr(prefix.size());
        found.push_back({i, find_instance(scene, "main rotor " + number),
                         find_instance(scene, "tail rotor " + number)});
    }
    if (found.empty()) find_instance(scene, prefix + "NN");  // throws
    return found;
}

/// Adds a rotor that turns about an axis of its own object, where the scene has placed it.
void add_rotor(Scene& scene, uint32_t instance, uint32_t hull_node, const vec3& axis, int turns) {
    const Instance& rotor = scene.instances[instance];
    const uint32_t node = add_node(
        scene.animation,
        {.name = rotor.name, .parent = hull_node, .parent_from_base = rotor.world_from_object});
    scene.animation.channels.push_back(steady_turn(node, axis, turns));
    scene.animation.carried.push_back({instance, node, affine_identity()});
}

}  // namespace

void orbiting_mirrors(Scene& scene) {
    const Affine floor = scene.instances[find_instance(scene, "floor")].world_from_object;
    const uint32_t red = find_instance(scene, "red");
    const uint32_t left = find_instance(scene, "left mirror");
    const uint32_t right = find_instance(scene, "right mirror");
    const dvec3 pivot = 0.5 * (dvec3(scene.instances[left].world_from_object[3]) +
                               dvec3(scene.instances[right].world_from_object[3]));
    constexpr double kHopHeight = 0.5;
    constexpr int kKeys = 24;  // splines then leave a circle by 1e-5 of its radius

    Animation& animation = scene.animation;
    animation.name = "orbiting mirrors";
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& ball = scene.instances[i];
        if (ball.name == "floor") continue;
        const vec3 start = ball.world_from_object[3];
        const bool is_mirror = i == left || i == right;
        const Round round{.start = dvec3(start),
                          .pivot = pivot,
                          .radius = ball.world_from_object[1].y,
                          .turns = i == red ? 0.0 : 1.0,
                          .hop_height = is_mirror ? 0.0 : kHopHeight,
                          .hops = 2 + static_cast<int>(i % 2)};
        const uint32_t node = add_node(animation, {.name = ball.name,
                                                   .parent = kNoId,
                                                   .parent_from_base = affine_identity(),
                                                   .translation = start});
        animation.channels.push_back(
            smooth_path(node, start, kKeys, [&](double t) { return round.at(t, floor); }));
        Affine node_from_object = ball.world_from_object;
        node_from_object[3] = vec3(0.0f);
        animation.carried.push_back({i, node, node_from_object});
    }
}

void turning_rotors(Scene& scene) {
    constexpr int kMainTurns = 4;  // in a loop; few enough that 24 frames a second show the sense
    constexpr int kTailTurns = 6;
    constexpr double kBob = 0.03;  // of the distance between the rotors
    constexpr double kAdvance = 0.1;
    constexpr double kGoldenAngle = 2.39996;  // radians: no two helicopters move alike

    scene.animation.name = "turning rotors";
    const std::vector<Helicopter> helicopters = find_helicopters(scene);
    for (size_t h = 0; h < helicopters.size(); ++h) {
        const auto& [hull, main_rotor, tail_rotor] = helicopters[h];
        const dvec3 forward(scene.instances[main_rotor].world_from_object[3] -
                            scene.instances[tail_rotor].world_from_object[3]);
        const double length = glm::length(forward);
        const double phase = kGoldenAngle * static_cast<double>(h);
        const auto drift = [&](double t) {
            const double angle = kTwoPi * t / kLoop;
            const double advance = kAdvance * (std::sin(angle + phase) - std::sin(phase));
            const double bob = kBob * length * (std::sin(angle - phase) + std::sin(phase));
            return forward * advance + dvec3(0.0, bob, 0.0);
        };
        const uint32_t node =
            add_node(scene.animation, {.name = "helicopter of " + scene.instances[hull].name});
        scene.animation.channels.push_back(smooth_path(node, vec3(0.0f), 8, drift));
        scene.animation.carried.push_back({hull, node, scene.instances[hull].world_from_object});
        add_rotor(scene, main_rotor, node, vec3(0, 1, 0), kMainTurns);
        add_rotor(scene, tail_rotor, node, vec3(1, 0, 0), kTailTurns);
    }
    sort_carried(scene.animation);
}

Scene make_swarm(uint32_t instances, uint64_t seed) {
    ONEPASS_CHECK_LT(0u, instances);
    Scene scene;
    scene.name = fmt::format("swarm-{}", instances);
    scene.background = vec3(0.12f, 0.15f, 0.2f);
    scene.ambient = vec3(0.15f);
    scene.objects = {make_sphere(11, 9)};
    for (const vec3& color : {vec3(0.8f, 0.3f, 0.2f), vec3(0.9f, 0.7f, 0.2f),
                              vec3(0.2f, 0.5f, 0.7f), vec3(0.4f, 0.6f, 0.3f)}) {
        scene.materials.push_back({.name = fmt::format("colour {}", scene.materials.size()),
                                   .diffuse = color,
                                   .specular = vec3(0.3f),
                                   .shininess = 40.0f,
                                   .reflectivity = 0.0f});
    }

    // Each has a place on a lattice of spacing 1, moves about it by less than half, and is small.
    Random random(seed);
    uint32_t side = 1;
    while (uint64_t{side} * side * side < instances) ++side;
    const float half = 0.5f * static_cast<float>(side);
    scene.animation.name = "swarm";
    for (uint32_t i = 0; i < instances; ++i) {
        const vec3 lattice(static_cast<float>(i % side), static_cast<float>(i / side % side),
                           static_cast<float>(i / side / side));
        const vec3 place = lattice + vec3(0.5f - half) + random.inside_cube(0.1f);
        const vec3 axis = glm::normalize(random.inside_cube(1.0f) + vec3(0.0f, 1.5f, 0.0f));
        const vec3 radii(random.between(0.15f, 0.3f), random.between(0.1f, 0.2f),
                         random.between(0.1f, 0.3f));
        const dvec3 ellipse = glm::normalize(glm::cross(dvec3(axis), dvec3(0.3, 0.2, 1.0)));
        const dvec3 across = glm::cross(dvec3(axis), ellipse);
        const float flatness = random.between(0.5f, 1.0f);
        const float reach = random.between(0.1f, 0.25f);

        scene.instances.push_back({fmt::format("member {}", i),
                                   0,
                                   compose(translation(place), scaling(radii)),
                                   {i % static_cast<uint32_t>(scene.materials.size())}});
        const uint32_t node = add_node(scene.animation, {.name = scene.instances.back().name,
                                                         .parent = kNoId,
                                                         .parent_from_base = affine_identity(),
                                                         .translation = place});
        scene.animation.channels.push_back(smooth_path(node, place, 4, [&](double t) {
            const double angle = kTwoPi * t / kLoop;
            return dvec3(place) + double{reach} * (ellipse * (std::cos(angle) - 1.0) +
                                                   across * (flatness * std::sin(angle)));
        }));
        scene.animation.channels.push_back(steady_turn(node, axis, i % 2 == 0 ? 1 : -1));
        scene.animation.carried.push_back({i, node, scaling(radii)});
    }

    scene.lights = {
        {.name = "key", .position = vec3(3.0f, 4.0f, 5.0f) * half, .intensity = vec3(0.85f)}};
    Camera camera = automatic_camera(scene_bounds(scene));
    camera.name = "main";
    scene.cameras = {camera};
    return scene;
}

}  // namespace onepass
