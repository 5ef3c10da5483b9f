// The generated scenes of our own, and balls-1. The paper's other scenes are in scenes/paper. Their
// counts are part of their contract; their looks were judged by eye.
#include <cmath>

#include "scenes/describe.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace onepass {

Scene make_balls_1() {
    Scene scene;
    scene.name = "balls-1";
    scene.background = vec3(0.09f, 0.13f, 0.22f);
    scene.ambient = vec3(0.1f);
    scene.objects.push_back(make_sphere(40, 40));

    // The floor is a ball as well, flattened; it bends down by less than 2 % of a ball's radius.
    constexpr float kFloorRadius = 14.0f;
    constexpr float kFloorThickness = 0.25f;  // half of it
    const auto floor_height = [&](float x, float z) {
        const float r = std::sqrt(x * x + z * z) / kFloorRadius;
        return kFloorThickness * (std::sqrt(1.0f - r * r) - 1.0f);
    };
    const uint32_t floor = add_material(scene, matte("floor", vec3(0.52f, 0.5f, 0.46f)));
    add_instance(scene, "floor", 0,
                 compose(translation(vec3(0, -kFloorThickness, 0)),
                         scaling(vec3(kFloorRadius, kFloorThickness, kFloorRadius))),
                 {floor});

    struct Ball {
        const char* name;
        float x, z, radius;
        Material material;
    };
    const Ball balls[] = {
        // Two mirrors face each other slantwise, so that the camera sees each one in the other.
        {"left mirror", -2.1f, -2.1f, 1.7f, mirror("silver", vec3(0.7f, 0.74f, 0.8f))},
        {"right mirror", 2.2f, 0.1f, 1.5f, mirror("gold", vec3(0.9f, 0.65f, 0.2f))},
        // Coloured balls lie between and before them, so that both reflect most of them.
        {"red", 0.15f, -1.2f, 0.5f, glossy("red", vec3(0.8f, 0.1f, 0.08f), 60.0f)},
        {"yellow", -0.9f, 0.6f, 0.55f, glossy("yellow", vec3(0.9f, 0.7f, 0.1f), 30.0f)},
        {"blue", 0.45f, 1.6f, 0.6f, glossy("blue", vec3(0.1f, 0.25f, 0.8f), 80.0f)},
        {"green", -2.6f, 1.4f, 0.6f, matte("green", vec3(0.15f, 0.6f, 0.2f))},
        {"white", 2.0f, 2.5f, 0.45f, matte("white", vec3(0.85f))},
        {"violet", -0.9f, 2.7f, 0.35f, glossy("violet", vec3(0.5f, 0.15f, 0.6f), 100.0f)},
        {"orange", 1.3f, -4.0f, 1.0f, matte("orange", vec3(0.9f, 0.4f, 0.1f))},
    };
    for (const Ball& ball : balls) {
        const vec3 centre(ball.x, floor_height(ball.x, ball.z) + ball.radius, ball.z);
        add_instance(scene, ball.name, 0, compose(translation(centre), scaling(vec3(ball.radius))),
                     {add_material(scene, ball.material)});
    }

    scene.lights = {light("key", vec3(5, 9, 7), vec3(0.75f, 0.73f, 0.68f)),
                    light("fill", vec3(-7, 6, 4), vec3(0.32f, 0.35f, 0.42f))};
    scene.cameras = {camera(vec3(0.2f, 3.9f, 10.8f), vec3(0, 0.75f, -0.3f))};
    orbiting_mirrors(scene);
    return scene;
}

