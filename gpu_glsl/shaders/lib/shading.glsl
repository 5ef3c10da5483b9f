// Phong shading, and the ray tree of a pixel ray by ray: primary, shadow and reflection rays.
//
// next_ray() takes the answer to one ray and says what the next one is for. Who casts the rays is
// left open: lib/trace_pixel.glsl does it in a loop of one pass, streaming/shade.glsl in many
// passes. core/shading.h states the same model over callables; a test compares the two.
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
UNIFORM(float, ray_offset_of_way)

// What shading needs to know of a hit.
struct SurfacePoint {
    vec3 geometric_normal;
    vec3 shading_normal;
    vec3 to_eye;
    vec3 origin;  // of the secondary rays, see leave_surface()
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

// The surface that a ray of direction `dir` met; `hit` says on which triangle. Its origin is yet to
// be set.
SurfacePoint surface_point(vec3 dir, Hit hit) {
    ShadingInstance instance = fetch_shading_instance(hit.inst_id);
    TriangleNormals normals = fetch_normals(instance.first_triangle + int(hit.prim_id));

    // Both normals look towards the side the ray comes from.
    vec3 geometric = world_normal(instance, normals.geometric);
    if (dot3(geometric, dir) > 0.0) geometric = -geometric;
    vec3 shading = geometric;
    if (smooth_normals) {
        shading = world_normal(instance, normals.n0 * (1.0 - hit.u - hit.v) + normals.n1 * hit.u +
                                             normals.n2 * hit.v);
        if (dot3(shading, geometric) < 0.0) shading = -shading;
    }

    return SurfacePoint(geometric, shading, unit(-dir), vec3(0.0),
                        fetch_material(instance.first_material + normals.group));
}

// Where secondary rays start: where `ray` met the surface at `t`, moved off it along its normal by
// the scene's share of the offset and that of the way, whose rounding moved the point.
vec3 leave_surface(Ray ray, float t, vec3 normal) {
    vec3 way = ray.dir * t;
    return ray.org + way + normal * (ray_offset + largest(abs(way)) * ray_offset_of_way);
}

// Phong reflection of one light that is not in shadow.
vec3 phong(SurfacePoint point, Light light) {
    vec3 to_light = unit(light.position - point.origin);
    vec3 n = point.shading_normal;
    float cosine = dot3(n, to_light);
    if (cosine <= 0.0) return vec3(0.0);
    vec3 color = point.material.diffuse * cosine;
    float highlight = dot3(n * (2.0 * cosine) - to_light, point.to_eye);
    if (highlight > 0.0) {
        color += point.material.specular * pow(highlight, point.material.shininess);
    }
    return color * light.intensity;
}

#if NEEDS(has_mirrors)
Ray reflection_ray(SurfacePoint point) {
    vec3 n = point.shading_normal;
    vec3 incoming = -point.to_eye;
    return Ray(point.origin, 0.0, incoming - n * (2.0 * dot3(incoming, n)),
               path_tmax(kSurfaceRay));
}
#endif

// A pixel's ray tree while it is being traced: everything that must be known between two rays.
//
// One ray is in flight at a time. A single pass keeps a Path in registers; a multi-pass tracer
// stores it between passes, and makes `point` and `contribution` again.
struct Path {
    Pixel pixel;
    SurfacePoint point;
    vec3 direct;        // light gathered at `point` so far
    vec3 contribution;  // of the light that the shadow ray in flight asks for
    float weight;       // of what the mirrors so far let through
    int light;          // the light a shadow ray goes to, or kSurfaceRay
    int depth;          // mirrors so far
};

Path begin_path() {
    Path path;
    path.pixel = Pixel(vec3(0.0), no_hit(), vec3(0.0));
    path.direct = vec3(0.0);
    path.contribution = vec3(0.0);
    path.weight = 1.0;
    path.light = kSurfaceRay;
    path.depth = 0;
    return path;
}

// Takes the answer to the path's ray, and makes the next ray. False if the path has ended.
bool next_ray(INOUT(Path) path, Hit hit, INOUT(Ray) ray) {
    if (path.light == kSurfaceRay) {
        // A primary or reflection ray: go on from the surface it found.
        if (path.depth == 0) path.pixel.primary = hit;
        if (!is_hit(hit)) {
            path.pixel.color += background * path.weight;
            return false;
        }
        path.point = surface_point(ray.dir, hit);
        path.point.origin = leave_surface(ray, hit.t, path.point.geometric_normal);
        if (path.depth == 0) path.pixel.normal = path.point.shading_normal;
        path.direct = path.point.material.diffuse * ambient;
    } else if (!is_hit(hit)) {
        // A shadow ray that reached its light.
        path.direct += path.contribution;
    }

    // The next shadow ray: to the next light that can contribute.
    int light = path.light + 1;
#if NEEDS(has_several_lights)
    // In a variable of its own: counting in path.light, one driver (NVIDIA 580) asks no light but
    // the first.
    for (; light < light_count; ++light)
#else
    if (light < light_count)
#endif
    {
        Light source = fetch_light(light);
        vec3 c = phong(path.point, source);
        if (c.x != 0.0 || c.y != 0.0 || c.z != 0.0) {
            if (shadows) {
                path.contribution = c;
                path.light = light;
                ray = Ray(path.point.origin, 0.0, source.position - path.point.origin,
                          path_tmax(light));
                return true;
            }
            path.direct += c;
        }
    }

    // All lights asked: what is not reflected stays here.
    float reflected = 0.0;
#if NEEDS(has_mirrors)
    if (path.depth < max_depth) reflected = path.point.material.reflectivity;
#endif
    path.pixel.color += path.direct * (path.weight * (1.0 - reflected));
#if NEEDS(has_mirrors)
    if (reflected > 0.0) {
        path.weight *= reflected;
        path.light = kSurfaceRay;
        ++path.depth;
        ray = reflection_ray(path.point);
        return true;
    }
#endif
    return false;
}
