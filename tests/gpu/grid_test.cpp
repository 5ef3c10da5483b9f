// The robust strategy: bit-identical to its twin, and without one wrong hit where others err.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/grid/sizing.h"
#include "core/shading.h"
#include "cpu_ref/embree_tracer.h"
#include "cpu_ref/exact_judge.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/shapes.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"grid/buffer/fragment", "grid/buffer/compute",
                                    "grid/ssbo/fragment", "grid/ssbo/compute"};

class GridStrategy : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, params);
    }

    std::optional<Catalogue> catalogue;
};

TEST_F(GridStrategy, hits_are_bit_identical_to_its_twin_on_a_software_renderer) {
    if (!context->description().software) GTEST_SKIP() << "promised on software renderers only";
    for (const auto& [made, records] :
         in_both_records({make_balls_1(), make_instances(), make_big_small(), make_knife()})) {
        const ScenePtr scene = share(made);
        const std::vector<std::vector<Ray>> ray_sets = {primary_rays(*scene, 64, 64),
                                                        random_rays(scene_bounds(*scene), 5000, 7),
                                                        awkward_rays(*scene)};
        const auto twin = make("grid/buffer/twin32", scene, {{"records", records}});
        for (const char* entry : kEntries) {
            const auto tracer = make(entry, scene, {{"records", records}});
            for (const std::vector<Ray>& rays : ray_sets) {
                const CastResult gpu = cast(*tracer, rays, {.counters = true});
                const CastResult cpu = cast(*twin, rays, {.counters = true});
                expect_same_bits(gpu.hits, cpu.hits, made.name + " " + records + " " + entry);
                EXPECT_EQ(gpu.flags, cpu.flags) << made.name << " " << records << " " << entry;
                const auto [theirs, ours] =
                    std::mismatch(gpu.counters.begin(), gpu.counters.end(), cpu.counters.begin());
                EXPECT_EQ(theirs - gpu.counters.begin(), std::ptrdiff_t(rays.size()))
                    << made.name << " " << records << " " << entry
                    << ": the first ray that costs another number of "
                    << "cells, tests or references";
            }
        }
    }
}

TEST_F(GridStrategy, triangles_have_records_of_the_form_that_suits_the_device) {
    const ScenePtr scene = share(make_balls_1());
    const auto bytes_a_triangle = [&](const char* name, const ParamValues& params) {
        double bytes = 0.0;
        double triangles = 0.0;
        for (const Stat& stat : make(name, scene, params)->stats()) {
            if (stat.name == "planes_bytes") bytes = stat.value;
            if (stat.name == "triangles") triangles = stat.value;
        }
        return bytes / triangles;
    };
    for (const char* name : {"grid/buffer/fragment", "grid/ssbo/compute", "grid/buffer/twin32"}) {
        EXPECT_EQ(bytes_a_triangle(name, {{"records", "floats"}}), 48.0) << name;
        EXPECT_EQ(bytes_a_triangle(name, {{"records", "fixed"}}), 32.0) << name;
    }
    const double on_device = context->description().software ? 32.0 : 48.0;
    EXPECT_EQ(bytes_a_triangle("grid/buffer/fragment", {}), on_device);
    EXPECT_EQ(bytes_a_triangle("grid/buffer/twin32", {}), 48.0);
}

TEST_F(GridStrategy, no_ray_aimed_at_corners_or_edges_is_answered_wrongly) {
    for (const Scene& made : {make_balls_1(), make_instances(), make_palace()}) {
        const ScenePtr scene = share(made);
        for (const char* kind : {"vertex", "edge"}) {
            const std::vector<Ray> rays = rays_of_kind(kind, *scene, 64);
            for (const char* entry : kEntries) {
                expect_no_error(*make(entry, scene), scene, rays, made.name + ", " + kind);
            }
        }
    }
}

TEST_F(GridStrategy, a_scene_far_from_the_origin_is_as_right_as_one_around_it) {
    for (const float distance : {0.0f, 1e2f, 1e4f, -1e6f}) {
        for (const float scale : {1e-3f, 1.0f, 1e3f}) {
            const ScenePtr scene = ball_at(scale * distance * vec3(1.0f, -0.3f, 0.7f), scale);
            for (const char* kind : {"vertex", "random"}) {
                std::vector<Ray> rays = rays_of_kind(kind, *scene, 32);
                expect_no_error(*make("grid/buffer/twin32", scene), scene, rays,
                                std::to_string(distance) + " sizes away, " + kind);
            }
        }
    }
}

TEST_F(GridStrategy, answers_are_right_for_the_ray_itself_and_not_only_for_one_beside_it) {
    // Aimed at edges, near and from 1e4 sizes away, at turned instances: rounding the ray would
    // take a few of a hundred to the other side, which is right for a ray of E_ray only.
    for (const Scene& made : {make_balls_1(), make_hind24()}) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = rays_of_kind("edge", *scene, 48);
        for (size_t i = 0, near = rays.size(); i < near; ++i) {
            const vec3 org = rays[i].org - 1e4f * rays[i].dir;
            rays.push_back({org, 0.0f, rays[i].org + rays[i].dir - org, kInfinity});
        }
        const auto judge = make_exact_judge(scene);
        const std::vector<Hit> hits = cast(*make("grid/buffer/twin32", scene), rays).hits;
        size_t edges = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const Verdict verdict =
                judge->judge(rays[i], Query::closest, std::span(&hits[i], 1)).front();
            edges += verdict.hit_class == HitClass::edge ? 1 : 0;
        }
        EXPECT_LE(edges, rays.size() / 500) << made.name;
    }
}

