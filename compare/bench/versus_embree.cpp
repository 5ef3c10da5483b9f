// Embree's side of the benchmarks, and the ratio.
#include "compare/bench/versus_embree.h"

#include <cstring>

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "compare/statistics.h"
#include "core/error.h"

namespace onepass {

namespace {

RTCDevice new_device() {
    const RTCDevice device = rtcNewDevice(nullptr);
    if (device == nullptr) {
        throw Error({.where = "rtcNewDevice",
                     .got = "no device",
                     .expected = "a usable Embree",
                     .remedy = "See `onepass doctor`."},
                    Error::Kind::device);
    }
    return device;
}

/// The object's triangles, committed.
RTCGeometry new_triangles(RTCDevice device, const Object& object) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(vec3), object.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(uvec3), object.triangles.size());
    std::memcpy(vertices, object.positions.data(), object.positions.size() * sizeof(vec3));
    std::memcpy(indices, object.triangles.data(), object.triangles.size() * sizeof(uvec3));
    rtcCommitGeometry(geometry);
    return geometry;
}

}  // namespace

struct EmbreeCommit::Impl {
    RTCDevice device = nullptr;
    RTCGeometry geometry = nullptr;
};

EmbreeCommit::EmbreeCommit(const Scene& scene) : impl_(std::make_unique<Impl>()) {
    ONEPASS_CHECK_EQ(scene.objects.size(), size_t{1});
    impl_->device = new_device();
    impl_->geometry = new_triangles(impl_->device, scene.objects[0]);
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

struct EmbreeRecommit::Impl {
    RTCDevice device = nullptr;
    std::vector<RTCScene> objects;
    std::vector<RTCGeometry> instances;
    RTCScene top = nullptr;
};

EmbreeRecommit::EmbreeRecommit(const Scene& scene) : impl_(std::make_unique<Impl>()) {
    impl_->device = new_device();
    for (const Object& object : scene.objects) {
        const RTCGeometry triangles = new_triangles(impl_->device, object);
        impl_->objects.push_back(rtcNewScene(impl_->device));
        rtcAttachGeometry(impl_->objects.back(), triangles);
        rtcReleaseGeometry(triangles);
        rtcCommitScene(impl_->objects.back());
    }
    impl_->top = rtcNewScene(impl_->device);
    rtcSetSceneBuildQuality(impl_->top, RTC_BUILD_QUALITY_MEDIUM);
    for (const Instance& instance : scene.instances) {
        const RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, impl_->objects[instance.object]);
        rtcAttachGeometry(impl_->top, geometry);
        impl_->instances.push_back(geometry);
    }
}

EmbreeRecommit::~EmbreeRecommit() {
    for (const RTCGeometry geometry : impl_->instances) rtcReleaseGeometry(geometry);
    rtcReleaseScene(impl_->top);
    for (const RTCScene object : impl_->objects) rtcReleaseScene(object);
    rtcReleaseDevice(impl_->device);
}

double EmbreeRecommit::recommit_ms(std::span<const Affine> world_from_object) {
    const auto start = std::chrono::steady_clock::now();
    constexpr size_t kInstancesATask = 512;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, impl_->instances.size(), kInstancesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              rtcSetGeometryTransform(impl_->instances[i], 0,
                                                      RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                                                      &world_from_object[i][0].x);
                              rtcCommitGeometry(impl_->instances[i]);
                          }
                      });
    rtcCommitScene(impl_->top);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
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
