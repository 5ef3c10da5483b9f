// Embree behind the Tracer seam: conventions, intervals, rays that would abort it, instancing,
// threads, and a rendered mirror.
#include "cpu_ref/embree_tracer.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include "core/error.h"
#include "cpu_ref/embree_scene.h"
#include "cpu_ref/exact_judge.h"
#include "tests/unit/cpu_ref/meshes.h"

namespace onepass {
namespace {

using namespace test;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const std::vector<std::string> kOneRayACall = {"embree/robust/threads", "embree/fast/threads",
                                               "embree/robust/1thread", "embree/fast/1thread"};
const std::vector<std::string> kManyRaysACall = {"embree/robust/packet8",  "embree/fast/packet8",
                                                 "embree/robust/packet16", "embree/fast/packet16",
                                                 "embree/robust/stream",   "embree/fast/stream"};

std::vector<std::string> all_names() {
    std::vector<std::string> names = kOneRayACall;
    names.insert(names.end(), kManyRaysACall.begin(), kManyRaysACall.end());
    return names;
}
const std::vector<std::string> kNames = all_names();

std::unique_ptr<Tracer> make(const std::string& name, ScenePtr scene,
                             const ParamValues& values = {}) {
    Catalogue catalogue;
    for (CatalogueEntry& entry : embree_tracers()) catalogue.add(std::move(entry));
    return catalogue.at(name).make(std::move(scene), values);
}

CastResult cast(Tracer& tracer, const std::vector<Ray>& rays, Query query = Query::closest) {
    return tracer.cast(tracer.upload(rays), {.query = query, .counters = false});
}

ScenePtr unit_triangle() {
    Object object;
    add_triangle(object, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    return one_object(object);
}

TEST(EmbreeTracer, all_are_catalogued_as_oracles_the_robust_one_first) {
    std::vector<std::string> names;
    for (const CatalogueEntry& entry : embree_tracers()) {
        names.push_back(entry.info.name);
        EXPECT_TRUE(entry.info.is_oracle);
        EXPECT_FALSE(entry.info.summary.empty());
    }
    EXPECT_EQ(names, kNames);
}

TEST(EmbreeTracer, u_belongs_to_the_second_corner_and_v_to_the_third) {
    for (const std::string& name : kNames) {
        const auto tracer = make(name, unit_triangle());
        const CastResult result = cast(*tracer, {{.org = {0.25f, 0.5f, 2}, .dir = {0, 0, -4}}});
        EXPECT_EQ(result.hits[0], (Hit{0.5f, 0.25f, 0.5f, 0, 0})) << name;
        EXPECT_EQ(result.flags[0], 0u);
        EXPECT_TRUE(std::isnan(result.device_ms));
        EXPECT_TRUE(result.counters.empty());
    }
}

TEST(EmbreeTracer, a_miss_is_infinite_and_without_ids) {
    const auto tracer = make("embree/robust/threads", unit_triangle());
    EXPECT_EQ(cast(*tracer, {{.org = {2, 2, 1}, .dir = {0, 0, -1}}}).hits[0], Hit{});
}

TEST(EmbreeTracer, a_sphere_is_hit_where_geometry_says) {
    const auto scene = one_object(make_sphere(200, 100, 1.0f, vec3(0)));
    const auto tracer = make("embree/robust/threads", scene);
    // A chord of the tessellation lies inside the sphere by at most 1 - cos(pi / 100) of the radius
    // in each of the two directions.
    constexpr float kSagitta = 2.0f * 4.94e-4f;
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const vec3 outside = 3.0f * glm::normalize(random.in_box({vec3(-1), vec3(1)}));
        const Hit hit = cast(*tracer, {{.org = outside, .dir = -outside / 3.0f}}).hits[0];
        ASSERT_TRUE(hit.is_hit());
        EXPECT_GE(hit.t, 2.0f - 1e-5f);
        EXPECT_LE(hit.t, 2.0f + kSagitta);
    }
}

TEST(EmbreeTracer, robust_hits_include_both_ends_of_the_interval) {
    const auto tracer = make("embree/robust/threads", unit_triangle());
    const Ray ray{.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}};
    const auto hits_in = [&](float tmin, float tmax) {
        Ray r = ray;
        r.tmin = tmin;
        r.tmax = tmax;
        const bool closest = cast(*tracer, {r}).hits[0].is_hit();
        EXPECT_EQ(cast(*tracer, {r}, Query::any).hits[0].is_hit(), closest);
        return closest;
    };
    EXPECT_TRUE(hits_in(0.0f, kInfinity));
    EXPECT_TRUE(hits_in(1.0f, 1.0f));
    EXPECT_FALSE(hits_in(std::nextafter(1.0f, 2.0f), kInfinity));
    EXPECT_FALSE(hits_in(0.0f, std::nextafter(1.0f, 0.0f)));
    EXPECT_FALSE(hits_in(2.0f, 0.5f));
}

TEST(EmbreeTracer, rays_embree_would_abort_on_are_flagged_misses) {
    const float too_large = std::nextafter(kEmbreeLargest, kInfinity);
    std::vector<Ray> rays;
    for (const float bad : {kNaN, kInfinity, -kInfinity, too_large, -too_large, 1e30f}) {
        for (int k = 0; k < 3; ++k) {
            Ray ray{.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}};
            ray.org[k] = bad;
            rays.push_back(ray);
            ray = {.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}};
            ray.dir[k] = bad;
            rays.push_back(ray);
        }
    }
    for (const float bad : {kNaN, kInfinity, -1.0f}) {
        rays.push_back({.org = {0.25f, 0.25f, 1}, .tmin = bad, .dir = {0, 0, -1}});
    }
    rays.push_back({.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}, .tmax = kNaN});
    rays.push_back({.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1e-42f}});

    for (const std::string& name : kNames) {
        const auto tracer = make(name, unit_triangle());
        for (const Query query : {Query::closest, Query::any}) {
            const CastResult result = cast(*tracer, rays, query);
            for (size_t i = 0; i < rays.size(); ++i) {
                EXPECT_EQ(result.hits[i], Hit{}) << name << " ray " << i;
                EXPECT_EQ(result.flags[i], kFlagOracleInvalid) << name << " ray " << i;
            }
        }
    }
}

