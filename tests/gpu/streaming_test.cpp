// Streaming: paper's hits and images to the bit, honest counts, and an end to its passes.
#include <algorithm>
#include <cstring>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/scene.h"
#include "gpu_glsl/gpu_tracer.h"
#include "gpu_glsl/prepared_strategy.h"
#include "gpu_glsl/streaming/streaming_tracer.h"
#include "tests/support/awkward_rays.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"fragment", "compute"};

/// All of paper's switches the other way.
const ParamValues kSwitched = {{"edge_tolerance", "1"},
                               {"clip_to_cell", "0"},
                               {"accumulate_ts", "0"},
                               {"step_ties", "0"},
                               {"guard_zero", "1"}};

/// Purcell's setting. Most tests use it, and so share their shaders: compiling these takes longer
/// than running them on a few rays.
const ParamValues kOneStep = {{"steps_per_pass", "1"}};

ParamValues with(ParamValues params, const std::string& name, const std::string& value) {
    params[name] = value;
    return params;
}

double cost(const std::vector<Stat>& costs, const std::string& name) {
    for (const Stat& stat : costs) {
        if (stat.name == name) return stat.value;
    }
    ADD_FAILURE() << "no cost '" << name << "'";
    return -1.0;
}

bool has_cost(const std::vector<Stat>& costs, const std::string& name) {
    return std::any_of(costs.begin(), costs.end(),
                       [&](const Stat& stat) { return stat.name == name; });
}

gl::StrategyInfo paper_of(const std::vector<gl::StrategyInfo>& strategies) {
    return *std::ranges::find(strategies, "paper", &gl::StrategyInfo::name);
}

/// Colours, normals and all else, bit by bit.
void expect_same_frames(const Frame& a, const Frame& b, const std::string& what) {
    const auto same_vectors = [](const std::vector<vec3>& x, const std::vector<vec3>& y) {
        return x.size() == y.size() &&
               (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(vec3)) == 0);
    };
    EXPECT_TRUE(same_vectors(a.color, b.color)) << what;
    EXPECT_TRUE(same_vectors(a.normals, b.normals)) << what;
    EXPECT_EQ(a.flags, b.flags) << what;
    EXPECT_EQ(a.counters, b.counters) << what;
    expect_same_bits(a.hits, b.hits, what);
}

/// Hits, flags and counters.
void expect_same_answers(const CastResult& a, const CastResult& b, const std::string& what) {
    expect_same_bits(a.hits, b.hits, what);
    EXPECT_EQ(a.flags, b.flags) << what;
    EXPECT_EQ(a.counters, b.counters) << what;
}

/// On a GPU the driver may round the two programs' arithmetic differently, so the promise of equal
/// bits is one for software renderers, as the twins' is.
class Streaming : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        if (!context->description().software) {
            GTEST_SKIP() << "bit-identity is promised on software renderers only";
        }
        catalogue = catalogue_of(context);
    }

    std::unique_ptr<Tracer> make(const std::string& strategy, const std::string& entry,
                                 const ScenePtr& scene, const ParamValues& params = {}) {
        return catalogue.at(strategy + "/texture2d/" + entry).make(scene, params);
    }

    Catalogue catalogue;
};

TEST_F(Streaming, casts_the_very_hits_of_paper) {
    for (const char* name : {"instances", "big-small", "balls-1"}) {
        const ScenePtr scene = share(load_scene(name).scene);
        std::vector<Ray> rays = primary_rays(*scene, 24, 24);
        for (const std::vector<Ray>& more :
             {random_rays(scene_bounds(*scene), 400, 7), awkward_rays(*scene)}) {
            rays.insert(rays.end(), more.begin(), more.end());
        }
        const std::pair<ParamValues, const char*> settings[] = {{{}, "1"}, {kSwitched, "7"}};
        for (const auto& [params, steps] : settings) {
            const auto paper = make("paper", "fragment", scene, params);
            const CastResult expected = cast(*paper, rays, {.counters = true});
            EXPECT_GT(hit_count(expected.hits), 200u);
            for (const char* entry : kEntries) {
                const auto streaming =
                    make("streaming", entry, scene, with(params, "steps_per_pass", steps));
                expect_same_answers(cast(*streaming, rays, {.counters = true}), expected,
                                    fmt::format("{} {} {}", name, entry, steps));
            }
        }
    }
}

