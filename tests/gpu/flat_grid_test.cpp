// The flat grid: bit-identical to its twin, the same answers as the two-level grid bit by bit, and
// without one wrong hit.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu_glsl/pack/flat_grid_buffers.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/motions.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"flat_grid/buffer/fragment", "flat_grid/buffer/compute",
                                    "flat_grid/ssbo/fragment", "flat_grid/ssbo/compute"};
constexpr const char* kTwin = "flat_grid/buffer/twin32";
constexpr const char* kTwoLevels = "grid/buffer/twin32";

class FlatGridStrategy : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, params);
    }

    std::optional<Catalogue> catalogue;
};

/// Places of a ball, as the columns of its map.
using Places = std::vector<Affine>;

Scene balls_at(const Places& places) {
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    scene.instances.clear();
    for (const Affine& place : places) {
        scene.instances.push_back(
            {.name = "ball", .object = 0, .world_from_object = place, .materials = {0}});
    }
    scene.cameras = {automatic_camera(scene_bounds(scene))};
    validate(scene);
    return scene;
}

/// The scene with each instance moved by `offset`.
Scene moved_by(Scene scene, const vec3& offset) {
    for (Instance& instance : scene.instances) instance.world_from_object[3] += offset;
    scene.cameras = {automatic_camera(scene_bounds(scene))};
    return scene;
}

/// Its ball stands far from its own origin, and the instances bring it back.
Scene brought_back(Scene scene) {
    const vec3 away(-3e4f, 1e4f, 2e4f);
    for (vec3& p : scene.objects.front().positions) p += away;
    for (Instance& instance : scene.instances) {
        instance.world_from_object[3] -= transform_vector(instance.world_from_object, away);
    }
    scene.cameras = {automatic_camera(scene_bounds(scene))};
    return scene;
}

/// Aimed at corners, from a few sizes of the ball away, from its inside and from afar.
std::vector<Ray> rays_at_corners(const Scene& scene, size_t stride) {
    std::vector<Ray> rays;
    for (const Instance& instance : scene.instances) {
        const std::vector<vec3>& corners = scene.objects[instance.object].positions;
        for (size_t i = 0; i < corners.size(); i += stride) {
            const vec3 target = transform_point(instance.world_from_object, corners[i]);
            for (const float distance : {3.0f, 0.5f, 1e3f}) {
                const vec3 from = transform_point(instance.world_from_object,
                                                  distance * corners[(i * 7) % corners.size()]);
                rays.push_back({from, 0.0f, target - from, kInfinity});
            }
        }
    }
    return rays;
}

std::vector<Ray> mixed_rays(const Scene& scene) {
    std::vector<Ray> rays = primary_rays(scene, 32, 32);
    for (const std::vector<Ray>& more :
         {random_rays(scene_bounds(scene), 1500, 7), awkward_rays(scene)}) {
        rays.insert(rays.end(), more.begin(), more.end());
    }
    return rays;
}

TEST_F(FlatGridStrategy, hits_are_bit_identical_to_its_twin_on_a_software_renderer) {
    if (!context->description().software) GTEST_SKIP() << "promised on software renderers only";
    for (const auto& [made, records] :
         in_both_records({make_balls_1(), make_instances(), make_palace()})) {
        const ScenePtr scene = share(made);
        const std::vector<Ray> rays = mixed_rays(*scene);
        const auto twin = make(kTwin, scene, {{"records", records}});
        const CastResult cpu = cast(*twin, rays, {.counters = true});
        for (const char* entry : kEntries) {
            const CastResult gpu =
                cast(*make(entry, scene, {{"records", records}}), rays, {.counters = true});
            expect_same_bits(gpu.hits, cpu.hits, made.name + " " + records + " " + entry);
            EXPECT_EQ(gpu.flags, cpu.flags) << made.name << " " << records << " " << entry;
            EXPECT_EQ(gpu.counters, cpu.counters) << made.name << " " << records << " " << entry;
        }
    }
}

TEST_F(FlatGridStrategy, answers_as_the_two_level_grid_does_whatever_its_cells) {
    for (const Scene& made :
         {make_balls_1(), make_instances(), make_palace(), make_big_small(), make_swarm(40, 3)}) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = mixed_rays(*scene);
        for (const char* kind : {"vertex", "edge"}) {
            const std::vector<Ray> aimed = rays_of_kind(kind, *scene, 24);
            rays.insert(rays.end(), aimed.begin(), aimed.end());
        }
        const std::vector<Hit> expected = cast(*make(kTwoLevels, scene), rays).hits;
        EXPECT_GT(hit_count(expected), rays.size() / 4) << made.name;
        for (const ParamValues& params :
             {ParamValues{}, ParamValues{{"density", "0.5"}}, ParamValues{{"resolution", "1x9x4"}},
              ParamValues{{"skip_empty", "0"}}}) {
            expect_same_bits(cast(*make(kTwin, scene, params), rays).hits, expected, made.name);
        }
    }
}

