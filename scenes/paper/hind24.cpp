// hind24: a squadron of 24 attack helicopters in formation, each an instance of one mesh; and
// hind24-flying, the same with rotors as objects of their own. Lengths in metres; they fly towards
// +z, and the origin of a helicopter is on the main rotor's axis.
//
// Hull S(64,41), rotor blades 5 K(66), hub S(24,13), tail blades 3 K(33), stub wings 2 B(20,6,1),
// pods 4 S(16,17), wheels 3 S(16,9), fin K(16).
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "scenes/describe.h"
#include "scenes/modelling.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"

namespace onepass {
namespace {

constexpr vec3 kMainRotor{0, 2.55f, 0};
constexpr vec3 kTailRotor{0.42f, 2.35f, -10.6f};

/// From the tail boom over the engines and the two canopies to the nose.
Object make_hull() {
    // at, half width, bottom, waist, top, exponent
    const Section keys[] = {
        {-10.6f, 0, 0, 0.85f, 0, 2},
        {-10.5f, 0.14f, 0.65f, 0.85f, 1.05f, 2},
        {-8, 0.27f, 0.42f, 0.8f, 1.15f, 2},
        {-4.4f, 0.5f, -0.15f, 0.55f, 1.25f, 2},
        {-3.2f, 0.68f, -0.6f, 0.4f, 1.45f, 2.2f},
        {-2.2f, 0.82f, -0.95f, 0.3f, 2, 2.6f},
        {-1, 0.88f, -1.1f, 0.25f, 2.2f, 2.8f},
        {1, 0.88f, -1.1f, 0.2f, 2.2f, 2.8f},
        {1.9f, 0.86f, -1.1f, 0.15f, 2, 2.6f},
        {2.15f, 0.82f, -1.1f, 0.1f, 1.45f, 2.3f},
        {2.7f, 0.76f, -1.08f, 0.05f, 1.5f, 2.1f},
        {3.3f, 0.7f, -1.05f, 0, 1.3f, 2},
        {3.8f, 0.64f, -1.02f, -0.1f, 0.72f, 2},
        {4.3f, 0.62f, -1, -0.15f, 0.78f, 2},
        {4.9f, 0.57f, -0.97f, -0.25f, 0.55f, 2},
        {5.5f, 0.5f, -0.92f, -0.4f, 0.05f, 2},
        {6.1f, 0.36f, -0.86f, -0.52f, -0.2f, 2},
        {6.5f, 0, 0, -0.58f, 0, 2},
    };
    Object hull = lofted(keys, 64, 41);
    set_groups(hull, {"green", "tan", "belly", "canopies"}, [](const vec3& c) {
        const bool rear_canopy = c.z > 2.2f && c.z < 3.75f && c.y > 0.45f;
        const bool front_canopy = c.z > 3.85f && c.z < 5.5f && c.y > 0.02f - 0.15f * (c.z - 3.85f);
        if (rear_canopy || front_canopy) return 3u;
        if (c.y < -0.62f) return 2u;
        const double waves = std::sin(1.3 * c.z + 1.5 * std::sin(1.1 * c.y + 0.4 * c.x));
        return waves > 0.1 ? 1u : 0u;
    });
    set_normals(hull, 50);
    return hull;
}

/// A wing that slopes down, thickest in the middle of its chord; side 1 is +x, -1 is -x.
Object make_stub_wing(float side) {
    Object wing = make_box(20, 6, 1);
    // Cells are 20 along the span (x), 6 along the chord (y), 1 across (z).
    for (vec3& p : wing.positions) {
        const float out = 0.5f + side * p.x;
        const float chord = 2.0f * p.y;
        const float half_thickness = 0.02f + 0.09f * (1.0f - chord * chord);
        p = vec3(side * (0.6f + 2.6f * out), 0.15f - 0.6f * out - 2.0f * p.z * half_thickness,
                 -0.1f - 0.25f * out + chord * (0.85f - 0.3f * out));
    }
    set_normals(wing, 25);
    return wing;
}

Object make_pod() {
    const Section keys[] = {
        {-1.15f, 0, 0, 0, 0},
        {-1.1f, 0.15f, -0.15f, 0, 0.15f},
        {-0.8f, 0.22f, -0.22f, 0, 0.22f},
        {0.85f, 0.22f, -0.22f, 0, 0.22f},
        {1.1f, 0.13f, -0.13f, 0, 0.13f},
        {1.15f, 0, 0, 0, 0},
    };
    Object pod = lofted(keys, 16, 17);
    set_normals(pod, 40);
    return pod;
}

/// The swept fin that carries the tail rotor; its blade's z points up and its y forwards.
Object make_fin() {
    const Section keys[] = {
        {0, 0.16f, -0.5f, 0.2f, 1.3f},
        {1.4f, 0.1f, -1.3f, -0.8f, 0.05f},
        {2.05f, 0.06f, -1.55f, -1.15f, -0.6f},
        {2.15f, 0, 0, -1.2f, 0},
    };
    Object fin = bladed(keys, 16);
    set_normals(fin, 12);
    return fin;
}

/// Everything but the rotors.
Object make_airframe() {
    Object airframe;
    append_shape(airframe, make_hull(), affine_identity());
    const Affine standing(vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0, 1, 0), vec3(0, 0.85f, -9.6f));
    append_shape(airframe, make_fin(), standing, "fin");
    append_shape(airframe, make_stub_wing(1), affine_identity(), "wings");
    append_shape(airframe, make_stub_wing(-1), affine_identity(), "wings");
    const Object pod = make_pod();
    for (const float x : {-2.7f, -1.75f, 1.75f, 2.7f}) {
        const float below_wing = -0.28f - 0.23f * std::abs(x);
        append_shape(airframe, pod, translation(vec3(x, below_wing, -0.15f)), "pods");
    }
    const Object wheel = make_sphere(16, 9);
    for (const vec3& axle :
         {vec3(1.1f, -1.5f, -1.3f), vec3(-1.1f, -1.5f, -1.3f), vec3(0, -1.45f, 4.2f)}) {
        append_shape(airframe, wheel, compose(translation(axle), scaling(vec3(0.17f, 0.4f, 0.4f))),
                     "wheels");
    }
    return airframe;
}

/// Hub and five blades about the y axis, the blades raised at their tips.
Object make_main_rotor() {
    const vec2 profile[] = {{0, -0.45f},   {0.2f, -0.45f}, {0.16f, -0.1f}, {0.5f, -0.06f},
                            {0.5f, 0.08f}, {0.2f, 0.14f},  {0.12f, 0.22f}, {0, 0.24f}};
    Object rotor;
    append_shape(rotor, turned(profile, 24, 13), affine_identity(), "hub");

    std::vector<Section> sections;
    constexpr uint32_t kSegments = 66;
    for (uint32_t i = 0; i <= kSegments; ++i) {
        const float s = static_cast<float>(i) / kSegments;
        const float chord = s < 0.12f ? 0.09f : s < 0.98f ? 0.27f : 0.2f;
        const float rise = 0.45f * s * s;
        sections.push_back({0.3f + 8.35f * s, chord, rise - 0.04f, rise, rise + 0.04f});
    }
    Object blade = make_blade(sections);
    set_normals(blade, 12);
    constexpr int kBlades = 5;
    for (int i = 0; i < kBlades; ++i) {
        const float degrees = 20.0f + 360.0f * static_cast<float>(i) / kBlades;
        append_shape(rotor, blade, rotation(vec3(0, 1, 0), degrees), "blades");
    }
    return rotor;
}

/// Three blades about the x axis.
Object make_tail_rotor() {
    const Section keys[] = {
        {-0.05f, 0.05f, -0.07f, 0, 0.07f},
        {0.35f, 0.04f, -0.08f, 0, 0.08f},
        {0.5f, 0.03f, -0.15f, 0, 0.15f},
        {1.85f, 0.02f, -0.14f, 0, 0.14f},
        {1.95f, 0, 0, 0, 0},
    };
    Object blade = bladed(keys, 33);
    set_normals(blade, 12);
    Object rotor;
    constexpr int kBlades = 3;
    for (int i = 0; i < kBlades; ++i) {
        const float degrees = 25.0f + 360.0f * static_cast<float>(i) / kBlades;
        append_shape(rotor, blade, rotation(vec3(1, 0, 0), degrees), "tail blades");
    }
    return rotor;
}

/// Where the helicopters fly: six ranks, each in the gaps of the one before and a little higher.
std::vector<vec3> formation() {
    constexpr int kRanks[] = {3, 4, 5, 5, 4, 3};
    constexpr float kAbreast = 19.0f;  // rotors are 17.3 wide
    constexpr float kBehind = 17.0f;
    std::vector<vec3> places;
    for (int rank = 0; rank < 6; ++rank) {
        const int count = kRanks[rank];
        // The two ranks of five are set off sideways against each other.
        const float shift = count == 5 ? (rank == 2 ? -0.25f : 0.25f) : 0.0f;
        for (int i = 0; i < count; ++i) {
            const float aside =
                static_cast<float>(i) - 0.5f * static_cast<float>(count - 1) + shift;
            places.emplace_back(kAbreast * aside, 3.0f * static_cast<float>(rank),
                                kBehind * (2.5f - static_cast<float>(rank)));
        }
    }
    return places;
}

/// Materials by the names of an object's groups.
std::vector<uint32_t> paints(const Scene& scene, const Object& object) {
    std::vector<uint32_t> result;
    for (const TriangleGroup& group : object.groups) {
        for (uint32_t m = 0; m < scene.materials.size(); ++m) {
            if (scene.materials[m].name == group.name) result.push_back(m);
        }
    }
    return result;
}

/// Sky, sun, camera and paints; a material is named after the groups it is for.
Scene make_sky() {
    Scene scene;
    scene.background = vec3(0.25f, 0.42f, 0.68f);
    scene.ambient = vec3(0.3f);
    const vec3 green(0.08f, 0.13f, 0.05f);
    const vec3 dark(0.05f, 0.055f, 0.06f);
    scene.materials = {
        matte("green", green),
        matte("tan", vec3(0.34f, 0.25f, 0.12f)),
        matte("belly", vec3(0.3f, 0.38f, 0.44f)),
        glossy("canopies", vec3(0.05f, 0.09f, 0.13f), 60),
        matte("fin", green),
        matte("wings", green),
        glossy("pods", vec3(0.3f, 0.31f, 0.3f), 30, 0.3f),
        matte("wheels", dark),
        glossy("hub", vec3(0.2f), 30, 0.3f),
        glossy("blades", dark, 30, 0.15f),
        glossy("tail blades", dark, 30, 0.15f),
    };
    scene.lights = {light("sun", vec3(-120, 260, 220), vec3(1.0f, 0.96f, 0.86f))};
    scene.cameras = {camera(vec3(58.5f, 69.5f, 126), vec3(1.6f, 5.5f, 2))};
    return scene;
}

}  // namespace

