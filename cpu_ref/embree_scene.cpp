// Devices, scenes and commits.
//
// Two traps of Embree 3.13.5 shape it. A device made with "threads=N" limits TBB in the whole
// process, so every device is made without, and the number of threads is the caller's task arena.
// And the ray that an instance sees is checked by the same assertions as the ray that we pass, so
// the limits are computed from the transforms.
#include "cpu_ref/embree_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <vector>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "core/error.h"
#include "cpu_ref/embree_tracer.h"

namespace onepass {

namespace {

/// What Embree tells through its callbacks while it builds.
struct DeviceReports {
    std::atomic<ptrdiff_t> bytes{0};
    std::mutex mutex;
    std::string message;
};

bool on_memory(void* user, ssize_t bytes, bool /*post*/) {
    static_cast<DeviceReports*>(user)->bytes += bytes;
    return true;
}

void on_error(void* user, RTCError /*code*/, const char* text) {
    DeviceReports& reports = *static_cast<DeviceReports*>(user);
    const std::lock_guard lock(reports.mutex);
    if (reports.message.empty() && text != nullptr) reports.message = text;
}

std::string_view error_name(RTCError code) {
    switch (code) {
        case RTC_ERROR_NONE:
            return "no error";
        case RTC_ERROR_UNKNOWN:
            return "an unknown error";
        case RTC_ERROR_INVALID_ARGUMENT:
            return "an invalid argument";
        case RTC_ERROR_INVALID_OPERATION:
            return "an invalid operation";
        case RTC_ERROR_OUT_OF_MEMORY:
            return "lack of memory";
        case RTC_ERROR_UNSUPPORTED_CPU:
            return "an unsupported CPU";
        case RTC_ERROR_CANCELLED:
            return "a cancelled build";
    }
    return "an error without a name";
}

Error device_error(const std::string& where, RTCError code, const std::string& message) {
    const bool is_device = code == RTC_ERROR_OUT_OF_MEMORY || code == RTC_ERROR_UNSUPPORTED_CPU;
    return Error(
        {.where = where,
         .got = fmt::format("{}{}{}", error_name(code), message.empty() ? "" : ": ", message),
         .expected = "a device and a scene that Embree accepts",
         .remedy =
             is_device ? "Use a smaller scene or another machine" : "Check the scene's geometry"},
        is_device ? Error::Kind::device : Error::Kind::input);
}

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceDeleter>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneDeleter>;

DeviceHandle open_device() {
    DeviceHandle device(rtcNewDevice(nullptr));
    if (!device) throw device_error("Embree", rtcGetDeviceError(nullptr), "no device");
    return device;
}

RTCBuildQuality rtc_quality(EmbreeOptions::Quality quality) {
    switch (quality) {
        case EmbreeOptions::Quality::low:
            return RTC_BUILD_QUALITY_LOW;
        case EmbreeOptions::Quality::medium:
            return RTC_BUILD_QUALITY_MEDIUM;
        case EmbreeOptions::Quality::high:
            return RTC_BUILD_QUALITY_HIGH;
    }
    return RTC_BUILD_QUALITY_MEDIUM;
}

SceneHandle new_scene(RTCDevice device, const EmbreeOptions& options) {
    SceneHandle scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), options.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene.get(), rtc_quality(options.quality));
    return scene;
}

