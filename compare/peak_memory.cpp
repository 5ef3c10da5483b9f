// The kernel's own count: VmRSS and VmHWM of /proc/self/status (man 5 proc).
#include "compare/peak_memory.h"

#include <fstream>
#include <sstream>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace onepass {
namespace {

std::optional<uint64_t> bytes_of_status(const std::string& key) {
    std::ifstream status("/proc/self/status");
    std::string line;
    while (std::getline(status, line)) {
        if (line.rfind(key + ":", 0) != 0) continue;
        std::istringstream words(line.substr(key.size() + 1));
        uint64_t kibibytes = 0;
        if (words >> kibibytes) return kibibytes * 1024;
    }
    return std::nullopt;
}

}  // namespace

std::optional<uint64_t> reset_peak_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    std::ofstream clear("/proc/self/clear_refs");
    constexpr const char* kResetPeak = "5";
    clear << kResetPeak << std::flush;
    if (!clear) return std::nullopt;
    return bytes_of_status("VmRSS");
}

std::optional<uint64_t> peak_memory() { return bytes_of_status("VmHWM"); }

}  // namespace onepass
