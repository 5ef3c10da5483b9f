// What instances' matrices can do: stretch, shear, mirror and flatten.
#include "scenes/ladders/parts.h"

namespace onepass::ladder {
namespace {

/// The ball in one instance, first mapped, then turned and moved.
Scene placed_ball(const Affine& map) {
    return scene_of(ball(),
                    {compose(translation(vec3(0.3f, -0.2f, 0.1f)), compose(aslant(), map))});
}

float single(double knob) { return static_cast<float>(knob); }

Ladder stretch_ladder() {
    return {.id = "stretch",
            .title = "Stretched instances",
            .question =
                "A ball that its instance stretches along one axis. In the object's frame "
                "a ray's direction has components of very different size.",
            .knob = "largest / smallest factor",
            .unit = "",
            .rungs = rungs_of(powers_of_ten(0, 6), [](double knob) {
                return placed_ball(scaling(vec3(single(knob), 1, 1)));
            })};
}

Ladder shear_ladder() {
    return {.id = "shear",
            .title = "Sheared instances",
            .question =
                "A ball that its instance shears. The inverse takes differences of large "
                "numbers to find small ones.",
            .knob = "x moved by so many y",
            .unit = "",
            .rungs = rungs_of(powers_of_ten(0, 6),
                              [](double knob) { return placed_ball(shear_x_by_y(single(knob))); })};
}

Ladder mirror_ladder() {
    return {.id = "mirror",
            .title = "Mirrored instances",
            .question =
                "A ball that its instance mirrors (the determinant is negative, and what "
                "was counter-clockwise no longer is) and flattens.",
            .knob = "height of the flattened ball",
            .unit = "widths",
            .rungs = rungs_of(powers_of_ten(0, -7), [](double knob) {
                return placed_ball(scaling(vec3(-1, 1, single(knob))));
            })};
}

Ladder singular_ladder() {
    return {.id = "singular",
            .title = "Nearly singular instances",
            .question =
                "A ball that its instance flattens aslant, until the columns of its matrix "
                "lie almost in one plane: its inverse is large, and its two sides nearly "
                "coincide.",
            .knob = "height of the third column over the others' plane",
            .unit = "",
            .rungs = rungs_of(powers_of_ten(0, -6), [](double knob) {
                Affine flat = affine_identity();
                flat[2] = vec3(0.6f, 0.8f, single(knob));
                return placed_ball(flat);
            })};
}

}  // namespace

std::vector<Ladder> transform_ladders() {
    return {stretch_ladder(), shear_ladder(), mirror_ladder(), singular_ladder()};
}

}  // namespace onepass::ladder
