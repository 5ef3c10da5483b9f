#include "compare/rays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "compare/hash.h"
#include "compare/npy.h"
#include "core/camera.h"
#include "core/error.h"
#include "core/random.h"
#include "core/shading.h"

namespace onepass {
namespace {

/// A tile is what 32 rays of a GPU see together, its halves what two vectors of a CPU do, its parts
/// what one of 8 does: each as nearly square as may be.
constexpr uvec2 kTile = {8, 4};
constexpr uvec2 kTileHalf = {4, 4};
constexpr uvec2 kTilePart = {4, 2};

/// Calls `visit` with the corners of each of the blocks, `size` a side, that an area from `lower`
/// to before `upper` consists of, row by row. Blocks cut off by its border are smaller.
template <class Visit>
void for_each_block(const uvec2& lower, const uvec2& upper, const uvec2& size, const Visit& visit) {
    for (uint32_t y = lower.y; y < upper.y; y += size.y) {
        for (uint32_t x = lower.x; x < upper.x; x += size.x) {
            visit(uvec2(x, y), glm::min(uvec2(x, y) + size, upper));
        }
    }
}

RaySet primary_rays(const Scene& scene, const RayRequest& request, bool tiled) {
    if (request.camera >= scene.cameras.size()) {
        throw Error({fmt::format("scene '{}'", scene.name),
                     fmt::format("camera {}", request.camera),
                     fmt::format("0 to {}", static_cast<long>(scene.cameras.size()) - 1),
                     "Choose another with --camera."});
    }
    RaySet set;
    set.pixels = pixel_order(request.width, request.height, tiled);
    const CameraFrame frame =
        camera_frame(scene.cameras[request.camera], request.width, request.height);
    for (const uint32_t pixel : set.pixels) {
        set.rays.push_back(primary_ray(frame, pixel % request.width, pixel / request.width));
    }
    return set;
}

vec3 uniform_point(const Bounds& box, Random& random) {
    // Named one by one: the order in which a call's arguments are computed is not specified.
    const float x = random.unit();
    const float y = random.unit();
    const float z = random.unit();
    return box.lower + box.extent() * vec3(x, y, z);
}

/// A uniform point of the unit disk, by rejection.
vec2 disk_point(Random& random) {
    for (;;) {
        const float x = 2.0f * random.unit() - 1.0f;
        const float y = 2.0f * random.unit() - 1.0f;
        if (x * x + y * y < 1.0f) return {x, y};
    }
}

/// Calls emit(pixel, incoming ray, surface point) for each primary hit, in order.
template <class Emit>
void for_each_primary_hit(const Scene& scene, Tracer& oracle, const RaySet& primary, Emit&& emit) {
    const ShadingScene shading(scene);
    const CastResult cast = oracle.cast(oracle.upload(primary.rays));
    for (size_t i = 0; i < primary.rays.size(); ++i) {
        if (!cast.hits[i].is_hit()) continue;
        const SurfacePoint point = surface_point(shading, primary.rays[i], cast.hits[i]);
        emit(primary.pixels[i], primary.rays[i], point);
    }
}

RaySet diffuse_rays(const Scene& scene, Tracer& oracle, const RayRequest& request) {
    RaySet primary = primary_rays(scene, request, true);
    RaySet set;
    Random random(request.seed);
    for_each_primary_hit(
        scene, oracle, primary, [&](uint32_t pixel, const Ray&, const SurfacePoint& point) {
            const vec2 disk = disk_point(random);
            const vec3 dir = cosine_direction(point.geometric_normal, disk.x, disk.y);
            set.rays.push_back(Ray{point.origin, 0.0f, dir, kInfinity});
            set.pixels.push_back(pixel);
        });
    return set;
}

RaySet reflection_rays(const Scene& scene, Tracer& oracle, const RayRequest& request) {
    RaySet primary = primary_rays(scene, request, true);
    RaySet set;
    for_each_primary_hit(scene, oracle, primary,
                         [&](uint32_t pixel, const Ray& ray, const SurfacePoint& point) {
                             const vec3 incoming = glm::normalize(ray.dir);
                             const vec3 n = point.geometric_normal;
                             const vec3 dir = incoming - n * (2.0f * glm::dot(incoming, n));
                             set.rays.push_back(Ray{point.origin, 0.0f, dir, kInfinity});
                             set.pixels.push_back(pixel);
                         });
    return set;
}

RaySet shadow_rays(const Scene& scene, Tracer& oracle, const RayRequest& request) {
    RaySet primary = primary_rays(scene, request, true);
    RaySet set;
    set.query = Query::any;
    for_each_primary_hit(scene, oracle, primary,
                         [&](uint32_t pixel, const Ray&, const SurfacePoint& point) {
                             for (const PointLight& light : scene.lights) {
                                 const vec3 to_light = light.position - point.origin;
                                 if (glm::dot(to_light, point.geometric_normal) <= 0.0f) continue;
                                 set.rays.push_back(Ray{point.origin, 0.0f, to_light, 1.0f});
                                 set.pixels.push_back(pixel);
                             }
                         });
    return set;
}

/// The corners of a triangle in the world, as floats.
std::array<vec3, 3> world_corners(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
    const Instance& instance = scene.instances[inst_id];
    const Object& object = scene.objects[instance.object];
    std::array<vec3, 3> corners;
    for (int i = 0; i < 3; ++i) {
        corners[static_cast<size_t>(i)] = transform_point(
            instance.world_from_object, object.positions[object.triangles[prim_id][i]]);
    }
    return corners;
}

/// Aimed at what traversals get wrong: a uniform triangle's corner, or a uniform point of its edge.
RaySet aimed_rays(const Scene& scene, const RayRequest& request, bool at_corners) {
    const Bounds box = scene_bounds(scene);
    RaySet set;
    set.at_edges = true;
    Random random(request.seed);
    const size_t count = size_t{request.width} * request.height;
    set.rays.resize(count);
    for (Ray& ray : set.rays) {
        const auto inst_id = static_cast<uint32_t>(random.below(scene.instances.size()));
        const Object& object = scene.objects[scene.instances[inst_id].object];
        const auto prim_id = static_cast<uint32_t>(random.below(object.triangles.size()));
        const std::array<vec3, 3> corners = world_corners(scene, inst_id, prim_id);
        const size_t corner = random.below(3);
        vec3 target = corners[corner];
        if (!at_corners) target += (corners[(corner + 1) % 3] - target) * random.unit();
        do {
            ray.org = uniform_point(box, random);
            ray.dir = target - ray.org;
        } while (ray.dir == vec3(0.0f));
    }
    return set;
}

RaySet rays_by_name(const std::string& name, const Scene& scene, Tracer& oracle,
                    const RayRequest& request) {
    RaySet set;
    if (name.ends_with(".npy")) {
        set.rays = read_rays_npy(name);
    } else if (name == "primary" || name == "scan") {
        set = primary_rays(scene, request, name == "primary");
    } else if (name == "random") {
        const size_t count = size_t{request.width} * request.height;
        set.rays = random_rays(scene_bounds(scene), count, request.seed);
    } else if (name == "diffuse") {
        set = diffuse_rays(scene, oracle, request);
    } else if (name == "shadow") {
        set = shadow_rays(scene, oracle, request);
    } else if (name == "reflection") {
        set = reflection_rays(scene, oracle, request);
    } else if (name == "vertex" || name == "edge") {
        set = aimed_rays(scene, request, name == "vertex");
    } else {
        std::string kinds;
        for (const RayKind& kind : ray_kinds()) kinds += kind.name + ", ";
        throw Error({"--rays", fmt::format("'{}'", name), "one of " + kinds + "or a file .npy",
                     "Choose one of them."});
    }
    if (!set.pixels.empty()) {
        set.width = request.width;
        set.height = request.height;
    }
    return set;
}

}  // namespace

const std::vector<RayKind>& ray_kinds() {
    static const std::vector<RayKind> kKinds = {
        {"primary", "through the pixels' centres, in 8 x 4-pixel tiles"},
        {"scan", "the primary rays in scan lines"},
        {"random", "pairs of uniform points in the scene's box"},
        {"diffuse", "one cosine-weighted bounce from each primary hit"},
        {"shadow", "from each primary hit to each light, any-hit"},
        {"reflection", "one mirror bounce from each primary hit"},
        {"vertex", "from uniform points in the scene's box to corners of its triangles"},
        {"edge", "from uniform points in the scene's box to points on edges of its triangles"},
    };
    return kKinds;
}

std::vector<uint32_t> pixel_order(uint32_t width, uint32_t height, bool tiled) {
    const uvec2 whole(width, height);
    std::vector<uint32_t> order;
    order.reserve(size_t{width} * height);
    const auto add_pixels = [&](const uvec2& lower, const uvec2& upper) {
        for_each_block(lower, upper, uvec2(1), [&](const uvec2& at, const uvec2&) {
            order.push_back(at.x + width * at.y);
        });
    };
    if (!tiled) {
        add_pixels(uvec2(0), whole);
        return order;
    }
    for_each_block(uvec2(0), whole, kTile, [&](const uvec2& lower, const uvec2& upper) {
        for_each_block(lower, upper, kTileHalf, [&](const uvec2& first, const uvec2& end) {
            for_each_block(first, end, kTilePart, add_pixels);
        });
    });
    return order;
}

std::vector<Ray> random_rays(const Bounds& bounds, size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = uniform_point(bounds, random);
        ray.dir = uniform_point(bounds, random) - ray.org;
    }
    return rays;
}

