// The paper's claims as switches: variants that must change the cost and not the hits, and those
// that must change the hits.
#include <cmath>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "cpu_ref/embree_tracer.h"
#include "gpu_glsl/pack/two_level_variants.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/shapes.h"
#include "tests/support/errors.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kStages[] = {"fragment", "compute", "twin32"};

const ParamValues kAllMended = {
    {"edge_tolerance", "1"}, {"clip_to_cell", "0"}, {"accumulate_ts", "0"}, {"step_ties", "0"},
    {"guard_zero", "1"},     {"local_planes", "1"}, {"edge_slack", "3"}};

/// One scene of each kind, and all deviations off where instances are turned, stretched and
/// mirrored. The two small grids of big-small lie side by side: a cell texture that is no cube.
std::vector<std::pair<std::string, ParamValues>> cases() {
    return {{"instances", {}},
            {"instances", kAllMended},
            {"big-small", {{"resolution", "12x12x12"}}},
            {"bunny", {}}};
}

ParamValues with(ParamValues params, const std::string& name, const std::string& value) {
    params[name] = value;
    return params;
}

ScenePtr one_object(Object object, const Affine& world_from_object = affine_identity()) {
    Scene scene;
    scene.objects.push_back(std::move(object));
    scene.instances.push_back(
        {.name = "only", .object = 0, .world_from_object = world_from_object, .materials = {0}});
    scene.materials.push_back({});
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    scene.lights.push_back({});
    return share(scene);
}

double stat(const Tracer& tracer, const std::string& name) {
    for (const Stat& s : tracer.stats()) {
        if (s.name == name) return s.value;
    }
    ADD_FAILURE() << "no statistic '" << name << "'";
    return 0.0;
}

class Variants : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (!IsSkipped() && !HasFatalFailure()) catalogue = catalogue_of(context);
    }

    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        return catalogue.at(name).make(scene, params);
    }

    /// Hits, flags and counts of two tracers are the same on rays from the camera and at random.
    void expect_same(Tracer& a, Tracer& b, const Scene& scene, const std::string& what) {
        for (const std::vector<Ray>& rays :
             {primary_rays(scene, 64, 64), random_rays(scene_bounds(scene), 6000, 7)}) {
            const CastResult of_a = cast(a, rays, {.counters = true});
            const CastResult of_b = cast(b, rays, {.counters = true});
            expect_same_bits(of_a.hits, of_b.hits, what);
            EXPECT_EQ(of_a.flags, of_b.flags) << what;
            EXPECT_EQ(of_a.counters, of_b.counters) << what;
            EXPECT_GT(hit_count(of_a.hits), 1000u) << what;
        }
    }

    Catalogue catalogue;  ///< its shader library must outlive the tracers
};

TEST_F(Variants, paper_claims_with_its_defaults_is_paper_bit_for_bit) {
    for (const auto& [scene_name, params] : cases()) {
        const ScenePtr scene = share(load_scene(scene_name).scene);
        for (const std::string stage : kStages) {
            expect_same(*make("paper/texture2d/" + stage, scene, params),
                        *make("paper_claims/texture2d/" + stage, scene, params), *scene,
                        scene_name + " " + stage);
        }
    }
}

TEST_F(Variants, copied_triangles_and_virtual_arrays_give_the_same_hits_bit_for_bit) {
    for (const auto& [scene_name, params] : cases()) {
        const ScenePtr scene = share(load_scene(scene_name).scene);
        for (const std::string stage : kStages) {
            const auto direct = make("paper_claims/texture2d/" + stage, scene, params);
            for (const std::string storage : {"/texture2d_copies/", "/texture2d_virtual/"}) {
                expect_same(*direct, *make("paper_claims" + storage + stage, scene, params), *scene,
                            scene_name + storage + stage);
            }
        }
    }
}

TEST_F(Variants, the_order_of_loops_and_tests_changes_no_hit) {
    const ScenePtr scene = share(make_instances());
    for (const std::string tracer :
         {"paper_claims/texture2d/fragment", "paper_claims/texture2d/compute",
          "paper_claims/texture2d_copies/fragment"}) {
        const auto plain = make(tracer, scene);
        for (const auto& [param, value] : {std::pair{"top_loop", "nested"},
                                           {"triangle_test", "sequential"},
                                           {"triangle_test", "early_out"}}) {
            expect_same(*plain, *make(tracer, scene, {{param, value}}), *scene,
                        tracer + " " + value);
        }
    }
}