TEST_F(GridStrategy, a_ray_that_starts_on_a_face_and_hardly_leaves_it_is_answered_rightly) {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& box = scene.objects.front();
    box = make_box(5, 5, 5);
    for (vec3& p : box.positions) p += vec3(0.6f, 0.1f, 0.05f);
    validate(scene);
    const ScenePtr shared = share(scene);
    std::vector<Ray> rays;
    for (size_t i = 0; i < box.triangles.size(); ++i) {
        const uvec3& t = box.triangles[i];
        const vec3 inside =
            0.3f * box.positions[t.x] + 0.25f * box.positions[t.y] + 0.45f * box.positions[t.z];
        for (const float small : {1e-3f, 1e-9f, 1e-12f, 1e-15f, 1e-30f}) {
            vec3 dir(i % 2 ? small : -small, i % 4 < 2 ? small : -small, small);
            dir[int(i % 3)] = i % 5 < 3 ? 0.9f : -0.9f;
            rays.push_back({inside, 0.0f, dir, kInfinity});
            rays.push_back({inside - dir, 0.0f, dir, kInfinity});
        }
    }
    expect_no_error(*make("grid/buffer/twin32", shared), shared, rays, "box");
}

TEST_F(GridStrategy, a_small_thing_in_a_large_mesh_is_seen_as_well_as_alone) {
    // A ball in a hall 1e5 times its size, in one mesh: seen from the hall's grid the ball is a few
    // roundings wide, all of its triangles are rivals, and only a closer look tells them apart.
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& mesh = scene.objects.front();
    mesh = make_sphere(20, 16);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    const Object hall = make_box(8, 8, 8);
    for (const vec3& p : hall.positions) mesh.positions.push_back(1e5f * (p + vec3(0.2f)));
    for (const uvec3& t : hall.triangles) mesh.triangles.push_back(t + uvec3(first));
    mesh.normals.clear();
    mesh.groups = {{"all", 0, uint32_t(mesh.triangles.size())}};
    validate(scene);
    const ScenePtr shared = share(scene);
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < first; ++i) {
        const vec3& target = mesh.positions[i];
        const vec3 from = (i % 2 ? 3.0f : 2e4f) * mesh.positions[(i * 7) % first];
        rays.push_back({from, 0.0f, target - from, kInfinity});
    }
    for (const char* entry : {"grid/buffer/twin32", "grid/buffer/fragment"}) {
        expect_no_error(*make(entry, shared), shared, rays, entry);
    }
}

TEST_F(GridStrategy, a_scene_of_any_size_is_as_right_as_one_of_size_1) {
    for (const float scale : {1e-17f, 1e-9f, 1e9f, 1e17f}) {
        const ScenePtr scene = ball_at(scale * vec3(1.0f, -0.3f, 0.7f), scale);
        for (const char* kind : {"vertex", "random"}) {
            expect_no_error(*make("grid/buffer/twin32", scene), scene,
                            rays_of_kind(kind, *scene, 32),
                            fmt::format("size {}, {}", scale, kind));
        }
    }
}

TEST_F(GridStrategy, instances_of_extreme_shape_and_size_are_hit_rightly) {
    const ScenePtr scene = squeezed_balls();
    // From all around each instance, at corners of its triangles.
    std::vector<Ray> rays;
    const Object& ball = scene->objects.front();
    for (const Instance& instance : scene->instances) {
        for (size_t i = 0; i < ball.positions.size(); i += 5) {
            const vec3 target = transform_point(instance.world_from_object, ball.positions[i]);
            const vec3 from = transform_point(
                instance.world_from_object, 3.0f * ball.positions[(i * 7) % ball.positions.size()]);
            rays.push_back({from, 0.0f, target - from, kInfinity});
            rays.push_back({target + 50.0f * (target - from), 0.0f, from - target, kInfinity});
        }
    }
    expect_no_error(*make("grid/buffer/twin32", scene), scene, rays, "squeezed balls");
}

