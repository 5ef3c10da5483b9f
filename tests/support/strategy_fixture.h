// Strategies made ready for tests: the shader library, tracers by name, rays, and comparisons of
// bits.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "compare/rays.h"
#include "core/camera.h"
#include "core/catalogue.h"
#include "gpu_glsl/glsl_tracers.h"
#include "scenes/scenes.h"
#include "tests/support/gl_fixture.h"

namespace onepass::test {

inline ScenePtr share(Scene scene) { return std::make_shared<const Scene>(std::move(scene)); }

/// Each scene with either form of the parameter `records`: a GPU, as a twin, has floats by default
/// and a software renderer fixed-point numbers.
inline std::vector<std::pair<Scene, std::string>> in_both_records(
    const std::vector<Scene>& scenes) {
    std::vector<std::pair<Scene, std::string>> cases;
    for (const Scene& scene : scenes) {
        for (const char* records : {"floats", "fixed"}) cases.emplace_back(scene, records);
    }
    return cases;
}

/// The built-in shaders' tracers on the test's context.
inline Catalogue catalogue_of(const std::shared_ptr<gl::GlContext>& context,
                              const gl::ShaderLibrary& library = gl::ShaderLibrary::embedded()) {
    Catalogue catalogue;
    for (CatalogueEntry& entry :
         glsl_tracers(library, [context]() -> gl::GlContext& { return *context; })) {
        catalogue.add(std::move(entry));
    }
    return catalogue;
}

inline std::vector<Ray> primary_rays(const Scene& scene, uint32_t width, uint32_t height) {
    const CameraFrame frame = camera_frame(scene.cameras.front(), width, height);
    std::vector<Ray> rays;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) rays.push_back(primary_ray(frame, x, y));
    }
    return rays;
}

inline CastResult cast(Tracer& tracer, const std::vector<Ray>& rays,
                       const CastOptions& options = {}) {
    return tracer.cast(tracer.upload(rays), options);
}

/// How many hits differ in any bit, and the first of them.
struct BitDifference {
    size_t count = 0;
    size_t first = 0;
};

inline BitDifference bit_difference(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    BitDifference difference;
    for (size_t i = 0; i < a.size(); ++i) {
        if (std::memcmp(&a[i], &b[i], sizeof(Hit)) == 0) continue;
        if (difference.count++ == 0) difference.first = i;
    }
    return difference;
}

inline std::string describe(const Hit& hit) {
    return "t " + std::to_string(hit.t) + " u " + std::to_string(hit.u) + " v " +
           std::to_string(hit.v) + " prim " + std::to_string(hit.prim_id) + " inst " +
           std::to_string(hit.inst_id);
}

inline void expect_same_bits(const std::vector<Hit>& a, const std::vector<Hit>& b,
                             const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    const BitDifference difference = bit_difference(a, b);
    if (difference.count == 0) return;
    ADD_FAILURE() << what << ": " << difference.count << " of " << a.size()
                  << " hits differ; first ray " << difference.first << ": "
                  << describe(a[difference.first]) << " against " << describe(b[difference.first]);
}

inline size_t hit_count(const std::vector<Hit>& hits) {
    size_t count = 0;
    for (const Hit& hit : hits) count += hit.is_hit() ? 1 : 0;
    return count;
}

}  // namespace onepass::test
