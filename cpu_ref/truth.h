// What is right to answer to one ray: the words between those who find the truth and the judge.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/types.h"

namespace onepass {

/// A triangle's corners in the world. Equal corners of neighbours are equal in every bit.
using WorldTriangle = std::array<dvec3, 3>;

/// Where a ray's line crosses a triangle, as far as its finder can tell.
struct Crossing {
    double t = 0.0;
    double t_tolerance = 0.0;  ///< how far the real t may be from `t`
    bool touch = false;  ///< outside, but by less than rounding: may count or not. Never exact
};

/// A triangle hit by a ray.
struct Surface {
    uint32_t inst_id = kNoId;
    uint32_t prim_id = kNoId;
    Crossing crossing;
    bool optional = false;  ///< a touch, or t equals tmin or tmax: may count or not
};

/// All that is right to answer to one ray.
struct Truth {
    /// Nearest at an inclusive interval, touches left out; of equal distances the lowest inst_id,
    /// then prim_id.
    std::optional<Surface> nearest;
    /// Every surface whose answer is right, ascending by ids: `nearest`, those as near as it,
    /// optional ones, and if `nearest` is optional the nearest that is not.
    std::vector<Surface> right;
    /// No surface lies inside the interval beyond doubt.
    bool miss_is_right = true;

    const Surface* find(uint32_t inst_id, uint32_t prim_id) const;
};

}  // namespace onepass
