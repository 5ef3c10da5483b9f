#include "scenes/ladders/parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace onepass::ladder {

// ---- Scenes

Object bare(Object object) {
    object.normals.clear();
    return object;
}

Object mapped(Object object, const std::function<dvec3(const dvec3&)>& map) {
    for (vec3& p : object.positions) p = vec3(map(dvec3(p)));
    return bare(std::move(object));
}

Affine aslant() { return rotation(vec3(0.35f, 0.8f, 0.5f), 37.0f); }

Scene scene_of(Object object, const std::vector<Affine>& world_from_object) {
    Scene scene;
    scene.name = object.name;
    const std::vector<uint32_t> materials(object.groups.size(), 0);
    scene.objects.push_back(std::move(object));
    for (const Affine& placed : world_from_object) {
        scene.instances.push_back({"instance", 0, placed, materials});
    }
    scene.materials.push_back({.name = "any"});
    return scene;
}

Object ball() {
    return mapped(make_sphere(24, 16), [](const dvec3& p) { return 0.5 * p; });
}

// ---- Rays

Target random_target(const Scene& scene, Random& random, size_t last_triangles) {
    // A triangle.
    const Instance& instance = scene.instances[random.below(scene.instances.size())];
    const Object& object = scene.objects[instance.object];
    const size_t all = object.triangles.size();
    const size_t from = last_triangles > 0 ? all - last_triangles : 0;
    const uvec3 triangle = object.triangles[from + random.below(all - from)];
    std::array<dvec3, 3> corners;
    for (int k = 0; k < 3; ++k) {
        corners[static_cast<size_t>(k)] = transform_point(DAffine(instance.world_from_object),
                                                          dvec3(object.positions[triangle[k]]));
    }

    // A point of it: uniform in the square, folded over the diagonal.
    double u = random.unit();
    double v = random.unit();
    if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    const dvec3 edge_u = corners[1] - corners[0];
    const dvec3 edge_v = corners[2] - corners[0];
    const dvec3 normal = glm::cross(edge_u, edge_v);
    const double area = glm::length(normal);
    return {corners[0] + u * edge_u + v * edge_v, area > 0.0 ? normal / area : dvec3(0.0)};
}

dvec3 point_around(const Bounds& box, double factor, Random& random) {
    // Named one by one: the order in which a call's arguments are computed is not specified.
    const double x = random.unit();
    const double y = random.unit();
    const double z = random.unit();
    const dvec3 lower(box.lower);
    const dvec3 upper(box.upper);
    return 0.5 * (lower + upper) + factor * (upper - lower) * (dvec3(x, y, z) - 0.5);
}

dvec3 random_unit_vector(Random& random) {
    // Archimedes: height and angle are uniform.
    const double z = 2.0 * random.unit() - 1.0;
    const double angle = 2.0 * std::numbers::pi * random.unit();
    const double radius = std::sqrt(1.0 - z * z);
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Ray ray_towards(const dvec3& origin, const dvec3& point, Random& random) {
    Ray ray;
    ray.org = vec3(origin);
    const dvec3 way = point - dvec3(ray.org);
    const double length = glm::length(way);
    const bool unit = random.below(2) == 0;
    ray.dir = vec3(unit && length > 0.0 ? way / length : way);
    return ray;
}

std::vector<Ray> rays_at_surfaces(const Scene& scene, size_t count, uint64_t seed) {
    constexpr double kAround = 2.0;  // times the box: from outside and from inside
    const Bounds box = scene_bounds(scene);
    Random random(seed);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Target target = random_target(scene, random);
        const Ray ray = ray_towards(point_around(box, kAround, random), target.point, random);
        if (ray.dir != vec3(0.0f)) rays.push_back(ray);
    }
    return rays;
}

// ---- Ladders

double power_of_ten(int power) { return std::stod("1e" + std::to_string(power)); }

std::vector<double> powers_of_ten(int first, int last) {
    const int step = last < first ? -1 : 1;
    std::vector<double> powers = {power_of_ten(first)};
    for (int power = first; power != last;) powers.push_back(power_of_ten(power += step));
    return powers;
}

std::vector<Rung> rungs_of(const std::vector<double>& knobs,
                           const std::function<Scene(double)>& make_scene,
                           const std::function<RayMaker(double)>& make_rays) {
    std::vector<Rung> rungs;
    for (const double knob : knobs) {
        Rung rung;
        rung.knob = knob;
        rung.make_scene = [=] { return make_scene(knob); };
        rung.make_rays = make_rays(knob);
        rungs.push_back(std::move(rung));
    }
    return rungs;
}

}  // namespace onepass::ladder
