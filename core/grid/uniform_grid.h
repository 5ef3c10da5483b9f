// A uniform grid over primitives: cells with lists of references.
#pragma once

#include <span>

#include "core/bounds.h"
#include "core/grid/sizing.h"
#include "core/raw_vector.h"
#include "core/scene.h"
#include "core/types.h"

namespace onepass {

/// Layout: CSR; cell (x, y, z) has index x + dims.x * (y + dims.y * z), and its references are
/// references[cell_begin[index]] .. references[cell_begin[index + 1] - 1], in ascending order.
/// Units: `bounds` in the frame of the primitives (object space, or world for the top level).
struct UniformGrid {
    Bounds bounds;
    uvec3 dims{1};
    RawVector<uint32_t> cell_begin;  ///< cells + 1 entries
    RawVector<uint32_t> references;  ///< primitive indices

    uint64_t cell_count() const { return uint64_t{dims.x} * dims.y * dims.z; }
    uint64_t cell_index(uvec3 cell) const {
        return cell.x + uint64_t{dims.x} * (cell.y + uint64_t{dims.y} * cell.z);
    }
    std::span<const uint32_t> cell_references(uvec3 cell) const {
        const uint64_t i = cell_index(cell);
        return std::span(references).subspan(cell_begin[i], cell_begin[i + 1] - cell_begin[i]);
    }
    /// Edge lengths of a cell, in double: extent / dims.
    dvec3 cell_size() const { return (dvec3(bounds.upper) - dvec3(bounds.lower)) / dvec3(dims); }

    bool operator==(const UniformGrid&) const = default;
};

/// Builds a grid over boxes: each box is referenced by every cell it overlaps.
///
/// Cell ranges are widened by kBinningPad of a cell on each side, so that a traversal whose cell
/// arithmetic is off by less never misses a reference.
/// Cost:   O(boxes + references + cells) time; 4 bytes a reference of memory beside the result;
/// parallel, the same bits for any thread count.
/// Throws: Error if there is no box, if one is empty or not finite, or if references exceed
/// 2^32 - 1; and as grid_resolution and padded_bounds.
/// Source: Fujimoto 1985; Adinetz & Berezin, section 3 (top level: scene subdivision).
UniformGrid build_box_grid(std::span<const Bounds> boxes, const GridSizing& sizing);

/// What becomes of triangles that equal a lower one.
enum class Duplicates { kept, dropped };

/// Builds a grid over an object's triangles: a triangle is referenced by every cell that its exact
/// surface overlaps (separating axes, cells widened by kBinningPad), not by its whole box. A
/// triangle that touches a closed cell is always referenced, degenerate ones (points, segments)
/// included.
///
/// With Duplicates::dropped, no cell references a triangle that equals a lower one, as far as
/// later_duplicates() finds them (core/grid/duplicates.h): by the rule for equal t it never is the
/// answer.
/// Cost, errors: as build_box_grid; a triangle also costs the rows (along x) of its box.
/// Source: Adinetz & Berezin, section 3 (second-level subdivision); Akenine-Moller 2001.
UniformGrid build_triangle_grid(const Object& object, const GridSizing& sizing,
                                Duplicates duplicates = Duplicates::kept);
/// `box`: object_bounds(object), where that is known already.
UniformGrid build_triangle_grid(const Object& object, const Bounds& box, const GridSizing& sizing,
                                Duplicates duplicates);

/// How many triangle grids this process has built so far, on all threads: "moving an instance
/// rebuilds no object grid" is counted with it, not inferred.
uint64_t triangle_grids_built();

/// Cells are taken this much larger, in cells, when primitives are binned: twice what a walk in
/// floats may err at 1,024 cells an axis (gpu_glsl/README.md, step 3, adds it up).
inline constexpr double kBinningPad = 0x1p-9;

}  // namespace onepass
