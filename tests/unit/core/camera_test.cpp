// Cameras and primary rays.
#include "core/camera.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/errors.h"

namespace onepass {
namespace {

// Unit vectors made in double and rounded once: an ulp of 1 a component, sums of three of them.
constexpr float kUnitTolerance = 4 * std::numeric_limits<float>::epsilon();

TEST(LookAt, makes_an_orthonormal_right_handed_frame_that_looks_at_the_target) {
    const vec3 eye(1, 2, 3);
    const vec3 target(-4, 0.5f, 7);
    const Affine m = look_at(eye, target, vec3(0, 1, 0), 0.7f).world_from_camera;
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(glm::length(m[i]), 1.0f, kUnitTolerance);
        EXPECT_NEAR(glm::dot(m[i], m[(i + 1) % 3]), 0.0f, kUnitTolerance);
    }
    EXPECT_GT(determinant(m), 0.0);
    EXPECT_GT(m[1].y, 0.0f);
    EXPECT_EQ(m[3], eye);
    EXPECT_NEAR(glm::dot(-m[2], glm::normalize(target - eye)), 1.0f, kUnitTolerance);
}

TEST(LookAt, refuses_an_eye_on_the_target_and_an_up_along_the_view) {
    const vec3 eye(1, 2, 3);
    EXPECT_THROW(look_at(eye, eye, vec3(0, 1, 0), 1.0f), Error);
    EXPECT_THROW(look_at(eye, eye + vec3(0, -2, 0), vec3(0, 1, 0), 1.0f), Error);
    EXPECT_THROW(look_at(eye, vec3(0), vec3(0), 1.0f), Error);
}

TEST(PrimaryRay, starts_at_the_top_left_pixel_and_has_unit_depth) {
    const Camera camera = look_at(vec3(0, 0, 5), vec3(0), vec3(0, 1, 0), 1.0f);
    const CameraFrame frame = camera_frame(camera, 200, 100);
    const Ray top_left = primary_ray(frame, 0, 0);
    EXPECT_LT(top_left.dir.x, 0.0f);
    EXPECT_GT(top_left.dir.y, 0.0f);
    EXPECT_EQ(top_left.dir.z, -1.0f);
    const float half_height = std::tan(0.5f);
    EXPECT_NEAR(top_left.dir.y, half_height * 0.99f, kUnitTolerance);
    EXPECT_NEAR(top_left.dir.x, -half_height * 2.0f * 0.995f, 2 * kUnitTolerance);
}

/// True if the point lies in front of the camera and within a square image.
bool is_seen(const Camera& camera, const vec3& point) {
    const Affine& m = camera.world_from_camera;
    const vec3 d = point - m[3];
    const float depth = -glm::dot(d, m[2]);
    const float reach = depth * std::tan(0.5f * camera.vertical_fov);
    return depth > 0.0f && std::abs(glm::dot(d, m[0])) <= reach &&
           std::abs(glm::dot(d, m[1])) <= reach;
}

TEST(AutomaticCamera, sees_every_corner_of_boxes_of_all_shapes_and_sizes) {
    const Bounds boxes[] = {
        {vec3(-1), vec3(1)},
        {vec3(0), vec3(1000, 1, 1)},
        {vec3(5, 5, 5), vec3(6, 90, 6)},
        {vec3(0), vec3(0, 2, 7)},
        {vec3(-3e5f), vec3(-2e5f)},
        {vec3(1e-6f), vec3(3e-6f)},
        {vec3(-1, 0, 0), vec3(1, 0, 0)},
    };
    for (const Bounds& box : boxes) {
        const Camera camera = automatic_camera(box);
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 p(corner & 1 ? box.upper.x : box.lower.x,
                         corner & 2 ? box.upper.y : box.lower.y,
                         corner & 4 ? box.upper.z : box.lower.z);
            EXPECT_TRUE(is_seen(camera, p)) << "corner " << corner << " of the box from x "
                                            << box.lower.x << " to " << box.upper.x;
        }
    }
}

TEST(AutomaticCamera, fills_the_image) {
    // Moved a fifth closer it would lose a corner: the scene is not a speck in the middle.
    const Bounds box{vec3(-1, -2, -3), vec3(1, 2, 3)};
    Camera camera = automatic_camera(box);
    camera.world_from_camera[3] *= 0.8f;
    bool all_seen = true;
    for (int corner = 0; corner < 8; ++corner) {
        all_seen &=
            is_seen(camera, vec3(corner & 1 ? 1 : -1, corner & 2 ? 2 : -2, corner & 4 ? 3 : -3));
    }
    EXPECT_FALSE(all_seen);
}

TEST(AutomaticCamera, exists_for_a_single_point) {
    EXPECT_NO_THROW(automatic_camera({vec3(0), vec3(0)}));
    EXPECT_NO_THROW(automatic_camera({vec3(1e6f), vec3(1e6f)}));
}

}  // namespace
}  // namespace onepass
