// The shading model: Phong, shadows, mirrors and the offset of secondary rays, over two callables.
//
// Embree and cast-only tracers render with it; gpu_glsl/shaders/lib/shading.glsl mirrors it line by
// line, and a test compares the two. Nothing here knows how a ray is traced.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/render_settings.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// A scene made ready for shading: what a hit's attributes are computed from.
struct ShadingScene {
    const Scene* scene = nullptr;
    std::vector<Affine> object_from_world;  ///< one an instance
    float ray_offset = 0.0f;                ///< secondary_offset() of the scene

    explicit ShadingScene(const Scene& s);

    /// Moves the instances: nothing else of the scene follows. One transform an instance.
    void move(std::span<const Affine> world_from_object);

  private:
    std::vector<Bounds> object_boxes_;
};

/// The distance by which a secondary ray's origin leaves its surface, along the normal: the scene's
/// share of it. The other is that of the way to the surface, offset_at().
///
/// 2^-17 of the scene's largest extent, which stays far below anything visible, plus 2^-20 of its
/// largest absolute coordinate: eight ulps, where a position on a surface and the origin moved off
/// it err by two together. So it scales with the scene, and far from the world's origin it grows
/// only as float positions force it to.
float secondary_offset(const Bounds& scene_bounds);

/// The way's share of the offset: of the largest component of dir * t.
///
/// With u = 2^-24, half an ulp of 1, org + dir * t is off by at most 3 u of that component on each
/// axis, u by the product and 2 u by a t that is an ulp off: 5.2 u in space. Sixteen leave as much
/// again and more for a tracer's t. (The sum rounds a coordinate of the scene, which has its own
/// share.)
constexpr float kOffsetOfWay = 0x1p-20f;

/// How far secondary rays start off the surface that `ray` met at `t`.
float offset_at(const ShadingScene& scene, const Ray& ray, float t);

/// What shading needs to know of a hit.
struct SurfacePoint {
    vec3 position{0.0f};
    vec3 geometric_normal{0.0f};  ///< unit, turned towards the ray's origin
    vec3 shading_normal{0.0f};    ///< unit, on the same side as the geometric normal
    vec3 origin{0.0f};            ///< of secondary rays: the position, moved off the surface
    const Material* material = nullptr;
};

SurfacePoint surface_point(const ShadingScene& scene, const Ray& ray, const Hit& hit);

/// Phong reflection of one light. `to_light` and `to_eye` are unit vectors.
inline vec3 phong(const Material& material, const vec3& normal, const vec3& to_light,
                  const vec3& to_eye, const vec3& intensity) {
    const float cosine = glm::dot(normal, to_light);
    if (cosine <= 0.0f) return vec3(0.0f);
    vec3 color = material.diffuse * cosine;
    const vec3 mirrored = normal * (2.0f * cosine) - to_light;
    const float highlight = glm::dot(mirrored, to_eye);
    if (highlight > 0.0f) color += material.specular * std::pow(highlight, material.shininess);
    return color * intensity;
}

/// One pixel's result.
struct ShadedPath {
    vec3 color{0.0f};
    Hit primary;
    vec3 normal{0.0f};  ///< shading normal at the primary hit
    uint32_t rays = 0;  ///< rays cast
};

/// Follows a primary ray and its mirror reflections; at each hit, a shadow ray to each light.
///
/// closest(Ray) -> Hit; occluded(Ray) -> bool. A shadow ray runs from the surface to the light with
/// t in [0, 1]; a reflection carries the weight material.reflectivity, and the surface's own colour
/// the rest.
/// Source: Adinetz & Berezin, section 4 (Phong model, shadow and mirror rays).
template <class Closest, class Occluded>
ShadedPath shade_path(const ShadingScene& scene, Ray ray, const RenderSettings& settings,
                      Closest&& closest, Occluded&& occluded) {
    ShadedPath path;
    float weight = 1.0f;
    for (uint32_t depth = 0;; ++depth) {
        const Hit hit = closest(ray);
        ++path.rays;
        if (depth == 0) path.primary = hit;
        if (!hit.is_hit()) {
            path.color += scene.scene->background * weight;
            return path;
        }

        // Direct light.
        const SurfacePoint point = surface_point(scene, ray, hit);
        if (depth == 0) path.normal = point.shading_normal;
        const vec3 to_eye = glm::normalize(-ray.dir);
        vec3 direct = point.material->diffuse * scene.scene->ambient;
        for (const PointLight& light : scene.scene->lights) {
            const vec3 to_light = light.position - point.origin;
            const vec3 contribution = phong(*point.material, point.shading_normal,
                                            glm::normalize(to_light), to_eye, light.intensity);
            if (contribution == vec3(0.0f)) continue;
            if (settings.shadows) {
                ++path.rays;
                if (occluded(Ray{point.origin, 0.0f, to_light, 1.0f})) continue;
            }
            direct += contribution;
        }

        // The mirror's share goes on; the rest stays here.
        const bool reflect = point.material->reflectivity > 0.0f && depth < settings.max_depth;
        const float reflectivity = reflect ? point.material->reflectivity : 0.0f;
        path.color += direct * (weight * (1.0f - reflectivity));
        if (!reflect) return path;
        weight *= reflectivity;
        const vec3 n = point.shading_normal;
        const vec3 incoming = -to_eye;
        ray = Ray{point.origin, 0.0f, incoming - n * (2.0f * glm::dot(incoming, n)), kInfinity};
    }
}

}  // namespace onepass
