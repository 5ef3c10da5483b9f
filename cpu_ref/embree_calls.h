// How rays are handed to Embree: one a call, in packets of 8 or 16, or as a stream.
//
// The same tree and the same tests lie behind all of them; they differ in how many rays walk it
// together. This page and embree_scene.h are what the rest of the program sees of Embree.
#pragma once

#include <cstdint>
#include <span>

#include "core/tracer.h"
#include "core/types.h"

struct RTCSceneTy;

namespace onepass {

/// rtcIntersect1, rtcIntersect8, rtcIntersect16, rtcIntersect1M; and the rtcOccluded of each.
enum class EmbreeCall { one, packet8, packet16, stream };

/// What Embree is told of rays that come together, RTC_INTERSECT_CONTEXT_FLAG_(IN)COHERENT, when it
/// is asked for closest hits.
enum class Coherence { incoherent, coherent };

/// True if rays that follow each other go nearly the same way, so that they would visit the same
/// nodes: in nine of ten runs of 16 all directions are within 8 degrees of the first.
bool are_coherent(std::span<const Ray> rays);

struct EmbreeQuery {
    Query query = Query::closest;
    EmbreeCall call = EmbreeCall::one;
    Coherence coherence = Coherence::incoherent;
    bool instanced = true;  ///< false: the scene has no instances, and every hit is of instance 0
};

/// The answer to an `any` query whose ray is occluded: Embree gives neither ids nor t, so these are
/// instance 0, triangle 0 at tmin.
Hit some_hit(const Ray& ray);

/// Answers rays[i] in hits[i] for every i of `which`, in the calling thread; leaves the others.
/// Each of these rays must pass oracle_can_take() and not be empty.
void ask_embree(RTCSceneTy* scene, const EmbreeQuery& query, std::span<const Ray> rays,
                std::span<const uint32_t> which, std::span<Hit> hits);

}  // namespace onepass
