// The two grid builders: over boxes (instances) and over triangles.
#include "core/grid/uniform_grid.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "core/error.h"
#include "core/grid/binning.h"
#include "core/grid/cell_lists.h"
#include "core/grid/duplicates.h"

namespace onepass {
namespace {

bool is_finite(const vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_boxes(std::span<const Bounds> boxes) {
    for (size_t i = 0; i < boxes.size(); ++i) {
        const Bounds& box = boxes[i];
        if (is_finite(box.lower) && is_finite(box.upper) && !box.empty()) continue;
        throw Error({.where = fmt::format("grid over boxes, box {}", i),
                     .got = fmt::format("({}, {}, {}) to ({}, {}, {})", box.lower.x, box.lower.y,
                                        box.lower.z, box.upper.x, box.upper.y, box.upper.z),
                     .expected = "finite bounds, lower <= upper",
                     .remedy = "Remove or mend the instance that has this box."});
    }
}

/// The first vertex that is not finite, or the number of vertices.
size_t first_not_finite(const std::vector<vec3>& positions) {
    constexpr size_t kVerticesATask = size_t{1} << 15;
    return tbb::parallel_reduce(
        tbb::blocked_range<size_t>(0, positions.size(), kVerticesATask), positions.size(),
        [&](const auto& range, size_t first) {
            for (size_t i = range.begin(); i < std::min(range.end(), first); ++i) {
                if (!is_finite(positions[i])) first = i;
            }
            return first;
        },
        [](size_t a, size_t b) { return std::min(a, b); });
}

void check_positions(const Object& object) {
    const size_t i = first_not_finite(object.positions);
    if (i == object.positions.size()) return;
    const vec3& p = object.positions[i];
    throw Error({.where = fmt::format("object '{}', vertex {}", object.name, i),
                 .got = fmt::format("({}, {}, {})", p.x, p.y, p.z),
                 .expected = "finite coordinates",
                 .remedy = "Remove or mend the vertex."});
}

void check_primitive_count(size_t count, const std::string& where) {
    if (count > 0 && count < kNoId) return;
    throw Error({.where = where,
                 .got = fmt::format("{} primitives", count),
                 .expected = fmt::format("1 to {}", kNoId - 1),
                 .remedy = "Remove empty objects; split those that are too large."});
}

/// Sizes the grid and lists what cells_of(frame, primitive, emit) emits by cell.
template <class CellsOf>
UniformGrid build_grid(const Bounds& bounds, size_t primitive_count, const GridSizing& sizing,
                       const CellsOf& cells_of) {
    UniformGrid grid;
    grid.bounds = padded_bounds(bounds);
    grid.dims = grid_resolution(grid.bounds, primitive_count, sizing);

    const CellFrame frame = cell_frame(grid.bounds, grid.dims);
    CellLists lists =
        list_by_cell(static_cast<uint32_t>(primitive_count), grid.cell_count(),
                     [&](uint32_t primitive, auto&& emit) { cells_of(frame, primitive, emit); });
    grid.cell_begin = std::move(lists.cell_begin);
    grid.references = std::move(lists.references);
    return grid;
}

std::atomic<uint64_t> triangle_grid_count = 0;

}  // namespace

UniformGrid build_box_grid(std::span<const Bounds> boxes, const GridSizing& sizing) {
    check_primitive_count(boxes.size(), "grid over boxes");
    check_boxes(boxes);
    Bounds bounds;
    for (const Bounds& box : boxes) bounds.extend(box);

    return build_grid(
        bounds, boxes.size(), sizing, [&](const CellFrame& frame, uint32_t i, auto&& emit) {
            const CellRange range = overlapped_range(frame.to_cells(boxes[i].lower),
                                                     frame.to_cells(boxes[i].upper), frame.dims);
            for_each_row(range, frame.dims, emit);
        });
}

UniformGrid build_triangle_grid(const Object& object, const GridSizing& sizing,
                                Duplicates duplicates) {
    return build_triangle_grid(object, object_bounds(object), sizing, duplicates);
}

UniformGrid build_triangle_grid(const Object& object, const Bounds& box, const GridSizing& sizing,
                                Duplicates duplicates) {
    check_primitive_count(object.triangles.size(), fmt::format("object '{}'", object.name));
    check_positions(object);
    ++triangle_grid_count;
    const std::vector<uint8_t> is_dropped =
        duplicates == Duplicates::dropped ? later_duplicates(object) : std::vector<uint8_t>{};

    return build_grid(
        box, object.triangles.size(), sizing, [&](const CellFrame& frame, uint32_t i, auto&& emit) {
            if (!is_dropped.empty() && is_dropped[i] != 0) return;
            const uvec3& corners = object.triangles[i];
            const std::array<dvec3, 3> vertices = {frame.to_cells(object.positions[corners.x]),
                                                   frame.to_cells(object.positions[corners.y]),
                                                   frame.to_cells(object.positions[corners.z])};
            for_each_overlapped_row(vertices, frame.dims, emit);
        });
}

uint64_t triangle_grids_built() { return triangle_grid_count; }

}  // namespace onepass
