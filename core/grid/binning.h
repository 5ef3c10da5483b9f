// Which cells a triangle or a box overlaps: the geometry of the grid builders (internal to
// core/grid).
//
// All of it works in cell units: a point p of the primitives' frame becomes (p - lower) * dims /
// extent in double, and cell (x, y, z) is the box [x, x + 1] x [y, y + 1] x [z, z + 1], widened by
// kBinningPad on each side. The traversals use the same cells, unwidened.
//
// Rounding is bounded by kBinningRounding, and the pad swallows it: a triangle that touches the
// closed, unwidened cell is always found.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/grid/uniform_grid.h"
#include "core/types.h"

namespace onepass {

/// How far a comparison may be off by rounding, in cells: 16 * 2^31 * 2^-53 = 4e-6.
///
/// Reason: the float inputs are exact in double, and coordinates in cells are at most kMaxCells.
/// The map to cells, the projection onto an axis and the solution for x take fewer than 16
/// roundings, each of 2^-53 relative to that. Projections scale with the length of the axis, but so
/// does the pad's, so the bound holds for every axis.
inline constexpr double kBinningRounding = 16.0 * double(kMaxCells) * 0x1p-53;
static_assert(kBinningPad > 100.0 * kBinningRounding, "the pad must dwarf the rounding");

/// The map from the primitives' frame to cell units.
struct CellFrame {
    dvec3 lower;
    dvec3 cells_per_unit;
    uvec3 dims;

    dvec3 to_cells(const vec3& p) const { return (dvec3(p) - lower) * cells_per_unit; }
};

inline CellFrame cell_frame(const Bounds& bounds, const uvec3& dims) {
    const dvec3 lower(bounds.lower);
    return {lower, dvec3(dims) / (dvec3(bounds.upper) - lower), dims};
}

/// A box of cells, both ends inclusive.
struct CellRange {
    uvec3 first;
    uvec3 last;

    uvec3 size() const { return last - first + uvec3(1); }
};

/// The widened cells that the box [lower, upper] (in cell units) overlaps or touches.
inline CellRange overlapped_range(const dvec3& lower, const dvec3& upper, const uvec3& dims) {
    CellRange range;
    for (int axis = 0; axis < 3; ++axis) {
        // Clamped before the conversion, which truncates: floor() of what is not negative.
        const double last_cell = double(dims[axis] - 1);
        range.first[axis] =
            static_cast<uint32_t>(std::clamp(lower[axis] - kBinningPad, 0.0, last_cell));
        range.last[axis] =
            static_cast<uint32_t>(std::clamp(upper[axis] + kBinningPad, 0.0, last_cell));
    }
    return range;
}

/// Calls emit(first_cell, last_cell), two cell indices, for each row (along x) of `range`.
template <class Emit>
void for_each_row(const CellRange& range, const uvec3& dims, Emit&& emit) {
    for (uint32_t z = range.first.z; z <= range.last.z; ++z) {
        for (uint32_t y = range.first.y; y <= range.last.y; ++y) {
            const uint64_t row = uint64_t{dims.x} * (y + uint64_t{dims.y} * z);
            emit(row + range.first.x, row + range.last.x);
        }
    }
}

/// The separating axes of one triangle, each solved for x, so that a row of cells is answered as
/// one interval instead of cell by cell.
///
/// Axis a separates the triangle from cell c unless lower <= a . c <= upper, where the bounds hold
/// the triangle's projection widened by the widened cell's. *Any* vector a is a valid axis, however
/// badly it was rounded, because all three vertices are projected onto the same a; so slivers and
/// degenerate triangles need no case of their own (a = 0 separates nothing).
/// Source: Akenine-Moller 2001 (the axes).
class TriangleAxes {
  public:
    explicit TriangleAxes(const std::array<dvec3, 3>& vertices) : vertices_(vertices) {}

    /// Adds what decides the cells of `range`, the range of the triangle's box. The three box axes
    /// are settled by the range itself. Along an axis where the range is one cell thick the whole
    /// triangle lies within that cell's slab, so the question is one of its projection along that
    /// axis: edge normals in that plane decide, and the triangle's own plane has no say.
    void add_axes_for(const CellRange& range) {
        const bool wide_x = range.first.x < range.last.x;
        const bool wide_y = range.first.y < range.last.y;
        const bool wide_z = range.first.z < range.last.z;
        for (int k = 0; k < 3; ++k) {
            const dvec3 edge = vertices_[(k + 1) % 3] - vertices_[k];
            if (wide_y && wide_z) add(dvec3(0.0, edge.z, -edge.y));
            if (wide_x && wide_z) add(dvec3(edge.z, 0.0, -edge.x));
            if (wide_x && wide_y) add(dvec3(edge.y, -edge.x, 0.0));
        }
        if (wide_x && wide_y && wide_z) {
            add(glm::cross(vertices_[1] - vertices_[0], vertices_[2] - vertices_[0]));
        }
    }