TEST_F(GridStrategy, the_finest_grid_loses_nothing_along_its_planes_and_through_its_corners) {
    // A lattice of 64 x 64 x 2 cells with a bump a cell, whose grid's planes are the lattice's;
    // rays in these planes, along cells' edges and diagonals, and through their corners.
    constexpr int kSide = 64;
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& lattice = scene.objects.front();
    lattice = Object{};
    for (int y = 0; y <= kSide; ++y) {
        for (int x = 0; x <= kSide; ++x) {
            lattice.positions.push_back(vec3(x, y, (x * 7 + y * 3) % 5 / 4.0f));
        }
    }
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const uint32_t i = x + (kSide + 1) * y;
            lattice.triangles.push_back({i, i + 1, i + kSide + 2});
            lattice.triangles.push_back({i, i + kSide + 2, i + kSide + 1});
        }
    }
    lattice.groups = {{"all", 0, uint32_t(lattice.triangles.size())}};
    validate(scene);
    const ScenePtr shared = share(scene);

    std::vector<Ray> rays;
    for (int i = 0; i <= 2 * kSide; ++i) {
        const float at = 0.5f * static_cast<float>(i);
        const vec3 corner(at, std::fmod(at * 5.0f, 64.0f), 2.0f);
        for (const vec3& dir : {vec3(0, 0, -1), vec3(1, 1, -1), vec3(-1, 0, -0.25f),
                                vec3(1, 0, -1e-3f), vec3(-1, -1, -1e-30f), vec3(1, 3, -2)}) {
            rays.push_back({corner, 0.0f, dir, kInfinity});
            rays.push_back({corner - 37.0f * dir, 0.0f, dir, kInfinity});
        }
        rays.push_back({vec3(-1, at, 0.5f), 0.0f, vec3(1, 0, 0), kInfinity});
        rays.push_back({vec3(at, 65, 0.25f), 0.0f, vec3(0, -1, 0), kInfinity});
    }
    for (const char* resolution : {"64x64x4", "1024x1x1", "1x1024x7", "1024x1024x1"}) {
        expect_no_error(*make("grid/buffer/twin32", shared, {{"resolution", resolution}}), shared,
                        rays, resolution);
    }
}

TEST_F(GridStrategy, the_finest_grid_loses_nothing_beside_the_corners_of_cells_seen_obliquely) {
    // Rays across 1,024 cells on two axes cut off a corner of a cell, by less and less, and hit a
    // small triangle there. A walk that errs by more goes past that cell, and finds the triangle
    // only if the lists' pad has given it to the cells beside.
    constexpr int kCells = 1024;
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const int thin : {0, 1, 2}) {
        const int a = (thin + 1) % 3;
        const int b = (thin + 2) % 3;
        uvec3 dims(kCells);
        dims[thin] = 4;
        const std::string resolution = fmt::format("{}x{}x{}", dims.x, dims.y, dims.z);

        // Two triangles span the box, so that the grid's planes are known before the others.
        Scene scene = *ball_at(vec3(0.0f), 1.0f);
        Object& object = scene.objects.front();
        object = Object{};
        const vec3 near(-64.0f - 0.125f);
        const vec3 far = near + vec3(dims) + vec3(0.125f, 0.25f, 0.5f);
        for (const float inwards : {0.1f, -0.1f}) {
            const vec3 end = inwards > 0.0f ? near : far;
            const auto first = static_cast<uint32_t>(object.positions.size());
            object.triangles.emplace_back(first, first + 1, first + 2);
            object.positions.push_back(end);
            object.positions.push_back(end + vec3(inwards, 0.0f, 0.0f));
            object.positions.push_back(end + vec3(0.0f, inwards, 0.0f));
        }
        const Bounds box = padded_bounds({near, far});
        const dvec3 lower(box.lower);
        const dvec3 cell = (dvec3(box.upper) - lower) / dvec3(dims);

        std::vector<Ray> rays;
        constexpr int kTriangles = 5000;
        for (int i = 0; i < kTriangles; ++i) {
            // An edge of a cell near the world's origin, where floats are finest, and a ray past it
            // from the far end: `along` it, and `across` into the cell on one side or the other.
            dvec3 corner(1.5);
            corner[a] = std::floor(1.0 + 126.0 * unit(engine));
            corner[b] = std::floor(1.0 + 126.0 * unit(engine));
            corner = lower + corner * cell;
            const double slope = std::exp2(2.0 * unit(engine) - 1.0);
            const double side = unit(engine) < 0.5 ? -1.0 : 1.0;
            dvec3 along(0.0);
            along[a] = -1.0;
            along[b] = -slope;
            along[thin] = 1e-4 * (unit(engine) - 0.5);
            dvec3 across(0.0);
            across[a] = side * slope;
            across[b] = -side;
            across = glm::normalize(across);
            const double wanted = std::exp2(-18.0 + 14.0 * unit(engine));
            const vec3 dir(along);
            const vec3 org(corner + wanted * across - along * (500.0 + 1000.0 * unit(engine)));

            // How far the ray, which is rounded, passes from the edge; there the triangle begins.
            const dvec3 from = corner - dvec3(org);
            const double distance =
                side * (from[a] * dir[b] - from[b] * dir[a]) / std::hypot(dir[a], dir[b]);
            if (distance < 0x1p-19) continue;
            dvec3 beside(0.0);
            beside[thin] = 0.05;
            const auto first = static_cast<uint32_t>(object.positions.size());
            object.positions.emplace_back(corner + 0.875 * distance * across - beside);
            object.positions.emplace_back(corner + 0.875 * distance * across + beside);
            object.positions.emplace_back(corner + (distance + 0.02) * across);
            object.triangles.emplace_back(first, first + 1, first + 2);
            rays.push_back({org, 0.0f, dir, kInfinity});
        }
        object.groups = {{"all", 0, uint32_t(object.triangles.size())}};
        validate(scene);
        const ScenePtr shared = share(scene);
        const auto tracer = make("grid/buffer/twin32", shared, {{"resolution", resolution}});
        EXPECT_GT(hit_count(cast(*tracer, rays).hits), 9u * rays.size() / 10u) << resolution;
        expect_no_error(*tracer, shared, rays, resolution);
    }
}

