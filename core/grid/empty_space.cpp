// Empty boxes by doubling: a box is empty if eight smaller ones that cover it are. A box is the
// same for all octants, seen from another corner, so that each edge takes one pass over bits.
#include "core/grid/empty_space.h"

#include <algorithm>
#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace onepass {
namespace {

constexpr uint32_t kWordBits = 64;
constexpr size_t kEdges = kEmptyCubeEdges.size();
constexpr uint32_t kGreatest = kEmptyCubeEdges.back();
static_assert(kGreatest <= kWordBits, "a row ends with one word for all that lies beyond it");

constexpr bool each_is_at_most_twice_the_last() {
    for (size_t k = 1; k < kEdges; ++k) {
        if (kEmptyCubeEdges[k] > 2 * kEmptyCubeEdges[k - 1]) return false;
    }
    return true;
}
static_assert(each_is_at_most_twice_the_last());

/// Calls row(y, z) for all of rows.x times rows.y rows, on all threads.
template <class Row>
void for_each_row_of(const uvec2& rows, const Row& row) {
    constexpr size_t kRowsATask = 64;
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, size_t{rows.x} * rows.y, kRowsATask), [&](const auto& range) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                row(static_cast<uint32_t>(i % rows.x), static_cast<uint32_t>(i / rows.x));
            }
        });
}

/// 32 x 32 bits to their transpose, in both halves of the words at once: bit c of row r goes to bit
/// r of row c. Blocks of half the size change places, then those within them.
void transpose(std::array<uint64_t, 32>& rows) {
    uint64_t low = 0x0000FFFF0000FFFFu;  // columns whose number lacks the bit `half`
    for (uint32_t half = 16; half > 0; half /= 2, low ^= low << half) {
        for (uint32_t block = 0; block < 32; block += 2 * half) {
            for (uint32_t r = block; r < block + half; ++r) {
                const uint64_t change = ((rows[r] >> half) ^ rows[r + half]) & low;
                rows[r + half] ^= change;
                rows[r] ^= change << half;
            }
        }
    }
}

/// The bits from `shift` on, which is at most kWordBits - 1, of a word and the next.
uint64_t bits_from(const uint64_t* word, uint32_t shift) {
    return word[0] >> shift | word[1] << 1 << (kWordBits - 1 - shift);
}

/// Bit k of the codes of 64 cells goes to code[k]. is_empty[e]: whether the cube of edge number
/// e + 1 is empty; larger cubes hold the smaller, so a code is the number of those that are.
void put_code_bits(const std::array<uint64_t, kEdges - 1>& is_empty, uint64_t* code) {
    const auto& [one, two, three, four, five, six, seven] = is_empty;
    code[0] = (one & ~two) | (three & ~four) | (five & ~six) | seven;
    code[1] = (two & ~four) | six;
    code[2] = four;
}

}  // namespace

EmptyCubes::EmptyCubes(const UniformGrid& grid)
    : dims_(grid.dims),
      pitch_((dims_.x + kWordBits - 1) / kWordBits + 1),
      outside_(pitch_, ~uint64_t{0}) {
    levels_.push_back(first_level(grid));
    for (size_t k = 1; k < kEdges; ++k) {
        levels_.push_back(next_level(levels_.back(), kEmptyCubeEdges[k]));
    }
}

const uint64_t* EmptyCubes::row(const Level& level, int64_t y, int64_t z) const {
    if (y < 0 || z < 0 || y >= level.rows.x || z >= level.rows.y) return outside_.data();
    return &level.bits[pitch_ * (static_cast<size_t>(y) + level.rows.x * static_cast<size_t>(z))];
}

EmptyCubes::Level EmptyCubes::first_level(const UniformGrid& grid) const {
    constexpr uint32_t kRun = 8;  // cells looked at together first: most are empty
    Level level{.edges = uvec3(1), .rows = uvec2(dims_.y, dims_.z), .bits = {}};
    level.bits.resize(pitch_ * level.rows.x * level.rows.y);
    for_each_row_of(level.rows, [&](uint32_t y, uint32_t z) {
        const size_t row = y + size_t{dims_.y} * z;
        const uint32_t* const begin = &grid.cell_begin[dims_.x * row];
        uint64_t* const out = &level.bits[pitch_ * row];
        std::fill_n(out, pitch_, ~uint64_t{0});
        for (uint32_t first = 0; first < dims_.x; first += kWordBits) {
            const uint32_t count = std::min(dims_.x - first, kWordBits);
            uint64_t full = 0;
            for (uint32_t k = 0; k < count; k += kRun) {
                const uint32_t end = std::min(k + kRun, count);
                if (begin[first + k] == begin[first + end]) continue;  // all of them are empty
                for (uint32_t i = k; i < end; ++i) {
                    full |= uint64_t{begin[first + i] != begin[first + i + 1]} << i;
                }
            }
            out[first / kWordBits] = ~full;
        }
    });
    return level;
}

