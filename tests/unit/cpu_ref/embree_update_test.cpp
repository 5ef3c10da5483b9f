// Embree with moved instances: the same answers as a tracer made anew, nothing built twice, and
// nothing changed by an update that fails.
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "core/camera.h"
#include "core/shading.h"
#include "cpu_ref/embree_scene.h"
#include "cpu_ref/embree_tracer.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;

constexpr const char* kRobust = "embree/robust/threads";

ScenePtr share(Scene scene) { return std::make_shared<const Scene>(std::move(scene)); }

std::unique_ptr<Tracer> make(ScenePtr scene, const std::string& name = kRobust) {
    Catalogue catalogue;
    for (CatalogueEntry& entry : embree_tracers()) catalogue.add(std::move(entry));
    return catalogue.at(name).make(std::move(scene), {});
}

/// A quad that moves along x by 1 a second, of an animated node at rest at 0.
Scene moving_quad() {
    Scene scene = test::quad_scene();
    scene.animation.nodes.resize(1);
    scene.animation.channels = {{.node = 0,
                                 .path = AnimationChannel::Path::translation,
                                 .interpolation = AnimationChannel::Interpolation::linear,
                                 .times = {0, 10},
                                 .values = {vec4(0.0f), vec4(10, 0, 0, 0)}}};
    scene.animation.carried = {{.instance = 0, .node = 0}};
    return scene;
}

