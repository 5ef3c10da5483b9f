// Embree's side of the build benchmarks, and the ratio.
#include "compare/bench/versus_embree.h"

#include <cstring>

#include <embree3/rtcore.h>

#include "compare/statistics.h"
#include "core/error.h"

namespace onepass {

struct EmbreeCommit::Impl {
    RTCDevice device = nullptr;
    RTCGeometry geometry = nullptr;
};

EmbreeCommit::EmbreeCommit(const Scene& scene) : impl_(std::make_unique<Impl>()) {
    ONEPASS_CHECK_EQ(scene.objects.size(), size_t{1});
    const Object& object = scene.objects[0];
    impl_->device = rtcNewDevice(nullptr);
    if (impl_->device == nullptr) {
        throw Error({.where = "rtcNewDevice",
                     .got = "no device",
                     .expected = "a usable Embree",
                     .remedy = "See `onepass doctor`."},
                    Error::Kind::device);
    }
    impl_->geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices =
        rtcSetNewGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(vec3), object.positions.size());
    void* indices =
        rtcSetNewGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(uvec3), object.triangles.size());
    std::memcpy(vertices, object.positions.data(), object.positions.size() * sizeof(vec3));
    std::memcpy(indices, object.triangles.data(), object.triangles.size() * sizeof(uvec3));
    rtcCommitGeometry(impl_->geometry);
}

EmbreeCommit::~EmbreeCommit() {
    rtcReleaseGeometry(impl_->geometry);
    rtcReleaseDevice(impl_->device);
}

double EmbreeCommit::commit_ms() {
    const RTCScene scene = rtcNewScene(impl_->device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene, impl_->geometry);
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    rtcReleaseScene(scene);
    return elapsed.count();
}

void report_ratio(benchmark::State& state, const std::vector<double>& ours_ms,
                  const std::vector<double>& embree_ms) {
    constexpr uint64_t kBootstrapSeed = 1;
    const RatioInterval ratio = ratio_of_medians(ours_ms, embree_ms, kBootstrapSeed);
    state.counters["median_ms"] = median(ours_ms);
    state.counters["embree_commit_ms"] = median(embree_ms);
    state.counters["ratio_to_embree_commit"] = ratio.ratio;
    state.counters["ratio_low"] = ratio.low;
    state.counters["ratio_high"] = ratio.high;
}

}  // namespace onepass
