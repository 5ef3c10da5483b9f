// Image metrics against values worked out by hand, and the pictures made from frames.
#include "compare/images.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace onepass {
namespace {

Frame grey_frame(uint32_t width, uint32_t height, float value) {
    Frame frame;
    frame.width = width;
    frame.height = height;
    frame.color.assign(size_t{width} * height, vec3(value));
    return frame;
}

TEST(CompareImages, finds_equal_images_equal) {
    const Frame frame = grey_frame(4, 2, 0.5f);
    const ImageRecord record = compare_images(frame, frame);
    EXPECT_EQ(record.rmse, 0.0);
    EXPECT_EQ(record.psnr_db, std::numeric_limits<double>::infinity());
    EXPECT_EQ(record.max_difference, 0.0);
    EXPECT_EQ(record.differing_pixels, 0u);
    EXPECT_TRUE(record.passed);
}

TEST(CompareImages, measures_one_channel_of_one_pixel) {
    // One of 4 * 2 * 3 = 24 values off by 0.5: RMSE = sqrt(0.25 / 24), PSNR = 10 log10(24 / 0.25).
    const Frame oracle = grey_frame(4, 2, 0.25f);
    Frame image = oracle;
    image.color[6].y = 0.75f;
    const ImageRecord record = compare_images(image, oracle);
    EXPECT_NEAR(record.rmse, 0.1020620726, 1e-10);
    EXPECT_NEAR(record.psnr_db, 19.8227123304, 1e-9);
    EXPECT_EQ(record.max_difference, 0.5);
    EXPECT_EQ(record.max_x, 2u);
    EXPECT_EQ(record.max_y, 1u);
    EXPECT_EQ(record.differing_pixels, 1u);
}

TEST(CompareImages, measures_a_uniform_difference) {
    const ImageRecord record = compare_images(grey_frame(8, 8, 0.5f), grey_frame(8, 8, 0.25f));
    EXPECT_EQ(record.rmse, 0.25);
    EXPECT_NEAR(record.psnr_db, 20.0 * std::log10(4.0), 1e-12);
    EXPECT_EQ(record.differing_pixels, 64u);
    EXPECT_FALSE(record.passed);
}

TEST(CompareImages, counts_a_pixel_only_beyond_the_tolerance) {
    const Frame oracle = grey_frame(2, 1, 0.0f);
    Frame image = oracle;
    const ImageTolerance tolerance{.channel = 0.25, .pixel_share = 0.0, .reason = "test"};
    image.color[1].z = 0.25f;
    EXPECT_EQ(compare_images(image, oracle, tolerance).differing_pixels, 0u);
    image.color[1].z = -0.2500001f;
    EXPECT_EQ(compare_images(image, oracle, tolerance).differing_pixels, 1u);
}

TEST(CompareImages, allows_the_stated_share_of_pixels_and_not_one_more) {
    const Frame oracle = grey_frame(20, 10, 0.0f);
    Frame image = oracle;
    const ImageTolerance tolerance{.channel = 0.0, .pixel_share = 0.01, .reason = "test"};
    image.color[3] = image.color[77] = vec3(1.0f);
    EXPECT_TRUE(compare_images(image, oracle, tolerance).passed);
    image.color[78] = vec3(1.0f);
    EXPECT_FALSE(compare_images(image, oracle, tolerance).passed);
}

TEST(CompareImages, takes_a_nan_for_an_infinite_difference) {
    const Frame oracle = grey_frame(2, 2, 0.5f);
    Frame image = oracle;
    image.color[3].x = std::numeric_limits<float>::quiet_NaN();
    const ImageRecord record = compare_images(image, oracle);
    EXPECT_EQ(record.differing_pixels, 1u);
    EXPECT_TRUE(std::isinf(record.max_difference));
    EXPECT_EQ(record.max_x, 1u);
    EXPECT_EQ(record.max_y, 1u);
    EXPECT_TRUE(std::isinf(record.rmse));
}

TEST(CompareImages, averages_the_rays_of_a_pixel) {
    Frame image = grey_frame(2, 1, 0.0f);
    image.counters = {{.rays = 2}, {.rays = 5}};
    EXPECT_EQ(compare_images(image, image).rays_per_pixel, 3.5);
}

TEST(ToneMapped, encodes_srgb_and_clamps) {
    Frame frame = grey_frame(4, 1, 0.0f);
    frame.color = {vec3(0.0f, 1.0f, 2.0f), vec3(-1.0f), vec3(0.21404114f), vec3(0.0f)};
    frame.color[3].y = std::numeric_limits<float>::quiet_NaN();
    const Picture picture = tone_mapped(frame);
    EXPECT_EQ(picture.pixels[0], (std::array<uint8_t, 3>{0, 255, 255}));
    EXPECT_EQ(picture.pixels[1], (std::array<uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(picture.pixels[2], (std::array<uint8_t, 3>{128, 128, 128})) << "half grey in sRGB";
    EXPECT_EQ(picture.pixels[3], (std::array<uint8_t, 3>{255, 0, 255})) << "NaN is seen";
}

TEST(DifferencePicture, is_black_within_the_tolerance_and_bright_at_one) {
    const Frame oracle = grey_frame(3, 1, 0.0f);
    Frame image = oracle;
    image.color[1].x = 0.01f;
    image.color[2].x = 1.0f;
    const Picture picture = difference_picture(image, oracle, 0.1);
    EXPECT_EQ(picture.pixels[1], (std::array<uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(picture.pixels[2], false_color(1.0));
}

TEST(HeatMap, scales_to_nearly_the_largest_value) {
    std::vector<uint32_t> values(1000, 10);
    values[0] = 0;
    values[1] = 100000;
    const HeatMap map = heat_map(values, 100, 10);
    EXPECT_EQ(map.full_scale, 10.0) << "one hot pixel does not darken the rest";
    EXPECT_EQ(map.picture.pixels[0], false_color(0.0));
    EXPECT_EQ(map.picture.pixels[1], false_color(1.0));
    EXPECT_EQ(map.picture.pixels[2], false_color(1.0));
}

TEST(ClassPicture, shows_the_last_class_of_a_pixel_and_black_without_one) {
    const std::vector<std::optional<HitClass>> classes = {HitClass::t_error, HitClass::agree,
                                                          std::nullopt};
    const std::vector<uint32_t> pixels = {1, 1, 2};
    const Picture picture = class_picture(classes, pixels, 2, 2);
    EXPECT_EQ(picture.pixels[0], (std::array<uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(picture.pixels[1], class_color(HitClass::t_error));
    EXPECT_EQ(picture.pixels[2], (std::array<uint8_t, 3>{0, 0, 0}));
}

TEST(FalseColor, grows_lighter_all_the_way) {
    double last = -1.0;
    for (int i = 0; i <= 50; ++i) {
        const auto color = false_color(i / 50.0);
        const double luma = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
        EXPECT_GT(luma, last) << i;
        last = luma;
    }
}

}  // namespace
}  // namespace onepass