TEST(EmbreeTracer, rays_without_a_point_are_plain_misses) {
    const std::vector<Ray> rays = {
        {.org = {0.25f, 0.25f, 0}, .dir = {0, 0, 0}},
        {.org = {0.25f, 0.25f, 1}, .tmin = 2, .dir = {0, 0, -1}, .tmax = 0.5f},
        {.org = {0.25f, 0.25f, 1}, .dir = {0, 0, -1}, .tmax = -kInfinity},
    };
    const auto tracer = make("embree/robust/threads", unit_triangle());
    for (const Query query : {Query::closest, Query::any}) {
        const CastResult result = cast(*tracer, rays, query);
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(result.hits[i], Hit{});
            EXPECT_EQ(result.flags[i], 0u);
        }
    }
}

TEST(EmbreeTracer, the_largest_rays_it_says_it_takes_do_not_abort) {
    // Scales far from 1 narrow the limits; rays at the very limit must survive Embree's own checks
    // of the ray in object space.
    for (const float scale : {1e-9f, 1.0f, 1e9f}) {
        Scene scene;
        scene.materials.resize(1);
        const uint32_t ball = add_object(scene, make_sphere(8, 6, 1.0f, vec3(0)));
        add_instance(
            scene, ball,
            Affine(vec3(scale, 0, 0), vec3(0, scale, 0), vec3(0, 0, scale), vec3(7, 8, 9)));
        add_instance(scene, ball, affine_identity());
        const auto shared = checked(scene);
        for (const bool robust : {true, false}) {
            const EmbreeScene embree(*shared, {.robust = robust});
            const RayLimits limits = embree.limits();
            ASSERT_GT(limits.largest_org, 1e6f);
            for (const float org : {limits.largest_org, -limits.largest_org}) {
                for (const float dir : {limits.largest_dir, -limits.least_dir}) {
                    const Ray ray{.org = vec3(org), .dir = vec3(dir)};
                    ASSERT_TRUE(oracle_can_take(ray, limits));
                    embree.closest(ray);
                    embree.occluded(ray);
                }
            }
            const float beyond = std::nextafter(limits.largest_org, kInfinity);
            EXPECT_FALSE(oracle_can_take({.org = {0, beyond, 0}}, limits));
        }
    }
}