    /// The part [first, last] of row (y, z) that no axis separates; false if it is empty.
    bool clip_row(uint32_t y, uint32_t z, uint32_t& first, uint32_t& last) const {
        for (int i = 0; i < row_axis_count_; ++i) {
            const Axis& axis = row_axes_[i];
            const double at_row = axis.y * y + axis.z * z;
            if (at_row < axis.lower || at_row > axis.upper) return false;
        }
        double lower = first;
        double upper = last;
        for (int i = 0; i < span_axis_count_; ++i) {
            const Axis& axis = span_axes_[i];
            const double at_row = axis.y * y + axis.z * z;
            lower = std::max(lower, axis.lower - at_row);
            upper = std::min(upper, axis.upper - at_row);
        }
        if (lower > upper) return false;
        // Both lie within [first, last], so the conversions truncate what is not negative.
        first = static_cast<uint32_t>(lower);
        if (first < lower) ++first;
        last = static_cast<uint32_t>(upper);
        return first <= last;
    }

  private:
    /// Cells with lower <= [x +] y * axis.y + z * axis.z <= upper are not separated; the term x
    /// belongs to a span axis only.
    struct Axis {
        double lower, upper, y, z;
    };

    void add(const dvec3& a) {
        // Project the triangle; widen by the cell [-pad, 1 + pad]^3 around its lower corner.
        const double p0 = glm::dot(a, vertices_[0]);
        const double p1 = glm::dot(a, vertices_[1]);
        const double p2 = glm::dot(a, vertices_[2]);
        const double centre = 0.5 * (a.x + a.y + a.z);
        const double radius = (0.5 + kBinningPad) * (std::abs(a.x) + std::abs(a.y) + std::abs(a.z));
        const double lower = std::min({p0, p1, p2}) - centre - radius;
        const double upper = std::max({p0, p1, p2}) - centre + radius;

        if (a.x == 0.0) {
            row_axes_[row_axis_count_++] = {lower, upper, a.y, a.z};
            return;
        }
        // Cannot overflow: an x that is not 0 comes from differences of coordinates that are at
        // least 2^-20 cells (padded_bounds), so it exceeds 2^-300.
        const double scale = 1.0 / a.x;
        const double at_lower = lower * scale;
        const double at_upper = upper * scale;
        span_axes_[span_axis_count_++] = {std::min(at_lower, at_upper),
                                          std::max(at_lower, at_upper), a.y * scale, a.z * scale};
    }

    static constexpr int kMaxAxes = 10;  // 9 edge axes and the plane
    const std::array<dvec3, 3>& vertices_;
    std::array<Axis, kMaxAxes> row_axes_;
    std::array<Axis, kMaxAxes> span_axes_;
    int row_axis_count_ = 0;
    int span_axis_count_ = 0;
};

/// Calls emit(first_cell, last_cell) for each row of widened cells that the triangle overlaps or
/// touches, rows and cells in ascending order.
///
/// Cost: O(rows of its box + references).
template <class Emit>
void for_each_overlapped_row(const std::array<dvec3, 3>& vertices, const uvec3& dims, Emit&& emit) {
    const CellRange range =
        overlapped_range(glm::min(vertices[0], glm::min(vertices[1], vertices[2])),
                         glm::max(vertices[0], glm::max(vertices[1], vertices[2])), dims);

    // A triangle is connected: it meets every cell of a range that is wide along one axis at most.
    const uvec3 size = range.size();
    if (int(size.x > 1) + int(size.y > 1) + int(size.z > 1) <= 1) {
        for_each_row(range, dims, emit);
        return;
    }

    TriangleAxes axes(vertices);
    axes.add_axes_for(range);
    for (uint32_t z = range.first.z; z <= range.last.z; ++z) {
        for (uint32_t y = range.first.y; y <= range.last.y; ++y) {
            uint32_t first = range.first.x;
            uint32_t last = range.last.x;
            if (!axes.clip_row(y, z, first, last)) continue;
            const uint64_t row = uint64_t{dims.x} * (y + uint64_t{dims.y} * z);
            emit(row + first, row + last);
        }
    }
}

}  // namespace onepass
