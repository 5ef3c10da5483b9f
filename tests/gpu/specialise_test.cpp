// A scene's shader does not hold what the scene lacks, and shows the same as one that holds it all.
#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "scenes/motions.h"
#include "scenes/shapes.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

const ParamValues kForAllScenes = {{"specialise", "0"}};

/// A ball above a ground plate: a mesh of its own each or one mesh for both, lamps in a row.
ScenePtr ball_on_ground(bool one_mesh, bool mirror, int lights) {
    Scene scene;
    scene.name = "ball on ground";
    Object ball = make_sphere(24, 16);
    Object ground = make_box(2, 2, 2);
    for (vec3& p : ground.positions) p = (p - vec3(0.0f, 1.0f, 0.0f)) * vec3(4.0f, 0.5f, 4.0f);
    if (one_mesh) {
        const auto first = static_cast<uint32_t>(ball.positions.size());
        for (const vec3& p : ground.positions) ball.positions.push_back(p - vec3(0.0f, 1.2f, 0.0f));
        for (const uvec3& t : ground.triangles) ball.triangles.push_back(t + uvec3(first));
        ball.normals.clear();
        ball.groups = {{"all", 0, static_cast<uint32_t>(ball.triangles.size())}};
        scene.objects = {ball};
        scene.instances = {{"both", 0, affine_identity(), {0}}};
    } else {
        Affine below = affine_identity();
        below[3] = vec3(0.0f, -1.2f, 0.0f);
        scene.objects = {ball, ground};
        scene.instances = {{"ball", 0, affine_identity(), {0}}, {"ground", 1, below, {0}}};
    }
    scene.materials.resize(1);
    scene.materials[0].reflectivity = mirror ? 0.5f : 0.0f;
    for (int i = 0; i < lights; ++i) {
        scene.lights.push_back(
            {fmt::format("lamp {}", i), vec3(3.0f * float(i) - 2.0f, 5, 4), vec3(0.5f)});
    }
    scene.cameras = {look_at(vec3(0, 1.5f, 6), vec3(0, -0.5f, 0), vec3(0, 1, 0), 0.8f)};
    validate(scene);
    return share(std::move(scene));
}