TEST(EmbreeTracer, scenes_beyond_embrees_floats_are_refused_by_name) {
    Object huge = make_sphere(8, 6, 1e19f, vec3(0));
    EXPECT_THROW(make("embree/robust/threads", one_object(huge)), Error);

    Scene scene;
    scene.materials.resize(1);
    const uint32_t ball = add_object(scene, make_sphere(8, 6, 1.0f, vec3(0)));
    add_instance(scene, ball,
                 Affine(vec3(1e-20f, 0, 0), vec3(0, 1e-20f, 0), vec3(0, 0, 1e-20f), vec3(0)));
    scene.instances[0].name = "speck";
    try {
        make("embree/robust/threads", checked(scene));
        FAIL() << "a transform that Embree cannot invert was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::input);
        EXPECT_EQ(error.parts().where, "instance speck");
    }
}

TEST(EmbreeTracer, instances_are_hit_in_world_distances_under_their_own_ids) {
    const auto tracer = make("embree/robust/threads", instanced_spheres());
    const CastResult result =
        cast(*tracer, {
                          {.org = {-4, 0, 10}, .dir = {0, 0, -2}},  // rotated unit sphere
                          {.org = {4, 1, 10}, .dir = {0, 0, -2}},   // stretched, 1.5 high
                          {.org = {-3, 4, 10}, .dir = {0, 0, -2}},  // mirrored, centre z = -1
                          {.org = {0.03f, -3.02f, 1}, .dir = {0, 0, -2}},  // 0.005 small
                      });
    // Sphere poles are vertices; elsewhere the tessellation lies within this of the sphere.
    constexpr float kSagitta = 0.1f;
    ASSERT_EQ(result.hits[0].inst_id, 0u);
    EXPECT_NEAR(result.hits[0].t, 4.5f, kSagitta);
    ASSERT_EQ(result.hits[1].inst_id, 1u);
    EXPECT_NEAR(result.hits[1].t, (10.0f - 1.5f) / 2.0f, kSagitta);
    ASSERT_EQ(result.hits[2].inst_id, 2u);
    EXPECT_NEAR(result.hits[2].t, (10.0f + 0.5f) / 2.0f, kSagitta);
    ASSERT_EQ(result.hits[3].inst_id, 3u);
    EXPECT_NEAR(result.hits[3].t, (1.0f - 0.015f) / 2.0f, 0.001f);
}

TEST(EmbreeTracer, an_instance_in_place_is_traced_without_the_upper_level_and_answers_alike) {
    const auto direct = one_object(make_sphere(24, 16, 1.0f, vec3(0)));
    Scene two = *direct;
    add_instance(two, 0, Affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(100, 0, 0)));
    const EmbreeScene flat(*direct, {});
    const EmbreeScene instanced(two, {});
    EXPECT_FALSE(flat.instanced());
    EXPECT_TRUE(instanced.instanced());
    for (const Ray& ray : random_rays(*direct, 1000, 5)) {
        EXPECT_EQ(flat.closest(ray), instanced.closest(ray));
    }
}

/// An answer's class by the exact judge.
HitClass class_of(const Judge& judge, const Ray& ray, const Hit& hit) {
    return judge.judge(ray, Query::closest, std::span(&hit, 1)).front().hit_class;
}

