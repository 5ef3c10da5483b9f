// How much memory a piece of work takes at its peak, as the system counts it: resident pages, so
// that memory which is only reserved does not count and every library's allocations do.
#pragma once

#include <cstdint>
#include <optional>

namespace onepass {

/// Sets the process's peak of resident memory back to what is resident now, after giving unused
/// memory back to the system. Returns the latter in bytes; nothing where the system offers no such
/// thing.
std::optional<uint64_t> reset_peak_memory();

/// The peak of resident memory, in bytes, since the last reset; nothing as above.
std::optional<uint64_t> peak_memory();

/// Calls work() and returns the bytes by which memory grew at its peak. Only one such call may be
/// under way in a process, and nothing else should run beside it.
template <class Work>
std::optional<uint64_t> peak_memory_of(const Work& work) {
    const std::optional<uint64_t> before = reset_peak_memory();
    work();
    const std::optional<uint64_t> peak = peak_memory();
    if (!before || !peak) return std::nullopt;
    return *peak - *before;
}

}  // namespace onepass
