// Keyframes to transforms: each interpolation against its formula, trees against products, the rest
// pose to the bit, and what an animation may not be.
#include "core/animation.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/scene.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;
using test::quad_scene;
using Interpolation = AnimationChannel::Interpolation;
using Path = AnimationChannel::Path;

/// A quad carried by one node, which `channels` move.
Scene moving_quad(std::vector<AnimationChannel> channels, AnimatedNode node = {}) {
    Scene scene = quad_scene();
    scene.animation.nodes = {std::move(node)};
    scene.animation.channels = std::move(channels);
    scene.animation.carried = {{.instance = 0, .node = 0}};
    return scene;
}

AnimationChannel channel(Path path, Interpolation interpolation, std::vector<float> times,
                         std::vector<vec4> values) {
    return {0, path, interpolation, std::move(times), std::move(values)};
}

Affine transform_at(const Scene& scene, double time_s) {
    return instance_transforms(scene, time_s).at(0);
}

vec3 position_at(const Scene& scene, double time_s) { return transform_at(scene, time_s)[3]; }

bool same_bits(const Affine& a, const Affine& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

/// Largest difference of any entry.
float difference(const Affine& a, const Affine& b) {
    float largest = 0.0f;
    for (int i = 0; i < 12; ++i) {
        largest = std::max(largest, std::abs(a[i / 3][i % 3] - b[i / 3][i % 3]));
    }
    return largest;
}

/// Entries of about 1 that were rounded to float twice.
constexpr float kUnitRounding = 2 * std::numeric_limits<float>::epsilon();

vec4 turn(const vec3& axis, double degrees) {
    const double half = degrees * std::numbers::pi / 360.0;
    return vec4(glm::normalize(axis) * static_cast<float>(std::sin(half)),
                static_cast<float>(std::cos(half)));
}

// ---- Interpolation ----

TEST(Keyframes, step_holds_a_value_until_the_next_key) {
    const Scene scene = moving_quad({channel(Path::translation, Interpolation::step, {1, 2, 4},
                                             {{1, 0, 0, 0}, {2, 0, 0, 0}, {4, 0, 0, 0}})});
    for (const auto& [time, x] : {std::pair{0.0, 1.0f},
                                  {1.0, 1.0f},
                                  {1.999, 1.0f},
                                  {2.0, 2.0f},
                                  {3.999, 2.0f},
                                  {4.0, 4.0f},
                                  {9.0, 4.0f}}) {
        EXPECT_EQ(position_at(scene, time), vec3(x, 0, 0)) << time;
    }
}

TEST(Keyframes, linear_divides_the_way_between_two_keys_and_stays_at_the_ends) {
    const Scene scene = moving_quad({channel(Path::translation, Interpolation::linear, {0.5f, 2.5f},
                                             {{1, 10, -1, 0}, {3, 20, -3, 0}})});
    EXPECT_EQ(position_at(scene, -7.0), vec3(1, 10, -1));
    EXPECT_EQ(position_at(scene, 0.5), vec3(1, 10, -1));
    EXPECT_EQ(position_at(scene, 1.0), vec3(1.5f, 12.5f, -1.5f));
    EXPECT_EQ(position_at(scene, 2.5), vec3(3, 20, -3));
    EXPECT_EQ(position_at(scene, 1e30), vec3(3, 20, -3));
    EXPECT_EQ(scene.animation.duration(), 2.5f);
}

TEST(Keyframes, a_cubic_spline_through_a_cubic_is_that_cubic) {
    // x(t) = t^3 - 2 t^2 + 3 between the uneven times 1, 2 and 4, by its values and slopes.
    const auto x = [](double t) { return t * t * t - 2 * t * t + 3; };
    const auto slope = [](double t) { return 3 * t * t - 4 * t; };
    std::vector<vec4> values;
    for (const double t : {1.0, 2.0, 4.0}) {
        const vec4 tangent(static_cast<float>(slope(t)), 0, 0, 0);
        values.insert(values.end(), {tangent, vec4(static_cast<float>(x(t)), 0, 0, 0), tangent});
    }
    const Scene scene =
        moving_quad({channel(Path::translation, Interpolation::cubic_spline, {1, 2, 4}, values)});
    for (const double t : {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.75, 4.0}) {
        EXPECT_FLOAT_EQ(position_at(scene, t).x, static_cast<float>(x(t))) << t;
    }
}

TEST(Keyframes, tangents_before_and_after_a_key_may_differ) {
    // From 0 to 1 with the outgoing slope 2 and the incoming slope 0, along x = 2 t - t^2.
    const Scene scene = moving_quad({channel(
        Path::translation, Interpolation::cubic_spline, {0, 1},
        {{99, 0, 0, 0}, {0, 0, 0, 0}, {2, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {99, 0, 0, 0}})});
    EXPECT_FLOAT_EQ(position_at(scene, 0.5).x, 0.75f);
}

TEST(Keyframes, linear_rotations_turn_at_even_speed) {
    const vec3 axis(1, 2, -0.5f);
    const Scene scene = moving_quad(
        {channel(Path::rotation, Interpolation::linear, {0, 1}, {turn(axis, 0), turn(axis, 150)})});
    for (const float part : {0.1f, 0.25f, 0.5f, 0.9f}) {
        EXPECT_LE(difference(transform_at(scene, part), rotation(axis, 150 * part)),
                  4 * kUnitRounding)
            << part;
    }
}

TEST(Keyframes, linear_rotations_go_the_short_way_round) {
    // -q is the same rotation as q, and its path from the start would be the long one.
    const vec3 axis(0, 1, 0);
    const Scene scene = moving_quad({channel(Path::rotation, Interpolation::linear, {0, 1},
                                             {turn(axis, 10), -turn(axis, 90)})});
    EXPECT_LE(difference(transform_at(scene, 0.5), rotation(axis, 50)), 4 * kUnitRounding);
    EXPECT_LE(difference(transform_at(scene, 1.0), rotation(axis, 90)), 4 * kUnitRounding);
}

TEST(Keyframes, nearly_equal_and_opposite_rotations_give_no_nan) {
    const vec4 q = turn(vec3(3, 1, 2), 77);
    const vec4 opposite = turn(vec3(3, 1, 2), 77 + 360);  // -q
    vec4 near = q;
    near.x = std::nextafter(near.x, 1.0f);
    for (const vec4& to : {q, -q, near, opposite}) {
        const Scene scene =
            moving_quad({channel(Path::rotation, Interpolation::linear, {0, 1}, {q, to})});
        EXPECT_LE(difference(transform_at(scene, 0.3), rotation(vec3(3, 1, 2), 77)),
                  4 * kUnitRounding);
    }
}

TEST(Keyframes, rotations_need_not_be_of_unit_length) {
    const vec3 axis(1, 0, 1);
    const Scene scene = moving_quad({channel(Path::rotation, Interpolation::linear, {0, 1},
                                             {turn(axis, 20) * 3.0f, turn(axis, 60) * 0.2f})});
    EXPECT_LE(difference(transform_at(scene, 0.0), rotation(axis, 20)), 4 * kUnitRounding);
    EXPECT_LE(difference(transform_at(scene, 0.5), rotation(axis, 40)), 4 * kUnitRounding);
}

// ---- Trees ----

TEST(Nodes, compose_base_translation_rotation_and_scale_down_the_tree) {
    Scene scene = quad_scene();
    const Affine base0 = compose(translation(vec3(1, 2, 3)), rotation(vec3(1, 1, 0), 30));
    const Affine base1 = compose(translation(vec3(-2, 0, 1)), shear_x_by_y(0.5f));
    const Affine node_from_object = compose(rotation(vec3(0, 0, 1), 15), scaling(vec3(2, 3, 0.5f)));
    scene.animation.nodes = {
        {.name = "root", .parent = kNoId, .parent_from_base = base0, .translation = vec3(0, 1, 0)},
        {.name = "child", .parent = 0, .parent_from_base = base1, .scale = vec3(1, -2, 3)}};
    scene.animation.channels = {
        {0, Path::rotation, Interpolation::step, {0}, {turn(vec3(0, 1, 0), 40)}},
        {1, Path::translation, Interpolation::step, {0}, {vec4(5, 6, 7, 0)}}};
    scene.animation.carried = {{0, 1, node_from_object}};
    const Affine parts[] = {
        base0,           translation(vec3(0, 1, 0)), rotation(vec3(0, 1, 0), 40),
        base1,           translation(vec3(5, 6, 7)), scaling(vec3(1, -2, 3)),
        node_from_object};
    Affine expected = affine_identity();
    for (const Affine& part : parts) expected = compose(expected, part);
    // Seven rounded products of entries up to 20.
    EXPECT_LE(difference(transform_at(scene, 0.0), expected), 20 * 7 * kUnitRounding);
}

TEST(Nodes, move_what_they_carry_and_nothing_else) {
    Scene scene = moving_quad(
        {channel(Path::translation, Interpolation::linear, {0, 1}, {{0, 0, 0, 0}, {1, 0, 0, 0}})});
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object = rotation(vec3(1, 2, 3), 11);
    const std::vector<Affine> moved = instance_transforms(scene, 1.0);
    EXPECT_EQ(moved[0], translation(vec3(1, 0, 0)));
    EXPECT_TRUE(same_bits(moved[1], scene.instances[1].world_from_object));

    const Scene later = scene_at(scene, 1.0);
    EXPECT_EQ(later.instances[0].world_from_object, moved[0]);
    EXPECT_EQ(later.animation, scene.animation);
    EXPECT_EQ(later.objects, scene.objects);
}

TEST(Nodes, at_rest_keep_every_bit_of_the_transform) {
    // A transform that no sum with 0 or product with 1 would leave alone: it holds -0.
    Affine placed = compose(rotation(vec3(0.3f, 1, 0.2f), 33), scaling(vec3(1.7f, 0.3f, 2.9f)));
    placed[0].y = -0.0f;
    placed[3] = vec3(-0.0f, 1e-20f, 1e10f);
    const auto moving = channel(Path::rotation, Interpolation::linear, {0, 1},
                                {vec4(0, 0, 0, 1), turn(vec3(0, 1, 0), 90)});
    Scene by_base =
        moving_quad({moving}, {.name = "base", .parent = kNoId, .parent_from_base = placed});
    by_base.instances[0].world_from_object = placed;
    EXPECT_TRUE(same_bits(transform_at(by_base, 0.0), placed));
    EXPECT_FALSE(same_bits(transform_at(by_base, 0.5), placed));
    EXPECT_NO_THROW(validate(by_base));

    Scene by_object = moving_quad({moving});
    by_object.instances[0].world_from_object = placed;
    by_object.animation.carried[0].node_from_object = placed;
    EXPECT_TRUE(same_bits(transform_at(by_object, 0.0), placed));
    EXPECT_NO_THROW(validate(by_object));

    // A ball: a centre, and a size that its node carries.
    Scene ball = moving_quad({channel(Path::translation, Interpolation::cubic_spline, {0, 1},
                                      {{1, 2, 3, 0},
                                       {0.1f, 0.7f, -0.3f, 0},
                                       {1, 1, 1, 0},
                                       {1, 2, 3, 0},
                                       {5, 5, 5, 0},
                                       {1, 1, 1, 0}})},
                             {.name = "ball",
                              .parent = kNoId,
                              .parent_from_base = affine_identity(),
                              .translation = vec3(0.1f, 0.7f, -0.3f)});
    ball.instances[0].world_from_object =
        compose(translation(vec3(0.1f, 0.7f, -0.3f)), scaling(vec3(1.7f)));
    ball.animation.carried[0].node_from_object = scaling(vec3(1.7f));
    EXPECT_TRUE(same_bits(transform_at(ball, 0.0), ball.instances[0].world_from_object));
    EXPECT_NO_THROW(validate(ball));
}

TEST(Nodes, a_scale_of_0_on_the_way_names_node_instance_and_time) {
    const Scene scene = moving_quad(
        {channel(Path::scale, Interpolation::linear, {0, 2}, {{1, 1, 1, 0}, {-1, 1, 1, 0}})},
        {.name = "flattened"});
    EXPECT_NO_THROW(validate(scene));
    EXPECT_NO_THROW(instance_transforms(scene, 0.9));
    const Error error = error_of([&] { instance_transforms(scene, 1.0); });
    EXPECT_TRUE(contains(error.what(), "'flattened'"));
    EXPECT_TRUE(contains(error.what(), "'only'"));
    EXPECT_TRUE(contains(error.what(), "1 s"));
    EXPECT_TRUE(test::is_clear(error));
}

// ---- What validate() promises ----

void expect_refused(const Scene& scene, const std::string& part) {
    const Error error = error_of([&] { validate(scene); });
    EXPECT_TRUE(contains(error.what(), part));
    EXPECT_TRUE(test::is_clear(error));
}

/// `broken(scene)` changes a sound scene; validate() must then complain of `part`.
template <class Break>
void expect_broken(const std::string& part, Break&& broken) {
    Scene scene = moving_quad(
        {channel(Path::translation, Interpolation::linear, {0, 1}, {{0, 0, 0, 0}, {1, 0, 0, 0}}),
         channel(Path::rotation, Interpolation::linear, {0, 1}, {{0, 0, 0, 1}, {0, 0, 1, 0}})},
        {.name = "mover"});
    ASSERT_NO_THROW(validate(scene));
    broken(scene);
    expect_refused(scene, part);
}

TEST(ValidAnimation, has_indices_in_range_and_parents_first) {
    expect_broken("parent 0", [](Scene& s) { s.animation.nodes[0].parent = 0; });
    expect_broken("animated node 1", [](Scene& s) { s.animation.channels[0].node = 1; });
    expect_broken("animated node 9", [](Scene& s) { s.animation.carried[0].node = 9; });
    expect_broken("instance 1", [](Scene& s) { s.animation.carried[0].instance = 1; });
    expect_broken("one after 0",
                  [](Scene& s) { s.animation.carried.push_back(s.animation.carried[0]); });
}

TEST(ValidAnimation, has_ascending_times_and_a_value_for_each) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const std::vector<float>& times :
         {std::vector<float>{0, 0}, {1, 0}, {-1, 0}, {0, nan}, {nan, 1}, {0, kInfinity}}) {
        expect_broken("('mover'), key", [&](Scene& s) { s.animation.channels[0].times = times; });
    }
    expect_broken("no keys", [](Scene& s) { s.animation.channels[0].times = {}; });
    expect_broken("3 values", [](Scene& s) { s.animation.channels[0].values.emplace_back(0.0f); });
    expect_broken("6 for 2 times, of a cubic spline", [](Scene& s) {
        s.animation.channels[0].interpolation = Interpolation::cubic_spline;
    });
}

