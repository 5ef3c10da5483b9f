// Rays into Embree's records, and hits out of them.
//
// Rays are kept as rows and turned round for every call, as a renderer that makes its rays one by
// one would; that is part of what a call costs.
#include "cpu_ref/embree_calls.h"

#include <algorithm>
#include <array>

#include <embree3/rtcore.h>

namespace onepass {
namespace {

/// Rays of one rtcIntersect1M: their records, 20 KiB, stay in the first-level cache.
constexpr size_t kStreamRays = 256;

/// Occlusion is always asked incoherently: told that rays are coherent, rtcOccluded16 of Embree
/// 3.13.5 was seen never to come back from a scene of instances.
RTCIntersectContext context_of(const EmbreeQuery& query) {
    const bool coherent = query.query == Query::closest && query.coherence == Coherence::coherent;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

// ---- Single records ----------------------------------------------------------------------------

RTCRay to_rtc(const Ray& ray) {
    RTCRay r{};
    r.org_x = ray.org.x;
    r.org_y = ray.org.y;
    r.org_z = ray.org.z;
    r.tnear = ray.tmin;
    r.dir_x = ray.dir.x;
    r.dir_y = ray.dir.y;
    r.dir_z = ray.dir.z;
    r.tfar = ray.tmax;
    r.mask = ~0u;
    return r;
}

RTCRayHit to_rtc_hit(const Ray& ray) {
    RTCRayHit record{to_rtc(ray), {}};
    record.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    record.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return record;
}

Hit from_rtc(const RTCRayHit& record, bool instanced) {
    if (record.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {.t = record.ray.tfar,
            .u = record.hit.u,
            .v = record.hit.v,
            .prim_id = record.hit.primID,
            .inst_id = instanced ? record.hit.instID[0] : 0};
}

/// Embree's answer is tfar = -inf; the empty rays that come with it already are not asked.
bool is_occluded(float tfar) { return tfar == -kInfinity; }

Hit ask_one(RTCScene scene, const EmbreeQuery& query, const Ray& ray) {
    RTCIntersectContext context = context_of(query);
    if (query.query == Query::closest) {
        RTCRayHit record = to_rtc_hit(ray);
        rtcIntersect1(scene, &context, &record);
        return from_rtc(record, query.instanced);
    }
    RTCRay record = to_rtc(ray);
    rtcOccluded1(scene, &context, &record);
    return is_occluded(record.tfar) ? some_hit(ray) : Hit{};
}

void ask_stream(RTCScene scene, const EmbreeQuery& query, std::span<const Ray> rays,
                std::span<const uint32_t> which, std::span<Hit> hits) {
    RTCIntersectContext context = context_of(query);
    const auto count = static_cast<unsigned>(which.size());
    if (query.query == Query::closest) {
        std::array<RTCRayHit, kStreamRays> records;
        for (size_t k = 0; k < which.size(); ++k) records[k] = to_rtc_hit(rays[which[k]]);
        rtcIntersect1M(scene, &context, records.data(), count, sizeof(RTCRayHit));
        for (size_t k = 0; k < which.size(); ++k) {
            hits[which[k]] = from_rtc(records[k], query.instanced);
        }
        return;
    }
    std::array<RTCRay, kStreamRays> records;
    for (size_t k = 0; k < which.size(); ++k) records[k] = to_rtc(rays[which[k]]);
    rtcOccluded1M(scene, &context, records.data(), count, sizeof(RTCRay));
    for (size_t k = 0; k < which.size(); ++k) {
        if (is_occluded(records[k].tfar)) hits[which[k]] = some_hit(rays[which[k]]);
    }
}

// ---- Packets -----------------------------------------------------------------------------------

template <size_t N>
struct Packet;
template <>
struct Packet<8> {
    using Ray = RTCRay8;
    using RayHit = RTCRayHit8;
    static constexpr auto* kIntersect = rtcIntersect8;
    static constexpr auto* kOccluded = rtcOccluded8;
};
template <>
struct Packet<16> {
    using Ray = RTCRay16;
    using RayHit = RTCRayHit16;
    static constexpr auto* kIntersect = rtcIntersect16;
    static constexpr auto* kOccluded = rtcOccluded16;
};

template <class PacketRay>
void put(PacketRay& packet, size_t lane, const Ray& ray) {
    packet.org_x[lane] = ray.org.x;
    packet.org_y[lane] = ray.org.y;
    packet.org_z[lane] = ray.org.z;
    packet.tnear[lane] = ray.tmin;
    packet.dir_x[lane] = ray.dir.x;
    packet.dir_y[lane] = ray.dir.y;
    packet.dir_z[lane] = ray.dir.z;
    packet.time[lane] = 0.0f;
    packet.tfar[lane] = ray.tmax;
    packet.mask[lane] = ~0u;
    packet.id[lane] = 0;
    packet.flags[lane] = 0;
}

/// At most N rays. Lanes without one are switched off, and hold the first ray so that they hold
/// nothing worse.
template <size_t N>
void ask_packet(RTCScene scene, const EmbreeQuery& query, std::span<const Ray> rays,
                std::span<const uint32_t> which, std::span<Hit> hits) {
    RTCIntersectContext context = context_of(query);
    alignas(64) std::array<int, N> valid;
    const auto fill = [&](typename Packet<N>::Ray& packet) {
        for (size_t lane = 0; lane < N; ++lane) {
            const bool asked = lane < which.size();
            valid[lane] = asked ? -1 : 0;
            put(packet, lane, rays[which[asked ? lane : 0]]);
        }
    };
    if (query.query == Query::closest) {
        typename Packet<N>::RayHit packet;
        fill(packet.ray);
        std::fill_n(packet.hit.geomID, N, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(packet.hit.instID[0], N, RTC_INVALID_GEOMETRY_ID);
        Packet<N>::kIntersect(valid.data(), scene, &context, &packet);
        for (size_t lane = 0; lane < which.size(); ++lane) {
            if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
            hits[which[lane]] = {.t = packet.ray.tfar[lane],
                                 .u = packet.hit.u[lane],
                                 .v = packet.hit.v[lane],
                                 .prim_id = packet.hit.primID[lane],
                                 .inst_id = query.instanced ? packet.hit.instID[0][lane] : 0};
        }
        return;
    }
    typename Packet<N>::Ray packet;
    fill(packet);
    Packet<N>::kOccluded(valid.data(), scene, &context, &packet);
    for (size_t lane = 0; lane < which.size(); ++lane) {
        if (is_occluded(packet.tfar[lane])) hits[which[lane]] = some_hit(rays[which[lane]]);
    }
}

/// part(first, count) over [0, count), `step` at a time.
template <class Part>
void in_parts(size_t count, size_t step, const Part& part) {
    for (size_t first = 0; first < count; first += step) part(first, std::min(step, count - first));
}

}  // namespace

bool are_coherent(std::span<const Ray> rays) {
    constexpr size_t kRun = 16;
    constexpr float kLeastCosine = 0.99f;  // 8.1 degrees
    size_t runs = 0;
    size_t together = 0;
    in_parts(rays.size(), kRun, [&](size_t first, size_t count) {
        const vec3 d = rays[first].dir;
        const auto goes_along = [&](const Ray& ray) {
            return glm::dot(ray.dir, d) >= kLeastCosine * glm::length(ray.dir) * glm::length(d);
        };
        const auto run = rays.subspan(first, count);
        together += std::all_of(run.begin(), run.end(), goes_along) ? 1 : 0;
        ++runs;
    });
    return 10 * together >= 9 * runs;
}

Hit some_hit(const Ray& ray) {
    return {.t = ray.tmin, .u = 0.0f, .v = 0.0f, .prim_id = 0, .inst_id = 0};
}

void ask_embree(RTCScene scene, const EmbreeQuery& query, std::span<const Ray> rays,
                std::span<const uint32_t> which, std::span<Hit> hits) {
    const auto in_calls_of = [&](size_t size, auto&& ask) {
        for (const uint32_t i : which) hits[i] = {};
        in_parts(which.size(), size, [&](size_t first, size_t count) {
            ask(scene, query, rays, which.subspan(first, count), hits);
        });
    };
    switch (query.call) {
        case EmbreeCall::one:
            for (const uint32_t i : which) hits[i] = ask_one(scene, query, rays[i]);
            return;
        case EmbreeCall::packet8:
            return in_calls_of(8, ask_packet<8>);
        case EmbreeCall::packet16:
            return in_calls_of(16, ask_packet<16>);
        case EmbreeCall::stream:
            return in_calls_of(kStreamRays, ask_stream);
    }
}

}  // namespace onepass