TEST_F(GridStrategy, of_the_triangles_at_a_corner_nearly_all_rays_name_the_lowest) {
    // They do if each says the same t there, to the last bit of a double: one quotient, once
    // rounded.
    const ScenePtr scene = ball_at(vec3(0.0f), 1.0f);
    const auto judge = make_exact_judge(scene);
    const auto rays = rays_of_kind("vertex", *scene, 48);
    const CastResult result = cast(*make("grid/buffer/twin32", scene), rays);
    size_t higher = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Verdict verdict =
            judge->judge(rays[i], Query::closest, std::span(&result.hits[i], 1)).front();
        higher += verdict.hit_class == HitClass::tie;
    }
    EXPECT_LE(higher, rays.size() / 100);
}

TEST_F(GridStrategy, neither_the_order_of_triangles_nor_that_of_instances_shows_in_a_hit) {
    // The palace's walls, stairs and floor touch each other; and every triangle is there twice.
    Scene scene = make_palace();
    for (Object& object : scene.objects) {
        const std::vector<uvec3> once = object.triangles;
        object.triangles.insert(object.triangles.end(), once.begin(), once.end());
        object.groups = {{"all", 0, uint32_t(object.triangles.size())}};
    }
    for (Instance& instance : scene.instances) instance.materials = {0};
    validate(scene);
    Scene reversed = scene;
    std::reverse(reversed.instances.begin(), reversed.instances.end());

    const auto rays = rays_of_kind("vertex", scene, 48);
    const CastResult forwards = cast(*make("grid/buffer/twin32", share(scene)), rays);
    const CastResult backwards = cast(*make("grid/buffer/twin32", share(reversed)), rays);
    size_t ties = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Hit& a = forwards.hits[i];
        const Hit& b = backwards.hits[i];
        ASSERT_EQ(a.t, b.t) << i;
        if (!a.is_hit()) continue;
        // Of two coincident triangles the one of lower number.
        const Object& object = scene.objects[scene.instances[a.inst_id].object];
        EXPECT_LT(a.prim_id, object.triangles.size() / 2) << i;
        if (a.inst_id == scene.instances.size() - 1 - b.inst_id && a.prim_id == b.prim_id) continue;
        ++ties;
    }
    EXPECT_LT(ties, rays.size() / 4) << "other triangles at the same t";
}

TEST_F(GridStrategy, a_triangle_without_area_is_never_hit) {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& object = scene.objects.front();
    object.positions = {{1, 2, 3}, {4, 6, 9}, {2.5f, 4, 6}, {0.1f, 0.7f, 0.3f}, {9, 9, 9}};
    object.triangles = {{0, 1, 2}, {1, 2, 0}, {3, 3, 4}, {0, 3, 4}};
    object.groups = {{"all", 0, uint32_t(object.triangles.size())}};
    object.normals.clear();
    validate(scene);
    const ScenePtr shared = share(scene);
    std::vector<Ray> rays;
    for (const float s : {0.0f, 0.125f, 0.3f, 0.5f, 0.77f, 1.0f}) {
        const vec3 target = object.positions[0] + s * (object.positions[1] - object.positions[0]);
        for (const vec3& dir : {vec3(1, 0, 0), vec3(0.3f, -0.2f, 0.9f), vec3(-5, 7, 1)}) {
            rays.push_back({target - dir, 0.0f, dir, kInfinity});
        }
    }
    for (const Hit& hit : cast(*make("grid/buffer/twin32", shared), rays).hits) {
        EXPECT_TRUE(!hit.is_hit() || hit.prim_id == 3) << describe(hit);
    }
}

TEST_F(GridStrategy, a_ray_along_an_axis_is_answered_rightly_however_long_its_direction) {
    const ScenePtr scene = ball_at(vec3(0.0f), 1.0f);
    std::vector<Ray> rays;
    for (int exponent = -28; exponent <= 28; exponent += 4) {
        const float length = std::pow(10.0f, static_cast<float>(exponent));
        for (int axis = 0; axis < 3; ++axis) {
            for (const float sign : {-1.0f, 1.0f}) {
                vec3 org(0.3f, 0.17f, -0.41f);
                org[axis] = -3.0f * sign;
                vec3 dir(0.0f);
                dir[axis] = sign * length;
                rays.push_back({org, 0.0f, dir, kInfinity});
            }
        }
    }
    for (const char* entry : {"grid/buffer/twin32", "grid/buffer/fragment"}) {
        EXPECT_EQ(hit_count(cast(*make(entry, scene), rays).hits), rays.size()) << entry;
        expect_no_error(*make(entry, scene), scene, rays, entry);
    }
}

