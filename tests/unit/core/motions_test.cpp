// The built-in motions: they start and end at the scene as it was built, loop, and collide nowhere.
#include "scenes/motions.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;

constexpr int kSteps = 480;  // ten a frame of a loop of 2 s at 24 frames a second
constexpr double kLoop = 2.0;

bool same_bits(const Affine& a, const Affine& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

void expect_starts_and_ends_as_built(const Scene& scene) {
    EXPECT_NO_THROW(validate(scene));
    EXPECT_EQ(scene.animation.duration(), kLoop);
    for (const double time : {0.0, kLoop}) {
        const std::vector<Affine> transforms = instance_transforms(scene, time);
        for (size_t i = 0; i < transforms.size(); ++i) {
            EXPECT_TRUE(same_bits(transforms[i], scene.instances[i].world_from_object))
                << scene.instances[i].name << " at " << time;
        }
    }
}

size_t index_of(const Scene& scene, const std::string& name) {
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].name == name) return i;
    }
    ADD_FAILURE() << "no " << name;
    return 0;
}

/// The largest distance that instance `i` moves in a step of the loop, and in the step from its
/// last to its first.
double largest_step(const Scene& scene, size_t i) {
    double largest = 0.0;
    vec3 before = instance_transforms(scene, kLoop * (1.0 - 1.0 / kSteps))[i][3];
    for (int s = 0; s < kSteps; ++s) {
        const vec3 now = instance_transforms(scene, kLoop * s / kSteps)[i][3];
        largest = std::max<double>(largest, glm::length(now - before));
        before = now;
    }
    return largest;
}

// ---- Orbiting mirrors ----

TEST(OrbitingMirrors, start_and_end_at_the_published_still) {
    expect_starts_and_ends_as_built(make_balls_1());
}

TEST(OrbitingMirrors, go_once_round_each_other) {
    const Scene scene = make_balls_1();
    const size_t left = index_of(scene, "left mirror");
    const size_t right = index_of(scene, "right mirror");
    const auto arm_at = [&](double time) {
        const std::vector<Affine> t = instance_transforms(scene, time);
        const vec3 arm = t[right][3] - t[left][3];
        return dvec3(arm.x, 0.0, arm.z);
    };
    const dvec3 first = arm_at(0.0);
    double turned = 0.0;
    dvec3 before = first;
    for (int s = 1; s <= kSteps; ++s) {
        const dvec3 arm = arm_at(kLoop * s / kSteps);
        EXPECT_NEAR(glm::length(arm), glm::length(first), 1e-4);  // splines of 24 keys
        turned += std::atan2(glm::cross(before, arm).y, glm::dot(before, arm));
        before = arm;
    }
    EXPECT_NEAR(std::abs(turned), 2.0 * 3.14159265, 1e-5);  // float positions
}

TEST(OrbitingMirrors, no_ball_ever_touches_another_or_passes_through_the_floor) {
    const Scene scene = make_balls_1();
    const size_t floor = index_of(scene, "floor");
    const Affine world_from_floor = scene.instances[floor].world_from_object;
    const Affine floor_from_world(inverse(world_from_floor));
    for (int s = 0; s < kSteps; ++s) {
        const double time = kLoop * s / kSteps;
        const std::vector<Affine> t = instance_transforms(scene, time);
        ASSERT_TRUE(same_bits(t[floor], world_from_floor));
        for (size_t i = 0; i < t.size(); ++i) {
            if (i == floor) continue;
            const float radius = t[i][1].y;
            // The floor bends down from a ball's lowest point, so that point decides.
            const vec3 lowest = t[i][3] - vec3(0, radius, 0);
            const float depth = 1.0f - glm::length(transform_point(floor_from_world, lowest));
            // In units of the floor's thickness; at rest a ball lies on it to within rounding.
            EXPECT_LE(depth, 1e-4f) << scene.instances[i].name << " at " << time;
            for (size_t k = 0; k < i; ++k) {
                if (k == floor) continue;
                EXPECT_GT(glm::length(t[i][3] - t[k][3]), radius + t[k][1].y + 0.05f)
                    << scene.instances[i].name << " and " << scene.instances[k].name << " at "
                    << time;
            }
        }
    }
}

