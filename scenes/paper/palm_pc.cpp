// palm-pc: a handheld computer and its stylus on a table. Lengths in centimetres; the computer lies
// with its screen up, its upper end towards -z.
//
// Body S(80,51), 2 buttons and 1 pad S(32,21), stylus S(24,33), screen G(1,1), table G(11,7).
#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

constexpr float kFace = 1.7f;     // height of the body's upper face
constexpr float kRecess = 1.56f;  // ... and of the recess that the screen lies in
constexpr vec2 kScreen{5.4f, 6.7f};
constexpr float kScreenCentre = 1.45f;  // up from the body's middle

/// Sections are outlines, stacked from the table to the recess; x across, y up along the body.
Object make_body() {
    constexpr float kMiddle = kScreenCentre;
    const float half_width = 0.5f * kScreen.x + 0.2f;
    const float low = kMiddle - 0.5f * kScreen.y - 0.2f;
    const float high = kMiddle + 0.5f * kScreen.y + 0.2f;
    const Section keys[] = {
        {0.1f, 0, 0, 0, 0, 5},
        {0.1f, 3.4f, -5.5f, 0.3f, 5.5f, 5},
        {0.25f, 3.75f, -5.85f, 0.3f, 5.85f, 5},
        {0.8f, 3.95f, -6.05f, 0.3f, 6.05f, 5},
        {0.82f, 3.87f, -5.97f, 0.3f, 5.97f, 5},
        {0.9f, 3.87f, -5.97f, 0.3f, 5.97f, 5},
        {0.92f, 3.95f, -6.05f, 0.3f, 6.05f, 5},
        {1.35f, 3.9f, -6.0f, 0.3f, 6.0f, 5},
        {kFace - 0.08f, 3.7f, -5.8f, 0.4f, 5.8f, 5},
        {kFace, 3.45f, -5.5f, 0.5f, 5.5f, 6},
        {kFace + 0.02f, half_width + 0.12f, low - 0.12f, kMiddle, high + 0.12f, 14},
        {kFace, half_width, low, kMiddle, high, 14},
        {kRecess, half_width - 0.03f, low + 0.03f, kMiddle, high - 0.03f, 14},
        {kRecess, 0, 0, kMiddle, 0, 14},
    };
    Object body = lofted(keys, 80, 51);
    set_groups(body, {"shell", "groove", "recess"}, [](const vec3& c) {
        const bool inside = glm::abs(c.x) < 0.5f * kScreen.x + 0.21f && c.z > 0.95f &&
                            glm::abs(c.y - kScreenCentre) < 0.5f * kScreen.y + 0.21f;
        if (inside && c.z < kFace + 0.005f) return 2u;
        return c.z > 0.8f && c.z < 0.92f ? 1u : 0u;
    });
    set_normals(body, 35);
    return body;
}

/// Height 1; radii in centimetres.
Object make_stylus() {
    const vec2 keys[] = {{0, 0},         {0.05f, 0.002f}, {0.09f, 0.02f}, {0.24f, 0.1f},
                         {0.28f, 0.11f}, {0.28f, 0.8f},   {0.22f, 0.81f}, {0.22f, 0.825f},
                         {0.3f, 0.835f}, {0.3f, 0.96f},   {0.2f, 0.99f},  {0, 1}};
    Object stylus = turned(keys, 24, 33);
    set_groups(stylus, {"tip", "barrel", "cap"}, [](const vec3& c) {
        return c.y < 0.11f ? 0u : c.y < 0.815f ? 1u : 2u;
    });
    return stylus;
}

}  // namespace

Scene make_palm_pc() {
    Scene scene;
    scene.name = "palm-pc";
    scene.background = vec3(0.35f, 0.45f, 0.6f);
    scene.ambient = vec3(0.2f);
    const uint32_t shell =
        add_material(scene, glossy("shell", vec3(0.24f, 0.27f, 0.32f), 50, 0.45f));
    const uint32_t black = add_material(scene, glossy("black", vec3(0.04f), 30, 0.3f));
    const uint32_t chrome = add_material(scene, mirror("chrome", vec3(0.7f), 0.5f));
    const uint32_t blue = add_material(scene, glossy("blue", vec3(0.06f, 0.15f, 0.5f), 60));
    const uint32_t display =
        add_material(scene, mirror("display", vec3(0.36f, 0.48f, 0.34f), 0.35f));
    const uint32_t wood = add_material(scene, matte("wood", vec3(0.3f, 0.14f, 0.055f)));
    const uint32_t dark_wood = add_material(scene, matte("dark wood", vec3(0.25f, 0.11f, 0.042f)));

    // The computer's own frame: x across, y up along its face, z out of the face.
    const Affine world_from_pc = compose(rotation(vec3(0, 1, 0), 14), rotation(vec3(1, 0, 0), -90));
    add_instance(scene, "body", add_object(scene, "body", make_body()), world_from_pc,
                 {shell, black, black});
    const Affine upright = rotation(vec3(1, 0, 0), 90);  // shapes that lie in y = 0
    add_instance(
        scene, "screen", add_object(scene, "screen", make_grid(1, 1)),
        compose(world_from_pc, compose(translation(vec3(0, kScreenCentre, kRecess + 0.03f)),
                                       compose(upright, scaling(vec3(kScreen.x, 1, kScreen.y))))),
        {display});

    const uint32_t key = add_object(scene, "key", make_sphere(32, 21));
    const auto add_key = [&](const char* name, const vec2& place, const vec3& half_size,
                             uint32_t material) {
        add_instance(scene, name, key,
                     compose(world_from_pc, compose(translation(vec3(place, kFace)),
                                                    compose(upright, scaling(half_size)))),
                     {material});
    };
    add_key("left button", vec2(-2.3f, -3.9f), vec3(0.5f, 0.22f, 0.42f), blue);
    add_key("right button", vec2(2.3f, -3.9f), vec3(0.5f, 0.22f, 0.42f), blue);
    add_key("pad", vec2(0, -3.9f), vec3(1.05f, 0.3f, 0.75f), chrome);

    // The stylus leans on the computer's right edge, its tip above the screen that mirrors it.
    add_instance(scene, "stylus", add_object(scene, "stylus", make_stylus()),
                 spanning(vec3(1.3f, 3.1f, -1.6f), vec3(8, 0.36f, 5)), {black, shell, black});

    Object table = make_grid(11, 7);
    set_groups(table, {"boards A", "boards B"},
               [](const vec3& c) { return static_cast<size_t>((c.x + 0.5f) * 11) % 2; });
    add_instance(scene, "table", add_object(scene, "table", std::move(table)),
                 scaling(vec3(56, 1, 50)), {wood, dark_wood});

    scene.lights = {light("lamp", vec3(-14, 26, -8), vec3(0.95f, 0.93f, 0.88f))};
    scene.cameras = {camera(vec3(4.6f, 17.5f, 14.5f), vec3(1.3f, 0.3f, 0.2f))};
    return scene;
}

}  // namespace onepass
