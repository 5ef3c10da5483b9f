#include "compare/images.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/statistics.h"
#include "core/error.h"

namespace onepass {
namespace {

constexpr std::array<uint8_t, 3> kBlack = {0, 0, 0};
constexpr std::array<uint8_t, 3> kNotANumber = {255, 0, 255};

/// A heat map is scaled to this quantile of its values.
constexpr double kHeatQuantile = 0.995;

double channel_difference(float a, float b) {
    const double difference = std::abs(double{a} - double{b});
    return std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity();
}

double largest_difference(const vec3& a, const vec3& b) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, channel_difference(a[c], b[c]));
    return largest;
}

void check_same_size(const Frame& a, const Frame& b) {
    ONEPASS_CHECK_EQ(a.width, b.width);
    ONEPASS_CHECK_EQ(a.height, b.height);
    ONEPASS_CHECK_EQ(a.color.size(), size_t{a.width} * a.height);
    ONEPASS_CHECK_EQ(a.color.size(), b.color.size());
}

/// IEC 61966-2-1.
uint8_t srgb_byte(float linear) {
    const double x = std::clamp(double{linear}, 0.0, 1.0);
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
    return static_cast<uint8_t>(std::lround(255.0 * encoded));
}

}  // namespace

ImageRecord compare_images(const Frame& image, const Frame& oracle,
                           const ImageTolerance& tolerance) {
    check_same_size(image, oracle);
    ImageRecord record;
    record.width = image.width;
    record.height = image.height;
    record.tolerance = tolerance.channel;
    record.reason = tolerance.reason;

    const size_t pixels = image.color.size();
    double sum_of_squares = 0.0;
    for (size_t i = 0; i < pixels; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double difference = channel_difference(image.color[i][c], oracle.color[i][c]);
            sum_of_squares += difference * difference;
        }
        const double largest = largest_difference(image.color[i], oracle.color[i]);
        record.differing_pixels += largest > tolerance.channel;
        if (largest > record.max_difference) {
            record.max_difference = largest;
            record.max_x = static_cast<uint32_t>(i % image.width);
            record.max_y = static_cast<uint32_t>(i / image.width);
        }
    }
    record.rmse = std::sqrt(sum_of_squares / (3.0 * static_cast<double>(pixels)));
    record.psnr_db = 20.0 * std::log10(1.0 / record.rmse);
    record.allowed_pixels =
        static_cast<uint64_t>(std::ceil(tolerance.pixel_share * static_cast<double>(pixels)));
    record.passed = record.differing_pixels <= record.allowed_pixels;

    uint64_t rays = 0;
    for (const RayCounters& counters : image.counters) rays += counters.rays;
    record.rays_per_pixel = static_cast<double>(rays) / static_cast<double>(pixels);
    return record;
}

Picture tone_mapped(const Frame& frame) {
    Picture picture{frame.width, frame.height, {}};
    picture.pixels.reserve(frame.color.size());
    for (const vec3& c : frame.color) {
        const bool valid = !std::isnan(c.x) && !std::isnan(c.y) && !std::isnan(c.z);
        picture.pixels.push_back(valid ? std::array{srgb_byte(c.x), srgb_byte(c.y), srgb_byte(c.z)}
                                       : kNotANumber);
    }
    return picture;
}

Picture difference_picture(const Frame& image, const Frame& oracle, double tolerance) {
    check_same_size(image, oracle);
    Picture picture{image.width, image.height, {}};
    picture.pixels.reserve(image.color.size());
    for (size_t i = 0; i < image.color.size(); ++i) {
        const double difference = largest_difference(image.color[i], oracle.color[i]);
        const double decades = std::log(std::min(difference, 1.0) / tolerance);
        picture.pixels.push_back(
            difference > tolerance ? false_color(decades / -std::log(tolerance)) : kBlack);
    }
    return picture;
}

HeatMap heat_map(std::span<const uint32_t> values, uint32_t width, uint32_t height) {
    ONEPASS_CHECK_EQ(values.size(), size_t{width} * height);
    HeatMap map{{width, height, {}}, 0.0};
    const std::vector<double> numbers(values.begin(), values.end());
    map.full_scale = std::max(1.0, quantile(numbers, kHeatQuantile));
    map.picture.pixels.reserve(values.size());
    for (const double value : numbers) {
        map.picture.pixels.push_back(false_color(value / map.full_scale));
    }
    return map;
}

HeatMap cells_heat_map(const Frame& frame) {
    std::vector<uint32_t> cells;
    cells.reserve(frame.counters.size());
    for (const RayCounters& counters : frame.counters) cells.push_back(counters.cells);
    return heat_map(cells, frame.width, frame.height);
}

std::array<uint8_t, 3> class_color(HitClass hit_class) {
    switch (hit_class) {
        case HitClass::agree:
            return {60, 66, 72};
        case HitClass::tie:
            return {86, 180, 233};
        case HitClass::edge:
            return {240, 228, 66};
        case HitClass::false_miss:
            return {213, 94, 0};
        case HitClass::false_hit:
            return {204, 121, 167};
        case HitClass::wrong_surface:
            return {230, 20, 40};
        case HitClass::t_error:
            return {0, 158, 115};
    }
    return kNotANumber;
}

Picture class_picture(std::span<const std::optional<HitClass>> classes,
                      std::span<const uint32_t> pixels, uint32_t width, uint32_t height) {
    ONEPASS_CHECK_EQ(classes.size(), pixels.size());
    std::vector<std::optional<HitClass>> worst(size_t{width} * height);
    for (size_t i = 0; i < classes.size(); ++i) {
        worst[pixels[i]] = std::max(worst[pixels[i]], classes[i]);
    }
    Picture picture{width, height, {}};
    picture.pixels.reserve(worst.size());
    for (const auto& hit_class : worst) {
        picture.pixels.push_back(hit_class ? class_color(*hit_class) : kBlack);
    }
    return picture;
}

std::array<uint8_t, 3> false_color(double x) {
    // Control points of the ramp; lightness grows evenly from one to the next.
    static constexpr std::array<std::array<double, 3>, 6> kRamp = {{{60, 8, 80},
                                                                    {62, 64, 136},
                                                                    {44, 113, 142},
                                                                    {38, 162, 126},
                                                                    {122, 205, 72},
                                                                    {250, 230, 40}}};
    const double place = std::clamp(x, 0.0, 1.0) * (kRamp.size() - 1);
    const size_t below = std::min(static_cast<size_t>(place), kRamp.size() - 2);
    const double weight = place - static_cast<double>(below);
    std::array<uint8_t, 3> color;
    for (size_t c = 0; c < 3; ++c) {
        const double value = kRamp[below][c] * (1.0 - weight) + kRamp[below + 1][c] * weight;
        color[c] = static_cast<uint8_t>(std::lround(value));
    }
    return color;
}

}  // namespace onepass