/// Attaches the geometry under the id and gives up our reference to it.
void attach(RTCScene scene, RTCGeometry geometry, uint32_t id, const EmbreeOptions& options) {
    rtcSetGeometryBuildQuality(geometry, rtc_quality(options.quality));
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

SceneHandle commit_object(RTCDevice device, const Object& object, const EmbreeOptions& options) {
    SceneHandle scene = new_scene(device, options);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree's own buffers: it may read 16 bytes at the last vertex, past the end of ours.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(vec3), object.positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(uvec3), object.triangles.size());
    if (vertices == nullptr || indices == nullptr) {
        rtcReleaseGeometry(geometry);
        throw device_error("object " + object.name, rtcGetDeviceError(device), "no buffer");
    }
    std::memcpy(vertices, object.positions.data(), object.positions.size() * sizeof(vec3));
    std::memcpy(indices, object.triangles.data(), object.triangles.size() * sizeof(uvec3));
    attach(scene.get(), geometry, 0, options);
    rtcCommitScene(scene.get());
    return scene;
}

SceneHandle commit_instances(RTCDevice device, const Scene& scene,
                             const std::vector<SceneHandle>& objects,
                             const EmbreeOptions& options) {
    SceneHandle top = new_scene(device, options);
    for (uint32_t id = 0; id < scene.instances.size(); ++id) {
        const Instance& instance = scene.instances[id];
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, objects[instance.object].get());
        // Affine is four columns of three floats, which is Embree's column-major 3 x 4.
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                                &instance.world_from_object[0][0]);
        attach(top.get(), geometry, id, options);
    }
    rtcCommitScene(top.get());
    return top;
}

/// The largest sum of absolute values of a row of the linear part: the most by which the map
/// stretches the largest component of a vector.
template <class AffineMap>
double largest_row_sum(const AffineMap& m) {
    double largest = 0.0;
    for (int row = 0; row < 3; ++row) {
        largest = std::max(largest, std::abs(double{m[0][row]}) + std::abs(double{m[1][row]}) +
                                        std::abs(double{m[2][row]}));
    }
    return largest;
}

/// How far Embree's float inverse of a transform may be from the true one, relative to its largest
/// entry, before we refuse the transform: cofactors that underflow show as an error of 1, a plain
/// badly conditioned matrix as far less.
constexpr double kInverseError = 1e-2;

/// Embree inverts transforms in float, by cofactors and determinant. Where those leave float's
/// range the object would be traced in the wrong place, or with infinite rays that abort.
bool float_inverse_holds(const Affine& world_from_object) {
    const vec3 a = world_from_object[0];
    const vec3 b = world_from_object[1];
    const vec3 c = world_from_object[2];
    const vec3 cofactors[3] = {glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)};
    const float det = glm::dot(a, cofactors[0]);
    const DAffine exact = inverse(world_from_object);
    const double largest = largest_row_sum(exact);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            const double error = std::abs(cofactors[row][column] / det - exact[column][row]);
            if (!(error <= kInverseError * largest)) return false;
        }
    }
    return true;
}

/// Narrows the limits to what stays within Embree's bounds in the instance's object space.
RayLimits narrowed(const RayLimits& limits, const Affine& world_from_object) {
    // Covers kInverseError and the rounding of the transformed ray.
    constexpr double kMargin = 0.5;
    const DAffine object_from_world = inverse(world_from_object);
    const double stretch = largest_row_sum(object_from_world);
    const dvec3 offset = glm::abs(object_from_world[3]);
    const double room = kEmbreeLargest * kMargin - std::max({offset.x, offset.y, offset.z});
    const double least = kEmbreeLeastDirection / kMargin * largest_row_sum(world_from_object);
    return {std::min(limits.largest_org, static_cast<float>(std::max(0.0, room / stretch))),
            std::min(limits.largest_dir, static_cast<float>(kEmbreeLargest * kMargin / stretch)),
            std::max(limits.least_dir, static_cast<float>(least))};
}

RayLimits limits_of(std::span<const Affine> world_from_object) {
    RayLimits limits;
    for (const Affine& transform : world_from_object) limits = narrowed(limits, transform);
    return limits;
}

bool is_direct(const Scene& scene) {
    return scene.animation.empty() && scene.instances.size() == 1 &&
           scene.instances[0].world_from_object == affine_identity();
}

void check_magnitude(const std::string& where, const Bounds& bounds) {
    if (bounds.magnitude() <= kEmbreeLargest) return;
    throw Error({.where = where,
                 .got = fmt::format("a coordinate of magnitude {:g}", bounds.magnitude()),
                 .expected = fmt::format("at most {:g}, what Embree can hold", kEmbreeLargest),
                 .remedy = "Scale the scene down"});
}

