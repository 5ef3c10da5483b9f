// Ray sets: the same on every run, in the order and from the places that are promised.
#include "compare/rays.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "compare/hash.h"
#include "compare/npy.h"
#include "core/camera.h"
#include "core/error.h"
#include "tests/support/fake_tracer.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

/// A square of side 2 in the plane z = 0, seen from z = 4, lit from (0, 0, 4).
Scene square_scene() {
    Scene scene;
    scene.name = "square";
    Object object;
    object.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    object.triangles = {{0, 1, 2}, {0, 2, 3}};
    object.groups = {{"all", 0, 2}};
    scene.objects = {object};
    scene.instances = {{"square", 0, affine_identity(), {0}}};
    scene.materials = {Material{}};
    scene.lights = {PointLight{"lamp", vec3(0, 0, 4), vec3(1)}};
    scene.cameras = {look_at(vec3(0, 0, 4), vec3(0), vec3(0, 1, 0), 1.0f)};
    return scene;
}

/// Intersects the square's plane; which triangle does not matter here.
FakeTracer square_tracer() {
    FakeTracer tracer("fake");
    tracer.answer = [](const Ray& ray) {
        const float t = -ray.org.z / ray.dir.z;
        const vec3 p = ray.org + t * ray.dir;
        const bool inside = t > 0 && std::abs(p.x) <= 1 && std::abs(p.y) <= 1;
        return inside ? Hit{t, 0.2f, 0.2f, 0, 0} : Hit{};
    };
    return tracer;
}

TEST(PixelOrder, walks_tiles_of_eight_by_four_in_halves_and_parts_of_four_by_two) {
    const auto order = pixel_order(16, 8, true);
    ASSERT_EQ(order.size(), 128u);
    EXPECT_EQ(order[0], 0u);
    EXPECT_EQ(order[3], 3u);
    EXPECT_EQ(order[4], 16u) << "the part's second row";
    EXPECT_EQ(order[8], 32u) << "the half's second part";
    EXPECT_EQ(order[16], 4u) << "the second half";
    EXPECT_EQ(order[32], 8u) << "the second tile";
    EXPECT_EQ(order[64], 64u) << "the second row of tiles";
}

TEST(PixelOrder, keeps_the_8_rays_of_a_part_together) {
    const uint32_t width = 64, height = 32;
    const auto order = pixel_order(width, height, true);
    for (size_t first = 0; first < order.size(); first += 8) {
        for (size_t ray = first; ray < first + 8; ++ray) {
            EXPECT_EQ(order[ray] % width / 4, order[first] % width / 4) << "ray " << ray;
            EXPECT_EQ(order[ray] / width / 2, order[first] / width / 2) << "ray " << ray;
        }
    }
}

TEST(PixelOrder, keeps_the_16_rays_of_a_half_together) {
    const uint32_t width = 64, height = 32;
    const auto order = pixel_order(width, height, true);
    for (size_t ray = 0; ray < order.size(); ++ray) {
        const uint32_t first = order[ray / 16 * 16];
        EXPECT_EQ(order[ray] % width / 4, first % width / 4) << "ray " << ray;
        EXPECT_EQ(order[ray] / width / 4, first / width / 4) << "ray " << ray;
    }
}

TEST(PixelOrder, keeps_the_32_rays_of_a_tile_together) {
    const uint32_t width = 64, height = 32;
    const auto order = pixel_order(width, height, true);
    for (size_t ray = 0; ray < order.size(); ++ray) {
        const uint32_t x = order[ray] % width, y = order[ray] / width;
        EXPECT_EQ(x / 8 + width / 8 * (y / 4), ray / 32) << "ray " << ray;
    }
}

TEST(PixelOrder, visits_every_pixel_once_whatever_the_size) {
    for (const auto& [width, height] : {std::pair{13u, 7u}, {1u, 1u}, {8u, 4u}, {3u, 9u}}) {
        for (const bool tiled : {true, false}) {
            const auto order = pixel_order(width, height, tiled);
            const std::set<uint32_t> pixels(order.begin(), order.end());
            EXPECT_EQ(order.size(), size_t{width} * height);
            EXPECT_EQ(pixels.size(), order.size());
            EXPECT_EQ(*pixels.rbegin(), width * height - 1);
        }
    }
}

