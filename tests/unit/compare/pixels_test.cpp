// Which pixels a sheet keeps, and how it is written.
#include "compare/pixels.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace onepass {
namespace {

std::vector<uint32_t> in_order(size_t count) {
    std::vector<uint32_t> pixels(count);
    std::iota(pixels.begin(), pixels.end(), 0u);
    return pixels;
}

bool holds(const SheetPixels& chosen, uint32_t pixel) {
    return std::binary_search(chosen.pixels.begin(), chosen.pixels.end(), pixel);
}

TEST(SheetPixels, are_a_lattice_where_all_agree) {
    const uint32_t side = 4 * kSheetLattice;
    const RayClasses agree(size_t{side} * side, HitClass::agree);
    const std::vector<RayClasses> classes = {agree, agree};
    const SheetPixels chosen = choose_pixels(classes, in_order(agree.size()), side, side);
    EXPECT_EQ(chosen.pixels.size(), size_t{kSheetLattice} * kSheetLattice);
    EXPECT_EQ(chosen.left_out, 0u);
    EXPECT_EQ(chosen.pixels.front(), 2 + side * 2);  // half a step from the border
}

TEST(SheetPixels, hold_every_pixel_at_which_some_tracer_errs) {
    const uint32_t side = 128;
    RayClasses agree(size_t{side} * side, HitClass::agree), odd = agree;
    odd[5] = HitClass::wrong_surface;
    odd[700] = HitClass::edge;
    agree[9] = std::nullopt;  // a ray that the oracle cannot take
    // Rays come from the last pixel to the first.
    std::vector<uint32_t> backwards = in_order(odd.size());
    std::reverse(backwards.begin(), backwards.end());
    const std::vector<RayClasses> classes = {agree, odd};
    const SheetPixels chosen = choose_pixels(classes, backwards, side, side);
    EXPECT_TRUE(holds(chosen, side * side - 1 - 5));
    EXPECT_TRUE(holds(chosen, side * side - 1 - 700));
    EXPECT_FALSE(holds(chosen, 5));
    EXPECT_TRUE(std::is_sorted(chosen.pixels.begin(), chosen.pixels.end()));
}

TEST(SheetPixels, give_errors_the_room_before_edges_and_count_who_had_none) {
    const uint32_t side = 256;
    RayClasses classes(size_t{side} * side, HitClass::edge);
    for (size_t i = 0; i < 300; ++i) classes[i * 7] = HitClass::false_miss;
    const std::vector<RayClasses> all = {classes};
    const SheetPixels chosen = choose_pixels(all, in_order(classes.size()), side, side);
    EXPECT_EQ(chosen.pixels.size(), kMostSheetPixels);
    EXPECT_EQ(chosen.left_out, classes.size() - kMostSheetPixels);
    for (uint32_t i = 0; i < 300; ++i) EXPECT_TRUE(holds(chosen, i * 7)) << i;
    // Those with room for a part only are spread over all of the image.
    EXPECT_GT(chosen.pixels.back(), side * (side - 8));
}

TEST(PixelSheet, writes_lists_that_tracers_share_once) {
    PixelSheet sheet{"bunny", 2, 1, {0, 1}, {}};
    const Hit hit{0.1f, 0.0f, 0.0f, 12, 0};
    const RayClasses classes = {HitClass::agree, std::nullopt};
    sheet.tracers.push_back({"a", {hit, Hit{}}, classes, {{255, 0, 16}, {1, 2, 3}}, {}});
    sheet.tracers.push_back({"b", {hit, Hit{}}, classes, {}, {{4, 5, 6, 1}, {7, 8, 9, 1}}});
    const auto document = nlohmann::json::parse(to_json(sheet));
    const auto& [a, b] = std::pair(document["tracers"][0], document["tracers"][1]);
    EXPECT_EQ(a["t"], b["t"]);
    EXPECT_EQ(a["class"], b["class"]);
    const auto& columns = document["columns"];
    EXPECT_EQ(columns[a["t"].get<size_t>()].dump(), "[0.1,null]");  // a float's own digits
    EXPECT_EQ(columns[a["prim"].get<size_t>()].dump(), "[12,-1]");
    EXPECT_EQ(columns[a["class"].get<size_t>()].dump(), "[0,-1]");
    EXPECT_EQ(columns[a["color"].get<size_t>()].dump(), "[16711696,66051]");
    EXPECT_EQ(columns[b["cells"].get<size_t>()].dump(), "[4,7]");
    EXPECT_FALSE(a.contains("cells"));
    EXPECT_FALSE(b.contains("color"));
    EXPECT_EQ(document["classes"][5], "wrong_surface");
}

}  // namespace
}  // namespace onepass
