// The seam to whoever decides who is right when a tracer and the oracle disagree.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/tracer.h"
#include "core/types.h"

namespace onepass {

/// The class of one compared ray. Every ray falls into exactly one.
///
/// E_ray, the rays that count as equal to the given one: each coordinate of the origin moved by at
/// most 4 ulp of the larger of the ray's and the scene box's largest absolute coordinate, each
/// component of the direction by at most 4 ulp of its largest component; the mesh unmoved and
/// shared vertices shared.
enum class HitClass : uint8_t {
    agree,          ///< the nearest surface, t within kTUlps ulps of the true t
    tie,            ///< equal true distance, another triangle; or t equal to tmin or tmax
    edge,           ///< exactly right for some ray of E_ray
    false_miss,     ///< missed although every ray of E_ray hits
    false_hit,      ///< hit although no ray of E_ray hits anything
    wrong_surface,  ///< hit a triangle that is nearest for no ray of E_ray
    t_error,        ///< the right triangle, t right for no ray of E_ray
};
inline constexpr size_t kHitClassCount = 7;

std::string_view to_string(HitClass hit_class);

/// The classes that a check never lets pass silently.
constexpr bool is_error(HitClass c) {
    return c == HitClass::false_miss || c == HitClass::false_hit || c == HitClass::wrong_surface ||
           c == HitClass::t_error;
}

/// How far a t may be from the true one and still `agree`: 16 ulps, the bound of Embree's own
/// `verify` program.
inline constexpr double kTUlps = 16.0;

/// What a judge says of one answer to one ray.
struct Verdict {
    HitClass hit_class = HitClass::agree;
    double true_t = 0.0;  ///< nearest true distance; +inf for a true miss
    uint32_t true_prim_id = kNoId;
    uint32_t true_inst_id = kNoId;
    double t_error_ulps =
        0.0;  ///< |t - true t of the answered triangle| in ulps of t; NaN: no such t
    double backward_error = 0.0;  ///< least move found that makes the answer right, in units of the
                                  ///< bounds of E_ray; 0 agree or tie, in (0, 1] edge, else +inf
};

/// Decides, by arithmetic better than the tracers', what a ray truly hits.
class Judge {
  public:
    virtual ~Judge() = default;

    /// How it decides, printed with every result: "double precision (stand-in ...)", "exact".
    virtual std::string_view name() const = 0;

    /// One verdict an answer. The truth about the ray is computed once for all of them.
    virtual std::vector<Verdict> judge(const Ray& ray, Query query,
                                       std::span<const Hit> answers) const = 0;
};

}  // namespace onepass
