// Which triangles a ray may hit, in floats: barycentric coordinates from planes computed beforehand
// (after Havel & Herout 2010), by a test that never says no where rounding leaves it open.
//
// A triangle is its own plane and two more, on which a barycentric coordinate is 0. The ray meets
// the first at t = dist / det; multiplied by det, the three coordinates there need no division.
// A triangle is ruled out only if they differ in sign by more than they can be wrong, and surely
// hit only if they agree by more than that. Between the two, lib/triangle/decide.glsl decides in
// doubles.
//
// The planes are stored in one of two forms: lib/triangle/float_planes.glsl takes less arithmetic,
// and GPUs do better with it; lib/triangle/fixed_planes.glsl takes a texel less.
#pragma once
#include "lib/triangle/fixed_planes.glsl"
#include "lib/triangle/float_planes.glsl"

// A ray made ready for testing triangles. Its origin is counted from the centre of a box around
// them, its direction's largest component is 1/2 to 1, and its t is a length there, from its own
// origin on.
struct Sight {
    vec3 org;
    vec3 dir;
    float doubt;  // a weight of corners is wrong by less than this, in the weights' unit
};

// `half_box`: half of the box's edges, or its upper corner: the lower one is as far, but for the
// rounding of the centre, 2^-23 of it. For coordinates of more than 1/2, of the box or of the ray's
// origin, the records' bounds are as much larger.
// (The doubt is made here, because some compilers take nothing out of loops.)
Sight sight_from(vec3 org, vec3 dir, vec3 half_box) {
    float reach = greater(1.0, 2.0 * largest(greater(abs(org), half_box)));
    return Sight(org, dir, (has_fixed_planes ? kDoubtOfFixed : kDoubtOfFloats) * reach);
}

// Where a ray crosses a triangle, from the sight's origin on.
struct Crossing {
    float t;
    float error;    // t is wrong by less than this
    bool is_known;  // false: t may be anything, whatever `error` says
    bool is_sure;   // false: it may be nowhere, or t is not known
};

Weights weights_of(Planes planes, Sight sight) {
    return has_fixed_planes ? weights_by_fixed(planes, sight.org, sight.dir)
                            : weights_by_floats(planes, sight.org, sight.dir);
}

// False if the ray misses the triangle.
// (A point of which the computed weights are all beyond the doubt is in the triangle or next to it,
// so that the bounds, which are for points in it, hold as well.)
//
// (Comparisons and no min() or max(): each of those costs a software renderer three instructions,
// for the sake of NaN.)
bool may_cross(Weights weights, Sight sight) {
    float doubt = sight.doubt;
    bool has_negative = weights.u < -doubt || weights.v < -doubt || weights.w < -doubt;
    bool has_positive = weights.u > doubt || weights.v > doubt || weights.w > doubt;
    return !(has_negative && has_positive);
}

// Of a ray that may: where. Few do, and so the division waits until it is known. (Where t is not
// known, it and its error may be no numbers, of which drivers keep no rules: nothing rests on
// them.)
Crossing crossing_of(Planes planes, Weights weights, Sight sight) {
    float doubt = sight.doubt;
    float error_of_det = has_fixed_planes ? error_of_det_by_fixed(planes, doubt)
                                          : error_of_det_by_floats(planes, doubt);
    bool is_thin = has_fixed_planes ? are_thin_fixed(planes) : are_thin_floats(planes);
    bool is_known = abs(weights.det) > 4.0 * error_of_det;
    float inverse = 1.0 / weights.det;
    float t = weights.dist * inverse;
    bool are_negative = weights.u < -doubt && weights.v < -doubt && weights.w < -doubt;
    bool are_positive = weights.u > doubt && weights.v > doubt && weights.w > doubt;
    bool is_sure = is_known && (are_negative || are_positive) && !is_thin;
    return Crossing(t, error_of_det * (1.0 + abs(t)) * abs(inverse), is_known, is_sure);
}

// Whether a crossing may be at t = 0 to `end`.
bool may_be_within(Crossing crossing, float end) {
    bool is_within = crossing.t - crossing.error <= end && crossing.t + crossing.error >= 0.0;
    return is_within || !crossing.is_known;
}