TEST_F(GridStrategy, a_triangle_seen_nearly_edge_on_is_not_hit_from_beside) {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& object = scene.objects.front();
    object.positions = {
        {0.5f, 1, 1}, {0.5f, 1 + 0x1p-8f, 1}, {0.5f + 0x1p-10f, 1 + 0x1p-9f, 1 + 0x1p-9f},
        {-1, -1, -1}, {-1, -0.5f, -1},        {-1, -1, -0.5f}};
    object.triangles = {{0, 1, 2}, {3, 4, 5}};
    object.groups = {{"all", 0, uint32_t(object.triangles.size())}};
    object.normals.clear();
    validate(scene);
    const ScenePtr shared = share(scene);
    std::vector<Ray> rays;
    for (int i = 1; i <= 200; ++i) {
        rays.push_back(
            {vec3(-1e-14f * static_cast<float>(i), 0, 0), 0.0f, vec3(0.5f, 0, 1), kInfinity});
    }
    for (const char* entry : {"grid/buffer/twin32", "grid/buffer/fragment"}) {
        const auto tracer = make(entry, shared, {{"resolution", "1x1x1"}});
        EXPECT_EQ(hit_count(cast(*tracer, rays).hits), 0u) << entry;
    }
}

/// Two triangles and rays that meet them about as far away: one is seen flatly, so that floats know
/// its t badly, the other one squarely, a little before or behind it.
std::pair<Scene, std::vector<Ray>> flat_beside_square(std::mt19937& engine) {
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto between = [&](float low, float high) {
        return low * std::pow(high / low, unit(engine));
    };
    const vec3 dir = glm::normalize(vec3(unit(engine), unit(engine), 1.0f));
    const vec3 side_1 = glm::normalize(glm::cross(dir, vec3(unit(engine), 1.0f, 0.0f)));
    const vec3 side_2 = glm::cross(dir, side_1);
    const vec3 org(unit(engine), unit(engine), -1.0f);
    const float t = 1.0f + unit(engine);
    const float slope = between(1e-4f, 1e-2f);
    const float apart = between(1e-5f, 1e-3f) * (unit(engine) < 0.5f ? 1.0f : -1.0f);

    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& object = scene.objects.front();
    object.positions.clear();
    object.triangles.clear();
    object.normals.clear();
    const auto add = [&](const vec3& centre, const vec3& across, const vec3& along) {
        const auto first = static_cast<uint32_t>(object.positions.size());
        object.positions.push_back(centre + across);
        object.positions.push_back(centre - 0.5f * across + 0.8f * along);
        object.positions.push_back(centre - 0.5f * across - 0.8f * along);
        object.triangles.emplace_back(first, first + 1, first + 2);
    };
    add(org + t * dir, side_2, glm::normalize(dir - slope * side_1));
    add(org + (t + apart) * dir, side_2, side_1);
    object.groups = {{"all", 0, uint32_t(object.triangles.size())}};
    validate(scene);

    // Side by side in the flat one's plane, so that its t is the same for all.
    std::vector<Ray> rays;
    for (int i = 0; i < 32; ++i) {
        rays.push_back({org + 0.3f * (unit(engine) - 0.5f) * side_2, 0.0f, dir, kInfinity});
    }
    return {std::move(scene), std::move(rays)};
}

TEST_F(GridStrategy, a_surface_seen_flatly_hides_none_that_is_about_as_far_away) {
    std::mt19937 engine(11);
    for (int i = 0; i < 60; ++i) {
        const auto [made, rays] = flat_beside_square(engine);
        const ScenePtr scene = share(made);
        for (const char* entry : {"grid/buffer/twin32", "grid/buffer/fragment"}) {
            expect_no_error(*make(entry, scene), scene, rays, fmt::format("{}, {}", entry, i));
        }
    }
}

TEST_F(GridStrategy, a_surface_that_floats_see_exactly_edge_on_is_hit_where_doubles_see_it) {
    // A triangle in the plane x + z = 0, in a map that shears z by a little of x: the ray's slope
    // to the plane is that little, of which floats keep nothing. To them t is 0 / 0.
    for (const int places : {26, 30, 36, 42}) {
        const float little = std::ldexp(1.0f, -places);
        Scene scene;
        scene.name = "edge-on";
        scene.objects.resize(1);
        Object& object = scene.objects[0];
        object.positions = {vec3(1, -1, -1), vec3(-1, -1, 1), vec3(0, 2, 0)};
        object.triangles = {uvec3(0, 1, 2)};
        object.groups = {{"all", 0, 1}};
        scene.materials.resize(1);
        Affine shear = affine_identity();
        shear[0].z = little;
        scene.instances = {{"sheared", 0, shear, {0}}};
        validate(scene);
        const ScenePtr shared = share(std::move(scene));
        std::vector<Ray> rays;
        for (int i = 0; i < 32; ++i) {
            const float height = -1.5f + 0.125f * static_cast<float>(i);
            for (const float way : {0.25f, 1.5f}) {
                const vec3 dir(-1, 0, 1);
                rays.push_back({vec3(0, height, 0) - way * dir, 0.0f, dir, kInfinity});
            }
        }
        for (const char* entry :
             {"grid/buffer/twin32", "grid/buffer/fragment", "bvh/buffer/compute"}) {
            const auto tracer = make(entry, shared);
            expect_no_error(*tracer, shared, rays, fmt::format("{}, 2^-{}", entry, places));
            EXPECT_GT(hit_count(cast(*tracer, rays).hits), rays.size() / 2) << entry;
        }
    }
}