vec3 cosine_direction(const vec3& normal, float disk_x, float disk_y) {
    // A tangent frame from the axis that the normal is least along.
    const vec3 magnitude = glm::abs(normal);
    const vec3 axis = magnitude.x <= magnitude.y && magnitude.x <= magnitude.z ? vec3(1, 0, 0)
                      : magnitude.y <= magnitude.z                             ? vec3(0, 1, 0)
                                                                               : vec3(0, 0, 1);
    const vec3 tangent = glm::normalize(glm::cross(axis, normal));
    const vec3 bitangent = glm::cross(normal, tangent);

    // Uniform in the disk, lifted to the hemisphere: density cos / pi (Malley's method).
    const float lift = std::sqrt(std::max(0.0f, 1.0f - disk_x * disk_x - disk_y * disk_y));
    return tangent * disk_x + bitangent * disk_y + normal * lift;
}

RaySet make_ray_set(const std::string& kind_or_file, const Scene& scene, Tracer& oracle,
                    const RayRequest& request) {
    RaySet set = rays_by_name(kind_or_file, scene, oracle, request);
    if (set.rays.empty()) {
        throw Error({fmt::format("{} rays of scene '{}'", kind_or_file, scene.name), "no ray",
                     "at least one",
                     "Choose another kind of ray, or a camera that sees the scene."});
    }
    set.name = kind_or_file;
    set.hash = hash_text(hash_rays(set.rays));
    return set;
}

}  // namespace onepass