TEST(OrbitingMirrors, move_without_jumps_and_some_balls_hop) {
    const Scene scene = make_balls_1();
    int hopping = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].name == "floor") continue;
        EXPECT_LT(largest_step(scene, i), 0.06)
            << scene.instances[i].name;  // 4 m round in 480 steps
        float highest = 0.0f;
        for (int s = 0; s < kSteps; ++s) {
            const std::vector<Affine> t = instance_transforms(scene, kLoop * s / kSteps);
            highest = std::max(highest, t[i][3].y - scene.instances[i].world_from_object[3].y);
        }
        hopping += highest > 0.3f;
    }
    EXPECT_EQ(hopping, 7);
}

TEST(OrbitingMirrors, ask_for_the_balls_that_they_know) {
    Scene scene = make_instances();
    const Error error = error_of([&] { orbiting_mirrors(scene); });
    EXPECT_TRUE(contains(error.what(), "'floor'"));
    EXPECT_TRUE(test::is_clear(error));
}

// ---- Turning rotors ----

/// Two helicopters of boxes; rotors are placed with their axes through their objects' origins, and
/// scaled alike across them.
Scene two_helicopters() {
    Scene scene;
    scene.name = "two helicopters";
    scene.objects = {make_box(1, 1, 1)};
    scene.materials.resize(1);
    for (const char* number : {"07", "12"}) {
        const Affine place = number[0] == '0' ? translation(vec3(0.1f, 0.2f, 0.3f))
                                              : compose(translation(vec3(20, 3, -7)),
                                                        rotation(vec3(0.1f, 1, 0), 50));
        const auto add = [&](const std::string& kind, const Affine& hull_from_object) {
            scene.instances.push_back(
                {kind + " " + number, 0, compose(place, hull_from_object), {0}});
        };
        add("tail rotor", compose(translation(vec3(0.3f, 1, 8)), scaling(vec3(0.1f, 1, 1))));
        add("hull", scaling(vec3(2, 2, 9)));
        add("main rotor", compose(translation(vec3(0, 1.5f, 0)), scaling(vec3(5, 0.1f, 5))));
    }
    scene.instances.push_back({"ground", 0, scaling(vec3(100, 0.1f, 100)), {0}});
    return scene;
}

TEST(TurningRotors, start_and_end_as_built) {
    Scene scene = two_helicopters();
    turning_rotors(scene);
    expect_starts_and_ends_as_built(scene);
    EXPECT_EQ(scene.animation.carried.size(), 6u) << "the ground stays";
}

TEST(TurningRotors, turn_about_their_own_axes_and_go_with_their_hull) {
    Scene scene = two_helicopters();
    turning_rotors(scene);
    struct Rotor {
        const char* name;
        const char* hull;
        int axis;
    };
    const std::vector<Affine> start = instance_transforms(scene, 0.0);
    for (const double time : {0.05, 0.3, 1.1}) {
        const std::vector<Affine> now = instance_transforms(scene, time);
        for (const Rotor& rotor : {Rotor{"main rotor 07", "hull 07", 1},
                                   {"tail rotor 07", "hull 07", 0},
                                   {"main rotor 12", "hull 12", 1},
                                   {"tail rotor 12", "hull 12", 0}}) {
            const size_t i = index_of(scene, rotor.name);
            const size_t hull = index_of(scene, rotor.hull);
            // The hub moves as the hull does, the axis stays, and the blades do not.
            const vec3 hull_step = now[hull][3] - start[hull][3];
            EXPECT_LE(glm::length(now[i][3] - start[i][3] - hull_step), 1e-5f) << rotor.name;
            const vec3 axis = start[i][rotor.axis];
            EXPECT_LE(glm::length(now[i][rotor.axis] - axis), 1e-5f * glm::length(axis));
            const vec3 blade = start[i][2];
            EXPECT_GT(glm::length(now[i][2] - blade), 0.01f * glm::length(blade));
            EXPECT_NEAR(glm::dot(glm::normalize(axis), glm::normalize(now[i][2])), 0.0f, 1e-5f);
        }
    }
}