TEST_F(Streaming, renders_the_very_image_of_paper) {
    const ScenePtr balls = share(make_balls_1());
    const ScenePtr instances = share(make_instances());
    struct Case {
        ScenePtr scene;
        ParamValues params;
        RenderSettings settings;
    };
    // Sizes that no group, row or tile divides.
    const Case cases[] = {
        {balls, kOneStep, {.width = 37, .height = 29}},
        {instances, kOneStep, {.width = 5, .height = 61, .max_depth = 0, .shadows = false}},
        {balls, {}, {.width = 37, .height = 29, .aovs = false}},
    };
    for (const Case& c : cases) {
        ParamValues paper_params = c.params;
        paper_params.erase("steps_per_pass");
        const Frame expected = make("paper", "fragment", c.scene, paper_params)
                                   ->render(c.scene->cameras.front(), c.settings);
        for (const char* entry : kEntries) {
            const Frame frame = make("streaming", entry, c.scene, c.params)
                                    ->render(c.scene->cameras.front(), c.settings);
            ASSERT_EQ(frame.color.size(), size_t{c.settings.width} * c.settings.height);
            expect_same_frames(frame, expected, fmt::format("{} {}", c.scene->name, entry));
        }
    }
}

TEST_F(Streaming, runs_out_of_budget_where_paper_does) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = primary_rays(*scene, 32, 32);
    const gl::ShaderLibrary library = gl::ShaderLibrary::embedded();
    const gl::StrategyInfo paper = paper_of(library.strategies());
    for (const float budget : {1.0f, 2.0f, 3.0f, 5.0f}) {
        const auto prepare = [&](const gl::StrategyInfo& info, const ParamValues& params) {
            PreparedStrategy prepared = prepare_strategy(info, "texture2d", scene, params, {});
            for (TextureData& texture : prepared.inputs.textures) {
                if (texture.name != "grids") continue;
                // The first texel of a record of four ends with the step budget.
                for (size_t i = 3; i < texture.texels.size(); i += 16) texture.texels[i] = budget;
            }
            return prepared;
        };
        const auto single =
            make_gpu_tracer("paper", prepare(paper, {}), GpuEntry::fragment, library, *context);
        const CastResult expected = cast(*single, rays, {.counters = true});
        EXPECT_GT(std::accumulate(expected.flags.begin(), expected.flags.end(), 0u), 0u);
        for (const GpuEntry entry : {GpuEntry::fragment, GpuEntry::compute}) {
            const auto many = make_streaming_tracer(
                "streaming", prepare(streaming_info(paper), kOneStep), entry, library, *context);
            expect_same_answers(cast(*many, rays, {.counters = true}), expected,
                                fmt::format("budget {}", budget));
        }
    }
}