TEST(EmbreeTracer, many_rays_a_call_are_answered_as_one_a_call_where_rounding_has_no_say) {
    const auto scene = instanced_spheres();
    const auto judge = make_exact_judge(scene);
    // A count that leaves packets and streams unfilled, of rays that are coherent and that are not.
    std::vector<Ray> rays = random_rays(*scene, 5003, 9);
    for (int i = 0; i < 2000; ++i) {
        const auto x = static_cast<float>(i % 50);
        const auto y = static_cast<float>(i / 50);
        rays.push_back({.org = {0, 0, 20}, .dir = {x / 50 - 0.5f, y / 40 - 0.5f, -2}});
    }
    for (const std::string& name : kManyRaysACall) {
        const std::string mode = name.substr(0, name.rfind('/'));
        const std::vector<Hit> expected = cast(*make(mode + "/threads", scene), rays).hits;
        for (const std::string coherence : {"auto", "coherent", "incoherent"}) {
            const auto tracer = make(name, scene, {{"coherence", coherence}});
            EXPECT_FALSE(tracer->capabilities().render);
            EXPECT_THROW(tracer->render({}, {}), Error);
            const CastResult any = cast(*tracer, rays, Query::any);
            const std::vector<Hit> hits = cast(*tracer, rays).hits;
            size_t found = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                EXPECT_EQ(any.hits[i].is_hit(), hits[i].is_hit()) << name << " ray " << i;
                found += hits[i].is_hit() ? 1 : 0;
                if (hits[i] == expected[i]) continue;
                // Other instructions round otherwise; which class an answer falls into may not
                // turn from right to wrong.
                EXPECT_EQ(is_error(class_of(*judge, rays[i], hits[i])),
                          is_error(class_of(*judge, rays[i], expected[i])))
                    << name << " " << coherence << " ray " << i;
            }
            EXPECT_GT(found, 500u);
        }
    }
}

TEST(EmbreeTracer, a_ray_embree_cannot_take_leaves_its_neighbours_in_a_packet_alone) {
    const auto scene = one_object(make_sphere(24, 16, 1.0f, vec3(0)));
    std::vector<Ray> rays = random_rays(*scene, 999, 11);
    const std::vector<Ray> sound = rays;
    for (size_t i = 0; i < rays.size(); i += 3) rays[i].org[i % 2] = i % 2 ? kNaN : kInfinity;
    for (size_t i = 1; i < rays.size(); i += 9) rays[i].dir = vec3(0);
    for (const std::string& name : kManyRaysACall) {
        const auto tracer = make(name, scene);
        for (const Query query : {Query::closest, Query::any}) {
            const CastResult all = cast(*tracer, sound, query);
            const CastResult some = cast(*tracer, rays, query);
            for (size_t i = 0; i < rays.size(); ++i) {
                const bool changed = i % 3 == 0 || i % 9 == 1;
                EXPECT_EQ(some.hits[i], changed ? Hit{} : all.hits[i]) << name << " ray " << i;
                EXPECT_EQ(some.flags[i], i % 3 == 0 ? kFlagOracleInvalid : 0u) << name;
            }
        }
    }
}

TEST(EmbreeTracer, rays_of_a_camera_are_coherent_and_random_ones_are_not) {
    const auto scene = one_object(make_sphere(24, 16, 1.0f, vec3(0)));
    const auto tracer = make("embree/fast/stream", scene);
    const auto told = [&](const std::vector<Ray>& rays) {
        return cast(*tracer, rays).costs.at(0).value;
    };
    std::vector<Ray> primary;
    for (int i = 0; i < 256 * 16; ++i) {
        const auto x = static_cast<float>(i % 256);
        const auto y = static_cast<float>(i / 256);
        primary.push_back({.org = {0, 0, 4}, .dir = {x / 256 - 0.5f, y / 256 - 0.5f, -1.2f}});
    }
    EXPECT_EQ(told(primary), 1.0);
    EXPECT_EQ(told(random_rays(*scene, 4096, 12)), 0.0);
    EXPECT_TRUE(cast(*make("embree/fast/threads", scene), primary).costs.empty());
}

