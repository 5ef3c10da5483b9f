#include "compare/cli/stress_trials.h"

#include <cmath>
#include <string>

#include "compare/trials.h"
#include "scenes/cases.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"

namespace onepass::cli {
namespace {

// ---- Scenes

Scene make_ball(uint32_t slices, uint32_t stacks) {
    return in_one_instance("ball", make_sphere(slices, stacks));
}

/// A ball on a floor, whose faces are flat and lie along the axes, beside a slanting plank, in one
/// mesh, so many of its own sizes from the origin.
Scene make_still_life(double distance) {
    Object mesh;
    mesh.name = "still life";
    append_shape(mesh, make_grid(12, 12), scaling(vec3(6.0f)), "mesh");
    Object ball = make_sphere(48, 32);
    ball.normals.clear();
    append_shape(mesh, ball, translation(vec3(0.4f, 1.2f, 0.3f)), "mesh");
    append_shape(
        mesh, make_box(8, 2, 4),
        compose(translation(vec3(-1.6f, 1.5f, 0.5f)),
                compose(rotation(vec3(0.3f, 1.0f, 0.2f), 35.0f), scaling(vec3(0.5f, 1.8f, 1.2f)))),
        "mesh");
    const vec3 along = glm::normalize(vec3(1.0f, 0.7f, -0.5f));
    const vec3 offset =
        along * static_cast<float>(distance * double{object_bounds(mesh).diagonal()});
    for (vec3& p : mesh.positions) p += offset;
    return in_one_instance("still life", std::move(mesh));
}

/// A ball, boxes and a blade far from touching each other, under transforms of every kind: turned,
/// unevenly scaled, sheared, mirrored.
Scene make_apart() {
    Scene scene;
    scene.name = "apart";
    scene.objects = {make_sphere(32, 24), make_box(5, 4, 3)};
    const auto add = [&](uint32_t object, const vec3& place, const Affine& shape) {
        scene.instances.push_back({.name = "part " + std::to_string(scene.instances.size()),
                                   .object = object,
                                   .world_from_object = compose(translation(place), shape),
                                   .materials = {0}});
    };
    const Affine turned = rotation(vec3(0.3f, 1.0f, 0.2f), 35.0f);
    add(0, vec3(0.0f), scaling(vec3(1.0f, 0.4f, 1.3f)));
    add(0, vec3(4.0f, 0.5f, 0.0f), compose(turned, scaling(vec3(0.2f, 1.5f, 0.9f))));
    add(0, vec3(-4.0f, 0.0f, 1.0f), scaling(vec3(-1.2f, 0.8f, 1.0f)));
    add(1, vec3(0.0f, 0.0f, 5.0f), compose(shear_x_by_y(0.8f), scaling(vec3(1.6f))));
    add(1, vec3(0.5f, 4.0f, -1.0f), compose(turned, scaling(vec3(2.4f, 0.3f, 1.0f))));
    add(1, vec3(0.0f, -4.0f, 0.0f), compose(turned, scaling(vec3(1.5f, 1.5f, -1.5f))));
    scene.materials.push_back({});
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    validate(scene);
    return scene;
}

// ---- Self-hits

/// From 64 times the offset down to none: the last rung has the label "0", which no logarithm has.
StressExperiment self_hits_by_offset() {
    std::vector<SelfHitRung> rungs;
    const auto at_rest = [] { return make_still_life(0.0); };
    for (int k = 6; k >= -8; k -= 2) {
        rungs.push_back({.knob = std::ldexp(1.0, k),
                         .label = "2^" + std::to_string(k),
                         .make_scene = at_rest,
                         .offset_factor = std::ldexp(1.0f, k)});
    }
    rungs.push_back(
        {.knob = 0.0, .label = "no offset", .make_scene = at_rest, .offset_factor = 0.0f});
    return self_hit_trial(
        {.id = "self-hits",
         .title = "Rays that meet the surface they leave",
         .question =
             "Shadow and mirror rays start a little off their surface. Too little, and "
             "rounding puts the start behind it; too much, and it lands behind another. The "
             "exact truth says where either begins.",
         .knob = "offset of secondary rays",
         .unit = "times the one in use"},
        rungs);
}

StressExperiment self_hits_far_from_the_origin() {
    std::vector<SelfHitRung> rungs;
    rungs.push_back(
        {.knob = 0.1, .label = "at it", .make_scene = [] { return make_still_life(0.0); }});
    for (int k = 0; k <= 5; ++k) {
        const double distance = std::pow(10.0, k);
        rungs.push_back(
            {.knob = distance, .make_scene = [distance] { return make_still_life(distance); }});
    }
    return self_hit_trial(
        {.id = "self-hits-far",
         .title = "The same, far from the origin",
         .question =
             "Positions round more coarsely the farther they are from the origin; an offset "
             "that does not grow with them is soon too short, and one that does is soon "
             "longer than the scene is deep.",
         .knob = "distance from the origin",
         .unit = "scene sizes"},
        rungs);
}

StressExperiment self_hits_seen_from_afar() {
    std::vector<SelfHitRung> rungs;
    for (int k = 0; k <= 5; ++k) {
        const double distance = std::pow(10.0, k);
        rungs.push_back({.knob = distance,
                         .make_scene = [] { return make_still_life(0.0); },
                         .view_distance = static_cast<float>(distance)});
    }
    return self_hit_trial(
        {.id = "self-hits-view",
         .title = "The same, seen from far away",
         .question = "A hit point is org + t dir: its error goes with the ray's length, of which "
                     "the size of the scene says nothing.",
         .knob = "distance of the eye",
         .unit = "scene sizes"},
        rungs);
}

// ---- Closed meshes

StressExperiment closed_meshes() {
    std::vector<TrialScene> rungs;
    for (const uint32_t n : {4u, 16u, 64u, 128u}) {
        rungs.push_back(
            {.knob = 4.0 * n * (n - 1), .make_scene = [n] { return make_ball(2 * n, n); }});
    }
    const Scene apart = make_apart();
    rungs.push_back({.knob = static_cast<double>(instanced_triangle_count(apart)),
                     .label = "six instances",
                     .make_scene = make_apart});
    return closed_mesh_trial(
        {.id = "enter-and-leave",
         .title = "A ray that enters leaves",
         .question =
             "Rays are followed from crossing to crossing through closed meshes: in and out "
             "must take turns, from outside to outside. One lost or doubled crossing turns "
             "inside out all that follows.",
         .knob = "triangles",
         .unit = {}},
        rungs);
}

// ---- Changes

StressExperiment far_mesh_in_an_instance() {
    std::vector<Change> changes;
    for (int k = 1; k <= 6; ++k) changes.push_back(far_instance(std::pow(10.0, k)));
    return change_trial(
        {.id = "far-instance",
         .title = "An unrelated object far away",
         .question = "An instance that no ray can reach is added. No hit may change, not by a bit.",
         .knob = "distance of the new instance",
         .unit = "scene sizes"},
        make_apart, changes);
}

StressExperiment far_mesh_in_the_object() {
    std::vector<Change> changes;
    for (int k = 1; k <= 6; ++k) changes.push_back(far_triangles(std::pow(10.0, k)));
    return change_trial(
        {.id = "far-triangles",
         .title = "Unrelated triangles far away in the same mesh",
         .question = "A copy of the mesh that no ray can reach joins it, so that one box and one "
                     "grid hold both. No hit may change, not by a bit.",
         .knob = "distance of the new triangles",
         .unit = "scene sizes"},
        [] { return make_ball(32, 24); }, changes);
}

/// Numbered: what changes is in the labels.
StressExperiment changes_of_order_and_scale() {
    std::vector<Change> changes = {permuted_triangles(), one_thread()};
    for (const int exponent : {-4, 4, -20, 20}) {
        changes.push_back(scaled_by_power_of_two(exponent));
    }
    for (size_t i = 0; i < changes.size(); ++i) changes[i].knob = static_cast<double>(i + 1);
    return change_trial(
        {.id = "same-hits",
         .title = "Order, threads and powers of two",
         .question =
             "The order of triangles, the number of threads and an exact change of unit are "
             "no part of the question that a ray asks. No hit may change, not by a bit.",
         .knob = "change",
         .unit = {},
         .log_axis = false},
        make_instances, changes);
}

StressExperiment invalid_rays() {
    return invalid_ray_trial(
        {.id = "invalid-rays",
         .title = "Rays that are none",
         .question = "NaN, infinity, no direction, an empty interval: the answer is a miss, and it "
                     "must come back at all.",
         .knob = "kind of ray",
         .unit = {},
         .log_axis = false},
        make_instances);
}

}  // namespace

std::vector<StressExperiment> stress_trials() {
    std::vector<StressExperiment> all = {
        self_hits_by_offset(),        self_hits_far_from_the_origin(),
        self_hits_seen_from_afar(),   closed_meshes(),
        far_mesh_in_an_instance(),    far_mesh_in_the_object(),
        changes_of_order_and_scale(), invalid_rays()};
    for (const Ladder& ladder : robustness_cases()) all.push_back(ladder_experiment(ladder));
    return all;
}

}  // namespace onepass::cli
