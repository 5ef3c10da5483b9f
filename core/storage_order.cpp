// A counting sort by cubes.
#include "core/storage_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <tbb/parallel_for.h>

namespace onepass {
namespace {

constexpr int kMostBitsAnAxis = 6;

/// The low 10 bits, two zeros behind each.
uint32_t spread(uint32_t bits) {
    bits = (bits | bits << 16) & 0x030000FFu;
    bits = (bits | bits << 8) & 0x0300F00Fu;
    bits = (bits | bits << 4) & 0x030C30C3u;
    return (bits | bits << 2) & 0x09249249u;
}

/// Cubes in a box, along the curve. (Counted in halves, so that the extent of any finite floats is
/// finite; what is too small for an inverse is one cube.)
class Cubes {
  public:
    Cubes(const Bounds& box, int bits_an_axis)
        : lower_(0.5f * box.lower), most_(static_cast<float>((1 << bits_an_axis) - 1)) {
        constexpr float kLeastEdge = 1e-30f;
        const vec3 extent = 0.5f * box.upper - lower_;
        const float edge = std::max({extent.x, extent.y, extent.z});
        per_unit_ = edge > kLeastEdge ? (most_ + 1.0f) / edge : 0.0f;
    }

    /// Of the cube that a point lies in: by rounding it may be a neighbour.
    uint32_t code(const vec3& point) const {
        const vec3 at = (0.5f * point - lower_) * per_unit_;
        const uvec3 place(glm::clamp(at, vec3(0.0f), vec3(most_)));
        return spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2;
    }

  private:
    vec3 lower_;
    float most_;
    float per_unit_ = 0.0f;
};

/// Calls visit(part, begin, end) for equal parts of 0 .. count, at the same time.
constexpr size_t kParts = 4;
template <class Visit>
void for_each_part(size_t count, const Visit& visit) {
    tbb::parallel_for(size_t{0}, kParts, [&](size_t part) {
        visit(part, count * part / kParts, count * (part + 1) / kParts);
    });
}

}  // namespace

RawVector<uint32_t> storage_slots(const Object& object, const Bounds& box) {
    const size_t count = object.triangles.size();
    const int bits = std::min((static_cast<int>(std::bit_width(count)) - 1) / 3, kMostBitsAnAxis);
    const Cubes cubes(box, bits);

    // Which cubes, which wait where the slots will be; and how many triangles of each part.
    RawVector<uint32_t> slots(count);
    std::array<std::vector<uint32_t>, kParts> next_slots;
    for_each_part(count, [&](size_t part, size_t begin, size_t end) {
        next_slots[part].assign(size_t{1} << (3 * bits), 0);
        for (size_t i = begin; i < end; ++i) {
            slots[i] = cubes.code(object.positions[object.triangles[i].x]);
            ++next_slots[part][slots[i]];
        }
    });

    // Cube by cube, in each part by part, in those by number.
    uint32_t next = 0;
    for (size_t code = 0; code < next_slots.front().size(); ++code) {
        for (std::vector<uint32_t>& of_part : next_slots) {
            next += std::exchange(of_part[code], next);
        }
    }
    for_each_part(count, [&](size_t part, size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) slots[i] = next_slots[part][slots[i]]++;
    });
    return slots;
}

}  // namespace onepass
