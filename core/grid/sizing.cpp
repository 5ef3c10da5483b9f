// The resolution formula and the padding of a grid's box.
#include "core/grid/sizing.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// Padding of a grid's box, as a share of its largest extent: far below a cell (2^-10 at the
/// default clamp), and far above the rounding of float coordinates (2^-24).
constexpr double kBoundsPad = 0x1p-20;

/// Padding in ulps of the largest coordinate, where that is more than kBoundsPad (far from the
/// origin): one ulp may be lost to the rounding of the sum, the other one remains.
constexpr double kBoundsPadUlps = 2.0;

bool is_finite(const vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string resolution_text(const uvec3& n) { return fmt::format("{} x {} x {}", n.x, n.y, n.z); }

void check_explicit_resolution(const GridSizing& sizing) {
    const uvec3 n = *sizing.resolution;
    const uint32_t limit = sizing.max_cells_per_axis;
    if (n.x >= 1 && n.y >= 1 && n.z >= 1 && n.x <= limit && n.y <= limit && n.z <= limit) return;
    throw Error({.where = "grid resolution",
                 .got = resolution_text(n) + " cells",
                 .expected = fmt::format("1 to {} cells on each axis", limit),
                 .remedy = "Give another resolution, or raise max_cells_per_axis."});
}

void check_density(const GridSizing& sizing) {
    if (std::isfinite(sizing.density) && sizing.density > 0.0) return;
    throw Error({.where = "grid density",
                 .got = fmt::format("{}", sizing.density),
                 .expected = "a finite number above 0 (cells per primitive)",
                 .remedy = "Values from 1 to 16 are usual."});
}

void check_cell_count(const uvec3& n, uint64_t primitive_count, const GridSizing& sizing) {
    // Each axis is below 2^32, so a product of three can pass 2^64: count in double.
    const double cells = double(n.x) * n.y * n.z;
    if (cells <= double(kMaxCells)) return;
    const std::string asked = sizing.resolution ? std::string("an explicit resolution")
                                                : fmt::format("density {} for {} primitives",
                                                              sizing.density, primitive_count);
    constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
    throw Error(
        {.where = "grid resolution",
         .got = fmt::format("{} = {:.0f} cells ({:.1f} GiB before any reference) from {}",
                            resolution_text(n), cells, cells * sizeof(uint32_t) / kGiB, asked),
         .expected = fmt::format("at most {} cells", kMaxCells),
         .remedy = "Lower the density, the resolution or max_cells_per_axis."});
}

uvec3 resolution_by_density(const Bounds& bounds, uint64_t primitive_count,
                            const GridSizing& sizing) {
    const dvec3 extent = dvec3(bounds.upper) - dvec3(bounds.lower);
    std::array<int, 3> axes = {0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] < extent[b]; });

    // From the shortest axis up, each takes its share of the cells that remain: d_i times the k-th
    // root of (cells / product of the k extents not yet served). While no axis falls below one
    // cell, that root is the same at every step, and equal to cbrt(lambda N / V).
    double cells = sizing.density * double(primitive_count);
    uvec3 resolution(1);
    for (int served = 0; served < 3; ++served) {
        double volume = 1.0;
        for (int i = served; i < 3; ++i) volume *= extent[axes[i]];
        const double per_unit = std::pow(cells / volume, 1.0 / (3 - served));
        const double share = std::max(1.0, extent[axes[served]] * per_unit);
        cells /= share;
        const double clamped = std::min(std::round(share), double(sizing.max_cells_per_axis));
        resolution[axes[served]] = static_cast<uint32_t>(clamped);
    }
    return resolution;
}

}  // namespace

void check_object_count(const TwoLevelSizing& sizing, size_t objects) {
    if (sizing.objects.empty() || sizing.objects.size() == objects) return;
    throw Error({.where = "sizes of object grids",
                 .got = fmt::format("{} sizes", sizing.objects.size()),
                 .expected = fmt::format("{}, one an object of the scene", objects),
                 .remedy = "Give one size for all objects, or one for each."});
}

uvec3 parse_resolution(std::string_view text, const std::string& where) {
    uvec3 resolution(0);
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int axis = 0; axis < 3; ++axis) {
        const auto [next, status] = std::from_chars(at, end, resolution[axis]);
        const bool last = axis == 2;
        if (status != std::errc() || (last ? next != end : next == end || *next != 'x')) {
            throw Error({where, fmt::format("'{}'", text), "cells as XxYxZ",
                         "Write for example 32x32x32."});
        }
        at = next + 1;
    }
    return resolution;
}

GridSizing parse_grid_sizing(std::string_view text, const std::string& where) {
    GridSizing sizing;
    if (text.find('x') != std::string_view::npos) {
        sizing.resolution = parse_resolution(text, where);
        return sizing;
    }
    const char* const end = text.data() + text.size();
    const auto [stop, status] = std::from_chars(text.data(), end, sizing.density);
    const bool sound = status == std::errc() && stop == end && std::isfinite(sizing.density);
    if (!sound || sizing.density <= 0.0) {
        throw Error({where, fmt::format("'{}'", text),
                     "a density above 0 (cells per primitive), or cells as XxYxZ",
                     "Write for example 8 or 32x32x32."});
    }
    return sizing;
}

std::string to_text(uvec3 resolution) {
    return fmt::format("{}x{}x{}", resolution.x, resolution.y, resolution.z);
}

std::string to_text(const GridSizing& sizing) {
    return sizing.resolution ? to_text(*sizing.resolution) : fmt::format("{}", sizing.density);
}

uvec3 grid_resolution(const Bounds& bounds, uint64_t primitive_count, const GridSizing& sizing) {
    for (int axis = 0; axis < 3; ++axis) ONEPASS_CHECK_LT(bounds.lower[axis], bounds.upper[axis]);
    if (sizing.max_cells_per_axis == 0) {
        throw Error({.where = "grid sizing",
                     .got = "max_cells_per_axis = 0",
                     .expected = "at least 1",
                     .remedy = "The default is 1024."});
    }
    if (sizing.resolution) {
        check_explicit_resolution(sizing);
    } else {
        check_density(sizing);
    }
    const uvec3 resolution = sizing.resolution
                                 ? *sizing.resolution
                                 : resolution_by_density(bounds, primitive_count, sizing);
    check_cell_count(resolution, primitive_count, sizing);
    return resolution;
}

Bounds padded_bounds(const Bounds& bounds) {
    // In double: the extent of a finite box can exceed the largest float.
    const dvec3 extent = dvec3(bounds.upper) - dvec3(bounds.lower);
    const double largest_extent = std::max({extent.x, extent.y, extent.z});
    const double ulp = std::max(double(bounds.magnitude()) * std::numeric_limits<float>::epsilon(),
                                double(std::numeric_limits<float>::min()));
    const dvec3 pad(std::max(kBoundsPad * largest_extent, kBoundsPadUlps * ulp));

    const Bounds padded{vec3(dvec3(bounds.lower) - pad), vec3(dvec3(bounds.upper) + pad)};
    if (!is_finite(padded.lower) || !is_finite(padded.upper)) {
        throw Error({.where = "grid bounds",
                     .got = fmt::format("a largest coordinate of {:g}", bounds.magnitude()),
                     .expected = "finite coordinates a little below the largest float, 3.4e38",
                     .remedy = "Scale the mesh down."});
    }
    return padded;
}

}  // namespace onepass
