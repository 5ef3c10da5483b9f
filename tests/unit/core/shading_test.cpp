// The shading model over answers that are known in closed form.
#include "core/shading.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/support/scenes.h"

namespace onepass {
namespace {

using test::quad_scene;

/// Two quads: number 0 in z = 0 facing +z, number 1 in z = 10 turned to face it.
Scene facing_quads() {
    Scene scene = quad_scene();
    scene.objects[0].groups = {{"quad", 0, 2}};
    scene.instances[0].materials = {0};
    scene.instances.push_back(
        {"opposite",
         0,
         Affine(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1), vec3(0, 0, 10)),
         {1}});
    scene.materials[0].diffuse = vec3(0.5f, 0.25f, 0.125f);
    scene.materials[1].diffuse = vec3(0.125f, 0.5f, 0.25f);
    scene.background = vec3(0.25f, 0.5f, 0.75f);
    return scene;
}

/// The planes of the two quads, without bounds.
Hit closest_plane(const Ray& ray) {
    if (ray.dir.z == 0.0f) return {};
    const bool down = ray.dir.z < 0.0f;
    const float t = ((down ? 0.0f : 10.0f) - ray.org.z) / ray.dir.z;
    return {t, 0.25f, 0.25f, 0, down ? 0u : 1u};
}

bool unoccluded(const Ray&) { return false; }

/// A ray straight down onto the first quad.
Ray ray_down() { return {vec3(0, 0, 5), 0.0f, vec3(0, 0, -1), kInfinity}; }

// The light stands 4 above the quad and the secondary origin 10 * 2^-16 above it, straight over the
// point: cosines are 1 up to rounding.
constexpr float kTolerance = 1e-6f;

void expect_near(const vec3& a, const vec3& b) {
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(a[channel], b[channel], kTolerance);
}

TEST(Shading, a_miss_shows_the_background) {
    const Scene scene = facing_quads();
    const ShadedPath path = shade_path(
        ShadingScene(scene), ray_down(), {}, [](const Ray&) { return Hit{}; }, unoccluded);
    expect_near(path.color, scene.background);
    EXPECT_EQ(path.rays, 1u);
    EXPECT_FALSE(path.primary.is_hit());
}

TEST(Shading, a_lit_matte_surface_shows_its_diffuse_colour) {
    const Scene scene = facing_quads();
    const ShadedPath path =
        shade_path(ShadingScene(scene), ray_down(), {}, closest_plane, unoccluded);
    expect_near(path.color, scene.materials[0].diffuse);
    expect_near(path.normal, vec3(0, 0, 1));
    EXPECT_EQ(path.rays, 2u);  // primary and shadow
    EXPECT_EQ(path.primary.inst_id, 0u);
}

TEST(Shading, a_shadow_leaves_only_ambient_light) {
    Scene scene = facing_quads();
    scene.ambient = vec3(0.5f);
    Ray shadow_ray;
    const auto occluded = [&](const Ray& ray) {
        shadow_ray = ray;
        return true;
    };
    const ShadedPath path =
        shade_path(ShadingScene(scene), ray_down(), {}, closest_plane, occluded);
    expect_near(path.color, scene.materials[0].diffuse * 0.5f);

    // The shadow ray ends at the light, and starts above the surface.
    EXPECT_EQ(shadow_ray.tmax, 1.0f);
    expect_near(shadow_ray.org + shadow_ray.dir, scene.lights[0].position);
    EXPECT_GT(shadow_ray.org.z, 0.0f);

    RenderSettings without_shadows;
    without_shadows.shadows = false;
    const ShadedPath lit =
        shade_path(ShadingScene(scene), ray_down(), without_shadows, closest_plane, occluded);
    expect_near(lit.color, scene.materials[0].diffuse * 1.5f);
}

TEST(Shading, light_from_behind_casts_no_shadow_ray) {
    Scene scene = facing_quads();
    scene.lights[0].position = vec3(0, 0, -4);
    const ShadedPath path =
        shade_path(ShadingScene(scene), ray_down(), {}, closest_plane, unoccluded);
    expect_near(path.color, vec3(0));
    EXPECT_EQ(path.rays, 1u);
}

TEST(Shading, a_mirror_shows_the_opposite_surface_by_its_share) {
    Scene scene = facing_quads();
    scene.materials[0].reflectivity = 0.75f;
    scene.lights[0].position = vec3(0, 0, 5);
    const ShadedPath path =
        shade_path(ShadingScene(scene), ray_down(), {}, closest_plane, unoccluded);
    expect_near(path.color,
                scene.materials[0].diffuse * 0.25f + scene.materials[1].diffuse * 0.75f);
    EXPECT_EQ(path.primary.inst_id, 0u);
    EXPECT_EQ(path.rays, 4u);
}

TEST(Shading, a_mirror_at_the_depth_limit_shows_its_own_colour) {
    Scene scene = facing_quads();
    scene.materials[0].reflectivity = 0.75f;
    scene.materials[1].reflectivity = 0.75f;
    scene.lights[0].position = vec3(0, 0, 5);
    const vec3 a = scene.materials[0].diffuse;
    const vec3 b = scene.materials[1].diffuse;
    RenderSettings settings;
    settings.max_depth = 0;
    const ShadingScene shading(scene);
    expect_near(shade_path(shading, ray_down(), settings, closest_plane, unoccluded).color, a);
    settings.max_depth = 2;
    expect_near(shade_path(shading, ray_down(), settings, closest_plane, unoccluded).color,
                a * 0.25f + b * (0.75f * 0.25f) + a * (0.75f * 0.75f));
}

TEST(Shading, a_reflected_ray_leaves_at_the_angle_of_incidence) {
    Scene scene = facing_quads();
    scene.materials[0].reflectivity = 1.0f;
    std::vector<Ray> rays;
    const auto closest = [&](const Ray& ray) {
        rays.push_back(ray);
        return rays.size() == 1 ? closest_plane(ray) : Hit{};
    };
    const Ray slanted{vec3(0, 0, 5), 0.0f, vec3(0.6f, 0, -0.8f), kInfinity};
    shade_path(ShadingScene(scene), slanted, {}, closest, unoccluded);
    ASSERT_EQ(rays.size(), 2u);
    expect_near(glm::normalize(rays[1].dir), vec3(0.6f, 0, 0.8f));
}

TEST(Shading, the_highlight_is_brightest_along_the_mirrored_direction) {
    Material material;
    material.diffuse = vec3(0);
    material.specular = vec3(1);
    material.shininess = 50.0f;
    const vec3 n(0, 0, 1);
    const vec3 to_light = glm::normalize(vec3(1, 0, 1));
    const vec3 mirrored = glm::normalize(vec3(-1, 0, 1));
    const float peak = phong(material, n, to_light, mirrored, vec3(1)).x;
    EXPECT_NEAR(peak, 1.0f, 1e-5f);  // 50 times the rounding of the cosine
    EXPECT_LT(phong(material, n, to_light, n, vec3(1)).x, 0.01f);
    EXPECT_EQ(phong(material, n, -to_light, mirrored, vec3(1)), vec3(0));
}

TEST(Shading, normals_of_a_mirrored_instance_face_the_ray) {
    Scene scene = facing_quads();
    scene.objects[0].normals.assign(4, vec3(0, 0, 1));
    scene.instances[0].world_from_object =
        Affine(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(0));
    const ShadingScene shading(scene);
    const SurfacePoint point = surface_point(shading, ray_down(), closest_plane(ray_down()));
    expect_near(point.geometric_normal, vec3(0, 0, 1));
    expect_near(point.shading_normal, vec3(0, 0, 1));
}

TEST(Shading, the_ray_offset_scales_with_the_scene) {
    const Bounds box{vec3(-1, -2, -3), vec3(1, 2, 3)};
    const Bounds large{vec3(-1000, -2000, -3000), vec3(1000, 2000, 3000)};
    EXPECT_FLOAT_EQ(secondary_offset(large), 1000.0f * secondary_offset(box));
    EXPECT_GT(secondary_offset(box), 0.0f);
}

TEST(Shading, rays_from_any_distance_leave_from_in_front_of_the_surface) {
    Scene scene = facing_quads();
    scene.instances[0].world_from_object =
        Affine(vec3(0.8f, 0.0f, -0.6f), vec3(0.36f, 0.8f, 0.48f), vec3(0.48f, -0.6f, 0.64f),
               vec3(0.3f, -0.2f, 0.1f));
    const ShadingScene shading(scene);
    const DAffine world_from_object(scene.instances[0].world_from_object);
    const auto on_quad = [&](float x, float y) {
        return transform_point(world_from_object, dvec3(x, y, 0.0));
    };
    const dvec3 place = on_quad(0.0f, 0.0f);
    const dvec3 normal =
        glm::normalize(glm::cross(on_quad(1.0f, 0.0f) - place, on_quad(0.0f, 1.0f) - place));
    Random random(7);
    size_t points = 0;
    for (const float distance : {1.0f, 1e2f, 1e4f, 1e6f}) {
        for (int i = 0; i < 2000; ++i) {
            // From in front of the quad to a point of it.
            const float x = random.unit(), y = random.unit(), z = random.unit();
            const vec3 from = distance * (2.0f * vec3(x, y, z) - vec3(1.0f));
            if (glm::dot(dvec3(from) - place, normal) <= 0.0) continue;
            const vec3 dir = vec3(on_quad(z - 0.5f, x - 0.5f)) - from;
            const double t = glm::dot(place - dvec3(from), normal) / glm::dot(dvec3(dir), normal);
            if (!(t > 0.0)) continue;

            // t as a tracer has it: rounded, or an ulp off.
            for (const float towards : {-kInfinity, 0.0f, kInfinity}) {
                Hit hit{static_cast<float>(t), 0.25f, 0.25f, 0, 0};
                if (towards != 0.0f) hit.t = std::nextafter(hit.t, towards);
                const Ray ray{from, 0.0f, dir, kInfinity};
                const SurfacePoint point = surface_point(shading, ray, hit);
                ++points;
                EXPECT_GT(glm::dot(dvec3(point.origin) - place, normal), 0.0)
                    << "from " << distance << " away, ray " << i;
            }
        }
    }
    EXPECT_GT(points, 10000u) << "else hardly a ray comes from in front";
}

}  // namespace
}  // namespace onepass