TEST(RandomRays, are_the_same_for_the_same_seed_on_every_machine) {
    const Bounds box{vec3(-1, -2, -3), vec3(1, 2, 3)};
    // The first three numbers of std::mt19937_64(1), by the standard's own definition.
    std::mt19937_64 engine(1);
    const float x = static_cast<float>(engine() >> 40) * 0x1p-24f;
    EXPECT_EQ(random_rays(box, 1, 1)[0].org.x, -1.0f + 2.0f * x);
    EXPECT_EQ(hash_rays(random_rays(box, 100, 5)), hash_rays(random_rays(box, 100, 5)));
    EXPECT_NE(hash_rays(random_rays(box, 100, 5)), hash_rays(random_rays(box, 100, 6)));
}

TEST(RandomRays, start_and_end_inside_the_box) {
    const Bounds box{vec3(10, 20, 30), vec3(11, 22, 33)};
    vec3 sum(0.0f);
    for (const Ray& ray : random_rays(box, 10000, 3)) {
        const vec3 end = ray.org + ray.dir;
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(ray.org[axis], box.lower[axis]);
            ASSERT_LE(ray.org[axis], box.upper[axis]);
            ASSERT_GE(end[axis], box.lower[axis] - 1e-5f);
            ASSERT_LE(end[axis], box.upper[axis] + 1e-5f);
        }
        EXPECT_EQ(ray.tmin, 0.0f);
        EXPECT_EQ(ray.tmax, kInfinity);
        sum += (ray.org - box.lower) / box.extent();
    }
    // The mean of n uniform numbers has standard deviation 0.289 / sqrt(n) = 0.0029; five of them.
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis] / 10000.0f, 0.5f, 0.0145f);
}

TEST(CosineDirection, is_a_unit_vector_about_any_normal) {
    for (const vec3& normal :
         {vec3(1, 0, 0), vec3(0, -1, 0), vec3(0, 0, 1), glm::normalize(vec3(1, 2, -3))}) {
        EXPECT_NEAR(glm::length(cosine_direction(normal, 0.3f, -0.6f)), 1.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(cosine_direction(normal, 0.0f, 0.0f), normal), 1.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(cosine_direction(normal, 0.6f, 0.0f), normal), 0.8f, 1e-6f);
    }
}

TEST(MakeRaySet, casts_the_same_primary_rays_in_tiles_and_in_scan_lines) {
    const Scene scene = square_scene();
    FakeTracer tracer = square_tracer();
    const RayRequest request{.width = 20, .height = 10};
    const RaySet tiled = make_ray_set("primary", scene, tracer, request);
    const RaySet scanned = make_ray_set("scan", scene, tracer, request);
    ASSERT_EQ(tiled.rays.size(), 200u);
    EXPECT_NE(tiled.hash, scanned.hash);
    for (size_t i = 0; i < tiled.rays.size(); ++i) {
        EXPECT_EQ(tiled.rays[i].dir, scanned.rays[tiled.pixels[i]].dir);
        EXPECT_EQ(scanned.pixels[i], i);
    }
    const CameraFrame frame = camera_frame(scene.cameras[0], 20, 10);
    EXPECT_EQ(scanned.rays[45].dir, primary_ray(frame, 5, 2).dir);
}

TEST(MakeRaySet, starts_secondary_rays_above_the_surface) {
    const Scene scene = square_scene();
    FakeTracer tracer = square_tracer();
    const RayRequest request{.width = 32, .height = 32, .seed = 4};
    for (const std::string kind : {"diffuse", "reflection", "shadow"}) {
        const RaySet set = make_ray_set(kind, scene, tracer, request);
        EXPECT_GT(set.rays.size(), 100u) << kind;
        EXPECT_LT(set.rays.size(), 1024u) << kind << ": not every pixel shows the square";
        EXPECT_EQ(set.pixels.size(), set.rays.size());
        EXPECT_EQ(set.query, kind == "shadow" ? Query::any : Query::closest);
        for (const Ray& ray : set.rays) {
            ASSERT_GT(ray.org.z, 0.0f) << kind;
            ASSERT_GT(ray.dir.z, 0.0f) << kind;
        }
    }
}

