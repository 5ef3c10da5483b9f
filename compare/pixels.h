// Sheets of pixels: for a bounded set of an image's pixels, what every tracer answered to the
// primary ray, how the judge classed it, what the pixel cost and which colour it became.
//
// `onepass check` leaves one a scene beside its pictures; the report's pixel inspector reads it.
// All pixels of all tracers would be larger than the page may be, so the odd ones come first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/judge.h"
#include "core/tracer.h"

namespace onepass {

/// Pixels of a sheet, at most: with a dozen tracers about half a MiB.
inline constexpr size_t kMostSheetPixels = 2048;

/// Lattice points along the longer side of the image: pixels shown whatever was answered there.
inline constexpr uint32_t kSheetLattice = 32;

using RayClasses = std::vector<std::optional<HitClass>>;

struct SheetPixels {
    std::vector<uint32_t> pixels;  ///< x + width * y, ascending
    uint64_t left_out = 0;         ///< odd pixels for which was no room
};

/// The pixels worth a look: the lattice, and every pixel at which some tracer's class is not
/// `agree`. Where those are too many, errors go before ties and edges, and of the last kind that
/// fits in part every n-th is kept.
///
/// `classes`: by tracer, one a ray; `pixel_of_ray` as RaySet::pixels, each pixel at most once.
SheetPixels choose_pixels(std::span<const RayClasses> classes,
                          std::span<const uint32_t> pixel_of_ray, uint32_t width, uint32_t height);

/// One tracer's answers, one element a pixel of the sheet.
struct SheetColumn {
    std::string tracer;
    std::vector<Hit> hits;
    RayClasses classes;
    std::vector<std::array<uint8_t, 3>> colors;  ///< as in its picture; empty: it renders none
    std::vector<RayCounters> counters;  ///< over all rays of the pixel; empty: it counts none
};

struct PixelSheet {
    std::string scene;
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint32_t> pixels;
    std::vector<SheetColumn> tracers;
};

/// JSON text without blanks. Lists that several tracers share, as most do with their siblings,
/// stand once, in "columns"; a tracer names them by index.
std::string to_json(const PixelSheet& sheet);

}  // namespace onepass
