// The bounding volume hierarchy: bit-identical to its twin, and without one wrong hit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu_glsl/prepared_strategy.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/judged.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"bvh/buffer/fragment", "bvh/buffer/compute",
                                    "bvh/ssbo/fragment", "bvh/ssbo/compute"};
constexpr const char* kTwin = "bvh/buffer/twin32";

class BvhStrategy : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        if (!catalogue) catalogue = catalogue_of(context);
        return catalogue->at(name).make(scene, params);
    }

    std::optional<Catalogue> catalogue;
};

TEST_F(BvhStrategy, hits_are_bit_identical_to_its_twin_on_a_software_renderer) {
    if (!context->description().software) GTEST_SKIP() << "promised on software renderers only";
    for (const auto& [made, records] :
         in_both_records({make_balls_1(), make_instances(), make_big_small(), make_knife()})) {
        const ScenePtr scene = share(made);
        const std::vector<std::vector<Ray>> ray_sets = {primary_rays(*scene, 64, 64),
                                                        random_rays(scene_bounds(*scene), 5000, 7),
                                                        awkward_rays(*scene)};
        const auto twin = make(kTwin, scene, {{"records", records}});
        for (const char* entry : kEntries) {
            const auto tracer = make(entry, scene, {{"records", records}});
            for (const std::vector<Ray>& rays : ray_sets) {
                const CastResult gpu = cast(*tracer, rays, {.counters = true});
                const CastResult cpu = cast(*twin, rays, {.counters = true});
                expect_same_bits(gpu.hits, cpu.hits, made.name + " " + records + " " + entry);
                EXPECT_EQ(gpu.flags, cpu.flags) << made.name << " " << records << " " << entry;
                EXPECT_EQ(gpu.counters, cpu.counters)
                    << made.name << " " << records << " " << entry;
            }
        }
    }
}

TEST_F(BvhStrategy, no_ray_aimed_at_corners_or_edges_is_answered_wrongly) {
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

TEST_F(BvhStrategy, a_scene_far_from_the_origin_or_of_any_size_is_as_right_as_any) {
    for (const float distance : {0.0f, 1e2f, -1e6f}) {
        for (const float scale : {1e-12f, 1.0f, 1e12f}) {
            const ScenePtr scene = ball_at(scale * distance * vec3(1.0f, -0.3f, 0.7f), scale);
            for (const char* kind : {"vertex", "random"}) {
                expect_no_error(*make(kTwin, scene), scene, rays_of_kind(kind, *scene, 32),
                                std::to_string(distance) + " sizes away, " + kind);
            }
        }
    }
}

TEST_F(BvhStrategy, instances_of_extreme_shape_and_size_are_hit_rightly) {
    const ScenePtr scene = squeezed_balls();
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
    expect_no_error(*make(kTwin, scene), scene, rays, "squeezed balls");
}

/// A sheet of 33 x 33 corners in the plane z = 0: its boxes are flat, and share their sides.
ScenePtr flat_sheet() {
    constexpr uint32_t kSide = 32;
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& sheet = scene.objects.front();
    sheet = Object{};
    for (uint32_t y = 0; y <= kSide; ++y) {
        for (uint32_t x = 0; x <= kSide; ++x) sheet.positions.push_back(vec3(x, y, 0.0f));
    }
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const uint32_t i = x + (kSide + 1) * y;
            sheet.triangles.push_back({i, i + 1, i + kSide + 2});
            sheet.triangles.push_back({i, i + kSide + 2, i + kSide + 1});
        }
    }
    sheet.groups = {{"all", 0, static_cast<uint32_t>(sheet.triangles.size())}};
    validate(scene);
    return share(std::move(scene));
}

