#include "scenes/cases.h"

#include <cmath>
#include <string>
#include <unordered_map>

#include "core/error.h"
#include "core/random.h"
#include "scenes/shapes.h"

namespace onepass {
namespace {

/// Uniform in [low, high).
float uniform(Random& random, float low, float high) { return low + (high - low) * random.unit(); }

/// Uniform in the cube from -half to half.
vec3 uniform_in_cube(Random& random, float half) {
    const float x = uniform(random, -half, half);
    const float y = uniform(random, -half, half);
    const float z = uniform(random, -half, half);
    return {x, y, z};
}

// ---- Embree's verify

/// In floats this far out the next coordinate is 1/64 away: corners of neighbouring triangles fall
/// together, and whole triangles with them.
const vec3 kVerifyCentre(148376.0f, 1234.0f, -223423.0f);
constexpr uint32_t kVerifyDivisions = 200;
constexpr float kVerifyRadius = 2.0f;
constexpr float kVerifySide = 12.0f;
constexpr float kVerifyDistance = 3.0f;  ///< of the rays' origin from the plane

Scene make_verify_sphere() {
    Object sphere = make_sphere(kVerifyDivisions, kVerifyDivisions);
    for (vec3& p : sphere.positions) p = p * kVerifyRadius + kVerifyCentre;
    sphere.normals.clear();
    return in_one_instance("verify sphere", std::move(sphere));
}

/// Origins in the cube of side 2 about the centre, which the sphere of radius 2 contains.
std::vector<Ray> rays_in_verify_sphere(const Scene&, size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = kVerifyCentre + uniform_in_cube(random, 1.0f);
        do ray.dir = uniform_in_cube(random, 1.0f);
        while (ray.dir == vec3(0.0f));
    }
    return rays;
}

/// Across the x axis, facing -x.
Scene make_verify_plane() {
    Object plane = make_grid(kVerifyDivisions, kVerifyDivisions);
    for (vec3& p : plane.positions) p = kVerifyCentre + kVerifySide * vec3(-p.y, p.x, p.z);
    return in_one_instance("verify plane", std::move(plane));
}

std::vector<Ray> rays_at_verify_plane(const Scene&, size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = kVerifyCentre - vec3(kVerifyDistance, 0.0f, 0.0f);
        const float y = uniform(random, -1.0f, 1.0f);
        const float z = uniform(random, -1.0f, 1.0f);
        ray.dir = vec3(1.0f, y, z);
    }
    return rays;
}

Ladder embree_verify() {
    Ladder ladder{.id = "embree-verify",
                  .title = "Embree's own watertightness setting",
                  .question =
                      "A sphere and a plane of 200 x 200 far from the origin, where floats "
                      "are 1/64 apart and corners fall together. Every ray hits; Embree "
                      "lets 2 of 100,000 miss.",
                  .knob = "triangles",
                  .unit = {},
                  .log_axis = true,
                  .rungs = {}};
    ladder.rungs.push_back({.knob = 2.0 * kVerifyDivisions * (kVerifyDivisions - 1),
                            .label = "sphere",
                            .make_scene = make_verify_sphere,
                            .ray_kind = {},
                            .make_rays = rays_in_verify_sphere,
                            .params = {}});
    ladder.rungs.push_back({.knob = 2.0 * kVerifyDivisions * kVerifyDivisions,
                            .label = "plane",
                            .make_scene = make_verify_plane,
                            .ray_kind = {},
                            .make_rays = rays_at_verify_plane,
                            .params = {}});
    return ladder;
}

// ---- pbrt's closed meshes

constexpr float kLeastRadius = 0.75f;
constexpr float kLargestRadius = 1.25f;
/// Of the ball that origins are drawn from. With the fewest divisions used (16 x 16, corners up to
/// 22.5 degrees apart) no face comes nearer to the centre than 0.45.
constexpr float kInside = 0.25f;

