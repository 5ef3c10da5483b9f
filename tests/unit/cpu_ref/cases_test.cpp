// The published robustness settings: the meshes are what they say, and every ray truly hits.
#include "scenes/cases.h"

#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "cpu_ref/exact_judge.h"

namespace onepass::test {
namespace {

TEST(SubdividedSquare, is_watertight_whole_and_nowhere_flipped) {
    for (const uint32_t count : {2u, 3u, 4u, 5u, 1024u, 16384u}) {
        const Object square = make_subdivided_square(count, 4);
        ASSERT_EQ(square.triangles.size(), count);

        // Doubles hold doubled areas on the lattice exactly, and their sum.
        double doubled_area = 0.0;
        std::map<std::pair<uint32_t, uint32_t>, int> edges;
        for (const uvec3& t : square.triangles) {
            const dvec3 a(square.positions[t.x]);
            const dvec3 b(square.positions[t.y]);
            const dvec3 c(square.positions[t.z]);
            const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            EXPECT_GT(area, 0.0);
            doubled_area += area;
            for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
        }
        EXPECT_EQ(doubled_area, 2.0) << count << " triangles";

        // An edge without a neighbour lies on one side of the square.
        for (const auto& [edge, times] : edges) {
            EXPECT_EQ(times, 1);
            if (edges.contains({edge.second, edge.first})) continue;
            const vec3 a = square.positions[edge.first];
            const vec3 b = square.positions[edge.second];
            EXPECT_TRUE((a.x == b.x && std::abs(a.x) == 0.5f) ||
                        (a.y == b.y && std::abs(a.y) == 0.5f))
                << count << " triangles";
        }
    }
}

TEST(SubdividedSquare, follows_its_seed) {
    EXPECT_EQ(make_subdivided_square(64, 1), make_subdivided_square(64, 1));
    EXPECT_NE(make_subdivided_square(64, 1), make_subdivided_square(64, 2));
}

TEST(RobustnessCases, every_ray_of_every_case_truly_hits) {
    for (const Ladder& ladder : robustness_cases()) {
        for (const Rung& rung : ladder.rungs) {
            const auto scene = std::make_shared<const Scene>(rung.make_scene());
            EXPECT_EQ(static_cast<double>(scene->objects[0].triangles.size()), rung.knob)
                << ladder.id;
            const auto judge = make_exact_judge(scene);
            for (const Ray& ray : rung.make_rays(*scene, 30, 9)) {
                const Hit miss;
                const Verdict verdict = judge->judge(ray, Query::any, std::span(&miss, 1)).front();
                EXPECT_EQ(verdict.true_inst_id, 0u) << ladder.id << " " << rung.label;
            }
        }
    }
}

TEST(RobustnessCases, go_up_to_65536_triangles_and_stand_where_embree_puts_them) {
    const std::vector<Ladder> cases = robustness_cases();
    ASSERT_EQ(cases.size(), 3u);
    EXPECT_EQ(cases[2].rungs.front().knob, 4.0);
    EXPECT_EQ(cases[2].rungs.back().knob, 65536.0);
    const vec3 centre(148376.0f, 1234.0f, -223423.0f);
    for (const Rung& rung : cases[0].rungs) {
        const Scene scene = rung.make_scene();
        EXPECT_EQ(scene_bounds(scene).centre(), centre) << rung.label;
    }
}

}  // namespace
}  // namespace onepass::test
