// The vocabulary every module shares: vectors, rays, hits, per-ray counters and flags.
//
// Vectors are GLM's; column vectors, right-handed, lengths in scene units, times in ms.
#pragma once

#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

namespace onepass {

using glm::dvec3;
using glm::ivec3;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr uint32_t kNoId = 0xFFFFFFFFu;

/// A ray; points are org + t * dir. `dir` need not be unit length, and t is in units of `dir`.
///
/// Layout: eight floats, the row of a ray file (`.npy`, float32, N x 8: org, tmin, dir, tmax).
struct Ray {
    vec3 org{0.0f};
    float tmin = 0.0f;
    vec3 dir{0.0f, 0.0f, -1.0f};
    float tmax = kInfinity;
};
static_assert(sizeof(Ray) == 32);

/// The answer to a ray. 0 <= tmin <= t <= tmax. A miss: t = +inf, both ids kNoId, u = v = 0.
///
/// (u, v) as in Embree: the point is (1 - u - v) v0 + u v1 + v v2. `prim_id` indexes
/// Object::triangles of the instance's object; `inst_id` indexes Scene::instances.
struct Hit {
    float t = kInfinity;
    float u = 0.0f;
    float v = 0.0f;
    uint32_t prim_id = kNoId;
    uint32_t inst_id = kNoId;

    bool is_hit() const { return inst_id != kNoId; }
    bool operator==(const Hit&) const = default;
};
static_assert(sizeof(Hit) == 20);

/// What a ray (or a pixel, all its rays together) cost.
struct RayCounters {
    uint32_t cells = 0;       ///< cells visited, both levels
    uint32_t tests = 0;       ///< ray-triangle tests
    uint32_t references = 0;  ///< list entries read, both levels
    uint32_t rays = 0;  ///< rays cast: 1 for `cast`; primary + shadow + reflection for `render`

    bool operator==(const RayCounters&) const = default;
};

/// Per-ray flags, a bit set. A flag is always counted and printed, never silent.
enum RayFlag : uint32_t {
    kFlagExhausted = 1,  ///< a loop ended by its budget, not by its own condition
    kFlagOracleInvalid =
        2,  ///< the oracle cannot take this ray (NaN, inf, ...); answered as a miss
};

}  // namespace onepass
