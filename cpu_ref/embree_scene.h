// Embree's scene behind our words: build, closest hit, occlusion. embree_scene.cpp and
// embree_calls.cpp are the only files that include Embree's headers; everything else of cpu_ref and
// the program sees this page and embree_calls.h.
//
// Debian's Embree is built with assertions, so a ray it does not like ends the process. Which rays
// those are stands here, in oracle_can_take(); no query must ever get another.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"
#include "core/types.h"
#include "cpu_ref/embree_calls.h"

namespace onepass {

/// FLT_LARGE of Embree 3.13: it asserts that no coordinate of a ray's origin or direction is
/// larger, and silently leaves out triangles with a larger coordinate.
inline constexpr float kEmbreeLargest = 1.844e18f;

/// min_rcp_input of Embree 3.13: components of a direction nearer to 0 count as this in its box
/// tests. A direction that lies wholly below is no longer the ray asked for, and a denormal one was
/// seen to be answered with t = NaN.
inline constexpr float kEmbreeLeastDirection = 1e-18f;

/// The magnitudes that Embree can take in one scene, as largest absolute components. An instance
/// sees the ray in its object's space, where the same bounds hold, so its scale narrows them.
struct RayLimits {
    float largest_org = kEmbreeLargest;
    float largest_dir = kEmbreeLargest;
    float least_dir = kEmbreeLeastDirection;

    bool operator==(const RayLimits&) const = default;
};

/// True if Embree can be asked about this ray; false: answer a miss flagged kFlagOracleInvalid.
///
/// Takes: origin and direction within the limits (so finite), the direction not below least_dir
/// unless it is 0 altogether; tmin finite and >= 0; tmax not NaN.
/// A zero direction and an empty interval (tmax < tmin) are taken: such a ray is a miss by
/// definition, see is_empty_ray().
bool oracle_can_take(const Ray& ray, const RayLimits& limits = {});

/// True if the ray holds no point to hit: its direction is 0, or tmax < tmin. Embree finds a miss
/// too, but we do not rest on that: such a ray is answered without asking.
bool is_empty_ray(const Ray& ray);

struct EmbreeOptions {
    enum class Quality { low, medium, high };
    bool robust = true;                 ///< RTC_SCENE_FLAG_ROBUST on every scene
    Quality quality = Quality::medium;  ///< RTCBuildQuality of every scene
};

/// A committed Embree scene. Queries are const and thread-safe.
///
/// One RTCScene an object, prim ids in the order of Object::triangles; above them a scene of
/// instances whose geometry id is the index into Scene::instances. A scene that is one instance
/// with the identity transform, and stays so, is traced without the upper level, as a user of
/// Embree would.
class EmbreeScene {
  public:
    /// Builds with the TBB workers of the caller's task arena.
    /// Throws: Error if a coordinate or a transform lies outside what Embree's floats can hold
    ///         (Kind::input), or if Embree reports an error (Kind::device for lack of memory or an
    ///         unusable CPU).
    EmbreeScene(const Scene& scene, const EmbreeOptions& options);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Moves the instances, and commits them and the upper level anew; objects stay as they are.
    ///
    /// One transform an instance of a scene with an animation. Not while queries run.
    /// Throws: Error as the constructor; for a transform that Embree cannot hold before anything
    ///         has changed. Lack of memory leaves a scene that is no longer fit for use.
    void update(std::span<const Affine> world_from_object);

    /// The nearest hit in [tmin, tmax]; fast scenes leave t = tmin out. The ray must pass
    /// oracle_can_take(ray, limits()).
    Hit closest(const Ray& ray) const;
    /// True if anything is hit in [tmin, tmax]. The ray must pass oracle_can_take(ray, limits()).
    bool occluded(const Ray& ray) const;
    /// Many rays, as ask_embree() says.
    void ask(Query query, EmbreeCall call, Coherence coherence, std::span<const Ray> rays,
             std::span<const uint32_t> which, std::span<Hit> hits) const;

    const RayLimits& limits() const;
    bool instanced() const;   ///< false: the upper level is left out
    double build_ms() const;  ///< wall time of all commits: buffers in, trees out
    double bytes() const;     ///< held by the device after the build, its vertex copies included
    uint64_t object_builds() const;  ///< commits of objects since it was made
    uint64_t top_builds() const;     ///< commits of the upper level

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// "Embree 3.13.5" of the loaded library.
/// Throws: Error of Kind::device if Embree cannot open a device.
std::string embree_version();

/// "Embree 3.13.5" of the headers; needs no device.
std::string embree_header_version();

}  // namespace onepass
