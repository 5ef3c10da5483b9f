// How many cells a grid gets.
//
// Pure arithmetic on a box and a count; the builders (uniform_grid.h) call it, and a sweep may call
// it to know a grid's size before building it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// Resolution of one grid: by density, or explicit.
struct GridSizing {
    double density = 5.0;                            ///< lambda: cells per primitive
    std::optional<uvec3> resolution = std::nullopt;  ///< overrides `density`
    uint32_t max_cells_per_axis = 1024;              ///< clamp of every axis

    bool operator==(const GridSizing&) const = default;
};

/// Sizing of the two levels. Defaults: top lambda 1.2, object lambda 5.0 (Kalojanov's instance
/// hierarchy); the paper does not state its formula.
struct TwoLevelSizing {
    GridSizing top{.density = 1.2};
    GridSizing object{.density = 5.0};  ///< of every object, unless `objects` says more
    std::vector<GridSizing> objects{};  ///< empty, or one an object of the scene, in its order

    const GridSizing& of_object(size_t k) const { return objects.empty() ? object : objects[k]; }

    bool operator==(const TwoLevelSizing&) const = default;
};

/// Throws: Error if `objects` is neither empty nor one for each of so many objects.
void check_object_count(const TwoLevelSizing& sizing, size_t objects);

/// "64x32x32" -> (64, 32, 32). Throws: Error at `where` for another form.
uvec3 parse_resolution(std::string_view text, const std::string& where);

/// A resolution ("64x32x32"), or else a density ("4.5"). Throws: Error at `where`.
GridSizing parse_grid_sizing(std::string_view text, const std::string& where);

/// What parse_grid_sizing reads back as an equal value: density or resolution, without the clamp.
std::string to_text(const GridSizing& sizing);
std::string to_text(uvec3 resolution);

/// No grid may have more cells: their begins alone take 8 GiB, and cell indices stay in 32 bits.
inline constexpr uint64_t kMaxCells = uint64_t{1} << 31;

/// N_i = d_i cbrt(lambda N / V), rounded, at least 1, at most sizing.max_cells_per_axis.
///
/// An axis that the formula gives less than one cell (a flat or a long thin box) gets exactly one,
/// and the other axes share all the cells: N_i = d_i sqrt(lambda N / A) for a flat box. Thus lambda
/// stays what it says, cells per primitive, in every shape of box.
/// `bounds` must not be flat (see padded_bounds).
/// Throws: Error if the density is not a positive number, if an explicit resolution has a zero or
/// exceeds the clamp, or if the grid would have more than kMaxCells cells.
/// Source: Cleary & Wyvill; Wald 2006.
uvec3 grid_resolution(const Bounds& bounds, uint64_t primitive_count, const GridSizing& sizing);

/// `bounds` widened so that no extent is 0 and no primitive touches the border: each side moves out
/// by 2^-20 of the largest extent, but at least by 2 ulps of the largest coordinate (2 smallest
/// normal floats if that is 0).
///
/// Throws: Error if a bound is not finite, before or after.
Bounds padded_bounds(const Bounds& bounds);

}  // namespace onepass