/// What Embree has to know of an instance to tell whether it can hold it.
struct Placed {
    std::string name;
    Bounds box;  ///< of its object
};

std::vector<Placed> placed_objects(const Scene& scene) {
    std::vector<Bounds> boxes;
    for (const Object& object : scene.objects) boxes.push_back(object_bounds(object));
    std::vector<Placed> placed;
    for (const Instance& instance : scene.instances) {
        placed.push_back({instance.name, boxes[instance.object]});
    }
    return placed;
}

std::vector<Affine> transforms_of(const Scene& scene) {
    std::vector<Affine> transforms;
    for (const Instance& instance : scene.instances) {
        transforms.push_back(instance.world_from_object);
    }
    return transforms;
}

void check_transforms(const std::vector<Placed>& placed,
                      std::span<const Affine> world_from_object) {
    for (size_t i = 0; i < placed.size(); ++i) {
        const Affine& transform = world_from_object[i];
        const std::string where = "instance " + placed[i].name;
        if (!is_invertible(transform)) {
            throw Error({.where = where,
                         .got = "a transform that flattens space, or is not finite",
                         .expected = "one that can be inverted",
                         .remedy = "Give it finite, non-zero scales along three axes"});
        }
        if (!float_inverse_holds(transform)) {
            throw Error({.where = where,
                         .got = "a transform whose float inverse overflows or underflows",
                         .expected = "scales that Embree can invert in single precision",
                         .remedy = "Bring the scales of the transform nearer to 1"});
        }
        check_magnitude(where, transform_bounds(transform, placed[i].box));
    }
}

float largest_component(const vec3& v) {
    const vec3 a = glm::abs(v);
    return std::max({a.x, a.y, a.z});
}

/// False for a NaN in any component, which std::max would lose.
bool within(const vec3& v, float limit) {
    return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}

/// The list of one ray.
constexpr std::array<uint32_t, 1> kOnlyOne = {0};

}  // namespace

bool oracle_can_take(const Ray& ray, const RayLimits& limits) {
    if (!within(ray.org, limits.largest_org) || !within(ray.dir, limits.largest_dir)) return false;
    const float speed = largest_component(ray.dir);
    if (speed != 0.0f && speed < limits.least_dir) return false;
    return ray.tmin >= 0.0f && ray.tmin < kInfinity && !std::isnan(ray.tmax);
}

bool is_empty_ray(const Ray& ray) { return ray.dir == vec3(0.0f) || ray.tmax < ray.tmin; }

// The handles are released in reverse order: scenes before their device, and the device before the
// reports that its callbacks write to.
struct EmbreeScene::Impl {
    DeviceReports reports;
    DeviceHandle device;
    std::vector<SceneHandle> objects;
    SceneHandle top;
    RTCScene traced = nullptr;
    std::string name;
    std::vector<Placed> placed;
    RayLimits limits;
    double build_ms = 0.0;
    double bytes = 0.0;
    uint64_t object_builds = 0;
    uint64_t top_builds = 0;

    /// Embree reports errors at the device, not at the call.
    void throw_errors(const std::string& what) {
        const RTCError error = rtcGetDeviceError(device.get());
        if (error == RTC_ERROR_NONE) return;
        const std::lock_guard lock(reports.mutex);
        throw device_error(what + " of scene " + name, error, reports.message);
    }
};

