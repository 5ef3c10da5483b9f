#include "scenes/motions.h"

#include <cmath>
#include <numbers>
#include <random>

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

}  // namespace

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
