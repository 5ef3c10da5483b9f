// Moving instances: a tracer that was updated answers like one made of the moved scene, bit by bit,
// and rebuilds nothing but the top level.
#include <cmath>
#include <functional>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/grid/uniform_grid.h"
#include "gpu_glsl/prepared_strategy.h"
#include "scenes/motions.h"
#include "tests/support/strategy_fixture.h"

namespace onepass::test {
namespace {

constexpr const char* kEntries[] = {"paper/texture2d/fragment", "paper/texture2d/compute",
                                    "paper/texture2d/twin32"};

/// Where the top level has buffers of its own.
constexpr const char* kBufferEntries[] = {"grid/buffer/fragment", "grid/buffer/compute",
                                          "grid/buffer/twin32"};
constexpr const char* kAllEntries[] = {"paper/texture2d/fragment", "paper/texture2d/compute",
                                       "paper/texture2d/twin32",   "grid/buffer/fragment",
                                       "grid/buffer/compute",      "grid/buffer/twin32"};

using Transforms = std::vector<Affine>;

/// The scene as it is once its instances have moved there.
ScenePtr moved(const Scene& scene, const Transforms& transforms) {
    Scene result = scene;
    for (size_t i = 0; i < transforms.size(); ++i) {
        result.instances[i].world_from_object = transforms[i];
    }
    return share(std::move(result));
}

Transforms transforms_of(const Scene& scene) {
    Transforms transforms;
    for (const Instance& instance : scene.instances) {
        transforms.push_back(instance.world_from_object);
    }
    return transforms;
}

/// The instances with their places taken to `place(centre, index)` and their sizes times `scale`.
Transforms placed(const Scene& scene, const std::function<vec3(vec3, size_t)>& place,
                  float scale = 1.0f) {
    Transforms transforms = transforms_of(scene);
    for (size_t i = 0; i < transforms.size(); ++i) {
        Affine& m = transforms[i];
        m = Affine(m[0] * scale, m[1] * scale, m[2] * scale, place(m[3], i));
    }
    return transforms;
}

/// Behind each other along x, a little above each other.
Transforms in_a_line(const Scene& scene) {
    const Bounds box = scene_bounds(scene);
    return placed(scene, [&](vec3, size_t i) {
        return vec3(0.05f * box.diagonal() * static_cast<float>(i), 0.01f * static_cast<float>(i),
                    0.0f);
    });
}

/// Rays that see the moved scene: primary ones, and random ones through its box.
std::vector<Ray> rays_of(const Scene& scene) {
    Scene seen = scene;
    seen.cameras = {automatic_camera(scene_bounds(scene))};
    std::vector<Ray> rays = primary_rays(seen, 48, 48);
    const std::vector<Ray> random = random_rays(scene_bounds(scene), 3000, 17);
    rays.insert(rays.end(), random.begin(), random.end());
    return rays;
}

double stat(const Tracer& tracer, const std::string& name) {
    for (const Stat& stat : tracer.stats()) {
        if (stat.name == name) return stat.value;
    }
    ADD_FAILURE() << "no statistic '" << name << "'";
    return std::nan("");
}

void expect_same_answers(Tracer& updated, Tracer& fresh, const Scene& scene,
                         const std::string& what) {
    const std::vector<Ray> rays = rays_of(scene);
    const CastResult ours = cast(updated, rays, {.counters = true});
    const CastResult theirs = cast(fresh, rays, {.counters = true});
    expect_same_bits(ours.hits, theirs.hits, what);
    EXPECT_TRUE(ours.flags == theirs.flags) << what;
    EXPECT_TRUE(ours.counters == theirs.counters) << what;
    EXPECT_GT(hit_count(ours.hits), 50u) << what;
    for (const Stat& own : updated.stats()) {
        // Times differ, and what counts builds, repacks and the room they left.
        const bool is_size = own.name == "cells" || own.name == "references" ||
                             own.name == "longest_list" || own.name.starts_with("top_cells") ||
                             own.name.starts_with("top_references");
        if (!is_size) continue;
        EXPECT_EQ(own.value, stat(fresh, own.name)) << what << ", " << own.name;
    }
}

class Moving : public GlTest {
  protected:
    void SetUp() override {
        GlTest::SetUp();
        if (context) catalogue = catalogue_of(context);
    }