TEST_F(GridStrategy, a_triangle_thin_in_its_object_is_hit_where_an_instance_widens_it) {
    // Of height 2^-20 in the object and of 1 in the world, in planes beside the middle of the
    // object.
    const float height = 0x1p-20f;
    Scene scene;
    scene.name = "thin";
    scene.objects.resize(1);
    Object& object = scene.objects[0];
    for (const float z : {-1.0f, 0.5f}) {
        for (const vec3& p : {vec3(-1, -height, z), vec3(1, -height, z), vec3(0, height, z)}) {
            object.positions.push_back(p);
        }
    }
    object.triangles = {uvec3(0, 1, 2), uvec3(3, 4, 5)};
    object.groups = {{"all", 0, 2}};
    scene.materials.resize(1);
    Affine widen = affine_identity();
    widen[1].y = 0x1p20f;
    scene.instances = {{"widened", 0, widen, {0}}};
    validate(scene);
    const ScenePtr shared = share(std::move(scene));
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> within(-1.0f, 1.0f);
    const auto vector = [&] {
        const float x = within(engine);
        const float y = within(engine);
        return vec3(x, y, within(engine));
    };
    std::vector<Ray> rays;
    for (int i = 0; i < 200; ++i) {
        const vec3 target = vec3(0.0f, 0.1f, 0.5f) + vec3(0.3f, 0.3f, 0.0f) * vector();
        const vec3 org = vec3(0, 0, 2.0f) + vector();
        rays.push_back({org, 0.0f, target - org, 1.5f});
    }
    for (const char* entry : {"grid/buffer/twin32", "grid/buffer/fragment", "bvh/buffer/compute",
                              "irregular_grid/buffer/compute", "flat_grid/buffer/compute"}) {
        const auto tracer = make(entry, shared);
        expect_no_error(*tracer, shared, rays, entry);
        EXPECT_EQ(hit_count(cast(*tracer, rays).hits), rays.size()) << entry;
    }
}

TEST_F(GridStrategy, a_ray_from_farther_than_floats_hold_in_the_object_misses) {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    for (vec3& p : scene.objects[0].positions) p *= 1e-12f;
    validate(scene);
    const ScenePtr shared = share(std::move(scene));
    std::vector<Ray> rays;
    for (const float away : {1e27f, 1e30f, 1e36f}) {
        for (int axis = 0; axis < 3; ++axis) {
            vec3 org(0.0f);
            org[axis] = -away;
            rays.push_back({org, 0.0f, -org, kInfinity});
            rays.push_back({org, 0.0f, glm::normalize(-org), kInfinity});
        }
    }
    for (const char* entry :
         {"grid/buffer/twin32", "grid/buffer/compute", "grid/buffer/fragment"}) {
        const CastResult result = cast(*make(entry, shared), rays);
        EXPECT_EQ(hit_count(result.hits), 0u) << entry;
        for (const uint32_t flags : result.flags) EXPECT_EQ(flags, 0u) << entry;
    }
}

TEST_F(GridStrategy, a_hit_at_the_very_end_of_the_interval_is_decided_exactly) {
    const ScenePtr scene = ball_at(vec3(5.0f, 3.0f, -2.0f), 1.0f);
    const auto tracer = make("grid/buffer/twin32", scene);
    std::vector<Ray> rays = random_rays(scene_bounds(*scene), 2000, 21);
    const std::vector<Hit> hits = cast(*tracer, rays).hits;
    // The interval ends at the answered t, one float before and one float behind it.
    std::vector<Ray> cut;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].is_hit()) continue;
        for (const float t :
             {hits[i].t, std::nextafter(hits[i].t, 0.0f), std::nextafter(hits[i].t, kInfinity)}) {
            cut.push_back({rays[i].org, 0.0f, rays[i].dir, t});
            cut.push_back({rays[i].org, t, rays[i].dir, kInfinity});
        }
    }
    // It begins on the surface itself, at a float beside it, and leaves along an axis.
    for (size_t i = 0; i < hits.size(); i += 7) {
        if (!hits[i].is_hit()) continue;
        const vec3 on = rays[i].org + rays[i].dir * hits[i].t;
        cut.push_back({on, 0.0f, rays[i].dir, kInfinity});
        cut.push_back({on, 0.0f, -rays[i].dir, kInfinity});
        cut.push_back({on, 0.0f, vec3(-1e-12f, 1.0f, -1e-12f), kInfinity});
    }
    expect_no_error(*tracer, scene, cut, "cut rays");
}

TEST_F(GridStrategy, a_ray_that_is_none_is_a_miss_and_visits_no_cell) {
    const ScenePtr scene = share(make_instances());
    const vec3 centre = scene_bounds(*scene).centre();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays = {
        {centre, 0.0f, vec3(0.0f), kInfinity},         {centre, 0.0f, vec3(-0.0f), kInfinity},
        {centre, 2.0f, vec3(0, -1, 0), 1.0f},          {centre, -1.0f, vec3(0, -1, 0), 1.0f},
        {centre, nan, vec3(0, -1, 0), kInfinity},      {centre, 0.0f, vec3(0, -1, 0), nan},
        {centre, kInfinity, vec3(0, -1, 0), kInfinity}};
    for (const float bad : {nan, kInfinity, -kInfinity}) {
        for (int axis = 0; axis < 3; ++axis) {
            Ray ray{centre, 0.0f, vec3(0, -1, 0), kInfinity};
            ray.org[axis] = bad;
            rays.push_back(ray);
            ray = {centre, 0.0f, vec3(1, 1, 1), kInfinity};
            ray.dir[axis] = bad;
            rays.push_back(ray);
        }
    }
    for (const char* entry : {"grid/buffer/twin32", "grid/buffer/twin64", "grid/buffer/fragment",
                              "grid/buffer/compute"}) {
        const CastResult result = cast(*make(entry, scene), rays, {.counters = true});
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(result.hits[i], Hit{}) << entry << ", ray " << i;
            EXPECT_EQ(result.counters[i].cells, 0u) << entry << ", ray " << i;
            EXPECT_EQ(result.flags[i], 0u) << entry << ", ray " << i;
        }
    }
}