TEST_F(FlatGridStrategy, answers_as_the_two_level_grid_does_wherever_instances_stand) {
    const Affine turned({0.6f, 0.8f, 0}, {-0.8f, 0.6f, 0}, {0, 0, 1}, {2.5f, 0, 0});
    const Affine mirrored({-1, 0, 0}, {0.5f, 1, 0}, {0, 0, 3}, {-3, 0, 0.25f});
    const Affine here = affine_identity();
    Affine beside = here;
    beside[3].x = 0x1p-20f;
    Affine far = turned;
    far[3] = vec3(3e4f, -2e4f, 1e4f);
    Affine tiny({1e-3f, 0, 0}, {0, 0, 1e-3f}, {0, -1e-3f, 0}, {1.5f, 0.1f, 0});
    struct Subject {
        const char* what;
        Scene scene;
    };
    const std::vector<Subject> subjects = {
        {"at the same place three times", balls_at({here, turned, here, here})},
        {"a 2^-20 of their size beside each other", balls_at({beside, here, mirrored})},
        {"far from each other", balls_at({here, turned, far})},
        {"of different sizes", balls_at({here, mirrored, tiny})},
        {"far from the origin", moved_by(balls_at({here, turned, mirrored}), vec3(-1e6f, 7e5f, 3))},
        {"far from their object's origin", brought_back(balls_at({here, turned, mirrored}))},
        {"needles, pancakes and mirror images", *squeezed_balls()}};
    for (const auto& [what, made] : subjects) {
        const ScenePtr scene = share(made);
        std::vector<Ray> rays = rays_at_corners(*scene, 17);
        const std::vector<Ray> primary = primary_rays(*scene, 24, 24);
        rays.insert(rays.end(), primary.begin(), primary.end());
        const std::vector<Hit> expected = cast(*make(kTwoLevels, scene), rays).hits;
        EXPECT_GT(hit_count(expected), rays.size() / 2) << what;
        const CastResult flat = cast(*make(kTwin, scene), rays);
        expect_same_bits(flat.hits, expected, what);
        EXPECT_EQ(std::ranges::count(flat.flags, 0u), std::ptrdiff_t(rays.size())) << what;
    }
}

TEST_F(FlatGridStrategy, of_hits_at_the_same_t_the_lower_instance_has_it) {
    const Affine here = affine_identity();
    Affine there = here;
    there[3].x = 3.0f;
    const ScenePtr scene = share(balls_at({there, here, here, there}));
    const std::vector<Hit> hits = cast(*make(kTwin, scene), primary_rays(*scene, 48, 48)).hits;
    EXPECT_GT(hit_count(hits), 200u);
    for (const Hit& hit : hits) EXPECT_TRUE(!hit.is_hit() || hit.inst_id < 2) << hit.inst_id;
}

TEST_F(FlatGridStrategy, no_ray_aimed_at_corners_or_edges_is_answered_wrongly) {
    for (const Scene& made : {make_balls_1(), make_instances(), make_palace()}) {
        const ScenePtr scene = share(made);
        for (const char* kind : {"vertex", "edge"}) {
            const std::vector<Ray> rays = rays_of_kind(kind, *scene, 48);
            for (const char* entry : {"flat_grid/buffer/compute", "flat_grid/ssbo/fragment"}) {
                expect_no_error(*make(entry, scene), scene, rays, made.name + ", " + kind);
            }
        }
    }
}

TEST_F(FlatGridStrategy, a_scene_far_from_the_origin_or_of_any_size_is_as_right_as_any) {
    const Places places = {affine_identity(),
                           Affine({0.6f, 0.8f, 0}, {-0.8f, 0.6f, 0}, {0, 0, 1}, {2.5f, 0, 0})};
    for (const float distance : {0.0f, -1e6f}) {
        for (const float scale : {1e-12f, 1.0f, 1e12f}) {
            Places scaled = places;
            for (Affine& place : scaled) place = scale * place;
            const ScenePtr scene =
                share(moved_by(balls_at(scaled), scale * distance * vec3(1.0f, -0.3f, 0.7f)));
            for (const char* kind : {"vertex", "random"}) {
                expect_no_error(*make(kTwin, scene), scene, rays_of_kind(kind, *scene, 32),
                                std::to_string(distance) + " sizes away, " + kind);
            }
        }
    }
}