TEST(EmbreeTracer, thread_count_does_not_show_in_the_hits) {
    const auto scene = instanced_spheres();
    const std::vector<Ray> rays = random_rays(*scene, 20000, 2);
    for (const std::string mode : {"embree/robust/", "embree/fast/"}) {
        const auto one = make(mode + "1thread", scene);
        const auto all = make(mode + "threads", scene);
        const auto asked = make(mode + "threads", scene, {{"threads", "1"}});
        EXPECT_EQ(one->capabilities().threads, 1u);
        EXPECT_EQ(asked->capabilities().threads, 1u);
        EXPECT_EQ(all->capabilities().threads,
                  static_cast<uint32_t>(tbb::info::default_concurrency()));
        const CastResult expected = cast(*one, rays);
        EXPECT_EQ(cast(*all, rays).hits, expected.hits);
        EXPECT_EQ(cast(*asked, rays).hits, expected.hits);
    }
}

TEST(EmbreeTracer, a_tracer_of_one_thread_leaves_tbb_its_threads) {
    const auto limit = [] {
        return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    };
    const size_t before = limit();
    const auto tracer = make("embree/robust/1thread", unit_triangle());
    EXPECT_EQ(limit(), before);
}

TEST(EmbreeTracer, parameters_out_of_range_are_refused) {
    EXPECT_THROW(make("embree/robust/threads", unit_triangle(), {{"threads", "-1"}}), Error);
    EXPECT_THROW(make("embree/robust/threads", unit_triangle(), {{"threads", "100000"}}), Error);
    EXPECT_THROW(make("embree/robust/threads", unit_triangle(), {{"quality", "best"}}), Error);
    EXPECT_THROW(make("embree/robust/1thread", unit_triangle(), {{"threads", "2"}}), Error);
}

TEST(EmbreeTracer, any_agrees_with_closest_about_hit_or_miss) {
    const auto scene = instanced_spheres();
    const auto tracer = make("embree/robust/threads", scene);
    const std::vector<Ray> rays = random_rays(*scene, 5000, 3);
    const CastResult closest = cast(*tracer, rays);
    const CastResult any = cast(*tracer, rays, Query::any);
    size_t hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(any.hits[i].is_hit(), closest.hits[i].is_hit());
        hits += closest.hits[i].is_hit() ? 1 : 0;
    }
    EXPECT_GT(hits, 100u);
}

TEST(EmbreeTracer, qualities_differ_in_the_tree_and_not_in_the_hits) {
    const auto scene = one_object(make_sphere(48, 32, 1.0f, vec3(0)));
    const std::vector<Ray> rays = random_rays(*scene, 2000, 4);
    const CastResult medium = cast(*make("embree/robust/threads", scene), rays);
    for (const std::string quality : {"low", "high"}) {
        const auto tracer = make("embree/robust/threads", scene, {{"quality", quality}});
        EXPECT_EQ(cast(*tracer, rays).hits, medium.hits) << quality;
    }
}

TEST(EmbreeTracer, stats_hold_the_build_and_its_memory) {
    const auto tracer = make("embree/robust/threads", instanced_spheres());
    const auto value = [&](const std::string& name) {
        for (const Stat& stat : tracer->stats()) {
            if (stat.name == name) return stat.value;
        }
        ADD_FAILURE() << "no stat " << name;
        return 0.0;
    };
    EXPECT_GT(value("build_ms"), 0.0);
    EXPECT_GT(value("bytes"), 10000.0);
    EXPECT_EQ(value("instances"), 4.0);
    EXPECT_EQ(value("triangles"), 2 * (2 * 24 * 15) + 2 * (2 * 12 * 7));
    EXPECT_EQ(value("unique_triangles"), 2 * 24 * 15 + 2 * 12 * 7);
}

TEST(EmbreeTracer, fast_and_robust_err_at_edges_only) {
    const auto scene = one_object(make_sphere(48, 32, 1.0f, vec3(0)));
    const auto judge = make_exact_judge(scene);
    const auto robust = make("embree/robust/threads", scene);
    const auto fast = make("embree/fast/threads", scene);
    const std::vector<Ray> rays = random_rays(*scene, 20000, 6);
    const std::vector<Hit> a = cast(*robust, rays).hits;
    const std::vector<Hit> b = cast(*fast, rays).hits;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (a[i].is_hit() == b[i].is_hit() && a[i].prim_id == b[i].prim_id) continue;
        const std::array<Hit, 2> answers = {a[i], b[i]};
        for (const Verdict& verdict : judge->judge(rays[i], Query::closest, answers)) {
            EXPECT_FALSE(is_error(verdict.hit_class))
                << "ray " << i << ": " << to_string(verdict.hit_class);
        }
    }
}