EmptyCubes::Level EmptyCubes::next_level(const Level& from, uint32_t edge) const {
    const uvec3 edges = glm::min(uvec3(edge), dims_);
    const uvec3 step = edges - from.edges;
    Level level{.edges = edges, .rows = from.rows + uvec2(step.y, step.z), .bits = {}};
    level.bits.resize(pitch_ * level.rows.x * level.rows.y);
    for_each_row_of(level.rows, [&](uint32_t y, uint32_t z) {
        const int64_t y_before = int64_t{y} - step.y;
        const int64_t z_before = int64_t{z} - step.z;
        const uint64_t* const a = row(from, y, z);
        const uint64_t* const b = row(from, y_before, z);
        const uint64_t* const c = row(from, y, z_before);
        const uint64_t* const d = row(from, y_before, z_before);
        uint64_t* const out = &level.bits[pitch_ * (y + size_t{level.rows.x} * z)];
        uint64_t before = ~uint64_t{0};
        for (size_t k = 0; k < pitch_; ++k) {
            const uint64_t here = a[k] & b[k] & c[k] & d[k];
            // The bits `step.x` below: the topmost of the word before come first.
            const uint64_t moved = here << step.x | before >> 1 >> (kWordBits - 1 - step.x);
            out[k] = here & moved;
            before = here;
        }
    });
    return level;
}

void EmptyCubes::row_words(uint32_t y, uint32_t z, uint32_t* words) const {
    // The rows where the cubes of each edge end that begin in this one: four ways to go in y, z.
    constexpr uint32_t kWays = 4;
    std::array<std::array<const uint64_t*, kEdges - 1>, kWays> rows;
    for (uint32_t way = 0; way < kWays; ++way) {
        for (size_t k = 1; k < kEdges; ++k) {
            const Level& level = levels_[k];
            const uint32_t y_last = y + ((way & 1) != 0 ? level.edges.y - 1 : 0);
            const uint32_t z_last = z + ((way & 2) != 0 ? level.edges.z - 1 : 0);
            rows[way][k - 1] = row(level, y_last, z_last);
        }
    }
    const uint64_t* const empty = row(levels_.front(), y, z);

    for (uint32_t first = 0; first < dims_.x; first += kWordBits) {
        const size_t at = first / kWordBits;
        const uint32_t count = std::min(dims_.x - first, kWordBits);
        const auto are_empty = [&](uint32_t octant, size_t k) {
            const uint32_t x_last = (octant & 1) != 0 ? levels_[k].edges.x - 1 : 0;
            return bits_from(rows[octant / 2][k - 1] + at, x_last);
        };
        // Far from everything all cubes are the greatest.
        std::array<uint64_t, 8> greatest;
        uint64_t all = ~uint64_t{0};
        for (uint32_t octant = 0; octant < 8; ++octant) {
            greatest[octant] = are_empty(octant, kEdges - 1);
            all &= greatest[octant];
        }
        constexpr uint32_t kAllGreatest = kEmptyCellBit | ((1u << empty_cube_shift(8)) - 1);
        if (~all == 0) {
            std::fill_n(words + first, count, kAllGreatest);
            continue;
        }
        std::array<uint64_t, 32> planes = {};  // bit k of the words of 64 cells
        for (uint32_t octant = 0; octant < 8; ++octant) {
            std::array<uint64_t, kEdges - 1> is_empty;
            for (size_t k = 1; k + 1 < kEdges; ++k) is_empty[k - 1] = are_empty(octant, k);
            is_empty.back() = greatest[octant];
            put_code_bits(is_empty, &planes[empty_cube_shift(octant)]);
        }
        planes[31] = empty[at];
        transpose(planes);
        for (uint32_t k = 0; k < count; ++k) {
            words[first + k] = static_cast<uint32_t>(planes[k % 32] >> (k & 32));
        }
    }
}

void find_empty_cubes(const UniformGrid& grid, uint32_t* words) {
    const EmptyCubes cubes(grid);
    for_each_row_of(uvec2(grid.dims.y, grid.dims.z), [&](uint32_t y, uint32_t z) {
        cubes.row_words(y, z, words + grid.cell_index(uvec3(0, y, z)));
    });
}

}  // namespace onepass
