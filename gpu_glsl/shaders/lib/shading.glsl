// The whole ray tree of a pixel in one loop: primary, shadow and reflection rays.
//
// Adinetz & Berezin, section 4: one fragment shader traces everything through one ray-casting
// procedure. So there is one call of closest_hit() below, and the loop around it decides what the
// next ray is for. core/shading.h states the same model over callables; a test compares the two.
#pragma once
#include "lib/camera.glsl"
#include "lib/math.glsl"
#include "lib/ray.glsl"
#include "storage/shading/texture2d.glsl"

CONSTANT(int, light_count)
CONSTANT(int, max_depth)
CONSTANT(bool, shadows)
UNIFORM(vec3, background)
UNIFORM(vec3, ambient)
UNIFORM(float, ray_offset)

// What shading needs to know of a hit.
struct SurfacePoint {
    vec3 position;
    vec3 geometric_normal;
    vec3 shading_normal;
    vec3 to_eye;
    vec3 origin;  // of the secondary rays: the position, moved off the surface
    Material material;
};

struct Pixel {
    vec3 color;
    Hit primary;
    vec3 normal;
};

// A normal goes to the world by the transposed inverse of the map that took it to the object.
vec3 world_normal(ShadingInstance instance, vec3 n) {
    return unit(instance.row0 * n.x + instance.row1 * n.y + instance.row2 * n.z);
}

SurfacePoint surface_point(Ray ray, Hit hit) {
    ShadingInstance instance = fetch_shading_instance(hit.inst_id);
    TriangleNormals normals = fetch_normals(instance.first_triangle + int(hit.prim_id));

    // Both normals look towards the side the ray comes from.
    vec3 geometric = world_normal(instance, normals.geometric);
    if (dot3(geometric, ray.dir) > 0.0) geometric = -geometric;
    vec3 shading = geometric;
    if (smooth_normals) {
        shading = world_normal(instance, normals.n0 * (1.0 - hit.u - hit.v) + normals.n1 * hit.u +
                                             normals.n2 * hit.v);
        if (dot3(shading, geometric) < 0.0) shading = -shading;
    }

    vec3 position = ray.org + ray.dir * hit.t;
    return SurfacePoint(position, geometric, shading, unit(-ray.dir),
                        position + geometric * ray_offset,
                        fetch_material(instance.first_material + normals.group));
}

// Phong reflection of one light that is not in shadow.
vec3 phong(SurfacePoint point, Light light) {
    vec3 to_light = unit(light.position - point.origin);
    vec3 n = point.shading_normal;
    float cosine = dot3(n, to_light);
    if (cosine <= 0.0) return vec3(0.0);
    vec3 color = point.material.diffuse * cosine;
    float highlight = dot3(n * (2.0 * cosine) - to_light, point.to_eye);
    if (highlight > 0.0) color += point.material.specular * pow(highlight, point.material.shininess);
    return color * light.intensity;
}

Pixel trace_pixel(ivec2 pixel) {
    const int kSurfaceRay = -1;
    Ray ray = primary_ray(pixel);
    Pixel result = Pixel(vec3(0.0), no_hit(), vec3(0.0));
    SurfacePoint point;
    vec3 direct = vec3(0.0);        // light gathered at `point` so far
    vec3 contribution = vec3(0.0);  // of the light that the shadow ray in flight asks for
    float weight = 1.0;             // of what the mirrors so far let through
    int light = kSurfaceRay;        // the light a shadow ray goes to
    int depth = 0;

    int ray_budget = (max_depth + 1) * (light_count + 1);
    for (int i = 0; i < ray_budget; ++i) {
        Hit hit = closest_hit(ray);
        ++rays_cast;

        if (light == kSurfaceRay) {
            // A primary or reflection ray: go on from the surface it found.
            if (depth == 0) result.primary = hit;
            if (!is_hit(hit)) {
                result.color += background * weight;
                break;
            }
            point = surface_point(ray, hit);
            if (depth == 0) result.normal = point.shading_normal;
            direct = point.material.diffuse * ambient;
        } else if (!is_hit(hit)) {
            // A shadow ray that reached its light.
            direct += contribution;
        }

        // The next shadow ray: to the next light that can contribute.
        bool cast_shadow_ray = false;
        for (++light; light < light_count; ++light) {
            Light source = fetch_light(light);
            contribution = phong(point, source);
            if (contribution.x == 0.0 && contribution.y == 0.0 && contribution.z == 0.0) continue;
            if (shadows) {
                ray = Ray(point.origin, 0.0, source.position - point.origin, 1.0);
                cast_shadow_ray = true;
                break;
            }
            direct += contribution;
        }
        if (cast_shadow_ray) continue;

        // All lights asked: the mirror's share goes on, the rest stays here.
        bool reflects = point.material.reflectivity > 0.0 && depth < max_depth;
        float reflectivity = reflects ? point.material.reflectivity : 0.0;
        result.color += direct * (weight * (1.0 - reflectivity));
        if (!reflects) break;
        weight *= reflectivity;
        vec3 n = point.shading_normal;
        vec3 incoming = -point.to_eye;
        ray = Ray(point.origin, 0.0, incoming - n * (2.0 * dot3(incoming, n)), infinity());
        light = kSurfaceRay;
        ++depth;
    }
    return result;
}