TEST(MakeRaySet, casts_one_diffuse_ray_from_each_primary_hit_and_follows_the_cosine) {
    const Scene scene = square_scene();
    FakeTracer tracer = square_tracer();
    const RayRequest request{.width = 128, .height = 128, .seed = 7};
    const RaySet primary = make_ray_set("primary", scene, tracer, request);
    std::vector<uint32_t> hits;
    for (size_t i = 0; i < primary.rays.size(); ++i) {
        if (tracer.answer(primary.rays[i]).is_hit()) hits.push_back(primary.pixels[i]);
    }
    const RaySet diffuse = make_ray_set("diffuse", scene, tracer, request);
    EXPECT_EQ(diffuse.pixels, hits) << "in the order of the tiles";
    double cosines = 0.0;
    for (const Ray& ray : diffuse.rays) cosines += ray.dir.z;
    const double n = static_cast<double>(diffuse.rays.size());
    // The mean of cos under density cos / pi is 2/3, its standard deviation sqrt(1/18); five of
    // them.
    EXPECT_NEAR(cosines / n, 2.0 / 3.0, 5.0 * std::sqrt(1.0 / 18.0 / n));
}

TEST(MakeRaySet, ends_shadow_rays_at_the_light) {
    const Scene scene = square_scene();
    FakeTracer tracer = square_tracer();
    const RaySet set = make_ray_set("shadow", scene, tracer, {.width = 8, .height = 8});
    for (const Ray& ray : set.rays) {
        EXPECT_EQ(ray.tmax, 1.0f);
        // The end is rounded by a few ulps of 4: 2^-20.
        EXPECT_NEAR(glm::length(ray.org + ray.dir - vec3(0, 0, 4)), 0.0f, 0x1p-20f);
    }
}

TEST(MakeRaySet, reads_files_and_names_them) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "mine.npy";
    write_rays_npy(path, std::vector<Ray>(3));
    FakeTracer tracer = square_tracer();
    const RaySet set = make_ray_set(path.string(), square_scene(), tracer, {});
    EXPECT_EQ(set.rays.size(), 3u);
    EXPECT_EQ(set.name, path.string());
    EXPECT_EQ(set.hash, hash_text(hash_rays(set.rays)));
    EXPECT_TRUE(set.pixels.empty());
}

TEST(MakeRaySet, refuses_unknown_kinds_cameras_and_kinds_without_a_ray) {
    Scene scene = square_scene();
    FakeTracer tracer = square_tracer();
    EXPECT_THROW(make_ray_set("sideways", scene, tracer, {}), Error);
    EXPECT_THROW(make_ray_set("primary", scene, tracer, {.camera = 1}), Error);
    scene.lights.clear();
    EXPECT_THROW(make_ray_set("shadow", scene, tracer, {}), Error);
}

TEST(Hash, follows_fnv_1a) {
    Fnv1a64 hash;
    EXPECT_EQ(hash_text(hash.value()), "cbf29ce484222325");
    hash.add("a", 1);
    EXPECT_EQ(hash_text(hash.value()), "af63dc4c8601ec8c") << "the published value of \"a\"";
}

TEST(Hash, sees_every_part_of_a_scene_but_names) {
    const Scene scene = square_scene();
    const auto changed = [&](auto&& change) {
        Scene other = scene;
        change(other);
        return hash_scene(other) != hash_scene(scene);
    };
    EXPECT_FALSE(changed([](Scene& s) { s.name = s.objects[0].name = "other"; }));
    EXPECT_TRUE(changed([](Scene& s) { s.objects[0].positions[2].y = 1.5f; }));
    EXPECT_TRUE(changed([](Scene& s) { s.objects[0].normals.assign(4, vec3(0, 0, 1)); }));
    EXPECT_TRUE(changed(
        [](Scene& s) { std::swap(s.objects[0].triangles[0].x, s.objects[0].triangles[0].y); }));
    EXPECT_TRUE(changed([](Scene& s) { s.instances[0].world_from_object[3].x = 1; }));
    EXPECT_TRUE(changed([](Scene& s) { s.materials[0].reflectivity = 0.5f; }));
    EXPECT_TRUE(changed([](Scene& s) { s.lights[0].intensity.y = 0.5f; }));
    EXPECT_TRUE(changed([](Scene& s) { s.cameras[0].vertical_fov = 0.5f; }));
    EXPECT_TRUE(changed([](Scene& s) { s.ambient.x = 0.5f; }));
}

}  // namespace
}  // namespace onepass