TEST_F(Variants, built_in_dot_products_differ_by_rounding_alone) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 20000, 3);
    const std::vector<Hit> sums = cast(*make("paper_claims/texture2d/fragment", scene), rays).hits;
    size_t changed = 0;
    for (const char* vectors : {"4d", "3d"}) {
        const std::vector<Hit> dots =
            cast(*make("paper_claims/texture2d/fragment", scene, {{"vectors", vectors}}), rays)
                .hits;
        changed += bit_difference(sums, dots).count;
        size_t other_triangle = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            other_triangle += sums[i].prim_id != dots[i].prim_id;
            if (sums[i].prim_id != dots[i].prim_id || !sums[i].is_hit()) continue;
            // Both are a quotient of sums of terms as large as the scene: 2^-20 of it.
            EXPECT_NEAR(sums[i].t, dots[i].t, 1e-4f) << vectors << ", ray " << i;
        }
        // Only rays at an edge, a crack or the border of the slack can change sides.
        EXPECT_LE(other_triangle, rays.size() / 2000) << vectors;
    }
    if (context->description().software) {
        EXPECT_GT(changed, 0u) << "llvmpipe's dot() sums in another order";
    }
}

TEST_F(Variants, copies_cost_memory_for_triangles_and_save_references) {
    const ScenePtr scene = share(make_balls_1());
    const auto shared = make("paper_claims/texture2d/fragment", scene, {{"address", "float"}});
    const auto copies = make("paper_claims/texture2d_copies/fragment", scene);
    const auto arrays = make("paper_claims/texture2d_virtual/fragment", scene);
    // Every reference of an object grid has become a record of four texels of 16 bytes.
    const double top_references = stat(*copies, "reference_bytes") / 8;
    EXPECT_GE(stat(*copies, "triangle_bytes"), (stat(*shared, "references") - top_references) * 64);
    EXPECT_GT(stat(*copies, "device_bytes"), stat(*shared, "device_bytes"));
    EXPECT_LT(stat(*copies, "reference_bytes"), stat(*shared, "reference_bytes") / 10);
    // An index takes half of two coordinates; and the top level needs no row of its own.
    constexpr double kLongestRow = 1024 * 8;
    EXPECT_LE(stat(*arrays, "reference_bytes"), stat(*shared, "reference_bytes") / 2);
    EXPECT_GE(stat(*arrays, "reference_bytes"),
              (stat(*shared, "reference_bytes") - kLongestRow) / 2);
    EXPECT_EQ(stat(*arrays, "triangle_bytes"), stat(*shared, "triangle_bytes"));
}

// ---- What does not fit -------------------------------------------------------------------------

/// paper_claims packed for a device with 2D textures of that many texels a side.
PreparedStrategy prepare_claims(const std::string& storage, const ScenePtr& scene,
                                uint32_t max_2d) {
    for (const gl::StrategyInfo& info : gl::ShaderLibrary::embedded().strategies()) {
        if (info.name != "paper_claims") continue;
        return prepare_strategy(info, storage, scene, {}, {.limits = {.max_2d = max_2d}});
    }
    throw std::runtime_error("no paper_claims strategy");
}

TEST(VariantLimits, copies_that_exceed_the_device_are_refused_where_shared_triangles_fit) {
    const ScenePtr scene = share(make_big_small());
    const uint32_t small_device = 512;
    EXPECT_NO_THROW(prepare_claims("texture2d", scene, small_device));
    const Error error = error_of([&] { prepare_claims("texture2d_copies", scene, small_device); });
    EXPECT_TRUE(is_clear(error));
    EXPECT_TRUE(contains(error.parts().where, "triangles"));
    EXPECT_TRUE(contains(error.parts().got, "copies"));
    EXPECT_TRUE(contains(error.parts().remedy, "density"));
}

TEST(VariantLimits, tables_that_a_float_index_cannot_count_are_refused) {
    const ScenePtr scene = share(make_balls_1());
    TwoLevelTexturesOptions options;
    options.address = AddressWidth::single;
    const auto packed = [&] {
        return pack_two_level_textures(*scene, build_two_level_grid(*scene, {}), options);
    };
    EXPECT_NO_THROW(with_virtual_arrays(*scene, packed(), {}));
    for (const char* table : {"cells", "triangles"}) {
        TwoLevelTextures large = packed();
        large.inputs.texture(table).size = uvec3(8192, 4096, 1);  // 2^25 texels, none of them read
        const Error error = error_of([&] { with_virtual_arrays(*scene, std::move(large), {}); });
        EXPECT_TRUE(is_clear(error));
        EXPECT_TRUE(contains(error.parts().where, table));
        EXPECT_TRUE(contains(error.parts().expected, "16777216"));
    }
}