Scene make_hind24() {
    Scene scene = make_sky();
    scene.name = "hind24";
    Object helicopter = make_airframe();
    append_shape(helicopter, make_main_rotor(), translation(kMainRotor));
    append_shape(helicopter, make_tail_rotor(), translation(kTailRotor));
    const uint32_t object = add_object(scene, "helicopter", std::move(helicopter));
    size_t number = 0;
    for (const vec3& place : formation()) {
        add_instance(scene, fmt::format("helicopter {:02}", ++number), object, translation(place),
                     paints(scene, scene.objects[object]));
    }
    return scene;
}

Scene make_hind24_flying() {
    Scene scene = make_sky();
    scene.name = "hind24-flying";
    const uint32_t hull = add_object(scene, "hull", make_airframe());
    const uint32_t main_rotor = add_object(scene, "main rotor", make_main_rotor());
    const uint32_t tail_rotor = add_object(scene, "tail rotor", make_tail_rotor());
    size_t number = 0;
    for (const vec3& place : formation()) {
        const std::string suffix = fmt::format(" {:02}", ++number);
        const auto add = [&](uint32_t object, const vec3& where) {
            add_instance(scene, scene.objects[object].name + suffix, object, translation(where),
                         paints(scene, scene.objects[object]));
        };
        add(hull, place);
        add(main_rotor, place + kMainRotor);
        add(tail_rotor, place + kTailRotor);
    }
    turning_rotors(scene);
    return scene;
}

}  // namespace onepass
