// From "this primitive overlaps these cells" to lists by cell (internal to core/grid).
//
// A stable two-digit counting sort. Primitives are cut into chunks, cells into ranges. Each chunk
// asks its primitives for their cells and leaves its references ordered by range; then each range
// collects its own from all chunks and orders them by cell. Where the cuts are depends on the
// numbers of primitives and cells alone, and both digits are stable, so the lists are ascending and
// have the same bits for any number of threads; nothing is atomic in the order, and nothing is
// sorted afterwards.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/raw_vector.h"

namespace onepass {

/// CSR, as in UniformGrid.
struct CellLists {
    RawVector<uint32_t> cell_begin;
    RawVector<uint32_t> references;
};

/// The offsets of a cell's list are 32-bit.
inline constexpr uint64_t kMaxReferences = 0xFFFFFFFFu;

[[noreturn]] void throw_too_many_references(uint32_t primitives, uint64_t limit);

/// Chunks of 2^chunk_bits consecutive primitives, ranges of 2^range_bits consecutive cells; the
/// last of each may be shorter. Together the bits are 32 at most, so that a word holds a reference
/// of a given chunk in a given range.
class SortCuts {
  public:
    SortCuts(uint32_t primitives, uint64_t cells);

    size_t chunk_count() const {
        return ((static_cast<uint64_t>(primitives_) - 1) >> chunk_bits_) + 1;
    }
    uint64_t first_primitive(size_t chunk) const {
        return std::min(uint64_t{chunk} << chunk_bits_, uint64_t{primitives_});
    }
    size_t range_count() const { return ((cells_ - 1) >> range_bits_) + 1; }
    uint64_t first_cell(size_t range) const {
        return std::min(uint64_t{range} << range_bits_, cells_);
    }
    size_t range_of(uint64_t cell) const { return cell >> range_bits_; }

    uint32_t primitives() const { return primitives_; }
    uint64_t cells() const { return cells_; }

    /// A reference as it waits in its range, beside others of its chunk.
    uint32_t word(uint64_t cell, uint64_t primitive) const {
        return low_bits(cell, range_bits_) << chunk_bits_ | low_bits(primitive, chunk_bits_);
    }
    uint32_t cell_in_range(uint32_t word) const { return word >> chunk_bits_; }
    uint32_t primitive_in_chunk(uint32_t word) const { return low_bits(word, chunk_bits_); }

  private:
    static uint32_t low_bits(uint64_t value, uint32_t bits) {
        return static_cast<uint32_t>(value & ((uint64_t{1} << bits) - 1));
    }

    uint32_t primitives_;
    uint64_t cells_;
    uint32_t chunk_bits_;
    uint32_t range_bits_;
};

/// A chunk's references as words, range by range, ascending by primitive in each.
struct ChunkReferences {
    RawVector<uint32_t> words;
    std::vector<uint32_t> range_begin;  ///< ranges + 1 entries

    std::span<const uint32_t> of_range(size_t range) const {
        return std::span(words).subspan(range_begin[range],
                                        range_begin[range + 1] - range_begin[range]);
    }
};

/// Cells that follow each other along a row, and the primitive that overlaps them all.
struct CellRun {
    uint32_t first_cell;
    uint32_t last_cell;
    uint32_t primitive;
};

ChunkReferences order_by_range(const SortCuts& cuts, std::span<const CellRun> runs);
CellLists order_by_cell(const SortCuts& cuts, std::span<const ChunkReferences> chunks);

/// Asks every primitive for its cells. Throws: Error if there are more than `limit` references.
template <class CellsOf>
std::vector<ChunkReferences> collect_references(const SortCuts& cuts, const CellsOf& cells_of,
                                                uint64_t limit) {
    std::atomic<uint64_t> total = 0;
    std::vector<ChunkReferences> chunks(cuts.chunk_count());
    tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t chunk) {
        const uint64_t begin = cuts.first_primitive(chunk);
        const uint64_t end = cuts.first_primitive(chunk + 1);
        std::vector<CellRun> runs;
        runs.reserve(2 * (end - begin));
        uint64_t count = 0;
        for (uint64_t i = begin; i < end; ++i) {
            const auto primitive = static_cast<uint32_t>(i);
            cells_of(primitive, [&](uint64_t first, uint64_t last) {
                count += last - first + 1;
                if (count > limit) throw_too_many_references(cuts.primitives(), limit);
                runs.push_back(
                    {static_cast<uint32_t>(first), static_cast<uint32_t>(last), primitive});
            });
        }
        if ((total += count) > limit) throw_too_many_references(cuts.primitives(), limit);
        chunks[chunk] = order_by_range(cuts, runs);
    });
    return chunks;
}

/// The lists of all cells. cells_of(primitive, emit) must call emit(first_cell, last_cell) for each
/// run of cells that the primitive overlaps, each cell once.
///
/// Cost:   O(primitives + references + cells) time; 4 bytes a reference beside the result, and 12 a
///         run for the chunks at work.
/// Throws: Error if there are more than `limit` references.
template <class CellsOf>
CellLists list_by_cell(uint32_t primitives, uint64_t cells, const CellsOf& cells_of,
                       uint64_t limit = kMaxReferences) {
    const SortCuts cuts(primitives, cells);
    return order_by_cell(cuts, collect_references(cuts, cells_of, limit));
}

}  // namespace onepass
