// How many cells a grid gets.
#pragma once

#include <cstdint>
#include <optional>

#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// Resolution of one grid: by density, or explicit.
struct GridSizing {
    double density = 5.0;                ///< lambda: cells per primitive
    std::optional<uvec3> resolution;     ///< overrides `density`
    uint32_t max_cells_per_axis = 1024;  ///< clamp of every axis

    bool operator==(const GridSizing&) const = default;
};

/// Sizing of the two levels. Defaults: top lambda 1.2, object lambda 5.0 (Kalojanov's instance
/// hierarchy); the paper does not state its formula.
struct TwoLevelSizing {
    GridSizing top{.density = 1.2};
    GridSizing object{.density = 5.0};

    bool operator==(const TwoLevelSizing&) const = default;
};

/// N_i = d_i cbrt(lambda N / V), rounded, at least 1, at most sizing.max_cells_per_axis.
///
/// `bounds` must not be flat (see padded_bounds).
/// Throws: Error if an explicit resolution has a zero or exceeds the clamp.
/// Source: Cleary & Wyvill; Wald 2006.
uvec3 grid_resolution(const Bounds& bounds, uint64_t primitive_count, const GridSizing& sizing);

/// `bounds` widened so that no extent is 0 and no primitive touches the border: each side moves out
/// by 2^-20 of the largest extent, but at least by 2 ulps of the largest coordinate.
Bounds padded_bounds(const Bounds& bounds);

}  // namespace onepass
