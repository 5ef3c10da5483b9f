// Triangles and surfaces that are hard to hit: needles, grazing rays, sheets that nearly coincide.
#include <cmath>
#include <numbers>

#include "scenes/ladders/parts.h"

namespace onepass::ladder {
namespace {

// ---- Needles

/// A closed tube of length 1 along a slanted axis, pointed at both ends; its triangles are `aspect`
/// times as long as they are wide.
Scene tube_of_needles(double aspect) {
    constexpr uint32_t kSlices = 32;
    constexpr uint32_t kStacks = 8;
    const double radius = kSlices / (2.0 * std::numbers::pi * kStacks * aspect);
    std::vector<vec2> profile(kStacks + 1, vec2(1.0f, 0.0f));
    for (uint32_t i = 0; i <= kStacks; ++i) {
        profile[i].y = static_cast<float>(i) / kStacks - 0.5f;
    }
    profile.front().x = profile.back().x = 0.0f;
    const DAffine slanted(aslant());
    return scene_of(mapped(make_lathe(profile, kSlices), [&](const dvec3& p) {
        return transform_point(slanted, p * dvec3(radius, 1.0, radius));
    }));
}

Ladder needles_ladder() {
    return {.id = "needles",
            .title = "Needles",
            .question =
                "A closed tube whose triangles become needles. Their areas vanish beside "
                "the products that they are the difference of, and a ray in the tube is "
                "near to many edges at once.",
            .knob = "length / width of a triangle",
            .unit = "",
            .rungs = rungs_of(powers_of_ten(0, 7), tube_of_needles)};
}

// ---- Sheets

constexpr uint32_t kSheetSide = 20;  ///< quads a side, 800 triangles

/// A square sheet of side 1 about the origin, along no axis.
Object sheet() {
    const DAffine slanted(aslant());
    return mapped(make_grid(kSheetSide, kSheetSide),
                  [&](const dvec3& p) { return transform_point(slanted, p); });
}

dvec3 sheet_normal() { return transform_vector(DAffine(aslant()), dvec3(0, 1, 0)); }

/// Along the sheet, at `angle` to it, from either side.
RayMaker grazing_rays(double angle) {
    return [=](const Scene& scene, size_t count, uint64_t seed) {
        Random random(seed);
        std::vector<Ray> rays;
        for (size_t i = 0; i < count; ++i) {
            const Target target = random_target(scene, random);
            const dvec3 n = random.below(2) ? target.normal : -target.normal;
            const dvec3 along = glm::normalize(glm::cross(n, random_unit_vector(random)));
            const dvec3 direction = along * std::cos(angle) - n * std::sin(angle);
            const double distance = 0.2 + 0.8 * random.unit();
            rays.push_back(ray_towards(target.point - distance * direction, target.point, random));
        }
        return rays;
    };
}

Ladder grazing_ladder() {
    return {.id = "grazing",
            .title = "Grazing rays",
            .question =
                "Rays that meet a flat sheet at ever smaller angles. t is a quotient of "
                "two small numbers, and the place of the hit moves by the angle's inverse "
                "times every rounding.",
            .knob = "angle to the surface",
            .unit = "radians",
            .rungs = rungs_of(
                powers_of_ten(0, -7), [](double) { return scene_of(sheet()); }, grazing_rays)};
}

/// Two sheets in one mesh.
Scene two_sheets(double distance) {
    const dvec3 offset = distance * sheet_normal();
    Object both;
    both.name = "sheets";
    append_shape(both, sheet(), affine_identity(), "lower");
    append_shape(both, mapped(sheet(), [&](const dvec3& p) { return p + offset; }),
                 affine_identity(), "upper");
    return scene_of(std::move(both));
}

/// One sheet in two instances.
Scene sheet_twice(double distance) {
    return scene_of(sheet(), {affine_identity(), translation(vec3(distance * sheet_normal()))});
}

std::vector<Rung> down_to_coincident(int last, Scene (*make_scene)(double)) {
    std::vector<double> knobs = powers_of_ten(-1, last);
    knobs.push_back(0.0);
    std::vector<Rung> rungs = rungs_of(knobs, make_scene);
    rungs.back().label = "coincident";
    return rungs;
}

Ladder coincident_ladder() {
    return {.id = "coincident",
            .title = "Sheets that nearly coincide",
            .question =
                "Two parallel sheets in one mesh, seen from both sides, until they are the "
                "same triangles twice. Which one is nearer is decided by the last digits "
                "of t; where nothing tells them apart, either is right.",
            .knob = "distance of the sheets",
            .unit = "scene sizes",
            .rungs = down_to_coincident(-8, two_sheets)};
}

Ladder coincident_instances_ladder() {
    return {.id = "coincident-instances",
            .title = "Instances that nearly coincide",
            .question =
                "The same with one sheet in two instances, whose matrices can tell them "
                "apart where coordinates no longer can.",
            .knob = "distance of the instances",
            .unit = "scene sizes",
            .rungs = down_to_coincident(-10, sheet_twice)};
}

}  // namespace

std::vector<Ladder> shape_ladders() {
    return {needles_ladder(), grazing_ladder(), coincident_ladder(), coincident_instances_ladder()};
}

}  // namespace onepass::ladder
