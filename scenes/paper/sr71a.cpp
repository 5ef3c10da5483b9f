// sr71a: the aircraft in one mesh. Lengths in metres; it flies towards +z.
//
// Fuselage S(48,33), 2 nacelles S(16,17), wing B(9,4,1), 2 fins K(8), nose K(4).
#include <cmath>

#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

constexpr float kNacelle = 4.85f;  // from the middle plane to an engine's axis

/// Sections below an exponent of 2 are pointed at their sides: the chines, which run from the nose
/// to the wing.
Object make_fuselage() {
    // at, half width, bottom, chine, top, exponent
    const Section keys[] = {
        {-16.2f, 0, 0, 0.25f, 0, 2},
        {-15.6f, 0.2f, 0.02f, 0.25f, 0.42f, 2},
        {-12.5f, 0.7f, -0.4f, 0.15f, 0.75f, 2},
        {-8, 0.95f, -0.65f, 0.05f, 0.95f, 1.9f},
        {-3, 1.5f, -0.75f, 0, 1, 1.4f},
        {0.5f, 2.15f, -0.75f, -0.05f, 1, 1.1f},
        {4, 2, -0.75f, -0.08f, 0.98f, 1.05f},
        {8, 1.75f, -0.72f, -0.1f, 0.95f, 1.05f},
        {10.3f, 1.55f, -0.65f, -0.1f, 0.95f, 1.05f},
        {11.5f, 1.4f, -0.6f, -0.1f, 1.05f, 1.05f},
        {12.6f, 1.15f, -0.52f, -0.1f, 0.62f, 1.15f},
        {14, 0.8f, -0.4f, -0.1f, 0.3f, 1.2f},
        {15.3f, 0.35f, -0.22f, -0.08f, 0.08f, 1.4f},
        {15.8f, 0, 0, -0.06f, 0, 1.4f},
    };
    Object fuselage = lofted(keys, 48, 33);
    set_groups(fuselage, {"skin", "canopy"}, [](const vec3& c) {
        return c.z > 11.2f && c.z < 12.5f && c.x * c.x < 0.2f && c.y > 0.4f ? 1u : 0u;
    });
    set_normals(fuselage, 40);
    return fuselage;
}

/// Spike, intake, barrel and exhaust about the z axis.
Object make_nacelle() {
    const vec2 radius_at[] = {{0, -6.4f},  {0.62f, -6.4f}, {0.72f, -6.5f}, {0.95f, -4.2f},
                              {0.98f, -2}, {0.95f, 1},     {0.85f, 4.2f},  {0.84f, 5},
                              {0.8f, 5},   {0.68f, 4.7f},  {0.6f, 5.1f},   {0, 7}};
    std::vector<Section> sections;
    for (const vec2& p : curve_through(radius_at, 18)) {
        sections.push_back({p.y, p.x, -p.x, 0, p.x, 2});
    }
    Object nacelle = make_loft(sections, 16);
    set_groups(nacelle, {"nacelle", "metal"}, [](const vec3& c) {
        const float radius = std::hypot(c.x, c.y);
        return c.z < -6.3f || (c.z > 4.69f && radius < 0.67f) ? 1u : 0u;
    });
    set_normals(nacelle, 40);
    return nacelle;
}

/// A delta whose tips are rounded; 10 stations along the span, 5 along the chord.
Object make_wing() {
    struct Station {
        float x, leading, trailing, half_thickness;
    };
    const Station stations[] = {
        {0.6f, 2.6f, -12.9f, 0.2f}, {3.4f, -1.6f, -12.3f, 0.18f},  {6, -5.8f, -12.2f, 0.14f},
        {7.5f, -7.6f, -12, 0.09f},  {8.47f, -9.7f, -11.2f, 0.04f},
    };
    Object wing = make_box(9, 4, 1);
    // The box's cells are 9 along x, 4 along y, 1 along z: y becomes the chord, from back to front.
    for (vec3& p : wing.positions) {
        const auto i = static_cast<int>(std::lround((p.x + 0.5f) * 9));
        const Station& station = stations[i < 5 ? 4 - i : i - 5];
        const float chord = p.y + 0.5f;
        const float edge = 0.15f + 0.85f * (1.0f - 4.0f * p.y * p.y);
        p = vec3(i < 5 ? -station.x : station.x, -2.0f * p.z * station.half_thickness * edge,
                 glm::mix(station.trailing, station.leading, chord));
    }
    set_normals(wing, 12);
    return wing;
}

/// Stands on a nacelle; its blade's z points up and its y forwards.
Object make_fin() {
    constexpr uint32_t kSegments = 8;
    std::vector<Section> sections;
    for (uint32_t i = 0; i < kSegments; ++i) {
        const float s = static_cast<float>(i) / (kSegments - 1);
        sections.push_back({2.6f * s, glm::mix(0.14f, 0.05f, s), glm::mix(-2.4f, -2.6f, s),
                            glm::mix(-0.3f, -1.8f, s), glm::mix(2.2f, -0.9f, s)});
    }
    sections.push_back({.at = 2.64f, .waist = -1.8f});
    Object fin = make_blade(sections);

    set_normals(fin, 12);
    return fin;
}

Object make_nose() {
    const Section keys[] = {
        {15.2f, 0.37f, -0.23f, -0.08f, 0.1f},
        {15.9f, 0.15f, -0.15f, -0.07f, 0.02f},
        {16.3f, 0.04f, -0.1f, -0.06f, -0.02f},
        {17.3f, 0, 0, -0.06f, 0},
    };
    Object nose = bladed(keys, 4);
    set_normals(nose, 12);
    return nose;
}

}  // namespace

Scene make_sr71a() {
    Scene scene;
    scene.name = "sr71a";
    scene.background = vec3(0.3f, 0.45f, 0.66f);
    scene.ambient = vec3(0.25f);
    const uint32_t skin =
        add_material(scene, glossy("skin", vec3(0.04f, 0.045f, 0.055f), 9, 0.16f));
    const uint32_t glass = add_material(scene, mirror("glass", vec3(0.2f, 0.22f, 0.25f), 0.4f));
    const uint32_t metal = add_material(scene, glossy("metal", vec3(0.25f, 0.23f, 0.21f), 25));

    Object aircraft;
    append_shape(aircraft, make_fuselage(), affine_identity());
    append_shape(aircraft, make_nose(), affine_identity(), "nose");
    append_shape(aircraft, make_wing(), affine_identity(), "wing");
    const Affine standing(vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0, 1, 0), vec3(0));
    for (const float side : {1.0f, -1.0f}) {
        const vec3 axis(side * kNacelle, 0.1f, -6.2f);
        append_shape(aircraft, make_nacelle(), translation(axis));
        // Fins lean inwards by 15 degrees.
        append_shape(aircraft, make_fin(),
                     compose(translation(axis + vec3(0, 0.8f, -3.4f)),
                             compose(rotation(vec3(0, 0, 1), 15 * side), standing)),
                     "fin");
    }
    // Skin and canopy, nose, wing, and on either side barrel, metal and fin.
    add_instance(scene, "aircraft", add_object(scene, "sr71a", std::move(aircraft)),
                 affine_identity(),
                 {skin, glass, skin, skin, skin, metal, skin, skin, metal, skin});

    scene.lights = {light("sun", vec3(40, 60, 5), vec3(1.6f, 1.5f, 1.35f))};
    scene.cameras = {camera(vec3(23.5f, 21.5f, 28), vec3(-0.2f, 0, 0.4f))};
    return scene;
}

}  // namespace onepass
