// palace: columns around four walls, under a roof with a main dome and four smaller ones, on steps.
// Lengths in metres; the steps lead down to +z and -z.
//
// 24 columns S(24,21), 4 domes S(32,26), 4 walls B(20,5,1), main dome S(30,21), stair B(16,2,1),
// roof B(12,1,1), floor G(6,5).
#include <cmath>

#include <fmt/format.h>

#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

constexpr int kSteps = 4;
constexpr float kStepHeight = 0.5f;
constexpr float kTerrace = kSteps * kStepHeight;
constexpr float kColumnHeight = 9.0f;
constexpr float kRoofThickness = 1.6f;
constexpr float kRoof = kTerrace + kColumnHeight + kRoofThickness;
constexpr float kColonnade = 15.0f;  // half the side of the square that the columns stand on
constexpr float kWalls = 11.5f;      // ... and of the walls

/// Base, a shaft that swells and narrows, and a capital; lengths in metres.
Object make_column() {
    const vec2 keys[] = {{0, 0},         {0.95f, 0},    {0.95f, 0.4f}, {0.7f, 0.5f},
                         {0.82f, 0.65f}, {0.62f, 0.8f}, {0.62f, 3},    {0.5f, 7.4f},
                         {0.66f, 7.55f}, {0.5f, 7.7f},  {0.58f, 8.1f}, {0.95f, 8.7f},
                         {0.95f, 9},     {0, 9}};
    return turned(keys, 24, 21);
}

/// An onion on a drum, with a finial; lengths in metres.
Object make_dome(uint32_t slices, uint32_t stacks, float drum_radius, float height) {
    const float r = drum_radius;
    const float h = height;
    const vec2 keys[] = {{0, 0},
                         {1.08f * r, 0},
                         {1.08f * r, 0.05f * h},
                         {r, 0.07f * h},
                         {r, 0.24f * h},
                         {1.1f * r, 0.26f * h},
                         {1.17f * r, 0.42f * h},
                         {0.92f * r, 0.6f * h},
                         {0.42f * r, 0.75f * h},
                         {0.08f * r, 0.86f * h},
                         {0.12f * r, 0.89f * h},
                         {0.03f * r, 0.92f * h},
                         {0, h}};
    Object dome = turned(keys, slices, stacks);
    set_groups(dome, {"drum", "onion"}, [&](const vec3& c) { return c.y < 0.25f * h ? 0u : 1u; });
    return dome;
}

/// Pilasters stand out by two of the grid's columns in four; door and windows are cells of another
/// group. Its outside is +z.
Object make_wall() {
    Object wall = make_box(20, 5, 1);
    set_groups(wall, {"wall", "windows"}, [](const vec3& c) {
        const auto column = static_cast<int>((c.x + 0.5f) * 20);
        const auto row = static_cast<int>((c.y + 0.5f) * 5);
        const bool door = (column == 9 || column == 10) && row < 3;
        const bool window = column % 4 == 1 && (row == 2 || row == 1);
        return c.z > 0.4f && (door || window) ? 1u : 0u;
    });
    set_normals(wall, 30);
    return wall;
}

/// Steps that lead up to a terrace from +z and from -z: the 16 cells are tread, riser, tread ...
Object make_stair() {
    constexpr float kTread = 0.9f;
    constexpr float kHalfTerrace = 18.0f;
    constexpr float kHalfDepth = kHalfTerrace + kTread * (kSteps - 1);
    constexpr float kHalfWidth = 18.5f;
    Object stair = make_box(16, 2, 1);
    for (vec3& p : stair.positions) {
        const auto i = static_cast<int>(std::lround((p.x + 0.5f) * 16));
        const int from_end = std::min(i, 16 - i);
        const int treads = std::min((from_end + 1) / 2, kSteps - 1);
        const int risers = std::min(from_end / 2 + 1, kSteps);
        const float sign = i < 8 ? -1.0f : 1.0f;
        vec2 above(sign * (kHalfDepth - kTread * static_cast<float>(treads)),
                   kStepHeight * static_cast<float>(risers));
        const bool on_terrace = from_end > 2 * (kSteps - 1);
        if (on_terrace) above.x = kHalfTerrace * static_cast<float>(i - 8) / 2.0f;
        const vec2 below(kHalfDepth * 2.0f * p.x, 0.0f);  // evenly, so that none coincide
        const vec2 profile = glm::mix(below, above, p.y + 0.5f);
        p = vec3(-2.0f * kHalfWidth * p.z, profile.y, profile.x);
    }
    return stair;
}