/// A sphere whose corners are moved along their radii at random: closed, and seen whole from its
/// centre.
Scene make_displaced_sphere(uint32_t divisions) {
    constexpr uint64_t kShapeSeed = 6;
    Random random(kShapeSeed);
    Object sphere = make_sphere(divisions, divisions);
    for (vec3& p : sphere.positions) p *= uniform(random, kLeastRadius, kLargestRadius);
    sphere.normals.clear();
    return in_one_instance("displaced sphere", std::move(sphere));
}

vec3 uniform_in_ball(Random& random, float radius) {
    for (;;) {
        const vec3 p = uniform_in_cube(random, radius);
        if (glm::dot(p, p) < radius * radius) return p;
    }
}

std::vector<Ray> random_rays_from_inside(const Scene&, size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = uniform_in_ball(random, kInside);
        do ray.dir = uniform_in_ball(random, 1.0f);
        while (ray.dir == vec3(0.0f));
    }
    return rays;
}

std::vector<Ray> rays_at_corners_from_inside(const Scene& scene, size_t count, uint64_t seed) {
    Random random(seed);
    const std::vector<vec3>& corners = scene.objects[0].positions;
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = uniform_in_ball(random, kInside);
        ray.dir = corners[random.below(corners.size())] - ray.org;
    }
    return rays;
}

Ladder pbrt_watertight() {
    Ladder ladder{.id = "pbrt-watertight",
                  .title = "pbrt's closed meshes, from inside",
                  .question =
                      "From inside a closed mesh every ray hits, those at its corners too. "
                      "pbrt asks for 100,000 of each kind without one miss.",
                  .knob = "triangles",
                  .unit = {},
                  .log_axis = true,
                  .rungs = {}};
    for (const uint32_t divisions : {16u, 64u, 128u}) {
        const Rung rung{.knob = 2.0 * divisions * (divisions - 1),
                        .label = {},
                        .make_scene = [divisions] { return make_displaced_sphere(divisions); },
                        .ray_kind = {},
                        .make_rays = random_rays_from_inside,
                        .params = {}};
        const std::string count = std::to_string(2 * divisions * (divisions - 1));
        ladder.rungs.push_back(rung);
        ladder.rungs.back().label = count + ", random";
        ladder.rungs.push_back(rung);
        ladder.rungs.back().label = count + ", corners";
        ladder.rungs.back().make_rays = rays_at_corners_from_inside;
    }
    return ladder;
}

// ---- The subdivided square

/// Cells of the lattice along a side: k * 2^-22 - 1/2 is a float for every k up to it.
constexpr int64_t kLattice = int64_t{1} << 22;

struct LatticePoint {
    int64_t x = 0;
    int64_t y = 0;
};

