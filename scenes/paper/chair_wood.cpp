// chair-wood: a turned wooden chair on a floor. Lengths in decimetres; the chair faces +z.
//
// 4 legs S(32,61), 4 rails S(24,41), seat B(24,24,2), back B(60,29,2), floor G(1,2).
#include <cmath>
#include <numbers>

#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

const std::vector<std::string> kBoards = {"boards A", "boards B", "boards C"};

/// Boards glued side by side, in an order that does not repeat to the eye.
size_t board(float place, float boards) {
    constexpr size_t kOrder[] = {0, 2, 1, 0, 1, 2, 1, 0};
    return kOrder[static_cast<size_t>(place * boards) % std::size(kOrder)];
}

/// Height 1; radii in decimetres.
Object make_leg() {
    const vec2 keys[] = {{0, 0},         {0.15f, 0},     {0.18f, 0.02f}, {0.13f, 0.06f},
                         {0.21f, 0.2f},  {0.21f, 0.24f}, {0.15f, 0.26f}, {0.24f, 0.285f},
                         {0.15f, 0.31f}, {0.2f, 0.36f},  {0.27f, 0.46f}, {0.2f, 0.6f},
                         {0.13f, 0.67f}, {0.22f, 0.69f}, {0.13f, 0.71f}, {0.23f, 0.75f},
                         {0.24f, 0.97f}, {0.17f, 1},     {0, 1}};
    return turned(keys, 32, 61);
}

/// Height 1; radii in decimetres.
Object make_rail() {
    const vec2 keys[] = {{0, 0},         {0.09f, 0},     {0.11f, 0.3f}, {0.09f, 0.38f},
                         {0.16f, 0.41f}, {0.09f, 0.44f}, {0.17f, 0.5f}, {0.09f, 0.56f},
                         {0.16f, 0.59f}, {0.09f, 0.62f}, {0.11f, 0.7f}, {0.09f, 1},
                         {0, 1}};
    return turned(keys, 24, 41);
}

/// Rounded, hollowed a little, wider in front, its upper face at y = 0 along the rim.
Object make_seat() {
    Object seat = make_box(24, 24, 2);
    set_groups(seat, kBoards, [](const vec3& c) { return board(c.x + 0.5f, 6); });
    for (vec3& p : seat.positions) {
        const vec3 q = 2.0f * p;  // from -1 to 1

        // Squares about the middle become superellipses of exponent 4.

        const vec2 plan(q.x, q.z);
        const float norm = std::sqrt(glm::length(plan * plan));
        const float square = std::max(std::abs(plan.x), std::abs(plan.y));
        const float rim = 1.0f - 0.03f * q.y * q.y;
        const vec2 round = norm > 0.0f ? rim * square / norm * plan : vec2(0);

        const float hollow = 0.22f * (1.0f - round.x * round.x) * (1.0f - round.y * round.y);
        p = vec3(round.x * (2.35f + 0.2f * round.y), 0.19f * (q.y - 1.0f) - hollow,
                 2.35f * round.y);
    }
    set_normals(seat, 40);
    return seat;
}

/// A splat that widens into a crest between the rear legs, bent towards the sitter's back. Height 1
/// along y, from the seat to the legs' ends; x and z in decimetres.
Object make_back(float half_width) {
    constexpr uint32_t kRows = 29;
    const vec2 outline_keys[] = {{0.36f, 0},    {0.2f, 0.22f}, {0.38f, 0.5f},
                                 {0.3f, 0.68f}, {1, 0.74f},    {1, 1}};
    const std::vector<vec2> outline = curve_through(outline_keys, kRows + 1);
    Object back = make_box(60, kRows, 2);
    set_groups(back, kBoards, [](const vec3& c) { return board(c.x + 0.5f, 6); });
    for (vec3& p : back.positions) {
        const vec2 row = outline[static_cast<size_t>(std::lround((p.y + 0.5f) * kRows))];
        const float across = 2.0f * p.x * row.x;  // -1 and 1: the legs
        const float crest = std::cos(0.5f * std::numbers::pi_v<float> * across);
        const float arch = glm::smoothstep(0.6f, 1.0f, row.y) * 0.12f * crest;
        p = vec3(across * half_width, row.y + arch, 0.24f * p.z - 0.35f * crest);
    }
    set_normals(back, 40);
    return back;
}

}  // namespace