Scene make_instances() {
    Scene scene;
    scene.name = "instances";
    scene.background = vec3(0.2f, 0.23f, 0.28f);
    scene.ambient = vec3(0.12f);
    const uint32_t ground = add_material(scene, matte("ground", vec3(0.55f, 0.56f, 0.52f)));
    const uint32_t clay = add_material(scene, matte("clay", vec3(0.75f, 0.4f, 0.25f)));
    const uint32_t glaze = add_material(scene, glossy("glaze", vec3(0.1f, 0.45f, 0.5f), 60.0f));
    const uint32_t wood = add_material(scene, matte("wood", vec3(0.6f, 0.45f, 0.25f)));
    const uint32_t plum = add_material(scene, glossy("plum", vec3(0.45f, 0.15f, 0.4f), 40.0f));
    const uint32_t chrome = add_material(scene, mirror("chrome", vec3(0.7f)));

    // An hourglass of two groups, so that instances differ in materials group by group.
    std::vector<vec2> lower{{0, 0}};
    std::vector<vec2> upper{{0, 1}};
    constexpr int kPoints = 16;
    for (int i = 0; i <= kPoints; ++i) {
        const float y = static_cast<float>(i) / kPoints;
        const float radius = 0.2f + 0.5f * (1.0f - y) * (1.0f - y);
        lower.emplace_back(radius, y);
        upper.emplace_back(0.2f + 0.5f * y * y, 1.0f + y);
    }
    lower.emplace_back(0.0f, 1.0f);
    upper.emplace_back(0.0f, 2.0f);
    Object hourglass;
    hourglass.name = "hourglass";
    append_shape(hourglass, make_lathe(lower, 32), affine_identity(), "lower");
    append_shape(hourglass, make_lathe(upper, 32), affine_identity(), "upper");
    scene.objects = {make_grid(12, 12), make_box(4, 3, 2), make_sphere(32, 24), hourglass};
    constexpr uint32_t kGround = 0, kBox = 1, kBall = 2, kHourglass = 3;

    const vec3 y_axis(0, 1, 0);
    add_instance(scene, "ground", kGround, scaling(vec3(14, 1, 14)), {ground});

    // Rotated and unevenly scaled, in both orders: the second shears.
    add_instance(scene, "plank", kBox,
                 compose(translation(vec3(-3.2f, 0.65f, 0.3f)),
                         compose(rotation(vec3(0.3f, 1, 0.2f), 35), scaling(vec3(2.4f, 0.5f, 1)))),
                 {wood});
    add_instance(
        scene, "squeezed box", kBox,
        compose(translation(vec3(3.3f, 1.05f, -0.6f)),
                compose(scaling(vec3(0.7f, 1.5f, 1.1f)), rotation(vec3(1, 0.4f, 0.7f), 50))),
        {plum});
    add_instance(scene, "sheared box", kBox,
                 compose(translation(vec3(-2.6f, 0.6f, -2.9f)),
                         compose(shear_x_by_y(0.8f), scaling(vec3(1.2f)))),
                 {glaze});

    // Mirrored: negative determinants, with and without vertex normals.
    add_instance(scene, "mirrored hourglass", kHourglass,
                 compose(translation(vec3(2.1f, 0, 2)),
                         compose(rotation(vec3(0, 0, 1), -12), scaling(vec3(-0.8f, 0.8f, 1)))),
                 {glaze, wood});
    add_instance(scene, "mirrored box", kBox,
                 compose(translation(vec3(0.2f, 0.35f, 2.9f)),
                         compose(rotation(y_axis, 25), scaling(vec3(0.9f, 0.7f, -0.6f)))),
                 {clay});
    add_instance(scene, "hanging hourglass", kHourglass,
                 compose(translation(vec3(-1.2f, 4.6f, -2.2f)),
                         compose(rotation(vec3(1, 0, 0.5f), 20), scaling(vec3(0.6f, -0.9f, 0.6f)))),
                 {plum, clay});

    // A ring of balls about the waist of a large hourglass: boxes inside a box.
    add_instance(scene, "large hourglass", kHourglass, scaling(vec3(1.3f)), {clay, glaze});
    constexpr int kRing = 5;
    for (int i = 0; i < kRing; ++i) {
        const float degrees = 360.0f * static_cast<float>(i) / kRing + 20.0f;
        const Affine on_ring =
            compose(rotation(y_axis, degrees), translation(vec3(0.62f, 1.3f, 0)));
        add_instance(scene, "ring", kBall,
                     compose(on_ring, compose(rotation(vec3(0, 0, 1), 30),
                                              scaling(vec3(0.16f, 0.3f, 0.2f)))),
                     {i % 2 == 0 ? chrome : plum});
    }
    add_instance(scene, "chrome egg", kBall,
                 compose(translation(vec3(-1.5f, 0.75f, 2.1f)),
                         compose(rotation(vec3(1, 0, 1), 40), scaling(vec3(0.55f, 0.9f, 0.6f)))),
                 {chrome});

    scene.lights = {light("key", vec3(4, 8, 6), vec3(0.8f, 0.78f, 0.72f)),
                    light("fill", vec3(-8, 5, 3), vec3(0.3f, 0.33f, 0.4f))};
    scene.cameras = {camera(vec3(2.6f, 4.2f, 10.5f), vec3(0, 1.35f, 0))};
    return scene;
}

