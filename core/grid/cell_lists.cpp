// The counting sort of references by cell: where it cuts, and its two digits.
#include "core/grid/cell_lists.h"

#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/grid/sizing.h"

namespace onepass {
namespace {

/// Calls visit(range, first_cell, last_cell) for the parts of a run that lie in one range each.
template <class Visit>
void for_each_part(const SortCuts& cuts, const CellRun& run, Visit&& visit) {
    uint64_t cell = run.first_cell;
    while (cell <= run.last_cell) {
        const size_t range = cuts.range_of(cell);
        const uint64_t end = std::min(uint64_t{run.last_cell} + 1, cuts.first_cell(range + 1));
        visit(range, cell, end - 1);
        cell = end;
    }
}

/// Turns counts into the sums of all before, in place; returns the sum of all.
uint32_t accumulate(std::span<uint32_t> counts, uint32_t sum = 0) {
    for (uint32_t& entry : counts) sum += std::exchange(entry, sum);
    return sum;
}

/// How many references are in the ranges before each range; the last entry counts all.
std::vector<uint32_t> range_begins(const SortCuts& cuts, std::span<const ChunkReferences> chunks) {
    std::vector<uint32_t> begins(cuts.range_count() + 1, 0);
    for (const ChunkReferences& chunk : chunks) {
        for (size_t r = 0; r < begins.size(); ++r) begins[r] += chunk.range_begin[r];
    }
    return begins;
}

/// Orders one range by cell, its first reference being number `first` of all.
///
/// `begin` is CellLists::cell_begin shifted by one: begin[c] belongs to cell c here and is
/// cell_begin[c + 1] there. It counts, then holds the list's begin, and has become its end (which
/// is the next list's begin) once the list is full; so every range writes its own entries only.
void order_range(const SortCuts& cuts, std::span<const ChunkReferences> chunks, size_t range,
                 uint32_t first, std::span<uint32_t> begin, uint32_t* references) {
    std::fill(begin.begin(), begin.end(), 0);
    for (const ChunkReferences& chunk : chunks) {
        for (const uint32_t word : chunk.of_range(range)) ++begin[cuts.cell_in_range(word)];
    }
    accumulate(begin, first);
    for (size_t k = 0; k < chunks.size(); ++k) {
        const auto first_primitive = static_cast<uint32_t>(cuts.first_primitive(k));
        for (const uint32_t word : chunks[k].of_range(range)) {
            references[begin[cuts.cell_in_range(word)]++] =
                first_primitive + cuts.primitive_in_chunk(word);
        }
    }
}

}  // namespace

void throw_too_many_references(uint32_t primitives, uint64_t limit) {
    throw Error(
        {.where = "grid build",
         .got = fmt::format("more than {} references from {} primitives", limit, primitives),
         .expected = fmt::format("at most {} references", limit),
         .remedy = "Lower the density or the resolution: large primitives are referenced "
                   "by every cell they cross."});
}

SortCuts::SortCuts(uint32_t primitives, uint64_t cells) : primitives_(primitives), cells_(cells) {
    // About a thousand ranges are few enough that one write position for each stays in cache while
    // a chunk is distributed, and many enough that a range's cells do while it is ordered. Chunks
    // are enough to spread over many cores, and few enough that the table stays small.
    constexpr uint32_t kLeastRangeBits = 10;
    constexpr uint32_t kMostRangeBits = 21;
    constexpr uint64_t kUsualRanges = 1024;
    constexpr uint32_t kLeastChunkBits = 11;
    constexpr uint64_t kUsualChunks = 256;
    static_assert(kMaxCells >> kMostRangeBits <= kUsualRanges);
    static_assert(kMostRangeBits + kLeastChunkBits <= 32, "a reference must fit a word");

    range_bits_ = kLeastRangeBits;
    while (range_count() > kUsualRanges) ++range_bits_;
    chunk_bits_ = kLeastChunkBits;
    while (chunk_count() > kUsualChunks && range_bits_ + chunk_bits_ < 32) ++chunk_bits_;
}

ChunkReferences order_by_range(const SortCuts& cuts, std::span<const CellRun> runs) {
    std::vector<uint32_t> position(cuts.range_count(), 0);
    for (const CellRun& run : runs) {
        for_each_part(cuts, run, [&](size_t range, uint64_t first, uint64_t last) {
            position[range] += static_cast<uint32_t>(last - first + 1);
        });
    }
    const uint32_t count = accumulate(position);

    ChunkReferences chunk{RawVector<uint32_t>(count), position};
    chunk.range_begin.push_back(count);
    for (const CellRun& run : runs) {
        for_each_part(cuts, run, [&](size_t range, uint64_t first, uint64_t last) {
            uint32_t* word = &chunk.words[position[range]];
            for (uint64_t cell = first; cell <= last; ++cell) {
                *word++ = cuts.word(cell, run.primitive);
            }
            position[range] += static_cast<uint32_t>(last - first + 1);
        });
    }
    return chunk;
}

CellLists order_by_cell(const SortCuts& cuts, std::span<const ChunkReferences> chunks) {
    const std::vector<uint32_t> begins = range_begins(cuts, chunks);
    CellLists lists;
    lists.cell_begin.resize(cuts.cells() + 1);
    lists.cell_begin[0] = 0;
    lists.references.reserve(size_t{begins.back()} + 1);  // room for who ends them with a word
    lists.references.resize(begins.back());
    const std::span cell_begin = std::span(lists.cell_begin).subspan(1);
    tbb::parallel_for(size_t{0}, cuts.range_count(), [&](size_t range) {
        const uint64_t first = cuts.first_cell(range);
        order_range(cuts, chunks, range, begins[range],
                    cell_begin.subspan(first, cuts.first_cell(range + 1) - first),
                    lists.references.data());
    });
    return lists;
}

}  // namespace onepass
