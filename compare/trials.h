// Trials: what `onepass stress` asks of tracers beside ladders whose every ray is judged alike.
// Each looks at answers in its own way (a start from a hit, a march through a mesh, an answer
// before and after a change), and fills a ladder's record with what went wrong. Where a cast ends
// with an error, all rays of the rung fail as "gave_up".
//
// Knows tracers and judges as compare/stress.h hands them in; scenes come from the caller.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "compare/stress.h"

namespace onepass {

/// What a trial is called, as in Ladder.
struct TrialTitle {
    std::string id;
    std::string title;
    std::string question;
    std::string knob;
    std::string unit{};
    bool log_axis = true;
};

/// A rung that is a scene.
struct TrialScene {
    double knob = 0.0;
    std::string label{};
    std::function<Scene()> make_scene;
};

// ---- Self-hits

/// A scene, from how far away it is looked at, and how far secondary rays start from surfaces.
struct SelfHitRung {
    double knob = 0.0;
    std::string label{};
    std::function<Scene()> make_scene;
    float view_distance = 1.0f;  ///< of the primary rays' origins from the centre, in diagonals
    float offset_factor = 1.0f;  ///< times the offset of core/shading.h
};

/// Rays that leave a surface must not meet it again. From every primary hit of the contestant one
/// shadow ray and one mirror ray start as core/shading.h starts them, in float.
///
/// Trials are secondary rays that really lead away from the surface. The exact truth about them
/// says whether the offset is sound; the contestant's own answer, whether it copes. A trial fails
/// once:
///   self_hit        the truth is the very triangle that the ray starts from
///   leak            the ray starts on or behind the plane of that triangle, or behind another
///                   surface that the offset led across
///   false_self_hit  neither, but the contestant hits that triangle
///   exhausted       kFlagExhausted
StressExperiment self_hit_trial(TrialTitle title, std::vector<SelfHitRung> rungs);

// ---- Closed meshes

/// A ray that enters leaves. Rays from outside are marched through closed meshes, crossing by
/// crossing (tmin is the next float above the last t), until they miss.
///
/// The meshes of a scene must be closed, face outwards, and not meet each other. Trials are rays.
///   left_without_entering  it crossed a surface outwards while outside
///   entered_twice          it crossed one inwards while inside: a crossing was lost, or counted
///                          twice
///   never_left             it ended inside
///   exhausted              kFlagExhausted
/// A failure where the truth itself has two crossings that floats do not keep apart (2 kTUlps) is a
/// tie.
StressExperiment closed_mesh_trial(TrialTitle title, std::vector<TrialScene> rungs);

// ---- Changes that must not change a hit

/// A scene that was changed, and how rays get there and hits come back.
struct ChangedScene {
    Scene scene;
    std::function<Ray(const Ray&)> ray_there;
    std::function<Hit(const Hit&)> hit_back;
};

/// One way to change a scene or the way it is traced.
struct Change {
    double knob = 0.0;
    std::string label{};
    std::function<ChangedScene(const Scene& scene, uint64_t seed)> make;
    bool one_thread = false;  ///< the changed scene is built and traced on one thread
};

/// A copy of the scene's first object, so many diagonals of the scene away, in an instance.
Change far_instance(double diagonals);
/// The same, but its triangles join the first object's.
Change far_triangles(double diagonals);
/// The triangles of every object in random order.
Change permuted_triangles();
/// Positions, translations and ray origins times 2^exponent: exact, so that t must be as exact.
Change scaled_by_power_of_two(int exponent);
/// One thread instead of all. A tracer whose threads are not this process's refuses.
Change one_thread();

/// Casts the same rays before and after each change, and compares t and ids bit by bit.
///
/// Trials are rays; half of them are aimed at corners of triangles. They end (tmax) before anything
/// far.
///   changed       the answers differ, and one of them is an error
///   changed_edge  another triangle, or a hit against a miss, at an edge: neither is an error
///   changed_t     the same triangle at another t, neither an error
///   exhausted     kFlagExhausted in one answer alone
/// Another triangle is a tie if both are right to the judge (agree or tie), or if t is the same and
/// neither is an error.
StressExperiment change_trial(TrialTitle title, std::function<Scene()> make_scene,
                              std::vector<Change> changes);

// ---- Invalid rays

/// One way to spoil a ray.
struct Spoiler {
    std::string label;
    std::function<Ray(const Ray& good, uint64_t index)> spoil;
};

/// NaN and infinity in origin, direction and interval, no direction, intervals that are empty or
/// begin below 0. What they make of any ray is a miss by definition.
const std::vector<Spoiler>& spoilers();

/// Spoiled rays must miss, and the tracer must come back from them. Trials are rays that were aimed
/// at corners; those that a tracer keeps from its library (kFlagOracleInvalid) are none, and
/// RungRecord::refusal says how many it takes.
///   false_hit  it hit something
///   exhausted  kFlagExhausted
StressExperiment invalid_ray_trial(TrialTitle title, std::function<Scene()> make_scene);

}  // namespace onepass
