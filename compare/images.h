// Image comparison and the pictures that show it: difference, heat map, classes, tone-mapped image.
//
// The metrics are spelled out here instead of taken from OpenImageIO, because a build without it
// (on a GPU node) must judge an image by the same rule. Files are written by image_io.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compare/results.h"
#include "core/judge.h"
#include "core/tracer.h"

namespace onepass {

/// When two images count as equal.
struct ImageTolerance {
    /// A pixel differs when one of its linear channels is off by more than this: one step of an
    /// 8-bit picture.
    double channel = 1.0 / 255.0;

    /// The share of pixels that may differ, and why.
    double pixel_share = 0.005;
    std::string reason =
        "a pixel may differ by one 8-bit step (1/255 of a linear channel); 0.5 % of the pixels may "
        "differ by more: hits of class edge or tie at a silhouette take another surface's colour, "
        "and secondary rays that start from points a few ulps apart fall on different sides of a "
        "shadow's or a mirrored object's outline, which is one pixel wide; the paper's own edge "
        "slack "
        "has to fit in as well";
};

/// Compares colours pixel by pixel and channel by channel. A difference that is NaN or infinite
/// counts as infinite. Frames have equal sizes. Fills all figures; names and pictures are the
/// caller's.
ImageRecord compare_images(const Frame& image, const Frame& oracle,
                           const ImageTolerance& tolerance = {});

/// Eight-bit sRGB, row-major, row 0 at the top.
struct Picture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<std::array<uint8_t, 3>> pixels;
};

/// Linear colour clamped to [0, 1] and encoded as sRGB. NaN becomes magenta, to be seen.
Picture tone_mapped(const Frame& frame);

/// Largest channel difference of each pixel in false colour, on a logarithmic scale from the
/// tolerance (dark) to 1 (bright); black where within the tolerance.
Picture difference_picture(const Frame& image, const Frame& oracle, double tolerance);

struct HeatMap {
    Picture picture;
    double full_scale = 0.0;  ///< the value of the brightest colour
};

/// Values in false colour from 0 to their 99.5 % quantile, so that a few hot pixels do not darken
/// the rest. One value a pixel.
HeatMap heat_map(std::span<const uint32_t> values, uint32_t width, uint32_t height);

/// Cells visited, a pixel, of a frame that has counters.
HeatMap cells_heat_map(const Frame& frame);

/// The colour that stands for a class in every picture.
std::array<uint8_t, 3> class_color(HitClass hit_class);

/// One colour a pixel by the class of its ray; of several rays, the class that comes last in
/// HitClass. Black where no ray or no class belongs to the pixel.
Picture class_picture(std::span<const std::optional<HitClass>> classes,
                      std::span<const uint32_t> pixels, uint32_t width, uint32_t height);

/// A perceptually even ramp from dark violet over green to yellow; `x` in [0, 1].
std::array<uint8_t, 3> false_color(double x);

}  // namespace onepass
