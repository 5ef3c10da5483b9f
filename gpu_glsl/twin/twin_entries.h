// The entries of a twin: what entry/*.glsl do on the GPU, for a strategy compiled as C++.
//
// `Program` is a struct whose members are the strategy's whole shader text (twin_unit.cpp.in).
#pragma once

#include <algorithm>

#include "core/error.h"
#include "gpu_glsl/twin/twin_unit.h"

namespace onepass::twin {

template <class Program>
RayCounters counters_of(const Program& program, uint32_t rays) {
    return {program.cells_visited, program.triangle_tests, program.references_read, rays};
}

template <class Program, class ShaderHit>
Hit to_hit(const ShaderHit& hit) {
    return {static_cast<float>(hit.t), static_cast<float>(hit.u), static_cast<float>(hit.v),
            hit.prim_id, hit.inst_id};
}

template <class Program>
void cast_rays(const Bindings& bindings, std::span<const Ray> rays, const CastOutput& out) {
    using Vec3 = typename Program::Vec3;
    Program program(bindings);
    for (size_t i = 0; i < rays.size(); ++i) {
        const Ray& ray = rays[i];
        program.reset_counters();
        out.hits[i] = to_hit<Program>(program.closest_hit(
            typename Program::Ray{Vec3(ray.org), ray.tmin, Vec3(ray.dir), ray.tmax}));
        out.flags[i] = program.ray_flags;
        if (!out.counters.empty()) out.counters[i] = counters_of(program, 1);
    }
}

// ---- A walk, written down: what the NOTE_ macros of the shader text call -----------------------

template <class Vec>
void note_cell(RayWalk& walk, uint32_t inst_id, const Vec& cell) {
    // Integers, or coordinates that are whole but for rounding.
    walk.steps.push_back({inst_id, ivec3(glm::round(dvec3(cell))), {}});
}

inline void note_test(RayWalk& walk, uint32_t inst_id, uint32_t prim_id) {
    ONEPASS_CHECK(!walk.steps.empty());
    if (walk.steps.back().inst_id != inst_id) {
        // A flat grid's cell, of the world: each instance that is met there gets a step.
        walk.steps.push_back({inst_id, ivec3(walk.steps.back().cell), {}});
    }
    walk.steps.back().tests.push_back({prim_id});
}

/// Marks the last test of the hit's triangle.
template <class ProgramHit>
void note_hit(RayWalk& walk, const ProgramHit& hit) {
    for (auto step = walk.steps.rbegin(); step != walk.steps.rend(); ++step) {
        if (step->inst_id != hit.inst_id) continue;
        const auto test = std::find_if(step->tests.rbegin(), step->tests.rend(),
                                       [&](const WalkTest& t) { return t.prim_id == hit.prim_id; });
        if (test == step->tests.rend()) continue;
        test->accepted = true;
        test->t = hit.t;
        return;
    }
    ONEPASS_CHECK(false && "a hit of a triangle that was not noted");
}

template <class Program>
RayWalk walk_ray(const Bindings& bindings, const Ray& ray) {
    using Vec3 = typename Program::Vec3;
    Program program(bindings);
    RayWalk walk;
    program.walk_ = &walk;
    program.reset_counters();
    walk.hit = to_hit<Program>(program.closest_hit(
        typename Program::Ray{Vec3(ray.org), ray.tmin, Vec3(ray.dir), ray.tmax}));
    walk.flags = program.ray_flags;
    walk.counters = counters_of(program, 1);
    return walk;
}

template <class Program>
void render_rows(const Bindings& bindings, uint32_t first_row, uint32_t last_row, Frame& frame) {
    Program program(bindings);
    for (uint32_t y = first_row; y < last_row; ++y) {
        for (uint32_t x = 0; x < frame.width; ++x) {
            program.reset_counters();
            const auto pixel = program.trace_pixel(glm::ivec2(x, y));
            const size_t i = x + size_t{frame.width} * y;
            frame.color[i] = vec3(pixel.color);
            frame.flags[i] = program.ray_flags;
            frame.counters[i] = counters_of(program, program.rays_cast);
            frame.hits[i] = to_hit<Program>(pixel.primary);
            frame.normals[i] = vec3(pixel.normal);
        }
    }
}

}  // namespace onepass::twin