/// A slab that widens upwards into a cornice.
Object make_roof() {
    Object roof = make_box(12, 1, 1);
    for (vec3& p : roof.positions) {
        const float half_side = kColonnade + (p.y > 0.0f ? 1.9f : 1.0f);
        p = vec3(2.0f * half_side * p.x, kRoofThickness * (p.y + 0.5f), 2.0f * half_side * p.z);
    }
    return roof;
}

}  // namespace

Scene make_palace() {
    Scene scene;
    scene.name = "palace";
    scene.background = vec3(0.16f, 0.34f, 0.68f);
    scene.ambient = vec3(0.3f);
    const uint32_t marble =
        add_material(scene, glossy("marble", vec3(0.78f, 0.71f, 0.6f), 30, 0.15f));
    const uint32_t sandstone = add_material(scene, matte("sandstone", vec3(0.6f, 0.3f, 0.16f)));
    const uint32_t steps = add_material(scene, matte("steps", vec3(0.56f, 0.5f, 0.42f)));
    const uint32_t shade = add_material(scene, glossy("windows", vec3(0.09f, 0.1f, 0.13f), 60));
    const uint32_t gold = add_material(scene, mirror("gold", vec3(0.9f, 0.46f, 0.04f), 0.2f));
    const uint32_t tiles = add_material(scene, glossy("tiles", vec3(0.03f, 0.3f, 0.34f), 60, 0.5f));
    const uint32_t light_paving =
        add_material(scene, matte("light paving", vec3(0.42f, 0.36f, 0.28f)));
    const uint32_t dark_paving =
        add_material(scene, matte("dark paving", vec3(0.34f, 0.28f, 0.21f)));
    const vec3 up(0, 1, 0);

    // 7 columns a side; corners are shared.
    const uint32_t column = add_object(scene, "column", make_column());
    constexpr int kColumnsASide = 7;
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i + 1 < kColumnsASide; ++i) {
            const float along =
                kColonnade * (2.0f * static_cast<float>(i) / (kColumnsASide - 1) - 1);
            add_instance(scene, fmt::format("column {:02}", side * (kColumnsASide - 1) + i + 1),
                         column,
                         compose(rotation(up, 90.0f * static_cast<float>(side)),
                                 translation(vec3(along, kTerrace, kColonnade))),
                         {marble});
        }
    }

    const uint32_t wall = add_object(scene, "wall", make_wall());
    for (int side = 0; side < 4; ++side) {
        add_instance(scene, fmt::format("wall {}", side + 1), wall,
                     compose(rotation(up, 90.0f * static_cast<float>(side)),
                             compose(translation(vec3(0, kTerrace + 0.5f * kColumnHeight, kWalls)),
                                     scaling(vec3(2 * kWalls + 0.96f, kColumnHeight, 1)))),
                     {sandstone, shade});
    }

    const uint32_t small_dome = add_object(scene, "small dome", make_dome(32, 26, 2.6f, 8));
    for (int corner = 0; corner < 4; ++corner) {
        add_instance(scene, fmt::format("small dome {}", corner + 1), small_dome,
                     compose(rotation(up, 90.0f * static_cast<float>(corner)),
                             translation(vec3(12.4f, kRoof, 12.4f))),
                     {marble, tiles});
    }
    add_instance(scene, "main dome", add_object(scene, "main dome", make_dome(30, 21, 8, 20)),
                 translation(vec3(0, kRoof, 0)), {marble, gold});

    add_instance(scene, "roof", add_object(scene, "roof", make_roof()),
                 translation(vec3(0, kRoof - kRoofThickness, 0)), {marble});
    add_instance(scene, "stair", add_object(scene, "stair", make_stair()), affine_identity(),
                 {steps});

    Object floor = make_grid(6, 5);
    set_groups(floor, {"light paving", "dark paving"}, [](const vec3& c) {
        const auto x = static_cast<int>((c.x + 0.5f) * 6);
        const auto z = static_cast<int>((c.z + 0.5f) * 5);
        return static_cast<size_t>((x + z) % 2);
    });
    add_instance(scene, "floor", add_object(scene, "floor", std::move(floor)),
                 scaling(vec3(108, 1, 90)), {light_paving, dark_paving});

    scene.lights = {light("sun", vec3(-45, 110, 150), vec3(0.9f, 0.86f, 0.76f))};
    scene.cameras = {camera(vec3(40.2f, 22.2f, 69.5f), vec3(-0.3f, 12.6f, 0))};
    return scene;
}

}  // namespace onepass