TEST_F(Streaming, counts_what_its_passes_did) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = primary_rays(*scene, 48, 40);
    for (const char* entry : kEntries) {
        const auto one = make("streaming", entry, scene, kOneStep);
        const auto eight = make("streaming", entry, scene, {{"steps_per_pass", "8"}});
        const CastResult result = cast(*one, rays);
        const CastResult counted = cast(*one, rays, {.counters = true});
        const std::vector<Stat>& costs = result.costs;

        // With one triangle a pass, the intersect passes' rays are the triangle tests.
        uint64_t tests = 0;
        for (const RayCounters& counters : counted.counters) tests += counters.tests;
        EXPECT_EQ(cost(costs, "rays_intersect"), static_cast<double>(tests)) << entry;
        EXPECT_EQ(cost(costs, "rays_shade"), 0.0);

        // Bytes, by the layout in shared/streaming_layout.h: a control word 4, the walks 96, a ray
        // 32, a hit 24, of which t is in a texel of 16; queue entries 4.
        const double traversals = cost(costs, "rays_traverse");
        const double intersections = cost(costs, "rays_intersect");
        const bool fragment = std::string(entry) == "fragment";
        const double queue = fragment ? 0.0 : 4.0;
        // A fragment is a texel of textures of 1984 x 4 texels here; those beyond the last ray run
        // as well.
        const double slots = fragment ? 4 * 1984.0 : static_cast<double>(rays.size());
        const double masks = fragment ? cost(costs, "passes_mask") : 0.0;
        EXPECT_EQ(cost(costs, "state_bytes_read"), traversals * (4 + 96 + 32 + 16 + queue) +
                                                       intersections * (4 + 24 + 32 + 32 + queue) +
                                                       slots * (4 + 24) + slots * masks * 4);
        EXPECT_EQ(cost(costs, "state_bytes_written"), traversals * (96 + 4 + queue) +
                                                          intersections * (24 + 4 + queue) +
                                                          slots * 4 + slots * masks * 8);
        EXPECT_GT(cost(counted.costs, "state_bytes_read"), cost(costs, "state_bytes_read"));
        EXPECT_FALSE(has_cost(costs, "grid_bytes_read"));
        // A test alone reads 64 bytes.
        EXPECT_GT(cost(counted.costs, "grid_bytes_read"), 64.0 * static_cast<double>(tests));

        // More steps, fewer passes.
        const std::vector<Stat> fewer = cast(*eight, rays).costs;
        for (const char* name : {"passes", "passes_traverse", "passes_intersect", "rays_traverse",
                                 "rays_intersect", "state_bytes_read", "state_bytes_written"}) {
            EXPECT_LT(cost(fewer, name), cost(costs, name)) << entry << " " << name;
        }

        // Shading passes are an image's.
        const Frame frame = one->render(scene->cameras.front(), {.width = 32, .height = 24});
        uint64_t rays_cast = 0;
        for (const RayCounters& counters : frame.counters) rays_cast += counters.rays;
        EXPECT_EQ(cost(frame.costs, "rays_shade"), static_cast<double>(rays_cast));
        double sum = cost(frame.costs, fragment ? "passes_mask" : "passes_queue");
        for (const char* name : {"passes_traverse", "passes_intersect", "passes_shade"}) {
            EXPECT_GT(cost(frame.costs, name), 0.0);
            sum += cost(frame.costs, name);
        }
        EXPECT_EQ(cost(frame.costs, "passes"), sum + 2) << "generate and resolve are two more";
    }
}

TEST_F(Streaming, stops_soon_after_the_last_ray) {
    const ScenePtr scene = share(make_instances());
    const Bounds box = scene_bounds(*scene);
    const Ray away{box.upper + box.extent(), 0.0f, vec3(1, 1, 1), kInfinity};
    const Ray through{box.centre() - vec3(0, 0, 2) * box.diagonal(), 0.0f, vec3(0, 0, 1),
                      kInfinity};
    for (const char* entry : kEntries) {
        const auto tracer = make("streaming", entry, scene, kOneStep);
        const CastResult misses = cast(*tracer, std::vector<Ray>(100, away));
        EXPECT_EQ(hit_count(misses.hits), 0u);
        // One round does it; the rest is the delay until the CPU knows.
        EXPECT_LE(cost(misses.costs, "passes_traverse"), 8.0) << entry;
        EXPECT_LT(cost(misses.costs, "passes_traverse"),
                  cost(cast(*tracer, {through}).costs, "passes_traverse"));
        const CastResult nothing = cast(*tracer, {});
        EXPECT_TRUE(nothing.hits.empty());
        EXPECT_EQ(cost(nothing.costs, "passes"), 0.0);
    }
}

