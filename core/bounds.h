// Axis-aligned bounding boxes.
#pragma once

#include "core/types.h"

namespace onepass {

/// A closed box [lower, upper]; empty when lower > upper on any axis, as a default one is.
struct Bounds {
    vec3 lower{kInfinity};
    vec3 upper{-kInfinity};

    void extend(const vec3& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    void extend(const Bounds& b) {
        lower = glm::min(lower, b.lower);
        upper = glm::max(upper, b.upper);
    }
    bool empty() const { return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z; }
    vec3 extent() const { return upper - lower; }
    vec3 centre() const { return 0.5f * lower + 0.5f * upper; }
    float diagonal() const { return glm::length(extent()); }
    /// The largest absolute coordinate: the scale that rounding errors of positions go with.
    float magnitude() const {
        const vec3 m = glm::max(glm::abs(lower), glm::abs(upper));
        return glm::max(m.x, glm::max(m.y, m.z));
    }
    bool operator==(const Bounds&) const = default;
};

}  // namespace onepass
