// Equal triangles meet in a hash table, where the lowest index stays.
#include "core/grid/duplicates.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace onepass {
namespace {

using Corners = std::array<vec3, 3>;

Corners corners_of(const Object& object, uint32_t triangle) {
    const uvec3& indices = object.triangles[triangle];
    return {object.positions[indices.x], object.positions[indices.y], object.positions[indices.z]};
}

bool are_equal(Corners a, Corners b) { return std::is_permutation(a.begin(), a.end(), b.begin()); }

/// The same in whichever order the corners come.
uint64_t hash_of(const Corners& corners) {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        uint64_t sum = 0;
        // (-0 + 0 is +0: equal numbers have equal bits.)
        for (const vec3& corner : corners) sum += std::bit_cast<uint32_t>(corner[axis] + 0.0f);
        hash = (hash ^ sum) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash;
}

/// One slot for each class of equal triangles. It holds the lowest index that has come so far, and
/// above it half of the hash, so that unequal triangles are seldom fetched to be compared.
class Table {
  public:
    /// With room for so many classes, and half as many again.
    Table(const Object& object, size_t classes, std::vector<uint8_t>& is_later)
        : object_(object), is_later_(is_later), slots_(std::bit_ceil(classes + classes / 2 + 1)) {
        for (auto& slot : slots_) slot.store(kFree, std::memory_order_relaxed);
    }

    /// Adds a triangle, and marks whoever of its class is now known not to be the lowest. True if
    /// it was not alone; false if it was, or found no room.
    bool add(uint32_t triangle, const Corners& corners, uint64_t hash) {
        const uint64_t entry = (hash & ~kIndexMask) | triangle;
        const size_t mask = slots_.size() - 1;
        for (size_t probe = 0; probe < slots_.size(); ++probe) {
            const size_t at = (hash + probe) & mask;
            uint64_t held = slots_[at].load(std::memory_order_relaxed);
            if (held == kFree && slots_[at].compare_exchange_strong(held, entry)) return false;
            if (((held ^ entry) & ~kIndexMask) != 0) continue;
            if (!are_equal(corners, corners_of(object_, static_cast<uint32_t>(held)))) continue;
            while (entry < held && !slots_[at].compare_exchange_weak(held, entry)) {
            }
            is_later_[std::max(triangle, static_cast<uint32_t>(held))] = 1;
            return true;
        }
        return false;
    }

  private:
    static constexpr uint64_t kIndexMask = 0xFFFFFFFFu;
    static constexpr uint64_t kFree = ~uint64_t{0};  // kNoId is no triangle

    const Object& object_;
    std::vector<uint8_t>& is_later_;
    std::vector<std::atomic<uint64_t>> slots_;
};

/// Marks the duplicates among the triangles whose hash ends in `zero_bits` zeros: equal triangles
/// have equal hashes, so of each class all are looked at or none. True if there are any.
bool mark_duplicates(const Object& object, int zero_bits, std::vector<uint8_t>& is_later) {
    const size_t triangles = object.triangles.size();
    Table table(object, triangles >> zero_bits, is_later);
    const uint64_t others = (uint64_t{1} << zero_bits) - 1;
    std::atomic<bool> any = false;
    constexpr size_t kTrianglesATask = size_t{1} << 13;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, triangles, kTrianglesATask),
                      [&](const auto& range) {
                          bool found = false;
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              const auto triangle = static_cast<uint32_t>(i);
                              const Corners corners = corners_of(object, triangle);
                              const uint64_t hash = hash_of(corners);
                              if ((hash & others) != 0) continue;
                              found |= table.add(triangle, corners, hash >> zero_bits);
                          }
                          if (found) any = true;
                      });
    return any;
}

}  // namespace

std::vector<uint8_t> later_duplicates(const Object& object) {
    // Most meshes have none, and a part of the classes tells; few triangles are looked at at once.
    constexpr int kSampleBits = 6;
    constexpr size_t kWorthASample = size_t{1} << 14;
    std::vector<uint8_t> is_later(object.triangles.size());
    const bool sampled = object.triangles.size() >= kWorthASample;
    const bool any = !sampled || mark_duplicates(object, kSampleBits, is_later);
    return any && mark_duplicates(object, 0, is_later) ? is_later : std::vector<uint8_t>{};
}

}  // namespace onepass