// ---- Switches that change hits -----------------------------------------------------------------

TEST_F(Variants, half_geometry_leaves_holes_and_takes_half_the_memory) {
    const ScenePtr scene = share(load_scene("bunny").scene);
    const std::vector<Ray> rays = primary_rays(*scene, 128, 128);
    for (const std::string stage : kStages) {
        const auto single = make("paper/texture2d/" + stage, scene);
        const auto half = make("paper/texture2d/" + stage, scene, {{"geometry", "half"}});
        EXPECT_EQ(stat(*half, "triangle_bytes"), stat(*single, "triangle_bytes") / 2);
        const std::vector<Hit> whole = cast(*single, rays).hits;
        const std::vector<Hit> holed = cast(*half, rays).hits;
        // Through a hole one sees what lies behind, or nothing.
        size_t holes = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            holes += whole[i].is_hit() && holed[i].t > whole[i].t * 1.05f;
        }
        EXPECT_GT(holes, hit_count(whole) / 1000) << stage;
        EXPECT_GT(hit_count(holed), hit_count(whole) / 2) << stage;
    }
}

/// Rays on which `hits` name another triangle than the truth, or a t more than 16 ulps from it.
size_t wrong_rays(const std::vector<Hit>& hits, const std::vector<Hit>& truth) {
    size_t count = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        const bool same = hits[i].prim_id == truth[i].prim_id;
        const float bound = truth[i].t * (16 * 0x1p-23f);
        count += !same || std::abs(hits[i].t - truth[i].t) > bound;
    }
    return count;
}

TEST_F(Variants, planes_in_absolute_coordinates_lose_digits_far_from_the_origin) {
    // A sphere that lies 100 of its diameters from its object's origin.
    Object sphere = make_sphere(64, 64);
    for (vec3& p : sphere.positions) p += vec3(200.0f, -100.0f, 50.0f);
    const ScenePtr scene = one_object(std::move(sphere));
    const std::vector<Ray> rays = primary_rays(*scene, 100, 100);
    const auto truth = cast(*embree_tracers().front().make(scene, {}), rays).hits;
    const ParamValues exact = {{"edge_tolerance", "1"}, {"clip_to_cell", "0"}};
    for (const std::string stage : {"fragment", "compute", "twin32"}) {
        const auto absolute = cast(*make("paper/texture2d/" + stage, scene, exact), rays).hits;
        const auto local =
            cast(*make("paper/texture2d/" + stage, scene, with(exact, "local_planes", "1")), rays)
                .hits;
        EXPECT_GT(wrong_rays(absolute, truth), 10 * (wrong_rays(local, truth) + 1)) << stage;
    }
}

TEST_F(Variants, edges_without_slack_crack_and_slack_in_units_of_rounding_closes_them) {
    // Rays from outside a closed sphere to points of its edges: a miss is a crack.
    const ScenePtr scene = one_object(make_sphere(200, 100));
    const Object& sphere = scene->objects[0];
    const Bounds box = scene_bounds(*scene);
    Random random(17);
    std::vector<Ray> rays;
    while (rays.size() < 40000) {
        const uvec3 t = sphere.triangles[random.below(sphere.triangles.size())];
        const auto s = static_cast<float>(random.unit());
        const vec3 on_edge = sphere.positions[t.x] * (1.0f - s) + sphere.positions[t.y] * s;
        const vec3 outside = on_edge * 3.0f + vec3(0.3f, -0.2f, 0.1f) * box.diagonal();
        rays.push_back({outside, 0.0f, (on_edge - outside) * 0.9f, kInfinity});
    }
    const ParamValues exact = {{"edge_tolerance", "1"}, {"clip_to_cell", "0"}};
    for (const std::string stage : {"fragment", "compute", "twin32"}) {
        const auto cracked = cast(*make("paper/texture2d/" + stage, scene, exact), rays).hits;
        const auto closed =
            cast(*make("paper/texture2d/" + stage, scene, with(exact, "edge_slack", "3")), rays)
                .hits;
        // A ray that slips in through a crack hits the sphere from within, farther on.
        const auto passed = [&](const std::vector<Hit>& hits) {
            size_t count = 0;
            for (const Hit& hit : hits) count += !(hit.t < 1.12f);
            return count;
        };
        EXPECT_GT(passed(cracked), 0u) << stage;
        EXPECT_EQ(passed(closed), 0u) << stage;
    }
}

}  // namespace
}  // namespace onepass::test
