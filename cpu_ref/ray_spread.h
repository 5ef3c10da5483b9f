// The rays that count as equal to a given one (E_ray of core/judge.h), as a box in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// The distance from a finite x to the next larger float magnitude: 2^(floor(log2 |x|) - 23), at
/// least the smallest denormal.
inline double float_ulp(double x) {
    constexpr int kMantissaBits = 23;
    constexpr int kLeastExponent = -149;
    if (x == 0.0) return std::ldexp(1.0, kLeastExponent);
    return std::ldexp(1.0, std::max(std::ilogb(x) - kMantissaBits, kLeastExponent));
}

inline double largest_component(const dvec3& v) {
    const dvec3 a = glm::abs(v);
    return std::max({a.x, a.y, a.z});
}

/// A ray in double, and how far each coordinate of its origin and direction may be moved. The
/// interval is never moved.
struct SpreadRay {
    dvec3 org{0.0};
    dvec3 dir{0.0};
    double tmin = 0.0;
    double tmax = std::numeric_limits<double>::infinity();
    double org_reach = 0.0;
    double dir_reach = 0.0;

    /// How far from the given ray's point a moved ray's point at t can be, in each coordinate.
    double reach(double t) const { return org_reach + std::max(t, 0.0) * dir_reach; }
};

/// The ray as given, without any reach.
inline SpreadRay exact_ray(const Ray& ray) {
    return {.org = dvec3(ray.org), .dir = dvec3(ray.dir), .tmin = ray.tmin, .tmax = ray.tmax};
}

/// E_ray: origin moved by at most kReachUlps ulp of the larger of the ray's and the scene box's
/// largest coordinate, direction by as many ulp of its largest component.
inline constexpr double kReachUlps = 4.0;

inline SpreadRay e_ray(const Ray& ray, double scene_magnitude) {
    SpreadRay spread = exact_ray(ray);
    const double org_scale = std::max(largest_component(spread.org), scene_magnitude);
    spread.org_reach = kReachUlps * float_ulp(org_scale);
    spread.dir_reach = kReachUlps * float_ulp(largest_component(spread.dir));
    return spread;
}

/// True if the ray can hit anything: finite origin and direction, the direction not 0, and an
/// interval 0 <= tmin <= tmax. Any other ray is a miss by definition.
inline bool is_traceable(const Ray& ray) {
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(ray.org[k]) || !std::isfinite(ray.dir[k])) return false;
    }
    return ray.dir != vec3(0.0f) && ray.tmin >= 0.0f && ray.tmin <= ray.tmax;
}

}  // namespace onepass
