// Equal triangles meet in a hash table, where the lowest index stays.
#include "core/grid/duplicates.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <tuple>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace onepass {
namespace {

/// A triangle's positions in an order that does not depend on the triangle's own.
using Corners = std::array<vec3, 3>;

Corners sorted_corners(const Object& object, size_t triangle) {
    const uvec3& indices = object.triangles[triangle];
    // (-0 + 0 is +0: equal numbers have equal bits.)
    Corners corners = {object.positions[indices.x] + vec3(0.0f),
                       object.positions[indices.y] + vec3(0.0f),
                       object.positions[indices.z] + vec3(0.0f)};
    std::sort(corners.begin(), corners.end(), [](const vec3& a, const vec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    });
    return corners;
}

uint64_t hash_of(const Corners& corners) {
    std::array<uint32_t, 9> words;
    static_assert(sizeof words == sizeof corners);
    std::memcpy(words.data(), corners.data(), sizeof words);
    uint64_t hash = 0;
    for (const uint32_t word : words) {
        hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash;
}

/// One slot for each class of equal triangles, which holds the lowest index that has come so far.
class Table {
  public:
    explicit Table(const Object& object)
        : object_(object), slots_(std::bit_ceil(2 * object.triangles.size())) {
        for (auto& slot : slots_) slot.store(kNoId, std::memory_order_relaxed);
    }

    void add(uint32_t triangle) {
        std::atomic<uint32_t>& slot = slot_of(triangle);
        uint32_t lowest = slot.load();
        while (triangle < lowest && !slot.compare_exchange_weak(lowest, triangle)) {
        }
    }

    uint32_t lowest_equal(uint32_t triangle) { return slot_of(triangle).load(); }

  private:
    /// The slot of its class; if the class has none yet, the triangle takes one.
    std::atomic<uint32_t>& slot_of(uint32_t triangle) {
        const Corners corners = sorted_corners(object_, triangle);
        const size_t mask = slots_.size() - 1;
        for (size_t at = hash_of(corners) & mask;; at = (at + 1) & mask) {
            uint32_t holder = slots_[at].load();
            if (holder == kNoId && slots_[at].compare_exchange_strong(holder, triangle)) {
                return slots_[at];
            }
            if (sorted_corners(object_, holder) == corners) return slots_[at];
        }
    }

    const Object& object_;
    std::vector<std::atomic<uint32_t>> slots_;
};

template <class Visit>
void for_each_triangle(const Object& object, const Visit& visit) {
    constexpr size_t kTrianglesATask = size_t{1} << 13;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, object.triangles.size(), kTrianglesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i)
                              visit(static_cast<uint32_t>(i));
                      });
}

}  // namespace

std::vector<uint8_t> later_duplicates(const Object& object) {
    Table table(object);
    for_each_triangle(object, [&](uint32_t i) { table.add(i); });
    std::vector<uint8_t> is_later(object.triangles.size());
    std::atomic<bool> any = false;
    for_each_triangle(object, [&](uint32_t i) {
        if (table.lowest_equal(i) == i) return;
        is_later[i] = 1;
        any.store(true, std::memory_order_relaxed);
    });
    return any ? is_later : std::vector<uint8_t>{};
}

}  // namespace onepass
