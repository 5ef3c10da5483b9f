// The twins: bit-identical to the shaders on a software renderer, and strict about fetches.
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/shading.h"
#include "gpu_glsl/prepared_strategy.h"
#include "gpu_glsl/twin_tracer.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::twin {
extern const Unit kbroken_texture2d_32;  // of tests/gpu/shaders/strategies/broken.glsl
}

namespace onepass::test {
namespace {

/// Every scene of the default report. `./dev` fetches the real meshes; where one is missing the
/// test fails with the name of its package.
constexpr const char* kScenes[] = {"balls-1", "instances", "big-small", "bunny", "cornell"};

ScenePtr load_named(const char* name) { return share(load_scene(name).scene); }

class TwinOnSoftware : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        if (!context->description().software) {
            GTEST_SKIP() << "bit-identity is promised on software renderers only";
        }
    }
};

TEST_F(TwinOnSoftware, hits_are_bit_identical_to_both_entries_on_every_scene) {
    Catalogue catalogue = catalogue_of(context);
    for (const char* name : kScenes) {
        const ScenePtr scene = load_named(name);
        std::vector<std::vector<Ray>> ray_sets = {primary_rays(*scene, 96, 96),
                                                  random_rays(scene_bounds(*scene), 20000, 7),
                                                  awkward_rays(*scene)};
        for (const ParamValues& params : {ParamValues{}, ParamValues{{"edge_tolerance", "1"},
                                                                     {"clip_to_cell", "0"},
                                                                     {"accumulate_ts", "0"},
                                                                     {"step_ties", "0"},
                                                                     {"guard_zero", "1"}}}) {
            const auto twin = catalogue.at("paper/texture2d/twin32").make(scene, params);
            for (const char* entry : {"paper/texture2d/fragment", "paper/texture2d/compute"}) {
                const auto tracer = catalogue.at(entry).make(scene, params);
                for (const std::vector<Ray>& rays : ray_sets) {
                    const CastResult gpu = cast(*tracer, rays, {.counters = true});
                    const CastResult cpu = cast(*twin, rays, {.counters = true});
                    expect_same_bits(gpu.hits, cpu.hits, std::string(name) + " " + entry);
                    EXPECT_EQ(gpu.flags, cpu.flags) << name << " " << entry;
                    EXPECT_EQ(gpu.counters, cpu.counters) << name << " " << entry;
                }
                EXPECT_GT(hit_count(cast(*tracer, ray_sets[0]).hits), 1000u) << name;
            }
        }
    }
}

TEST_F(TwinOnSoftware, a_rendered_frame_has_the_hits_of_the_same_rays_cast) {
    Catalogue catalogue = catalogue_of(context);
    const ScenePtr scene = share(make_balls_1());
    const RenderSettings settings{.width = 80, .height = 64};
    for (const char* entry :
         {"paper/texture2d/fragment", "paper/texture2d/compute", "paper/texture2d/twin32"}) {
        const auto tracer = catalogue.at(entry).make(scene, {});
        const Frame frame = tracer->render(scene->cameras.front(), settings);
        expect_same_bits(frame.hits, cast(*tracer, primary_rays(*scene, 80, 64)).hits, entry);
    }
}

TEST_F(TwinOnSoftware, frames_agree_with_the_twin_in_colour_and_counts) {
    Catalogue catalogue = catalogue_of(context);
    for (const char* name : kScenes) {
        const ScenePtr scene = load_named(name);
        const RenderSettings settings{.width = 96, .height = 96};
        const Frame twin = catalogue.at("paper/texture2d/twin32")
                               .make(scene, {})
                               ->render(scene->cameras.front(), settings);
        for (const char* entry : {"paper/texture2d/fragment", "paper/texture2d/compute"}) {
            const Frame frame =
                catalogue.at(entry).make(scene, {})->render(scene->cameras.front(), settings);
            // pow() is the driver's own, so a colour may differ by its error, 16 ulps in GLSL's
            // terms, and a secondary ray at a shadow's border may then fall on the other side.
            constexpr float kPowError = 1e-4f;
            size_t differing = 0;
            for (size_t i = 0; i < frame.color.size(); ++i) {
                const vec3 d = glm::abs(frame.color[i] - twin.color[i]);
                if (std::max(d.x, std::max(d.y, d.z)) > kPowError) ++differing;
            }
            EXPECT_LE(differing, 2u) << name << " " << entry;
        }
    }
}