    std::unique_ptr<Tracer> make(const std::string& name, const ScenePtr& scene,
                                 const ParamValues& params = {}) {
        return catalogue.at(name).make(scene, params);
    }

    /// Moves one tracer of each entry through all these places, and compares at each.
    void follow(const Scene& scene, const std::vector<Transforms>& places,
                const ParamValues& params, std::span<const char* const> entries = kEntries) {
        for (const char* entry : entries) {
            const auto tracer = make(entry, share(scene), params);
            for (size_t i = 0; i < places.size(); ++i) {
                const ScenePtr there = moved(scene, places[i]);
                tracer->update(places[i]);
                expect_same_answers(*tracer, *make(entry, there, params), *there,
                                    std::string(entry) + ", place " + std::to_string(i));
            }
        }
    }

    Catalogue catalogue;  ///< holds the shaders that tracers refer to
};

TEST_F(Moving, an_updated_tracer_answers_like_a_new_one_at_every_frame) {
    const Scene swarm = make_swarm(60, 3);
    std::vector<Transforms> frames;
    for (const double time_s : {0.25, 0.9, 1.6, 0.0}) {
        frames.push_back(instance_transforms(swarm, time_s));
    }
    ASSERT_NE(frames[0], frames[1]);
    follow(swarm, frames, {});
    follow(swarm, frames, {{"clip_to_cell", "0"}, {"accumulate_ts", "0"}, {"address", "float"}});
    // The object's grid takes 3 of 4 blocks on each axis: the top level lies between.
    follow(swarm, frames, {{"density", "200"}, {"top_density", "20"}});
}

TEST_F(Moving, buffers_of_the_top_level_are_made_anew_at_every_move) {
    const Scene swarm = make_swarm(60, 3);
    const std::vector<Transforms> places = {
        instance_transforms(swarm, 0.9), in_a_line(swarm), transforms_of(swarm),
        placed(swarm, [](vec3 p, size_t) { return p + vec3(1e4f, 0.0f, -3e3f); })};
    follow(swarm, places, {}, kBufferEntries);
    follow(swarm, places, {{"density", "200"}, {"top_density", "20"}}, kBufferEntries);

    Scene scene = make_instances();  // of several objects
    scene.animation = swarm.animation;
    follow(scene, {placed(scene, [](vec3 p, size_t) { return p * 3.0f; }), transforms_of(scene)},
           {{"top_density", "40"}}, kBufferEntries);
}

TEST_F(Moving, several_objects_keep_their_places_while_the_top_level_changes) {
    Scene scene = make_instances();
    scene.animation = make_swarm(1, 1).animation;  // any: it is what lets a tracer move
    const Bounds box = scene_bounds(scene);
    follow(scene,
           {placed(scene, [](vec3 p, size_t) { return p * 3.0f; }),
            placed(scene,
                   [&](vec3 p, size_t i) {
                       return p + vec3(0, box.diagonal() * static_cast<float>(i), 0);
                   }),
            transforms_of(scene)},
           {{"top_density", "40"}});
}

TEST_F(Moving, a_top_level_that_outgrows_its_room_is_packed_into_more_and_stays_there) {
    const Scene swarm = make_swarm(60, 5);
    const ParamValues params = {{"top_density", "3"}};
    const Transforms compact = transforms_of(swarm);
    const Transforms line = in_a_line(swarm);
    const Transforms huge = placed(
        swarm, [](vec3 p, size_t) { return p; }, 12.0f);
    follow(swarm, {compact, line, huge, compact, line}, params);

    for (const char* entry : kEntries) {
        const auto tracer = make(entry, share(swarm), params);
        const double object_builds = stat(*tracer, "object_builds");
        const double bytes_at_first = stat(*tracer, "cell_bytes");
        tracer->update(compact);
        EXPECT_EQ(stat(*tracer, "repacks"), 0.0) << entry;
        tracer->update(line);
        EXPECT_EQ(stat(*tracer, "repacks"), 1.0) << entry << ": more cells on an axis";
        EXPECT_GT(stat(*tracer, "cell_bytes"), bytes_at_first) << entry;
        tracer->update(huge);
        EXPECT_EQ(stat(*tracer, "repacks"), 2.0) << entry << ": more references";
        for (const Transforms& again : {compact, line, huge}) tracer->update(again);
        EXPECT_EQ(stat(*tracer, "repacks"), 2.0) << entry << ": there is room by now";
        EXPECT_EQ(stat(*tracer, "object_builds"), object_builds) << entry;
    }
}

PreparedStrategy prepare_paper(const ScenePtr& scene, const ParamValues& params) {
    for (const gl::StrategyInfo& info : gl::ShaderLibrary::embedded().strategies()) {
        if (info.name == "paper") return prepare_strategy(info, "texture2d", scene, params, {});
    }
    throw std::runtime_error("no paper strategy");
}

/// Where the grids lie in the cell texture, in cells: lower ends of their boxes, then upper ones.
std::vector<vec3> places_of_grids(const ShaderInputs& inputs, size_t grid_count) {
    const TextureData& grids = inputs.texture("grids");
    const vec3 size(inputs.texture("cells").size);
    std::vector<vec3> places;
    for (const size_t texel : {2, 3}) {
        for (size_t k = 0; k < grid_count; ++k) {
            const float* at = &grids.texels[4 * (4 * k + texel)];
            places.push_back(vec3(at[0], at[1], at[2]) * size);
        }
    }
    return places;
}

TEST(MovingTopLevel, lies_where_a_new_packing_puts_it_whatever_lay_there_before) {
    const Scene swarm = make_swarm(60, 5);
    const Transforms compact = transforms_of(swarm);
    const Transforms line = in_a_line(swarm);
    // Small objects, which the top level lies beside; a large one with free blocks around it.
    for (const char* density : {"5", "200"}) {
        const ParamValues params = {{"density", density}, {"top_density", "20"}};
        PreparedStrategy updated = prepare_paper(share(swarm), params);
        for (const Transforms& place : {compact, line, compact, line}) {
            commit_move(updated, plan_move(updated, place));
            const PreparedStrategy fresh = prepare_paper(moved(swarm, place), params);
            const size_t grids = 1 + swarm.objects.size();
            EXPECT_EQ(places_of_grids(updated.inputs, grids), places_of_grids(fresh.inputs, grids))
                << "density " << density;
        }
    }
}

TEST_F(Moving, half_addresses_give_way_to_float_ones_when_the_references_grow_beyond_them) {
    // 1,100 instances over 1,000 cells each: more references than 1024 x 1024 texels hold.
    const Scene swarm = make_swarm(1100, 5);
    const ParamValues params = {{"top_resolution", "10x10x10"}};
    const Transforms heap = placed(swarm, [](vec3 p, size_t) { return p * 1e-3f; });
    const ScenePtr there = moved(swarm, heap);
    for (const char* entry : {"paper/texture2d/fragment", "paper/texture2d/twin32"}) {
        const auto tracer = make(entry, share(swarm), params);
        ASSERT_EQ(stat(*tracer, "address_bits"), 16.0);
        tracer->update(heap);
        EXPECT_EQ(stat(*tracer, "address_bits"), 32.0);
        const std::vector<Ray> rays = random_rays(scene_bounds(*there), 300, 17);
        expect_same_bits(cast(*tracer, rays).hits, cast(*make(entry, there, params), rays).hits,
                         entry);

        const ParamValues half = {{"address", "half"}, {"top_resolution", "10x10x10"}};
        EXPECT_THROW(make(entry, share(swarm), half)->update(heap), Error);
    }
}

TEST_F(Moving, updates_rebuild_the_top_level_and_no_object_grid) {
    const Scene swarm = make_swarm(40, 2);
    for (const char* entry : kAllEntries) {
        const auto tracer = make(entry, share(swarm));
        EXPECT_EQ(stat(*tracer, "object_builds"), static_cast<double>(swarm.objects.size()));
        EXPECT_EQ(stat(*tracer, "top_builds"), 1.0);
        const double object_builds = stat(*tracer, "object_builds");
        const uint64_t built_in_process = triangle_grids_built();
        constexpr int kFrames = 48;
        for (int frame = 0; frame < kFrames; ++frame) {
            const UpdateTimes times =
                tracer->update(instance_transforms(swarm, 2.0 * frame / kFrames));
            EXPECT_GT(times.update_ms, 0.0);
            EXPECT_GE(times.upload_ms, 0.0);
        }
        EXPECT_EQ(stat(*tracer, "object_builds"), object_builds) << entry;
        EXPECT_EQ(triangle_grids_built(), built_in_process) << entry;
        EXPECT_EQ(stat(*tracer, "top_builds"), 1.0 + kFrames) << entry;
    }
}

TEST_F(Moving, a_frame_rendered_after_an_update_is_that_of_a_new_tracer) {
    Scene swarm = make_swarm(60, 9);
    swarm.materials.front().reflectivity = 0.5f;
    const RenderSettings settings{.width = 48, .height = 40};
    const ParamValues params = {{"top_density", "3"}};
    for (const char* entry : kAllEntries) {
        const auto tracer = make(entry, share(swarm), params);
        const Camera before = automatic_camera(scene_bounds(swarm));
        tracer->render(before, settings);  // its programs are there when the textures change
        // Far enough for another ray offset; the line for larger textures.
        for (const Transforms& place :
             {placed(
                  swarm, [](vec3 p, size_t) { return p * 2.0f + vec3(40, 0, 0); }, 2.0f),
              in_a_line(swarm)}) {
            const ScenePtr there = moved(swarm, place);
            tracer->update(place);
            const Camera camera = automatic_camera(scene_bounds(*there));
            const Frame ours = tracer->render(camera, settings);
            const Frame theirs = make(entry, there, params)->render(camera, settings);
            expect_same_bits(ours.hits, theirs.hits, entry);
            EXPECT_TRUE(ours.color == theirs.color) << entry;
            EXPECT_TRUE(ours.normals == theirs.normals) << entry;
            EXPECT_TRUE(ours.counters == theirs.counters) << entry;
            EXPECT_GT(hit_count(ours.hits), 10u) << entry;
        }
    }
}

TEST_F(Moving, a_scene_without_an_animation_is_refused) {
    Scene scene = make_instances();
    scene.animation = {};
    for (const char* entry : kAllEntries) {
        const auto tracer = make(entry, share(scene));
        try {
            tracer->update(transforms_of(scene));
            FAIL() << entry << " moved a scene that cannot";
        } catch (const Error& error) {
            EXPECT_NE(error.parts().got.find("without an animation"), std::string::npos)
                << error.what();
        }
    }
}

TEST_F(Moving, an_update_that_fails_leaves_the_tracer_as_it_was) {
    const Scene swarm = make_swarm(60, 4);
    // 32 cells a side: the line asks for more. Buffers take it.
    const ParamValues atlas = {{"top_density", "3"}, {"atlas", "32"}};
    const Transforms frame = instance_transforms(swarm, 0.7);
    Transforms flat = frame;
    flat[7][2] = vec3(0.0f);
    Transforms endless = frame;
    endless[3][3] = vec3(kInfinity);
    Transforms overflowing = frame;  // finite, but not the size of its box
    overflowing[5][0] = vec3(3e38f, 0.0f, 0.0f);
    const Transforms too_few(frame.begin(), frame.end() - 1);
    for (const std::string entry : kAllEntries) {
        const bool has_atlas = entry.starts_with("paper");
        const ParamValues params = has_atlas ? atlas : ParamValues{};
        std::vector<Transforms> impossible = {flat, endless, overflowing, too_few, {}};
        if (has_atlas) impossible.push_back(in_a_line(swarm));
        const auto tracer = make(entry, share(swarm), params);
        tracer->update(frame);
        const std::vector<Stat> stats = tracer->stats();
        for (size_t i = 0; i < impossible.size(); ++i) {
            EXPECT_THROW(tracer->update(impossible[i]), Error) << entry << ", update " << i;
            EXPECT_TRUE(tracer->stats() == stats) << entry << ", update " << i;
            const ScenePtr there = moved(swarm, frame);
            expect_same_answers(*tracer, *make(entry, there, params), *there, entry);
        }
    }
}

}  // namespace
}  // namespace onepass::test
