// The paper's strategy: packing limits, budgets, bad rays, agreement with Embree, one file a
// strategy.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/error.h"
#include "cpu_ref/embree_tracer.h"
#include "gpu_glsl/gpu_tracer.h"
#include "gpu_glsl/prepared_strategy.h"
#include "gpu_glsl/twin_tracer.h"
#include "scenes/shapes.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"paper/texture2d/fragment", "paper/texture2d/compute",
                                    "paper/texture2d/twin32"};

class Paper : public GlTest {
  protected:
    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        return catalogue_of(context).at(name).make(scene, params);
    }
};

TEST_F(Paper, agrees_with_embree_but_for_its_known_deviations) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 20000, 11);
    const auto embree = embree_tracers().front().make(scene, {});
    const std::vector<Hit> truth = cast(*embree, rays).hits;
    for (const char* entry : kEntries) {
        const auto tracer = make(entry, scene, {{"edge_tolerance", "1"}, {"clip_to_cell", "0"}});
        const std::vector<Hit> hits = cast(*tracer, rays).hits;
        size_t same = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].prim_id == truth[i].prim_id && hits[i].inst_id == truth[i].inst_id) ++same;
        }
        // Without its slack the test is exact but for rounding at edges.
        EXPECT_GT(same, rays.size() * 9995 / 10000) << entry;
    }
}

TEST_F(Paper, answers_rays_that_are_not_finite_as_misses) {
    const ScenePtr scene = share(make_balls_1());
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const vec3 centre = scene_bounds(*scene).centre();
    const std::vector<Ray> rays = {
        {vec3(nan), 0.0f, vec3(0, 0, -1), kInfinity},
        {centre, 0.0f, vec3(nan), kInfinity},
        {centre, 0.0f, vec3(0.0f), kInfinity},
        {centre, nan, vec3(0, 0, -1), kInfinity},
        {centre, 2.0f, vec3(0, 0, -1), 1.0f},
        {vec3(kInfinity), 0.0f, vec3(0, 0, -1), kInfinity},
    };
    for (const char* entry : kEntries) {
        const CastResult result = cast(*make(entry, scene), rays);
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_FALSE(result.hits[i].is_hit()) << entry << ", ray " << i;
            EXPECT_TRUE(std::isinf(result.hits[i].t)) << entry << ", ray " << i;
        }
    }
}

TEST_F(Paper, the_printed_edge_slack_picks_wrong_triangles_and_exact_edges_do_not) {
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 20000, 5);
    const auto slack = cast(*make("paper/texture2d/twin32", scene), rays).hits;
    const auto exact =
        cast(*make("paper/texture2d/twin32", scene, {{"edge_tolerance", "1"}}), rays).hits;
    const auto truth = cast(*embree_tracers().front().make(scene, {}), rays).hits;
    size_t wrong_with_slack = 0;
    size_t wrong_without = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (slack[i].prim_id != truth[i].prim_id) ++wrong_with_slack;
        if (exact[i].prim_id != truth[i].prim_id) ++wrong_without;
    }
    EXPECT_GT(wrong_with_slack, 10 * (wrong_without + 1));
}

TEST_F(Paper, flags_a_ray_whose_step_budget_runs_out) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = primary_rays(*scene, 64, 64);
    const gl::ShaderLibrary library = gl::ShaderLibrary::embedded();
    const auto paper_with_one_step = [&] {
        const auto& known = library.strategies();
        const gl::StrategyInfo info = *std::find_if(
            known.begin(), known.end(), [](const auto& s) { return s.name == "paper"; });
        PreparedStrategy prepared = prepare_strategy(info, "texture2d", scene, {}, {});
        for (TextureData& texture : prepared.inputs.textures) {
            if (texture.name == "grids") texture.texels[3] = 1.0f;  // the top grid's step budget
        }
        return prepared;
    };
    for (const GpuEntry entry : {GpuEntry::fragment, GpuEntry::compute}) {
        const auto tracer =
            make_gpu_tracer("paper", paper_with_one_step(), entry, library, *context);
        const CastResult result = cast(*tracer, rays);
        size_t flagged = 0;
        for (const uint32_t flags : result.flags) flagged += (flags & kFlagExhausted) != 0;
        EXPECT_GT(flagged, 100u);
    }
    const CastResult sound = cast(*make("paper/texture2d/fragment", scene), rays);
    for (const uint32_t flags : sound.flags) EXPECT_EQ(flags & kFlagExhausted, 0u);
}

/// The message's parts for a scene that does not fit, or empty if it does.
Error::Parts refusal(const std::function<void()>& make_tracer) {
    try {
        make_tracer();
    } catch (const Error& error) {
        return error.parts();
    }
    return {};
}