/// True if the point lies on the side of the hit triangle that `normal` points to: its distance is
/// a determinant of differences, in long double, whose rounding is far below a float's.
bool is_in_front(const Scene& scene, const Hit& hit, const vec3& point, const vec3& normal) {
    using Real = long double;
    const Instance& instance = scene.instances[hit.inst_id];
    const Object& object = scene.objects[instance.object];
    Real corners[3][3];
    for (int k = 0; k < 3; ++k) {
        const vec3& p = object.positions[object.triangles[hit.prim_id][k]];
        for (int row = 0; row < 3; ++row) {
            Real sum = instance.world_from_object[3][row];
            for (int c = 0; c < 3; ++c) sum += Real(instance.world_from_object[c][row]) * p[c];
            corners[k][row] = sum;
        }
    }
    Real side = 0.0, same_way = 0.0;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        const Real cross = (corners[1][j] - corners[0][j]) * (corners[2][k] - corners[0][k]) -
                           (corners[1][k] - corners[0][k]) * (corners[2][j] - corners[0][j]);
        side += cross * (Real(point[i]) - corners[0][i]);
        same_way += cross * normal[i];
    }
    return same_way > 0.0 ? side > 0.0 : side < 0.0;
}

TEST_F(GridStrategy, secondary_rays_start_in_front_of_their_surface_at_any_scale_and_place) {
    for (const float scale : {1e-6f, 1.0f, 1e6f}) {
        for (const float distance : {0.0f, 1e2f, 1e5f}) {
            const ScenePtr scene = ball_at(scale * distance * vec3(1.0f, -0.3f, 0.7f), scale);
            const ShadingScene shading(*scene);
            std::vector<Ray> rays = random_rays(scene_bounds(*scene), 1000, 8);
            const std::vector<Ray> primary = primary_rays(*scene, 32, 32);
            rays.insert(rays.end(), primary.begin(), primary.end());
            const auto tracer = make("grid/buffer/twin32", scene);
            const std::vector<Hit> hits = cast(*tracer, rays).hits;
            std::vector<Ray> secondary;
            std::vector<Hit> left;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (!hits[i].is_hit()) continue;
                const SurfacePoint point = surface_point(shading, rays[i], hits[i]);
                const vec3 n = point.geometric_normal;
                EXPECT_TRUE(is_in_front(*scene, hits[i], point.origin, n))
                    << "scale " << scale << ", " << distance << " sizes away, ray " << i;
                secondary.push_back({point.origin, 0.0f, glm::reflect(rays[i].dir, n), kInfinity});
                left.push_back(hits[i]);
            }
            const std::vector<Hit> next = cast(*tracer, secondary).hits;
            for (size_t i = 0; i < next.size(); ++i) {
                EXPECT_FALSE(next[i].prim_id == left[i].prim_id &&
                             next[i].inst_id == left[i].inst_id)
                    << "scale " << scale << ", " << distance << " sizes away";
            }
            EXPECT_GT(secondary.size(), 500u);
            EXPECT_LT(shading.ray_offset, 0.2f * scale) << distance << " sizes away";
        }
    }
}

TEST_F(GridStrategy, any_resolution_gives_the_same_hits) {
    const ScenePtr scene = share(make_big_small());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 3000, 12);
    const std::vector<Hit> coarse =
        cast(*make("grid/buffer/twin32", scene, {{"resolution", "1x1x1"}}), rays).hits;
    for (const char* resolution : {"2x3x5", "64x8x64", "200x200x200"}) {
        const auto tracer = make("grid/buffer/twin32", scene, {{"resolution", resolution}});
        expect_same_bits(cast(*tracer, rays).hits, coarse, resolution);
    }
}

