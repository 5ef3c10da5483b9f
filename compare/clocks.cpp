#include "compare/clocks.h"

#include <array>
#include <limits>

#include <dlfcn.h>
#include <fmt/format.h>

namespace onepass {
namespace {

// The part of the library's interface that is used; its header need not be there to build.
using NvmlDevice = struct NvmlDeviceOpaque*;
constexpr int kSuccess = 0;
constexpr int kClockSm = 1;
constexpr int kClockMemory = 2;
constexpr int kTemperatureGpu = 0;

constexpr double kNotTold = std::numeric_limits<double>::quiet_NaN();

}  // namespace

struct ClockReader::Library {
    void* handle = nullptr;
    bool running = false;
    NvmlDevice device = nullptr;
    int (*init)() = nullptr;
    int (*shutdown)() = nullptr;
    int (*device_count)(unsigned*) = nullptr;
    int (*device_by_index)(unsigned, NvmlDevice*) = nullptr;
    int (*device_name)(NvmlDevice, char*, unsigned) = nullptr;
    int (*clock)(NvmlDevice, int, unsigned*) = nullptr;
    int (*temperature)(NvmlDevice, int, unsigned*) = nullptr;

    Library() = default;
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    ~Library() {
        if (running) shutdown();
        if (handle != nullptr) dlclose(handle);
    }

    /// False if the library has no such function.
    template <class F>
    bool find(const char* name, F*& function) {
        function = reinterpret_cast<F*>(dlsym(handle, name));
        return function != nullptr;
    }
};

ClockReader::ClockReader(const std::string& library) : library_(std::make_unique<Library>()) {
    const std::string why_not = connect(library);
    if (why_not.empty()) return;
    library_.reset();
    source_ = why_not;
}

ClockReader::~ClockReader() = default;

/// Sets the device and its name; what stands in the way, or empty.
std::string ClockReader::connect(const std::string& library) {
    Library& nvml = *library_;
    nvml.handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (nvml.handle == nullptr) return "not known: no " + library + " on this machine";
    const bool whole = nvml.find("nvmlInit_v2", nvml.init) &&
                       nvml.find("nvmlShutdown", nvml.shutdown) &&
                       nvml.find("nvmlDeviceGetCount_v2", nvml.device_count) &&
                       nvml.find("nvmlDeviceGetHandleByIndex_v2", nvml.device_by_index) &&
                       nvml.find("nvmlDeviceGetName", nvml.device_name) &&
                       nvml.find("nvmlDeviceGetClockInfo", nvml.clock) &&
                       nvml.find("nvmlDeviceGetTemperature", nvml.temperature);
    if (!whole) return "not known: " + library + " lacks a function";
    if (nvml.init() != kSuccess) return "not known: " + library + " does not start";
    nvml.running = true;

    unsigned devices = 0;
    if (nvml.device_count(&devices) != kSuccess) devices = 0;
    if (devices != 1) {
        return fmt::format("not known: {} tells of {} devices, not of one", library, devices);
    }
    std::array<char, 96> name{};
    if (nvml.device_by_index(0, &nvml.device) != kSuccess ||
        nvml.device_name(nvml.device, name.data(), name.size()) != kSuccess) {
        return "not known: " + library + " does not give the device away";
    }
    source_ = name.data();
    return {};
}

std::optional<ClockReading> ClockReader::read() const {
    if (!library_) return {};
    const auto told = [](int status, unsigned value) {
        return status == kSuccess ? static_cast<double>(value) : kNotTold;
    };
    const auto clock = [&](int which) {
        unsigned mhz = 0;
        const int status = library_->clock(library_->device, which, &mhz);
        return told(status, mhz);
    };
    unsigned celsius = 0;
    const int status = library_->temperature(library_->device, kTemperatureGpu, &celsius);
    return ClockReading{clock(kClockSm), clock(kClockMemory), told(status, celsius)};
}

}  // namespace onepass