/// Twice the signed area; positive if counter-clockwise. Exact.
int64_t doubled_area(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A triangulation of the square that is divided in place. Corner order is counter-clockwise.
class Subdivision {
  public:
    Subdivision() {
        add({0, 1, 2});
        add({0, 2, 3});
    }

    size_t triangle_count() const { return triangles_.size(); }
    const std::vector<LatticePoint>& points() const { return points_; }
    const std::vector<uvec3>& triangles() const { return triangles_; }

    /// One triangle becomes three. False, changing nothing, where the lattice is too coarse.
    bool divide_inside(uint32_t index, Random& random) {
        const uvec3 t = triangles_[index];
        const LatticePoint p = point_inside(t, random);
        for (int k = 0; k < 3; ++k) {
            if (doubled_area(points_[t[k]], points_[t[(k + 1) % 3]], p) <= 0) return false;
        }
        const uint32_t corner = add_point(p);
        replace(index, {t.x, t.y, corner});
        add({t.y, t.z, corner});
        add({t.z, t.x, corner});
        return true;
    }

    /// The triangle and its neighbour across one edge become two each; at the border, the triangle
    /// alone. False, changing nothing, where the lattice is too coarse or `most_new` too small.
    bool divide_edge(uint32_t index, int edge, size_t most_new, Random& random) {
        const uvec3 t = triangles_[index];
        const uint32_t a = t[edge];
        const uint32_t b = t[(edge + 1) % 3];
        const uint32_t left = t[(edge + 2) % 3];
        const auto twin = triangle_at_.find(key(b, a));
        const bool at_border = twin == triangle_at_.end();
        if (most_new < (at_border ? 1 : 2)) return false;

        // The new corner need not lie on an inner edge, but must turn no triangle over.
        const LatticePoint p = point_on_edge(a, b, random);
        if (doubled_area(points_[a], p, points_[left]) <= 0) return false;
        if (doubled_area(p, points_[b], points_[left]) <= 0) return false;
        const uint32_t other = at_border ? 0 : twin->second;
        const uint32_t right = at_border ? 0 : opposite_corner(other, b, a);
        if (!at_border) {
            if (doubled_area(points_[b], p, points_[right]) <= 0) return false;
            if (doubled_area(p, points_[a], points_[right]) <= 0) return false;
        }

        const uint32_t corner = add_point(p);
        triangle_at_.erase(key(a, b));
        replace(index, {a, corner, left});
        add({corner, b, left});
        if (!at_border) {
            triangle_at_.erase(key(b, a));
            replace(other, {b, corner, right});
            add({corner, a, right});
        }
        return true;
    }

  private:
    static uint64_t key(uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; }

    uint32_t add_point(const LatticePoint& p) {
        points_.push_back(p);
        return static_cast<uint32_t>(points_.size() - 1);
    }
    void add(const uvec3& triangle) {
        triangles_.push_back(triangle);
        replace(static_cast<uint32_t>(triangles_.size() - 1), triangle);
    }
    void replace(uint32_t index, const uvec3& triangle) {
        triangles_[index] = triangle;
        for (int k = 0; k < 3; ++k) triangle_at_[key(triangle[k], triangle[(k + 1) % 3])] = index;
    }
    uint32_t opposite_corner(uint32_t index, uint32_t from, uint32_t to) const {
        const uvec3& t = triangles_[index];
        for (int k = 0; k < 3; ++k) {
            if (t[k] != from && t[k] != to) return t[k];
        }
        ONEPASS_CHECK(false);
        return 0;
    }

    /// Uniform in the triangle, rounded to the lattice.
    LatticePoint point_inside(const uvec3& t, Random& random) const {
        double u = random.unit();
        double v = random.unit();
        if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
        }
        const LatticePoint &a = points_[t.x], &b = points_[t.y], &c = points_[t.z];
        const auto mix = [&](int64_t p, int64_t q, int64_t r) {
            return p +
                   std::llround(u * static_cast<double>(q - p) + v * static_cast<double>(r - p));
        };
        return {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y)};
    }
    /// In the middle half of the edge. Sides of the square run along axes and are met exactly.
    LatticePoint point_on_edge(uint32_t from, uint32_t to, Random& random) const {
        const double share = 0.25 + 0.5 * double{random.unit()};
        const LatticePoint &a = points_[from], &b = points_[to];
        const auto mix = [&](int64_t p, int64_t q) {
            return p + std::llround(share * static_cast<double>(q - p));
        };
        return {mix(a.x, b.x), mix(a.y, b.y)};
    }

    std::vector<LatticePoint> points_ = {
        {0, 0}, {kLattice, 0}, {kLattice, kLattice}, {0, kLattice}};
    std::vector<uvec3> triangles_;
    std::unordered_map<uint64_t, uint32_t> triangle_at_;  ///< of a directed edge, on its left
};

/// What the rays are aimed at keeps this far from the square's border, so that rounding a ray's
/// direction cannot lead past it.
constexpr float kTargetHalf = 0.49f;