TEST_F(Paper, refuses_what_half_addresses_cannot_reach_and_takes_it_with_float_ones) {
    // 300,000 triangles: 1.2 million texels, beyond 1024 x 1024.
    Scene scene;
    scene.objects.push_back(make_sphere(400, 376));
    scene.instances.push_back({.name = "sphere", .object = 0, .materials = {0}});
    scene.materials.push_back({});
    scene.cameras.push_back(automatic_camera(scene_bounds(scene)));
    scene.lights.push_back({});
    const ScenePtr shared = share(scene);
    const Error::Parts parts = refusal([&] {
        make("paper/texture2d/twin32", shared, {{"address", "half"}});
    });
    EXPECT_NE(parts.where.find("triangles"), std::string::npos) << parts.where;
    EXPECT_NE(parts.remedy.find("address=float"), std::string::npos) << parts.remedy;
    for (const char* address : {"float", "auto"}) {
        const auto tracer = make("paper/texture2d/twin32", shared, {{"address", address}});
        EXPECT_GT(hit_count(cast(*tracer, primary_rays(*shared, 32, 32)).hits), 100u);
    }
}

TEST_F(Paper, refuses_grids_that_do_not_fit_the_cell_texture) {
    const ScenePtr scene = share(make_big_small());
    const Error::Parts parts = refusal([&] {
        make("paper/texture2d/fragment", scene, {{"atlas", "16"}, {"resolution", "40x40x40"}});
    });
    EXPECT_NE(parts.where.find("cells"), std::string::npos);
    EXPECT_NE(parts.remedy.find("atlas"), std::string::npos);
}

TEST_F(Paper, half_and_float_addresses_give_the_same_hits) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 20000, 2);
    for (const char* entry : kEntries) {
        expect_same_bits(cast(*make(entry, scene, {{"address", "half"}}), rays).hits,
                         cast(*make(entry, scene, {{"address", "float"}}), rays).hits, entry);
    }
}

TEST_F(Paper, rejects_parameters_it_does_not_know_or_cannot_use) {
    const ScenePtr scene = share(make_instances());
    for (const ParamValues& params :
         {ParamValues{{"no-such", "1"}}, ParamValues{{"density", "-1"}},
          ParamValues{{"density", "many"}}, ParamValues{{"resolution", "3x4"}},
          ParamValues{{"address", "double"}}, ParamValues{{"atlas", "3"}}}) {
        EXPECT_THROW(make("paper/texture2d/twin32", scene, params), Error) << params.begin()->first;
    }
}

TEST_F(Paper, a_new_strategy_is_one_new_file) {
    // The file: another name and another default, the rest the paper's.
    std::map<std::string, std::string> files = gl::ShaderLibrary::embedded().files();
    std::string text = files.at("strategies/paper.glsl");
    const auto replace = [&](const std::string& from, const std::string& to) {
        const size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
    };
    replace("strategy: paper", "strategy: paper_exact");
    replace("edge_tolerance real 1.004", "edge_tolerance real 1.0");
    replace("twin: yes", "twin: none read at run time");
    files["strategies/paper_exact.glsl"] = text;

    const Catalogue catalogue = catalogue_of(context, gl::ShaderLibrary(files));
    const ScenePtr scene = share(make_balls_1());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 5000, 9);
    const auto added = catalogue.at("paper_exact/texture2d/compute").make(scene, {});
    const auto paper = catalogue.at("paper/texture2d/compute").make(scene, {});
    const auto paper_exact =
        catalogue.at("paper/texture2d/compute").make(scene, {{"edge_tolerance", "1"}});
    expect_same_bits(cast(*added, rays).hits, cast(*paper_exact, rays).hits, "the new strategy");
    EXPECT_GT(bit_difference(cast(*added, rays).hits, cast(*paper, rays).hits).count, 0u);
}

TEST_F(Paper, a_strategy_file_that_promises_a_twin_which_was_not_built_is_refused) {
    std::map<std::string, std::string> files = gl::ShaderLibrary::embedded().files();
    std::string text = files.at("strategies/paper.glsl");
    text.replace(text.find("strategy: paper"), 15, "strategy: other");
    files["strategies/other.glsl"] = text;
    EXPECT_THROW(catalogue_of(context, gl::ShaderLibrary(files)), Error);
}

TEST_F(Paper, rays_are_answered_in_order_over_several_rows_and_batches) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 3001, 4);
    for (const char* entry : kEntries) {
        const auto tracer = make(entry, scene);
        const std::vector<Hit> together = cast(*tracer, rays).hits;
        ASSERT_EQ(together.size(), rays.size());
        const std::vector<Ray> tail(rays.begin() + 1500, rays.end());
        const std::vector<Hit> apart = cast(*tracer, tail).hits;
        expect_same_bits({together.begin() + 1500, together.end()}, apart, entry);
        EXPECT_TRUE(cast(*tracer, {}).hits.empty());
    }
}

}  // namespace
}  // namespace onepass::test