EmbreeScene::EmbreeScene(const Scene& scene, const EmbreeOptions& options)
    : impl_(std::make_unique<Impl>()) {
    for (const Object& object : scene.objects) {
        check_magnitude("object " + object.name, object_bounds(object));
    }
    const std::vector<Affine> transforms = transforms_of(scene);
    impl_->name = scene.name;
    impl_->placed = placed_objects(scene);
    check_transforms(impl_->placed, transforms);
    impl_->device = open_device();
    const RTCDevice device = impl_->device.get();
    rtcSetDeviceErrorFunction(device, on_error, &impl_->reports);
    rtcSetDeviceMemoryMonitorFunction(device, on_memory, &impl_->reports);

    // Commit bottom up: an instance's scene must be committed before the instance.
    const auto start = std::chrono::steady_clock::now();
    for (const Object& object : scene.objects) {
        impl_->objects.push_back(commit_object(device, object, options));
        ++impl_->object_builds;
    }
    if (is_direct(scene)) {
        impl_->traced = impl_->objects[scene.instances[0].object].get();
    } else {
        impl_->top = commit_instances(device, scene, impl_->objects, options);
        impl_->traced = impl_->top.get();
        impl_->limits = limits_of(transforms);
        ++impl_->top_builds;
    }
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    impl_->throw_errors("Embree build");
    impl_->build_ms = elapsed.count();
    impl_->bytes = static_cast<double>(impl_->reports.bytes);
}

void EmbreeScene::update(std::span<const Affine> world_from_object) {
    ONEPASS_CHECK_EQ(world_from_object.size(), impl_->placed.size());
    ONEPASS_CHECK(instanced());
    check_transforms(impl_->placed, world_from_object);
    impl_->limits = limits_of(world_from_object);
    for (uint32_t id = 0; id < world_from_object.size(); ++id) {
        const RTCGeometry geometry = rtcGetGeometry(impl_->top.get(), id);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                                &world_from_object[id][0][0]);
        rtcCommitGeometry(geometry);
    }
    rtcCommitScene(impl_->top.get());
    ++impl_->top_builds;
    impl_->throw_errors("Embree update");
}

EmbreeScene::~EmbreeScene() = default;

Hit EmbreeScene::closest(const Ray& ray) const {
    Hit hit;
    ask(Query::closest, EmbreeCall::one, {}, {&ray, 1}, kOnlyOne, {&hit, 1});
    return hit;
}

bool EmbreeScene::occluded(const Ray& ray) const {
    Hit hit;
    ask(Query::any, EmbreeCall::one, {}, {&ray, 1}, kOnlyOne, {&hit, 1});
    return hit.is_hit();
}

void EmbreeScene::ask(Query query, EmbreeCall call, Coherence coherence, std::span<const Ray> rays,
                      std::span<const uint32_t> which, std::span<Hit> hits) const {
    ask_embree(impl_->traced, {query, call, coherence, instanced()}, rays, which, hits);
}

const RayLimits& EmbreeScene::limits() const { return impl_->limits; }
bool EmbreeScene::instanced() const { return impl_->top != nullptr; }
double EmbreeScene::build_ms() const { return impl_->build_ms; }
double EmbreeScene::bytes() const { return impl_->bytes; }
uint64_t EmbreeScene::object_builds() const { return impl_->object_builds; }
uint64_t EmbreeScene::top_builds() const { return impl_->top_builds; }

std::string embree_version() {
    const DeviceHandle device = open_device();
    const auto property = [&](RTCDeviceProperty p) {
        return rtcGetDeviceProperty(device.get(), p);
    };
    return fmt::format("Embree {}.{}.{}", property(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                       property(RTC_DEVICE_PROPERTY_VERSION_MINOR),
                       property(RTC_DEVICE_PROPERTY_VERSION_PATCH));
}

std::string embree_header_version() { return "Embree " RTC_VERSION_STRING; }

std::string embree_description() {
    const DeviceHandle device = open_device();
    const auto has = [&](RTCDeviceProperty p) {
        return rtcGetDeviceProperty(device.get(), p) != 0;
    };
    const int width = has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)  ? 16
                      : has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8
                                                                       : 4;
    const bool is_tbb = rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_TASKING_SYSTEM) == 1;
    return fmt::format("{} (Debian build with assertions), {} tasking, native ray packets up to {}",
                       embree_version(), is_tbb ? "TBB" : "internal", width);
}

}  // namespace onepass