TEST_F(FlatGridStrategy, its_shader_holds_no_top_level_however_many_instances_there_are) {
    const RenderSettings settings;
    const std::string text =
        compose_tracer_shader(gl::ShaderLibrary::embedded(), "flat_grid/buffer/compute",
                              share(make_instances()), {{"specialise", "0"}}, &settings)
            .text;
    for (const char* part : {"walk_scene", "fetch_top_", "to_top_level", "top_cells"}) {
        EXPECT_EQ(text.find(part), std::string::npos) << part;
    }
    EXPECT_NE(text.find("flat_names"), std::string::npos);
}

/// Each triangle of the object again, behind them all.
Object doubled(Object object) {
    const std::vector<uvec3> once = object.triangles;
    object.triangles.insert(object.triangles.end(), once.begin(), once.end());
    object.groups = {{"all", 0, static_cast<uint32_t>(object.triangles.size())}};
    return object;
}

/// The instances and triangles in each cell's list, cell by cell.
std::vector<std::vector<uvec2>> triangles_in_cells(const FlatGrid& flat, const Scene& scene) {
    std::vector<std::vector<uvec2>> cells;
    for (uint64_t i = 0; i < flat.grid.cell_count(); ++i) {
        std::vector<uvec2>& cell = cells.emplace_back();
        for (uint32_t k = flat.grid.cell_begin[i]; k < flat.grid.cell_begin[i + 1]; ++k) {
            const uint32_t at = flat.grid.references[k];
            const auto behind = std::ranges::upper_bound(flat.first, at);
            const auto inst_id = static_cast<uint32_t>(behind - flat.first.begin() - 1);
            const uint32_t object = scene.instances[inst_id].object;
            cell.emplace_back(inst_id, flat.listed[object][at - flat.first[inst_id]]);
        }
        std::ranges::sort(cell, {}, [](const uvec2& name) { return std::pair(name.x, name.y); });
    }
    return cells;
}

TEST_F(FlatGridStrategy, a_triangle_that_equals_a_lower_one_of_its_object_is_in_no_list) {
    const Scene once = balls_at({affine_identity(), affine_identity()});
    Scene twice = once;
    twice.objects.front() = doubled(once.objects.front());
    const FlatGrid expected = build_flat_grid(once, {});
    const FlatGrid flat = build_flat_grid(twice, {});
    EXPECT_EQ(flat.first.back(), 2 * once.objects.front().triangles.size())
        << "the other instance's stay";
    EXPECT_EQ(flat.grid.bounds, expected.grid.bounds);
    EXPECT_EQ(flat.grid.dims, expected.grid.dims);
    EXPECT_EQ(triangles_in_cells(flat, twice), triangles_in_cells(expected, once));
    const std::vector<Ray> rays = primary_rays(once, 32, 32);
    expect_same_bits(cast(*make(kTwin, share(twice)), rays).hits,
                     cast(*make(kTwoLevels, share(once)), rays).hits, "every triangle twice");
}

TEST_F(FlatGridStrategy, refuses_to_move_instances) {
    const Scene swarm = make_swarm(10, 3);
    const auto tracer = make("flat_grid/buffer/compute", share(swarm));
    const std::vector<Affine> places = instance_transforms(swarm, 0.9);
    EXPECT_THROW(tracer->update(places), Error);
}

TEST_F(FlatGridStrategy, refuses_more_triangles_than_the_device_holds_and_names_another_strategy) {
    const Scene scene = make_balls_1();
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) {
        triangles += scene.objects[instance.object].triangles.size();
    }
    for (const auto& [form, kind] : {std::pair(PlanesForm::floats, BufferKind::texture),
                                     std::pair(PlanesForm::floats, BufferKind::block),
                                     std::pair(PlanesForm::fixed, BufferKind::texture),
                                     std::pair(PlanesForm::fixed, BufferKind::block)}) {
        const uint64_t bytes_a_triangle = form == PlanesForm::floats ? 48 : 32;
        const TextureLimits enough{.max_buffer = triangles * bytes_a_triangle / 16,
                                   .max_block = triangles * bytes_a_triangle};
        const TextureLimits less{.max_buffer = enough.max_buffer - 1,
                                 .max_block = enough.max_block - 1};
        EXPECT_NO_THROW(check_flat_grid_fits(scene, enough, kind, form));
        try {
            check_flat_grid_fits(scene, less, kind, form);
            ADD_FAILURE() << "fewer were enough";
        } catch (const Error& error) {
            EXPECT_NE(error.parts().got.find(std::to_string(triangles)), std::string::npos);
            EXPECT_NE(error.parts().expected.find(std::to_string(triangles - 1)),
                      std::string::npos);
            EXPECT_NE(error.parts().remedy.find("`grid`"), std::string::npos);
        }
    }
    EXPECT_THROW(make(kTwin, share(scene), {{"density", "0"}}), Error);
}

}  // namespace
}  // namespace onepass::test