TEST(Twin, float_and_double_agree_on_nearly_every_ray) {
    const Catalogue catalogue = catalogue_of(nullptr);
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 20000, 3);
    const auto hits32 = cast(*catalogue.at("paper/texture2d/twin32").make(scene, {}), rays).hits;
    const auto hits64 = cast(*catalogue.at("paper/texture2d/twin64").make(scene, {}), rays).hits;
    size_t same_triangle = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits32[i].prim_id == hits64[i].prim_id && hits32[i].inst_id == hits64[i].inst_id) {
            ++same_triangle;
        }
    }
    EXPECT_GT(hit_count(hits64), 2000u);
    EXPECT_GT(same_triangle, rays.size() * 999 / 1000);
    EXPECT_GT(bit_difference(hits32, hits64).count, 0u) << "the double twin is a float one";
}

PreparedStrategy prepare_paper(const ScenePtr& scene, const ParamValues& params = {}) {
    for (const gl::StrategyInfo& info : gl::ShaderLibrary::embedded().strategies()) {
        if (info.name == "paper") return prepare_strategy(info, "texture2d", scene, params, {});
    }
    throw std::runtime_error("no paper strategy");
}

TEST(Twin, a_fetch_out_of_range_in_a_broken_shader_is_an_error) {
    const ScenePtr scene = share(make_big_small());
    const std::vector<Ray> rays = primary_rays(*scene, 32, 32);
    const auto sound = catalogue_of(nullptr).at("paper/texture2d/twin32").make(scene, {});
    EXPECT_NO_THROW(cast(*sound, rays));
    const auto broken =
        make_twin_tracer("broken", prepare_paper(scene), twin::kbroken_texture2d_32);
    try {
        cast(*broken, rays);
        FAIL() << "the broken fetch went unnoticed";
    } catch (const Error& error) {
        EXPECT_NE(error.parts().where.find("'references'"), std::string::npos) << error.what();
    }
}

/// The same picture from so many times as far away.
ScenePtr seen_from_afar(Scene scene, float times) {
    const vec3 centre = scene_bounds(scene).centre();
    Camera& camera = scene.cameras.front();
    vec3& eye = camera.world_from_camera[3];
    eye = centre + (eye - centre) * times;
    camera.vertical_fov = 2.0f * std::atan(std::tan(0.5f * camera.vertical_fov) / times);
    return share(std::move(scene));
}

TEST(Twin, shading_agrees_with_core_shading_on_the_same_hits) {
    const Catalogue catalogue = catalogue_of(nullptr);
    for (const std::string name :
         {"balls-1", "instances", "big-small", "bunny", "cornell", "bunny from afar"}) {
        constexpr float kAfar = 1000.0f;  // secondary rays start several times as far off there
        const ScenePtr scene = name == "bunny from afar"
                                   ? seen_from_afar(load_scene("bunny").scene, kAfar)
                                   : load_named(name.c_str());
        const auto twin = catalogue.at("paper/texture2d/twin32").make(scene, {});
        const RenderSettings settings{.width = 64, .height = 64};
        const Frame frame = twin->render(scene->cameras.front(), settings);

        // core's model over the very same tracer, one ray at a time.
        const auto closest = [&](const Ray& ray) { return cast(*twin, {ray}).hits.front(); };
        const ShadingScene shading(*scene);
        const std::vector<Ray> rays = primary_rays(*scene, 64, 64);
        size_t differing = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const ShadedPath path =
                shade_path(shading, rays[i], settings, closest,
                           [&](const Ray& ray) { return closest(ray).is_hit(); });
            // The two differ in how they normalise and sum: some ulps of colours near 1, and rarely
            // a shadow ray that rounding takes across a border.
            constexpr float kRounding = 2e-4f;
            const vec3 d = glm::abs(path.color - frame.color[i]);
            if (std::max(d.x, std::max(d.y, d.z)) > kRounding) ++differing;
            EXPECT_EQ(path.primary, frame.hits[i]);
        }
        EXPECT_LE(differing, rays.size() / 500) << name;
    }
}

}  // namespace
}  // namespace onepass::test
