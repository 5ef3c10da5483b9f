// Parameters of the grid strategies at their limits.
#include <string>

#include "scenes/ladders/parts.h"

namespace onepass::ladder {
namespace {

Ladder half_addresses_ladder() {
    Ladder ladder{.id = "half-addresses",
                  .title = "Addresses of 16 bits",
                  .question =
                      "Texture addresses as 16-bit floats, as the paper has them, over "
                      "ever larger meshes. They name a texel's centre exactly in textures "
                      "of up to 1024 a side; a mesh beyond has to be refused, since it "
                      "would be read from wrong places.",
                  .knob = "triangles",
                  .unit = "",
                  .rungs = {}};
    // The last two have just less and just more than the 1024 x 1024 / 4 triangles that fit.
    const uvec2 sizes[] = {{32, 17},   {64, 33},   {128, 65}, {256, 129},
                           {360, 281}, {512, 256}, {512, 258}};
    for (const uvec2& size : sizes) {
        Rung rung;
        rung.knob = 2.0 * size.x * (size.y - 1);
        rung.make_scene = [=] { return scene_of(bare(make_sphere(size.x, size.y))); };
        rung.make_rays = rays_at_surfaces;
        rung.params = {{"address", "half"}};
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

Ladder resolution_ladder() {
    Ladder ladder{.id = "resolution",
                  .title = "Grid resolution",
                  .question =
                      "Rays at edges of a ball in grids from one cell to a thousand a "
                      "side: the finer the grid, the more cells a ray crosses, and the "
                      "smaller a cell beside the rounding of its planes.",
                  .knob = "cells a side",
                  .unit = "",
                  .rungs = {}};
    const auto add = [&](uint32_t cells, const std::string& resolution, const std::string& label) {
        Rung rung;
        rung.knob = cells;
        rung.label = label;
        rung.make_scene = [] { return scene_of(ball()); };
        rung.ray_kind = "edge";
        rung.params = {{"resolution", resolution}};
        ladder.rungs.push_back(std::move(rung));
    };
    for (const uint32_t cells : {1u, 2u, 4u, 16u, 64u, 128u}) {
        const std::string n = std::to_string(cells);
        add(cells, n + "x" + n + "x" + n, "");
    }
    add(256, "256x256x64", "256x256x64");
    add(1024, "1024x64x64", "1024x64x64");
    return ladder;
}

}  // namespace

std::vector<Ladder> limit_ladders() { return {half_addresses_ladder(), resolution_ladder()}; }

}  // namespace onepass::ladder