Scene make_chair_wood() {
    Scene scene;
    scene.name = "chair-wood";
    scene.background = vec3(0.17f, 0.21f, 0.22f);
    scene.ambient = vec3(0.2f);
    const uint32_t dark =
        add_material(scene, glossy("turned wood", vec3(0.25f, 0.085f, 0.03f), 40));
    const std::vector<uint32_t> boards = {
        add_material(scene, glossy("walnut", vec3(0.42f, 0.17f, 0.055f), 30, 0.25f)),
        add_material(scene, glossy("light walnut", vec3(0.47f, 0.2f, 0.068f), 30, 0.25f)),
        add_material(scene, glossy("dark walnut", vec3(0.36f, 0.14f, 0.045f), 30, 0.25f))};
    const uint32_t floor = add_material(scene, matte("floor", vec3(0.45f, 0.41f, 0.35f)));

    // Feet stand wider than the seat; the rear legs go on, past the seat, to the back's crest.
    constexpr float kFoot = 0.036f;  // legs lean: so high is the middle of a foot whose rim stands
    constexpr float kSeatHeight = 4.6f;
    constexpr float kBackHeight = 9.8f;
    struct Leg {
        const char* name;
        vec3 foot, top;
    };
    const Leg legs[] = {
        {"front left leg", {-2.2f, kFoot, 2.15f}, {-1.95f, kSeatHeight - 0.3f, 1.85f}},
        {"front right leg", {2.2f, kFoot, 2.15f}, {1.95f, kSeatHeight - 0.3f, 1.85f}},
        {"rear left leg", {-1.95f, kFoot, -1.75f}, {-1.95f, kBackHeight, -2.9f}},
        {"rear right leg", {1.95f, kFoot, -1.75f}, {1.95f, kBackHeight, -2.9f}},
    };
    const auto at_height = [&](const Leg& leg, float y) {
        return glm::mix(leg.foot, leg.top, (y - leg.foot.y) / (leg.top.y - leg.foot.y));
    };
    const uint32_t leg_object = add_object(scene, "leg", make_leg());
    for (const Leg& leg : legs) {
        add_instance(scene, leg.name, leg_object, spanning(leg.foot, leg.top), {dark});
    }

    struct Rail {
        const char* name;
        size_t from, to;  // legs
        float height;
    };
    const Rail rails[] = {{"front rail", 0, 1, 1.9f},
                          {"rear rail", 2, 3, 1.9f},
                          {"left rail", 0, 2, 1.2f},
                          {"right rail", 1, 3, 1.2f}};
    const uint32_t rail_object = add_object(scene, "rail", make_rail());
    for (const Rail& rail : rails) {
        add_instance(scene, rail.name, rail_object,
                     spanning(at_height(legs[rail.from], rail.height),
                              at_height(legs[rail.to], rail.height)),
                     {dark});
    }

    add_instance(scene, "seat", add_object(scene, "seat", make_seat()),
                 translation(vec3(0, kSeatHeight, -0.1f)), boards);

    // The back leans with the rear legs.
    const vec3 bottom = at_height(legs[2], kSeatHeight - 0.3f) * vec3(0, 1, 1);
    const vec3 top = legs[2].top * vec3(0, 0.97f, 0.99f);
    add_instance(scene, "back", add_object(scene, "back", make_back(legs[3].top.x)),
                 spanning(bottom, top), boards);

    // The floor lies square to the view, so that its far edge is level.
    const vec3 eye(8.6f, 10.2f, 15.6f);
    const vec3 target(0.4f, 4.7f, -0.3f);
    const float azimuth = glm::degrees(std::atan2(eye.x - target.x, eye.z - target.z));
    add_instance(scene, "floor", add_object(scene, "floor", make_grid(1, 2)),
                 compose(rotation(vec3(0, 1, 0), azimuth), scaling(vec3(60, 1, 60))), {floor});

    scene.lights = {light("lamp", vec3(-7, 25, 13), vec3(0.95f, 0.92f, 0.85f))};
    scene.cameras = {camera(eye, target)};
    return scene;
}

}  // namespace onepass