TEST_F(GridStrategy, a_ray_for_which_a_software_renderer_ends_a_loop_says_so) {
    // 80,000 triangles in one cell: more than the 65,535 turns that llvmpipe lets a loop have.
    const Object ball = make_sphere(200, 201);
    ASSERT_GT(ball.triangles.size(), 65535u);
    Scene scene;
    scene.name = "ball";
    scene.objects = {ball};
    scene.materials = {Material{}};
    scene.instances = {Instance{.name = "one", .materials = {0}}};
    Scene two = scene;
    two.instances.push_back(two.instances.front());
    two.instances.back().world_from_object[3] = vec3(0.5f, 0.25f, 0.0f);
    for (const Scene& made : {scene, two}) {
        const ScenePtr shared = share(made);
        const std::vector<Ray> rays = random_rays(scene_bounds(made), 64, 3);
        const ParamValues params = {{"resolution", "1x1x1"}};
        const std::vector<Hit> expected =
            cast(*make("grid/buffer/twin32", shared, params), rays).hits;
        for (const char* entry : kEntries) {
            const CastResult result = cast(*make(entry, shared, params), rays);
            size_t flagged = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                if ((result.flags[i] & kFlagExhausted) != 0) {
                    ++flagged;
                } else {
                    EXPECT_EQ(result.hits[i].t, expected[i].t) << entry << " ray " << i;
                }
            }
            // (Mesa 25, which jumps, ends no loop.)
            if (context->description().software && !context->description().jumps) {
                EXPECT_GT(flagged, 0u) << entry;
            }
        }
    }
}

/// Rays along the edges and across the faces of all instances' boxes, in their very planes, and at
/// their corners: from far away, from two box sizes away, and from one face on.
std::vector<Ray> rays_along_boxes(const Scene& scene) {
    std::vector<Ray> rays;
    for (const Bounds& box : instance_bounds(scene)) {
        for (uint32_t i = 0; i < 64; ++i) {
            const auto corner = [&](uint32_t bits) {
                return vec3((bits & 1) != 0 ? box.upper.x : box.lower.x,
                            (bits & 2) != 0 ? box.upper.y : box.lower.y,
                            (bits & 4) != 0 ? box.upper.z : box.lower.z);
            };
            const vec3 from = corner(i % 8);
            const vec3 way = corner(i / 8) - from;
            if (way == vec3(0.0f)) continue;
            rays.push_back({from, 0.0f, way, kInfinity});
            rays.push_back({from - 2.0f * way, 0.0f, way, kInfinity});
            rays.push_back({from - 3e4f * way, 0.0f, way, kInfinity});
        }
    }
    return rays;
}

uint64_t cells_of(const CastResult& result) {
    uint64_t cells = 0;
    for (const RayCounters& counters : result.counters) cells += counters.cells;
    return cells;
}

TEST_F(GridStrategy, an_instance_whose_box_is_missed_is_not_walked_through_and_no_hit_is_lost) {
    Scene boxes;  // whose triangles lie in the faces of their instances' boxes, and of each other's
    boxes.name = "boxes";
    boxes.objects = {make_box(3, 2, 4)};
    boxes.materials = {Material{}};
    for (int i = 0; i < 12; ++i) {
        Affine place = affine_identity();
        place[3] = vec3(i % 3, i / 3 % 2, 2 * (i / 6)) * vec3(3, 2, 4);
        boxes.instances.push_back({.name = "box", .world_from_object = place, .materials = {0}});
    }
    validate(boxes);
    for (const Scene& made : {boxes, make_palace(), make_balls_1(), *squeezed_balls()}) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = rays_along_boxes(made);
        const std::vector<Ray> others = random_rays(scene_bounds(made), 2500, 7);
        rays.insert(rays.end(), others.begin(), others.end());
        for (const char* top : {"1x1x1", "9x4x7", "1024x1x300"}) {
            const ParamValues one_by_one = {{"top_resolution", top}, {"test_boxes", "0"}};
            const auto every = make("grid/buffer/twin32", scene, one_by_one);
            const auto tested = make("grid/buffer/twin32", scene, {{"top_resolution", top}});
            const CastResult all = cast(*every, rays, {.counters = true});
            const CastResult met = cast(*tested, rays, {.counters = true});
            expect_same_bits(met.hits, all.hits, made.name);
            EXPECT_EQ(met.flags, all.flags) << made.name;
            EXPECT_GT(hit_count(all.hits), rays.size() / 20) << made.name;
            EXPECT_LE(cells_of(met), cells_of(all)) << made.name;
        }
    }
}

/// What the strategy says where the device holds no more than that; empty if it is content.
std::string refusal(const std::string& storage, const TextureLimits& limits) {
    for (const gl::StrategyInfo& info : gl::ShaderLibrary::embedded().strategies()) {
        if (info.name != "grid") continue;
        try {
            prepare_strategy(info, storage, share(make_balls_1()), {}, {.limits = limits});
            return "";
        } catch (const Error& error) {
            return error.what();
        }
    }
    return "no such strategy";
}

TEST_F(GridStrategy, a_buffer_that_the_device_cannot_hold_is_refused_by_name) {
    const std::string texture = refusal("buffer", {.max_buffer = 10000});
    EXPECT_NE(texture.find("'cells'"), std::string::npos) << texture;
    EXPECT_NE(texture.find("10000"), std::string::npos) << texture;
    const std::string block = refusal("ssbo", {.max_block = 40000});
    EXPECT_NE(block.find("'cells'"), std::string::npos) << block;
    EXPECT_NE(block.find("10000"), std::string::npos) << block;
}

TEST_F(GridStrategy, what_a_walk_fetches_is_held_to_the_limit_of_its_own_storage) {
    EXPECT_EQ(refusal("buffer", {.max_block = 40000}), "");
    EXPECT_EQ(refusal("ssbo", {.max_buffer = 10000}), "");
}

}  // namespace
}  // namespace onepass::test
