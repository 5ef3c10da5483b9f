// The seam to whoever decides who is right when a tracer and the oracle disagree.
#pragma once

#include <array>
#include <limits>
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

/// How a ray truly stands to one triangle, and how near that is to being otherwise.
struct Meeting {
    uint32_t inst_id = kNoId;
    uint32_t prim_id = kNoId;

    bool crosses = false;  ///< the line does, be it outside [tmin, tmax]

    // Where the line meets the triangle's plane; NaN and "" if it does not.
    double t = std::numeric_limits<double>::quiet_NaN();  ///< the real t, rounded
    std::string t_digits;                                 ///< the real t, cut after 30 digits
    double u = std::numeric_limits<double>::quiet_NaN();  ///< rounded; outside [0, 1] beside it
    double v = std::numeric_limits<double>::quiet_NaN();
    double incidence = 0.0;  ///< |d.n| / (|d| |n|): 1 head-on, 0 along the plane

    // The edge that the line passes nearest, by what E_ray allows there.
    uint32_t edge = 0;           ///< from corner `edge` to the next one
    double edge_distance = 0.0;  ///< largest component of the least shift onto it, in scene units
    double edge_moves = 0.0;     ///< the same in units of the bounds of E_ray: up to 1, rays that
                                 ///< count as equal may pass on the other side
    bool on_edge = false;        ///< exactly through an edge or a corner

    double gap_ulps = std::numeric_limits<double>::infinity();  ///< of a hit: from t to the next
                                                                ///< hit's, in float ulps; 0: a tie
    bool at_interval_end = false;                               ///< t is exactly tmin or tmax
    bool is_right = false;                                      ///< naming it is a right answer
    bool close_side = false;   ///< exact numbers had to decide whether the line crosses it
    bool close_order = false;  ///< exact numbers had to decide its t's place
};

/// All that is true of one ray, for a reader.
struct RayTruth {
    bool traceable = true;      ///< false: not finite, or empty: a miss by definition
    std::vector<Meeting> hits;  ///< all of them in [tmin, tmax], nearest first, ties by ids
    std::vector<Meeting>
        passed;  ///< not hit, but near: an edge within E_ray, or asked about; by edge_moves
    bool miss_is_right = true;
    double org_reach = 0.0;  ///< the bounds of E_ray: of each coordinate of the origin ...
    double dir_reach = 0.0;  ///< ... and of the direction
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

    /// The truth about a ray that asks for its closest hit. `answers`: triangles to be told of even
    /// if the ray passes them by; ids that name nothing are left out.
    virtual RayTruth explain(const Ray& ray, std::span<const Hit> answers) const = 0;
};

}  // namespace onepass