TEST_F(BvhStrategy, rays_in_the_sides_of_boxes_and_with_components_of_zero_lose_nothing) {
    const ScenePtr scene = flat_sheet();
    std::vector<Ray> rays;
    for (int i = 0; i <= 64; ++i) {
        const float at = 0.5f * static_cast<float>(i);
        const vec3 corner(at, std::fmod(at * 5.0f, 32.0f), 0.0f);
        for (const vec3& dir : {vec3(0, 0, -1), vec3(0, -0.0f, 1), vec3(1e-30f, 0, 1e-3f),
                                vec3(1, 0, -1e-3f), vec3(-1e-38f, 1e-38f, 1), vec3(1, 3, -2)}) {
            rays.push_back({corner, 0.0f, dir, kInfinity});
            rays.push_back({corner - dir, 0.0f, dir, kInfinity});
            rays.push_back({corner - 37.0f * dir, 37.0f, dir, 37.0f});
        }
    }
    for (const char* entry : {kTwin, "bvh/buffer/fragment"}) {
        expect_no_error(*make(entry, scene), scene, rays, entry);
    }
}

TEST_F(BvhStrategy, a_ray_exactly_through_the_rim_of_a_surface_hits_it) {
    // From places and in directions that are exact, but whose quotients round.
    const ScenePtr scene = flat_sheet();
    std::vector<Ray> rays;
    for (int i = 0; i <= 32; ++i) {
        const float at = 0.96875f * static_cast<float>(i);
        for (const vec3& rim : {vec3(0, at, 0), vec3(32, at, 0), vec3(at, 0, 0), vec3(at, 32, 0)}) {
            for (int k = -9; k <= 9; ++k) {
                const vec3 dir(k, 9 - 2 * (k % 5), i % 2 ? 23 + k : -29 - k);
                rays.push_back({rim - 37.0f * dir, 0.0f, dir, kInfinity});
            }
        }
    }
    for (const char* entry : {kTwin, "bvh/buffer/fragment"}) {
        EXPECT_EQ(hit_count(cast(*make(entry, scene), rays).hits), rays.size()) << entry;
    }
}

TEST_F(BvhStrategy, neither_the_tree_nor_the_order_of_triangles_shows_in_a_hit) {
    // Every instance is there twice, so that each hit is a tie, beside those of shared corners.
    Scene scene = make_palace();
    const size_t once = scene.instances.size();
    for (size_t i = 0; i < once; ++i) scene.instances.push_back(scene.instances[i]);
    validate(scene);
    const ScenePtr doubled = share(scene);
    const std::vector<Ray> rays = rays_of_kind("vertex", scene, 48);
    const std::vector<Hit> hits = cast(*make(kTwin, doubled), rays).hits;
    for (const Hit& hit : hits) {
        if (!hit.is_hit()) continue;
        EXPECT_LT(hit.inst_id, once) << "of two the one of lower number";
    }
    EXPECT_GT(hit_count(hits), rays.size() / 2);
    for (const ParamValues& params : {ParamValues{{"leaf_size", "1"}},
                                      ParamValues{{"leaf_size", "15"}, {"test_cost", "0.1"}}}) {
        expect_same_bits(cast(*make(kTwin, doubled, params), rays).hits, hits, "another tree");
    }
}

TEST_F(BvhStrategy, hits_are_those_of_the_grid_bit_for_bit) {
    // From afar as well, where rays are moved before they are decided on.
    for (const Scene& made : {make_balls_1(), make_instances(), make_knife()}) {
        const ScenePtr scene = share(made);
        for (const char* kind : {"vertex", "edge", "random"}) {
            std::vector<Ray> rays = rays_of_kind(kind, *scene, 48);
            const size_t near = rays.size();
            for (size_t i = 0; i < near; ++i) {
                const vec3 way = rays[i].dir * (i % 2 == 0 ? 300.0f : 3e4f);
                rays.push_back({rays[i].org - way, 0.0f, rays[i].dir, kInfinity});
            }
            const std::vector<Hit> hits = cast(*make("grid/buffer/twin32", scene), rays).hits;
            EXPECT_GT(hit_count(hits), near / 2) << made.name << ", " << kind;
            expect_same_bits(cast(*make(kTwin, scene), rays).hits, hits, made.name + ", " + kind);
        }
    }
}