TEST(TurningRotors, show_their_sense_at_24_frames_a_second) {
    // Between two frames a rotor turns by less than half the angle between two blades.
    Scene scene = two_helicopters();
    turning_rotors(scene);
    const std::vector<Affine> start = instance_transforms(scene, 0.0);
    const std::vector<Affine> next = instance_transforms(scene, 1.0 / 24.0);
    for (const auto& [name, blades] : {std::pair{"main rotor 07", 5}, {"tail rotor 07", 3}}) {
        const size_t i = index_of(scene, name);
        const float cosine = glm::dot(glm::normalize(start[i][2]), glm::normalize(next[i][2]));
        EXPECT_LT(std::acos(cosine), 3.14159265f / static_cast<float>(blades)) << name;
    }
}

TEST(TurningRotors, keep_the_hulls_near_where_they_were_but_not_still) {
    Scene scene = two_helicopters();
    turning_rotors(scene);
    for (const char* name : {"hull 07", "hull 12"}) {
        const size_t i = index_of(scene, name);
        const vec3 rest = scene.instances[i].world_from_object[3];
        float farthest = 0.0f;
        for (int s = 0; s < kSteps; ++s) {
            const vec3 now = instance_transforms(scene, kLoop * s / kSteps)[i][3];
            farthest = std::max(farthest, glm::length(now - rest));
        }
        EXPECT_GT(farthest, 0.2f) << name;
        EXPECT_LT(farthest, 2.5f) << name;  // of a length of 9
    }
}

TEST(TurningRotors, ask_for_hulls_with_both_rotors) {
    Scene scene = two_helicopters();
    scene.instances[0].name = "broken off";
    EXPECT_TRUE(contains(error_of([&] { turning_rotors(scene); }).what(), "'tail rotor 07'"));
    Scene balls = make_balls_1();
    balls.animation = {};
    EXPECT_TRUE(contains(error_of([&] { turning_rotors(balls); }).what(), "'hull NN'"));
}

// ---- Swarms ----

TEST(Swarm, starts_and_ends_as_built) { expect_starts_and_ends_as_built(make_swarm(50, 3)); }

TEST(Swarm, is_the_same_for_the_same_seed_and_another_for_another) {
    EXPECT_EQ(make_swarm(20, 7), make_swarm(20, 7));
    EXPECT_NE(make_swarm(20, 7), make_swarm(20, 8));
}

TEST(Swarm, moves_every_instance_and_keeps_its_density) {
    for (const uint32_t count : {1u, 10u, 1000u}) {
        const Scene scene = make_swarm(count, 1);
        EXPECT_EQ(scene.instances.size(), count);
        EXPECT_EQ(scene.animation.carried.size(), count);
        const std::vector<Affine> moved = instance_transforms(scene, 0.7);
        for (uint32_t i = 0; i < count; ++i) {
            const Affine& rest = scene.instances[i].world_from_object;
            EXPECT_GT(glm::length(moved[i][3] - rest[3]), 0.01f) << i;
            EXPECT_LT(glm::length(moved[i][3] - rest[3]), 1.0f) << i;
            EXPECT_NE(moved[i][0], rest[0]) << i;
        }
        const vec3 size = scene_bounds(scene).extent();
        const double side = std::ceil(std::cbrt(static_cast<double>(count)) - 1e-6);
        EXPECT_LT(size.x, side + 0.5) << "a member a unit cell";
    }
}

}  // namespace
}  // namespace onepass