bool holds(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

class Specialise : public GlTest {
  protected:
    static std::string frame_text(const std::string& tracer, const ScenePtr& scene,
                                  const ParamValues& params = {}) {
        const RenderSettings settings;
        return compose_tracer_shader(gl::ShaderLibrary::embedded(), tracer, scene, params,
                                     &settings)
            .text;
    }
};

constexpr const char* kTracers[] = {"grid/buffer/compute", "grid/ssbo/fragment",
                                    "bvh/buffer/compute"};

TEST_F(Specialise, one_matte_instance_under_one_light_has_no_code_for_more) {
    for (const char* tracer : kTracers) {
        const std::string text = frame_text(tracer, ball_on_ground(true, false, 1));
        for (const char* part : {"walk_scene", "fetch_top_", "to_top_level", "top_cells",
                                 "bvh_top_nodes", "reflection_ray", "++light", "++path.depth"}) {
            EXPECT_FALSE(holds(text, part)) << tracer << ": " << part;
        }
        for (const char* part : {"walk_instance", "phong", "next_ray", "fetch_light"}) {
            EXPECT_TRUE(holds(text, part)) << tracer << ": " << part;
        }
    }
}

TEST_F(Specialise, what_a_scene_has_is_there_and_nothing_beside) {
    constexpr const char* kTopLevel = "void walk_scene(";
    constexpr const char* kMirrors = "Ray reflection_ray(";
    constexpr const char* kLights = "++light";
    for (const char* tracer : kTracers) {
        const auto expect = [&](bool one_mesh, bool mirror, int lights) {
            const std::string text = frame_text(tracer, ball_on_ground(one_mesh, mirror, lights));
            EXPECT_EQ(holds(text, kTopLevel), !one_mesh) << tracer;
            EXPECT_EQ(holds(text, kMirrors), mirror) << tracer;
            EXPECT_EQ(holds(text, kLights), lights > 1) << tracer;
        };
        expect(false, false, 1);
        expect(true, true, 1);
        expect(true, false, 2);
        expect(false, true, 2);
        const std::string text = frame_text(tracer, ball_on_ground(true, false, 1), kForAllScenes);
        for (const char* part : {kTopLevel, kMirrors, kLights}) {
            EXPECT_TRUE(holds(text, part)) << tracer << ": " << part;
        }
        EXPECT_TRUE(holds(text, "uniform int light_count;")) << tracer;
    }
}

TEST_F(Specialise, which_object_an_instance_is_of_is_looked_up_where_there_are_several) {
    constexpr const char* kLookUp = "instance_grids";
    for (const char* tracer :
         {"grid/buffer/compute", "irregular_grid/ssbo/fragment", "flat_grid/buffer/fragment"}) {
        const ScenePtr one = ball_on_ground(true, false, 1);
        EXPECT_FALSE(holds(frame_text(tracer, one), kLookUp)) << tracer;
        EXPECT_TRUE(holds(frame_text(tracer, one, kForAllScenes), kLookUp)) << tracer;
        EXPECT_TRUE(holds(frame_text(tracer, ball_on_ground(false, false, 1)), kLookUp)) << tracer;
    }
}

TEST_F(Specialise, rays_for_instances_that_are_only_shifted_meet_no_matrix) {
    constexpr const char* kMatrix = "dvec3 row_x";
    for (const char* tracer : {"grid/buffer/compute", "irregular_grid/ssbo/fragment",
                               "flat_grid/buffer/fragment", "bvh/ssbo/compute"}) {
        Scene scene = *ball_on_ground(false, false, 1);
        EXPECT_FALSE(holds(frame_text(tracer, share(scene)), kMatrix)) << tracer;
        EXPECT_TRUE(holds(frame_text(tracer, share(scene), kForAllScenes), kMatrix)) << tracer;
        for (int column = 0; column < 3; ++column) {
            Scene scaled = scene;
            scaled.instances[1].world_from_object[column] *= 1.5f;
            EXPECT_TRUE(holds(frame_text(tracer, share(scaled)), kMatrix)) << tracer;
        }
        if (std::string(tracer).starts_with("flat_grid")) continue;  // where nothing moves
        scene.animation = make_swarm(2, 1).animation;
        EXPECT_TRUE(holds(frame_text(tracer, share(scene)), kMatrix)) << tracer << ", moving";
    }
}

TEST_F(Specialise, a_frame_is_the_same_as_by_the_shader_for_all_scenes_and_as_by_the_twin) {
    const Catalogue catalogue = catalogue_of(context);
    const RenderSettings settings{.width = 48, .height = 40};
    struct Kind {
        bool one_mesh;
        bool mirror;
        int lights;
    };
    for (const auto& [one_mesh, mirror, lights] : {Kind{true, false, 1}, Kind{false, true, 2}}) {
        const ScenePtr scene = ball_on_ground(one_mesh, mirror, lights);
        const auto frame = [&](const std::string& tracer, const ParamValues& params) {
            return catalogue.at(tracer).make(scene, params)->render(scene->cameras[0], settings);
        };
        for (const std::string storage : {"grid/buffer/", "bvh/buffer/"}) {
            const std::string what = fmt::format("{} one mesh {}, mirror {}, {} lights", storage,
                                                 one_mesh, mirror, lights);
            const Frame special = frame(storage + "compute", {});
            const Frame general = frame(storage + "compute", kForAllScenes);
            const Frame twin = frame(storage + "twin32", {});
            expect_same_bits(special.hits, general.hits, what);
            expect_same_bits(special.hits, twin.hits, what);
            EXPECT_GT(hit_count(special.hits), special.hits.size() / 4) << what;
            size_t rays = 0;
            for (size_t i = 0; i < special.color.size(); ++i) {
                rays += special.counters[i].rays;
                EXPECT_EQ(special.counters[i].rays, general.counters[i].rays) << what;
                EXPECT_EQ(special.counters[i].rays, twin.counters[i].rays) << what;
                for (int c = 0; c < 3; ++c) {
                    // Two programs: the driver may round shading otherwise, by a few ulps of 1.
                    constexpr float kShadingUlps = 1e-5f;
                    EXPECT_NEAR(special.color[i][c], general.color[i][c], kShadingUlps) << what;
                    EXPECT_NEAR(special.color[i][c], twin.color[i][c], kShadingUlps) << what;
                }
            }
            EXPECT_EQ(rays > special.color.size(), lights > 0 || mirror) << what;
        }
    }
}

}  // namespace
}  // namespace onepass::test