TEST(EmbreeTracer, a_mirror_shows_what_stands_behind_the_camera) {
    Scene scene;
    scene.ambient = vec3(1);
    scene.background = vec3(0, 0, 1);
    Material mirror;
    mirror.diffuse = vec3(0, 1, 0);
    mirror.reflectivity = 0.75f;
    Material red;
    red.diffuse = vec3(1, 0, 0);
    scene.materials = {mirror, red};
    Object square;
    add_square(square, 1.0f, 0.0f);
    add_object(scene, square);
    add_instance(scene, 0, affine_identity(), 0);
    add_instance(scene, 0, Affine(vec3(50, 0, 0), vec3(0, 50, 0), vec3(0, 0, 1), vec3(0, 0, 5)), 1);
    Camera camera;
    camera.world_from_camera[3] = vec3(0.1f, 0.2f, 2.0f);
    const auto tracer = make("embree/robust/threads", checked(scene));

    RenderSettings settings;
    settings.width = 33;
    settings.height = 21;
    const Frame frame = tracer->render(camera, settings);
    const size_t centre = 10 * 33 + 16;
    EXPECT_EQ(frame.color[centre], vec3(0.75f, 0.25f, 0.0f));
    EXPECT_EQ(frame.hits[centre].inst_id, 0u);
    EXPECT_FLOAT_EQ(frame.hits[centre].t, 2.0f);
    EXPECT_EQ(frame.normals[centre], vec3(0, 0, 1));
    EXPECT_EQ(frame.counters[centre].rays, 2u);
    EXPECT_EQ(frame.flags, std::vector<uint32_t>(33 * 21, 0u));

    settings.max_depth = 0;
    settings.aovs = false;
    const Frame dull = tracer->render(camera, settings);
    EXPECT_EQ(dull.color[centre], vec3(0, 1, 0));
    EXPECT_TRUE(dull.hits.empty());
}

TEST(EmbreeTracer, a_shadow_falls_between_light_and_surface) {
    Scene scene;
    scene.materials.resize(1);
    scene.lights.resize(1);
    scene.lights[0].position = vec3(0, 0, 4);
    Object squares;
    add_square(squares, 3.0f, 0.0f);
    add_square(squares, 0.25f, 2.0f);
    add_instance(scene, add_object(scene, squares), affine_identity());
    Camera camera;
    camera.world_from_camera[3] = vec3(0, 0, 1.5f);  // below the small square, above the large one
    const auto tracer = make("embree/robust/1thread", checked(scene));
    RenderSettings settings;
    settings.width = settings.height = 9;
    settings.aovs = false;
    const size_t centre = 4 * 9 + 4;
    EXPECT_EQ(tracer->render(camera, settings).color[centre], vec3(0));
    settings.shadows = false;
    EXPECT_GT(tracer->render(camera, settings).color[centre].x, 0.1f);
}

TEST(EmbreeTracer, a_camera_at_infinity_flags_every_pixel) {
    Camera camera;
    camera.world_from_camera[3] = vec3(0, 0, kInfinity);
    RenderSettings settings;
    settings.width = settings.height = 4;
    const Frame frame = make("embree/robust/threads", unit_triangle())->render(camera, settings);
    EXPECT_EQ(frame.flags, std::vector<uint32_t>(16, kFlagOracleInvalid));
}

TEST(EmbreeTracer, the_description_names_version_and_build) {
    EXPECT_NE(embree_description().find("Embree 3."), std::string::npos);
    EXPECT_NE(embree_description().find("Debian build with assertions"), std::string::npos);
}

}  // namespace
}  // namespace onepass