bool is_target(const vec3& p) { return std::abs(p.x) < kTargetHalf && std::abs(p.y) < kTargetHalf; }

vec3 uniform_target(Random& random) {
    const float x = uniform(random, -kTargetHalf, kTargetHalf);
    const float y = uniform(random, -kTargetHalf, kTargetHalf);
    return {x, y, 0.0f};
}

/// A corner of a random triangle (`along` false) or a point of its edge; any point of the square
/// where no such lies clear of the border.
vec3 target_of_triangle(const Object& square, bool along, Random& random) {
    constexpr int kTries = 100;
    for (int i = 0; i < kTries; ++i) {
        const uvec3 t = square.triangles[random.below(square.triangles.size())];
        const auto k = static_cast<int>(random.below(3));
        const vec3 a = square.positions[t[k]];
        const vec3 b = square.positions[t[(k + 1) % 3]];
        const vec3 target = along ? a + (b - a) * random.unit() : a;
        if (is_target(target)) return target;
    }
    return uniform_target(random);
}

/// By turns at uniform points, at corners and at points of edges; from both sides.
std::vector<Ray> rays_at_square(const Scene& scene, size_t count, uint64_t seed) {
    const Object& square = scene.objects[0];
    Random random(seed);
    std::vector<Ray> rays(count);
    for (size_t i = 0; i < count; ++i) {
        const vec3 target =
            i % 3 == 0 ? uniform_target(random) : target_of_triangle(square, i % 3 == 2, random);
        const float x = uniform(random, -1.0f, 1.0f);
        const float y = uniform(random, -1.0f, 1.0f);
        const float z = uniform(random, 0.5f, 1.5f);
        rays[i].org = vec3(x, y, i % 2 == 0 ? z : -z);
        rays[i].dir = target - rays[i].org;
    }
    return rays;
}

Ladder subdivided_square() {
    constexpr uint64_t kShapeSeed = 4;
    Ladder ladder{.id = "subdivided-square",
                  .title = "A square divided at random",
                  .question =
                      "Rays through a square of ever smaller triangles and slivers, a third "
                      "of them at corners and a third at edges: not one may slip through.",
                  .knob = "triangles",
                  .unit = {},
                  .log_axis = true,
                  .rungs = {}};
    for (uint32_t triangles = 4; triangles <= 65536; triangles *= 4) {
        const auto make_scene = [triangles] {
            return in_one_instance("subdivided square",
                                   make_subdivided_square(triangles, kShapeSeed));
        };
        ladder.rungs.push_back({.knob = static_cast<double>(triangles),
                                .label = {},
                                .make_scene = make_scene,
                                .ray_kind = {},
                                .make_rays = rays_at_square,
                                .params = {}});
    }
    return ladder;
}

}  // namespace

Object make_subdivided_square(uint32_t triangles, uint64_t seed) {
    ONEPASS_CHECK_LE(2u, triangles);
    Random random(seed);
    Subdivision square;
    while (square.triangle_count() < triangles) {
        const size_t missing = triangles - square.triangle_count();
        const auto index = static_cast<uint32_t>(random.below(square.triangle_count()));
        if (missing >= 2 && random.below(2) == 0) {
            square.divide_inside(index, random);
        } else {
            square.divide_edge(index, static_cast<int>(random.below(3)), missing, random);
        }
    }

    Object object;
    object.name = "subdivided square";
    for (const LatticePoint& p : square.points()) {
        const auto coordinate = [](int64_t k) {
            return static_cast<float>(k) / static_cast<float>(kLattice) - 0.5f;
        };
        object.positions.emplace_back(coordinate(p.x), coordinate(p.y), 0.0f);
    }
    object.triangles = square.triangles();
    object.groups = {{"square", 0, triangles}};
    return object;
}

std::vector<Ladder> robustness_cases() {
    return {embree_verify(), pbrt_watertight(), subdivided_square()};
}

}  // namespace onepass