TEST(ValidAnimation, has_finite_values_and_rotations) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    expect_broken("value 1", [&](Scene& s) { s.animation.channels[0].values[1].y = nan; });
    expect_broken("then 0", [](Scene& s) { s.animation.channels[0].values[1].w = 1; });
    expect_broken("not all 0", [](Scene& s) { s.animation.channels[1].values[0] = vec4(0.0f); });
    expect_broken("rotation of 0", [](Scene& s) { s.animation.nodes[0].rotation = vec4(0.0f); });
    expect_broken("NaN", [&](Scene& s) { s.animation.nodes[0].scale.x = nan; });
    expect_broken("flattens",
                  [](Scene& s) { s.animation.nodes[0].parent_from_base = scaling(vec3(1, 0, 1)); });
    expect_broken("flattens", [](Scene& s) {
        s.animation.carried[0].node_from_object = scaling(vec3(1, 0, 1));
    });
}

TEST(ValidAnimation, has_one_channel_a_property_and_moves_something) {
    expect_broken("channel 0 alone",
                  [](Scene& s) { s.animation.channels.push_back(s.animation.channels[0]); });
    expect_broken("carry 0 instances", [](Scene& s) { s.animation.carried.clear(); });
    expect_broken("0 channels", [](Scene& s) { s.animation.channels.clear(); });
}

