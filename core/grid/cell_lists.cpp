// The stable two-digit counting sort of references by cell.
#include "core/grid/cell_lists.h"

#include <memory>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// The first digit: ranges of 2^shift consecutive cells. About a thousand ranges are few enough
/// that one write position for each stays in cache while a chunk is distributed, and many enough
/// that a range's cells do while it is ordered.
struct CellRanges {
    static constexpr uint64_t kMostRanges = 1024;

    explicit CellRanges(uint64_t cell_count) : cells(cell_count) {
        while (((cells - 1) >> shift) + 1 > kMostRanges) ++shift;
        count = ((cells - 1) >> shift) + 1;
    }
    uint64_t first_cell(size_t range) const { return std::min(uint64_t{range} << shift, cells); }
    size_t of_cell(uint32_t cell) const { return cell >> shift; }

    uint64_t cells;
    uint32_t shift = 0;
    size_t count = 0;
};

/// A table [chunk][range], first of counts, then of write positions.
using ChunkTable = std::vector<std::vector<uint32_t>>;

ChunkTable count_by_range(const ReferenceChunks& chunks, const CellRanges& ranges) {
    ChunkTable counts(chunks.size());
    tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t k) {
        counts[k].assign(ranges.count, 0);
        for (const CellReference& r : chunks[k]) ++counts[k][ranges.of_cell(r.cell)];
    });
    return counts;
}

/// Turns counts into the position of each chunk's first reference of each range: by range, then by
/// chunk, which keeps primitives ascending. Returns where each range begins (ranges.count + 1).
std::vector<uint32_t> positions_from_counts(ChunkTable& table, const CellRanges& ranges) {
    std::vector<uint32_t> range_begin(ranges.count + 1);
    uint32_t position = 0;
    for (size_t range = 0; range < ranges.count; ++range) {
        range_begin[range] = position;
        for (std::vector<uint32_t>& of_chunk : table) {
            const uint32_t count = of_chunk[range];
            of_chunk[range] = position;
            position += count;
        }
    }
    range_begin[ranges.count] = position;
    return range_begin;
}

/// Orders the references of one range of cells by cell. `begin` is CellLists::cell_begin shifted by
/// one: begin[c] belongs to cell c here and is cell_begin[c + 1] there. It counts, then holds the
/// list's begin, and has become its end (which is the next list's begin) once the list is full; so
/// every range writes its own entries only.
void order_range(const CellReference* first, const CellReference* last, uint64_t first_cell,
                 uint64_t last_cell, uint32_t position, uint32_t* begin, uint32_t* references) {
    for (const CellReference* r = first; r != last; ++r) ++begin[r->cell];
    for (uint64_t cell = first_cell; cell < last_cell; ++cell) {
        const uint32_t count = begin[cell];
        begin[cell] = position;
        position += count;
    }
    for (const CellReference* r = first; r != last; ++r) {
        references[begin[r->cell]++] = r->primitive;
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

CellLists sort_by_cell(ReferenceChunks chunks, uint64_t cell_count) {
    // First digit: distribute the chunks over the ranges of cells.
    const CellRanges ranges(cell_count);
    ChunkTable table = count_by_range(chunks, ranges);
    const std::vector<uint32_t> range_begin = positions_from_counts(table, ranges);
    const uint32_t reference_count = range_begin.back();
    const auto by_range = std::make_unique_for_overwrite<CellReference[]>(reference_count);
    tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t k) {
        std::vector<uint32_t>& position = table[k];
        for (const CellReference& r : chunks[k]) by_range[position[ranges.of_cell(r.cell)]++] = r;
        chunks[k] = {};
    });

    // Second digit: order each range by cell.
    CellLists lists;
    lists.cell_begin.resize(cell_count + 1);
    lists.references.resize(reference_count);
    tbb::parallel_for(size_t{0}, ranges.count, [&](size_t range) {
        order_range(by_range.get() + range_begin[range], by_range.get() + range_begin[range + 1],
                    ranges.first_cell(range), ranges.first_cell(range + 1), range_begin[range],
                    lists.cell_begin.data() + 1, lists.references.data());
    });
    return lists;
}

}  // namespace onepass
