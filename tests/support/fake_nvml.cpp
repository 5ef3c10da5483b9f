// A management library of one or more GPUs that do not exist, loaded by the test of the clocks.
#include <cstdlib>
#include <cstring>

namespace {

constexpr int kSuccess = 0;
constexpr int kNotSupported = 3;

}  // namespace

extern "C" {

int nvmlInit_v2() { return kSuccess; }
int nvmlShutdown() { return kSuccess; }

int nvmlDeviceGetCount_v2(unsigned* count) {
    const char* devices = std::getenv("FAKE_NVML_DEVICES");
    *count = devices ? static_cast<unsigned>(std::atoi(devices)) : 1;
    return kSuccess;
}

int nvmlDeviceGetHandleByIndex_v2(unsigned, void** device) {
    static int some_device;
    *device = &some_device;
    return kSuccess;
}

int nvmlDeviceGetName(void*, char* name, unsigned length) {
    std::strncpy(name, "Fake GPU", length);
    return kSuccess;
}

int nvmlDeviceGetClockInfo(void*, int type, unsigned* mhz) {
    constexpr int kSm = 1, kMemory = 2;
    if (type != kSm && type != kMemory) return kNotSupported;
    *mhz = type == kSm ? 1980 : 2619;
    return kSuccess;
}

int nvmlDeviceGetTemperature(void*, int, unsigned*) { return kNotSupported; }

}  // extern "C"