Scene make_big_small() {
    Scene scene;
    scene.name = "big-small";
    scene.background = vec3(0.25f, 0.3f, 0.38f);
    scene.ambient = vec3(0.15f);
    const uint32_t sail = add_material(scene, glossy("sail", vec3(0.75f, 0.3f, 0.15f), 40.0f));
    const uint32_t field = add_material(scene, matte("field", vec3(0.35f, 0.55f, 0.3f)));

    // Both kinds are one object, so that one grid holds them.
    Object object;
    object.name = "big-small";

    // Three large triangles stand over the field; three lie in it at a slant, so that bumps come
    // through: a ray's first cell then refers to a triangle that it only meets behind a bump.
    const vec3 corners[6][3] = {
        {{-4.6f, 0.2f, -3.9f}, {4.4f, 0.3f, -4.2f}, {-0.4f, 3.6f, -3.4f}},
        {{-4.7f, 0.1f, 3.6f}, {-4.4f, 0.4f, -3.7f}, {-3.7f, 2.7f, 0.3f}},
        {{1.6f, 0.3f, -3.2f}, {4.5f, 0.2f, 2.9f}, {3.4f, 2.4f, -1.1f}},
        {{-4.3f, -0.25f, -4.1f}, {-3.9f, 0.35f, 4.3f}, {3.8f, 0.1f, -3.6f}},
        {{4.6f, -0.3f, 4.4f}, {4.2f, 0.4f, -3.3f}, {-3.6f, 0.2f, 3.9f}},
        {{-4.4f, 0.3f, 0.4f}, {0.3f, -0.2f, 4.6f}, {4.4f, 0.25f, -0.6f}},
    };
    for (const auto& triangle : corners) {
        const auto first = static_cast<uint32_t>(object.positions.size());
        object.positions.insert(object.positions.end(), std::begin(triangle), std::end(triangle));
        object.triangles.emplace_back(first, first + 1, first + 2);
    }
    object.groups = {{"large", 0, 6}};

    Object bumps = make_grid(100, 100);
    constexpr float kSize = 10.0f;
    for (vec3& p : bumps.positions) {
        p *= kSize;
        const double waves = std::sin(3.1 * p.x) * std::cos(2.7 * p.z) +
                             0.5 * std::sin(7.3 * p.x + 1.7 * p.z) * std::sin(5.9 * p.z);
        p.y = static_cast<float>(0.3 * waves);
    }
    append_shape(object, bumps, affine_identity(), "field");
    scene.objects = {std::move(object)};
    add_instance(scene, "big-small", 0, affine_identity(), {sail, field});

    scene.lights = {light("key", vec3(3, 9, 8), vec3(0.85f, 0.82f, 0.75f))};
    scene.cameras = {camera(vec3(4.5f, 5.2f, 10.5f), vec3(0, 0.2f, 0))};
    return scene;
}

Scene make_ball_on_ground() {
    Scene scene;
    scene.name = "ball-on-ground";
    scene.background = vec3(0.35f, 0.45f, 0.6f);
    scene.ambient = vec3(0.15f);
    const uint32_t marble = add_material(scene, glossy("marble", vec3(0.75f, 0.7f, 0.6f), 60.0f));
    const uint32_t ground = add_material(scene, matte("ground", vec3(0.35f, 0.42f, 0.25f)));

    // One object, so that one grid holds both.
    constexpr float kGroundSide = 500.0f;  // in radii of the ball
    Object object;
    object.name = "ball on ground";
    append_shape(object, make_sphere(264, 133), translation(vec3(0, 1, 0)), "ball");
    object.normals.clear();
    append_shape(object, make_grid(8, 8), scaling(vec3(kGroundSide, 1, kGroundSide)), "ground");
    scene.objects = {std::move(object)};
    add_instance(scene, "ball on ground", 0, affine_identity(), {marble, ground});

    scene.lights = {light("key", vec3(4, 7, 5), vec3(0.85f, 0.82f, 0.75f))};
    scene.cameras = {camera(vec3(2.4f, 2.6f, 4.2f), vec3(0, 0.85f, 0))};
    return scene;
}

}  // namespace onepass