TEST(ValidAnimation, starts_from_where_the_instances_are_placed) {
    expect_broken("at rest", [](Scene& s) {
        s.instances[0].world_from_object[3].x = 1e-30f;  // all its terms are 0, so nothing rounds
    });

    // An inverse that is rounded to float is near enough; a difference of a millionth is not.
    Scene scene =
        moving_quad({channel(Path::rotation, Interpolation::step, {0}, {turn(vec3(1, 2, 3), 40)})},
                    {.name = "turned",
                     .parent = kNoId,
                     .parent_from_base = translation(vec3(100, -200, 300)),
                     .translation = vec3(0.1f, 0.2f, 0.3f),
                     .rotation = turn(vec3(3, 1, 2), 70)});
    scene.instances[0].world_from_object =
        compose(translation(vec3(7, 8, 9)), rotation(vec3(1, 0, 1), 25));
    const Affine node_from_world(inverse(Affine(rest_transforms(scene.animation)[0])));
    scene.animation.carried[0].node_from_object =
        compose(node_from_world, scene.instances[0].world_from_object);
    scene.instances[0].world_from_object = carried_transform(
        rest_transforms(scene.animation)[0], scene.animation.carried[0].node_from_object);
    for (int i = 0; i < 3; ++i) {
        float& entry = scene.instances[0].world_from_object[0][i];
        entry = std::nextafter(entry, 2.0f);
    }
    EXPECT_NO_THROW(validate(scene));
    scene.instances[0].world_from_object[0].x += 1e-6f;
    expect_refused(scene, "column 0, row 0");
}

}  // namespace
}  // namespace onepass