/// Sheets of one triangle each, nearer to each other than floats tell apart, and no two parallel:
/// so all but one are open. `is_alone`: in one instance; else between others.
ScenePtr crossing_sheets(bool is_alone) {
    constexpr int kSheets = 24;
    Scene scene = *ball_at(vec3(0.0f), 1.0f);
    Object& sheets = scene.objects.front();
    sheets = Object{};
    for (int k = 0; k < kSheets; ++k) {
        const float tilt = 1e-6f * static_cast<float>(7 * k % kSheets - kSheets / 2);
        const auto first = static_cast<uint32_t>(sheets.positions.size());
        sheets.positions.insert(sheets.positions.end(), {vec3(-3, -2, -tilt), vec3(3, -2, tilt),
                                                         vec3(0.1f * static_cast<float>(k), 4, 0)});
        sheets.triangles.push_back({first, first + 1, first + 2});
    }
    sheets.groups = {{"all", 0, kSheets}};
    if (!is_alone) {
        for (const float place : {-1.0f, 1.0f, 5.0f}) {
            scene.instances.push_back(scene.instances.front());
            scene.instances.back().world_from_object[3].z = place;
        }
    }
    validate(scene);
    return share(std::move(scene));
}

TEST_F(BvhStrategy, a_walk_with_no_room_for_another_open_triangle_is_taken_up_after_the_decision) {
    for (const bool is_alone : {true, false}) {
        const ScenePtr scene = crossing_sheets(is_alone);
        const size_t sheets = scene->objects[0].triangles.size();
        std::vector<Ray> rays;
        for (int i = 0; i < 200; ++i) {
            const vec3 target(0.01f * static_cast<float>(i % 100) - 0.5f,
                              0.013f * static_cast<float>(i % 71) - 0.5f, 0.0f);
            const vec3 dir(0.3f, 0.1f, i % 2 == 0 ? 1.0f : -1.0f);
            rays.push_back({target - 0.5f * dir, 0.0f, dir, kInfinity});
        }
        for (const char* entry : {kTwin, "bvh/buffer/fragment", "bvh/ssbo/compute"}) {
            for (const char* leaf_size : {"1", "4", "15"}) {
                const auto tracer = make(entry, scene, {{"leaf_size", leaf_size}});
                const std::string what =
                    std::string(entry) + (is_alone ? ", alone, leaves of " : ", leaves of ");
                expect_no_error(*tracer, scene, rays, what + leaf_size);
                // Each time a walk stops it tests one triangle again.
                const CastResult result = cast(*tracer, rays, {.counters = true});
                for (size_t i = 0; i < rays.size(); ++i) {
                    EXPECT_GT(result.counters[i].tests, sheets) << what << leaf_size;
                }
            }
        }
    }
}

TEST_F(BvhStrategy, a_hit_at_the_very_end_of_the_interval_is_decided_exactly) {
    const ScenePtr scene = ball_at(vec3(5.0f, 3.0f, -2.0f), 1.0f);
    const auto tracer = make(kTwin, scene);
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 2000, 21);
    const std::vector<Hit> hits = cast(*tracer, rays).hits;
    std::vector<Ray> cut;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].is_hit()) continue;
        for (const float t :
             {hits[i].t, std::nextafter(hits[i].t, 0.0f), std::nextafter(hits[i].t, kInfinity)}) {
            cut.push_back({rays[i].org, 0.0f, rays[i].dir, t});
            cut.push_back({rays[i].org, t, rays[i].dir, kInfinity});
        }
    }
    expect_no_error(*tracer, scene, cut, "cut rays");
}