double stat(const Tracer& tracer, const std::string& name) {
    for (const Stat& s : tracer.stats()) {
        if (s.name == name) return s.value;
    }
    ADD_FAILURE() << "no " << name;
    return 0.0;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(EmbreeUpdate, gives_the_frames_of_a_tracer_made_anew) {
    for (const Scene& scene : {make_balls_1(), make_swarm(200, 1)}) {
        for (const char* name : {kRobust, "embree/fast/1thread"}) {
            const auto moved = make(share(scene), name);
            const RenderSettings settings{.width = 96, .height = 96};
            for (const double time : {0.0, 0.55, 1.7, 0.2}) {
                moved->update(instance_transforms(scene, time));
                const Frame frame = moved->render(scene.cameras[0], settings);
                const Frame fresh =
                    make(share(scene_at(scene, time)), name)->render(scene.cameras[0], settings);
                EXPECT_TRUE(same_bits(frame.hits, fresh.hits)) << scene.name << " at " << time;
                EXPECT_TRUE(same_bits(frame.normals, fresh.normals));
                EXPECT_TRUE(same_bits(frame.color, fresh.color));
            }
        }
    }
}

TEST(EmbreeUpdate, moves_what_a_ray_hits_and_keeps_rays_that_were_uploaded_before) {
    const Scene scene = moving_quad();
    const auto tracer = make(share(scene));
    const RayBatch batch =
        tracer->upload(std::vector<Ray>{{.org = {0.5f, 0.25f, 2}, .dir = {0, 0, -1}},
                                        {.org = {3.5f, 0.25f, 2}, .dir = {0, 0, -1}}});
    EXPECT_TRUE(tracer->cast(batch).hits[0].is_hit()) << "one identity instance, before any update";
    EXPECT_FALSE(tracer->cast(batch).hits[1].is_hit());
    tracer->update(instance_transforms(scene, 3.0));
    EXPECT_FALSE(tracer->cast(batch).hits[0].is_hit());
    EXPECT_EQ(tracer->cast(batch).hits[1].t, 2.0f);
    EXPECT_EQ(tracer->cast(batch).hits[1].inst_id, 0u);
}

TEST(EmbreeUpdate, builds_the_top_level_only) {
    const Scene scene = make_instances();
    const auto still = make(share(scene));
    EXPECT_EQ(stat(*still, "object_builds"), static_cast<double>(scene.objects.size()));
    EXPECT_EQ(stat(*still, "top_builds"), 1.0);

    const Scene swarm = make_swarm(30, 1);
    const auto tracer = make(share(swarm));
    for (int k = 0; k < 5; ++k) {
        const UpdateTimes times = tracer->update(instance_transforms(swarm, 0.1 * k));
        EXPECT_GT(times.update_ms, 0.0);
        EXPECT_EQ(times.upload_ms, 0.0);
    }
    EXPECT_EQ(stat(*tracer, "object_builds"), 1.0);
    EXPECT_EQ(stat(*tracer, "top_builds"), 6.0);
}

TEST(EmbreeUpdate, that_fails_changes_nothing) {
    const Scene scene = make_balls_1();
    const auto tracer = make(share(scene));
    const RenderSettings settings{.width = 32, .height = 32};
    tracer->update(instance_transforms(scene, 0.5));
    const Frame before = tracer->render(scene.cameras[0], settings);

    const std::vector<Affine> good = instance_transforms(scene, 1.2);
    // The last instance is the bad one, so that all others would have moved by then.
    const auto refused = [&](const Affine& bad) {
        std::vector<Affine> transforms = good;
        transforms.back() = bad;
        const Error error = error_of([&] { tracer->update(transforms); });
        EXPECT_TRUE(contains(error.what(), "orange"));
        EXPECT_TRUE(test::is_clear(error));
        const Frame after = tracer->render(scene.cameras[0], settings);
        EXPECT_TRUE(same_bits(before.color, after.color));
        EXPECT_TRUE(same_bits(before.hits, after.hits));
    };
    refused(scaling(vec3(1, 0, 1)));
    refused(scaling(vec3(std::numeric_limits<float>::quiet_NaN())));
    refused(scaling(vec3(1e-20f)));
    refused(translation(vec3(1e19f, 0, 0)));
    EXPECT_THROW(tracer->update(std::vector<Affine>(3, affine_identity())), Error);
    EXPECT_TRUE(same_bits(before.color, tracer->render(scene.cameras[0], settings).color));
    EXPECT_EQ(stat(*tracer, "top_builds"), 2.0);
}

TEST(EmbreeUpdate, of_a_static_scene_is_refused) {
    const Scene scene = make_instances();
    const auto tracer = make(share(scene));
    const Error error = error_of([&] { tracer->update(instance_transforms(scene, 0.0)); });
    EXPECT_TRUE(contains(error.what(), "without an animation"));
    EXPECT_TRUE(test::is_clear(error));
}

TEST(EmbreeUpdate, narrows_the_rays_that_embree_may_be_asked_about) {
    // In an object a million times smaller the same ray would leave what Embree asserts.
    const Scene scene = moving_quad();
    const auto tracer = make(share(scene));
    const Ray far_ray{.org = {0, 0, 1e15f}, .dir = {0, 0, -1}};
    const RayBatch batch = tracer->upload(std::vector<Ray>{far_ray});
    EXPECT_EQ(tracer->cast(batch).flags[0], 0u);
    tracer->update(std::vector<Affine>{scaling(vec3(1e-6f))});
    EXPECT_EQ(tracer->cast(batch).flags[0], static_cast<uint32_t>(kFlagOracleInvalid));
    tracer->update(std::vector<Affine>{affine_identity()});
    EXPECT_EQ(tracer->cast(batch).flags[0], 0u);
}

TEST(ShadingScene, follows_moved_instances_as_if_made_anew) {
    const Scene scene = make_balls_1();
    ShadingScene shading(scene);
    EXPECT_EQ(shading.ray_offset, secondary_offset(scene_bounds(scene)));
    const Scene later = scene_at(scene, 0.8);
    shading.move(instance_transforms(scene, 0.8));
    const ShadingScene fresh(later);
    EXPECT_EQ(shading.object_from_world, fresh.object_from_world);
    EXPECT_EQ(shading.ray_offset, fresh.ray_offset);

    Scene far_scene = moving_quad();
    ShadingScene moved(far_scene);
    const float near_offset = moved.ray_offset;
    moved.move(std::vector<Affine>{translation(vec3(1000, 0, 0))});
    EXPECT_GT(moved.ray_offset, 10 * near_offset);
    far_scene.instances[0].world_from_object = translation(vec3(1000, 0, 0));
    EXPECT_EQ(moved.ray_offset, secondary_offset(scene_bounds(far_scene)));
}

}  // namespace
}  // namespace onepass