TEST_F(Streaming, can_be_used_again_and_between_runs_of_paper) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 1500, 4);
    const std::vector<Ray> few(rays.begin(), rays.begin() + 333);
    const RenderSettings settings{.width = 33, .height = 21};
    const Camera& camera = scene->cameras.front();
    for (const char* entry : kEntries) {
        const auto streaming = make("streaming", entry, scene, kOneStep);
        const auto paper = make("paper", entry, scene);
        const RayBatch all_rays = streaming->upload(rays);
        const CastResult expected = cast(*paper, rays);
        const Frame expected_frame = paper->render(camera, settings);
        for (int repetition = 0; repetition < 2; ++repetition) {
            expect_same_answers(streaming->cast(all_rays), expected, entry);
            expect_same_frames(streaming->render(camera, settings), expected_frame, entry);
            expect_same_answers(cast(*paper, rays), expected, entry);
            expect_same_answers(cast(*streaming, few), cast(*paper, few), entry);
            expect_same_frames(paper->render(camera, settings), expected_frame, entry);
        }
    }
}

TEST_F(Streaming, more_rays_than_may_be_in_flight_come_in_parts) {
    const ScenePtr scene = share(make_instances());
    const std::vector<Ray> rays = random_rays(scene_bounds(*scene), 1500, 6);
    const RenderSettings settings{.width = 30, .height = 31};
    const auto paper = make("paper", "fragment", scene);
    const gl::ShaderLibrary library = gl::ShaderLibrary::embedded();
    for (const GpuEntry entry : {GpuEntry::fragment, GpuEntry::compute}) {
        // Three batches of 500 rays; bands of 16 and 15 rows.
        constexpr size_t kInFlight = 500;
        const auto tracer =
            make_streaming_tracer("streaming",
                                  prepare_strategy(streaming_info(paper_of(library.strategies())),
                                                   "texture2d", scene, kOneStep, {}),
                                  entry, library, *context, kInFlight);
        expect_same_answers(cast(*tracer, rays), cast(*paper, rays), "rays");
        expect_same_frames(tracer->render(scene->cameras.front(), settings),
                           paper->render(scene->cameras.front(), settings), "pixels");
    }
}

TEST_F(Streaming, measuring_copies_changes_no_answer) {
    const ScenePtr scene = share(make_instances());
    const RenderSettings settings{.width = 40, .height = 30};
    for (const char* entry : kEntries) {
        const auto plain = make("streaming", entry, scene, kOneStep);
        const auto measured = make("streaming", entry, scene, with(kOneStep, "measure_copy", "1"));
        const Frame expected = plain->render(scene->cameras.front(), settings);
        const Frame frame = measured->render(scene->cameras.front(), settings);
        expect_same_frames(frame, expected, entry);
        for (const char* name : {"passes", "rays_traverse", "rays_shade", "state_bytes_read"}) {
            EXPECT_EQ(cost(frame.costs, name), cost(expected.costs, name)) << entry << name;
        }
        EXPECT_GT(cost(frame.costs, "copy_ms"), 0.0);
        EXPECT_GT(frame.wall_ms, 0.0);
        EXPECT_FALSE(has_cost(expected.costs, "copy_ms"));
    }
}

TEST_F(Streaming, refuses_what_it_cannot_do) {
    const ScenePtr scene = share(make_instances());
    for (const char* entry : kEntries) {
        EXPECT_THROW(make("streaming", entry, scene, {{"steps_per_pass", "0"}}), Error);
        EXPECT_THROW(make("streaming", entry, scene, {{"edge_tolerance", "wide"}}), Error);
        const auto tracer = make("streaming", entry, scene, kOneStep);
        EXPECT_THROW(tracer->update({}), Error);
        EXPECT_THROW(
            tracer->render(scene->cameras.front(), {.width = 8, .height = 8, .max_depth = 1000}),
            Error);
    }
}

}  // namespace
}  // namespace onepass::test