TEST_F(BvhStrategy, a_ray_that_is_none_is_a_miss_and_visits_no_node) {
    const ScenePtr scene = share(make_instances());
    const vec3 centre = scene_bounds(*scene).centre();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays = {{centre, 0.0f, vec3(0.0f), kInfinity},
                             {centre, 2.0f, vec3(0, -1, 0), 1.0f},
                             {centre, nan, vec3(0, -1, 0), kInfinity},
                             {centre, 0.0f, vec3(0, nan, 0), kInfinity},
                             {vec3(kInfinity), 0.0f, vec3(0, -1, 0), kInfinity}};
    for (const char* entry : {kTwin, "bvh/buffer/twin64", "bvh/buffer/fragment"}) {
        const CastResult result = cast(*make(entry, scene), rays, {.counters = true});
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(result.hits[i], Hit{}) << entry << ", ray " << i;
            EXPECT_EQ(result.counters[i].cells, 0u) << entry << ", ray " << i;
        }
    }
}

const gl::StrategyInfo& bvh_info() {
    static const gl::ShaderLibrary kLibrary = gl::ShaderLibrary::embedded();
    static const std::vector<gl::StrategyInfo> kStrategies = kLibrary.strategies();
    return *std::find_if(kStrategies.begin(), kStrategies.end(),
                         [](const gl::StrategyInfo& info) { return info.name == "bvh"; });
}

TEST_F(BvhStrategy, one_instance_pays_for_no_top_level) {
    const ScenePtr one = ball_at(vec3(0.0f), 1.0f);
    const std::vector<Ray> rays = random_rays(scene_bounds(*one), 1000, 3);
    Scene two = *one;
    two.instances.push_back(two.instances.front());
    two.instances.back().world_from_object[3] = vec3(0, 0, 100);
    validate(two);
    const ScenePtr far_twin = share(std::move(two));
    const auto has_top_level = [](const ScenePtr& scene) {
        const PreparedStrategy prepared = prepare_strategy(bvh_info(), "buffer", scene, {}, {});
        for (const gl::ShaderConstant& constant : prepared.param_constants) {
            if (constant.name == "has_top_level") return std::get<bool>(constant.value);
        }
        throw std::runtime_error("no such constant");
    };
    EXPECT_FALSE(has_top_level(one));
    EXPECT_TRUE(has_top_level(far_twin));

    const CastResult alone = cast(*make(kTwin, one), rays, {.counters = true});
    const CastResult beside = cast(*make(kTwin, far_twin), rays, {.counters = true});
    expect_same_bits(alone.hits, beside.hits, "with a second ball far away");
    for (size_t i = 0; i < rays.size(); ++i) {
        EXPECT_LE(alone.counters[i].cells + 1, beside.counters[i].cells) << "ray " << i;
    }
}

TEST_F(BvhStrategy, a_buffer_that_the_device_cannot_hold_is_refused_by_name) {
    try {
        prepare_strategy(bvh_info(), "buffer", share(make_balls_1()), {},
                         {.limits = {.max_buffer = 1000}});
        FAIL() << "1000 texels were enough";
    } catch (const Error& error) {
        EXPECT_NE(error.parts().where.find("bvh_nodes"), std::string::npos) << error.what();
        EXPECT_NE(error.parts().expected.find("1000"), std::string::npos) << error.what();
    }
    EXPECT_THROW(make(kTwin, share(make_balls_1()), {{"leaf_size", "16"}}), Error);
}

TEST_F(BvhStrategy, what_a_walk_fetches_is_held_to_the_limit_of_its_own_storage) {
    const ScenePtr scene = share(make_balls_1());
    EXPECT_NO_THROW(
        prepare_strategy(bvh_info(), "ssbo", scene, {}, {.limits = {.max_buffer = 1000}}));
    EXPECT_NO_THROW(
        prepare_strategy(bvh_info(), "buffer", scene, {}, {.limits = {.max_block = 1000}}));
    EXPECT_THROW(prepare_strategy(bvh_info(), "ssbo", scene, {}, {.limits = {.max_block = 1000}}),
                 Error);
}

}  // namespace
}  // namespace onepass::test
