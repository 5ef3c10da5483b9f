// From "this primitive overlaps these cells" to lists by cell (internal to core/grid).
//
// Two steps. collect_references() asks every primitive for its cells, in parallel over chunks of
// consecutive primitives. sort_by_cell() orders the result by cell with a stable two-digit counting
// sort: chunks -> ranges of cells -> cells. Chunks depend on the number of primitives alone and
// both digits are stable, so the lists are ascending and have the same bits for any number of
// threads; nothing is atomic in the order, and nothing is sorted afterwards.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

namespace onepass {

/// A reference on its way to its cell.
struct CellReference {
    uint32_t cell;
    uint32_t primitive;
};

/// References by chunk of consecutive primitives; ascending by primitive within a chunk.
using ReferenceChunks = std::vector<std::vector<CellReference>>;

/// CSR, as in UniformGrid.
struct CellLists {
    std::vector<uint32_t> cell_begin;
    std::vector<uint32_t> references;
};

/// The offsets of a cell's list are 32-bit.
inline constexpr uint64_t kMaxReferences = 0xFFFFFFFFu;

[[noreturn]] void throw_too_many_references(uint32_t primitives, uint64_t limit);

/// Primitives a chunk: enough to spread over many cores, few enough chunks that their histograms
/// (sort_by_cell) stay small. A function of the count alone: see the head of this file.
inline uint32_t primitives_per_chunk(uint32_t primitive_count) {
    constexpr uint32_t kLeastChunk = 2048;
    constexpr uint32_t kMostChunks = 256;
    return std::max(kLeastChunk, primitive_count / kMostChunks + 1);
}

/// Calls cells_of(primitive, emit) for every primitive; it must call emit(first_cell, last_cell)
/// for each run of cells that the primitive overlaps, each cell once.
///
/// Memory: 8 bytes a reference. Throws: Error if there are more than `limit` references.
template <class CellsOf>
ReferenceChunks collect_references(uint32_t primitive_count, const CellsOf& cells_of,
                                   uint64_t limit = kMaxReferences) {
    // The running total is kept roughly, in steps of this many references, so that too many are
    // noticed before they fill the memory and the threads rarely meet at the counter.
    constexpr size_t kCountingStep = 1 << 16;
    std::atomic<uint64_t> total = 0;

    const uint32_t per_chunk = primitives_per_chunk(primitive_count);
    ReferenceChunks chunks((uint64_t{primitive_count} + per_chunk - 1) / per_chunk);
    tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t k) {
        std::vector<CellReference>& chunk = chunks[k];
        size_t counted = 0;
        const auto count = [&] {
            total += chunk.size() - counted;
            counted = chunk.size();
            if (total > limit) throw_too_many_references(primitive_count, limit);
        };

        const uint64_t first = k * uint64_t{per_chunk};
        const uint64_t last = std::min<uint64_t>(first + per_chunk, primitive_count);
        chunk.reserve(2 * (last - first));
        for (uint64_t i = first; i < last; ++i) {
            const uint32_t primitive = static_cast<uint32_t>(i);
            cells_of(primitive, [&](uint64_t first_cell, uint64_t last_cell) {
                for (uint64_t cell = first_cell; cell <= last_cell; ++cell) {
                    chunk.push_back({static_cast<uint32_t>(cell), primitive});
                }
                if (chunk.size() - counted >= kCountingStep) count();
            });
        }
        count();
    });
    return chunks;
}

/// Orders the references by cell, ascending by primitive in each cell. Consumes the chunks.
///
/// Cost: O(references + cells) time; 8 bytes a reference beside input and result.
CellLists sort_by_cell(ReferenceChunks chunks, uint64_t cell_count);

}  // namespace onepass
