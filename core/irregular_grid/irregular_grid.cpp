// The build of an irregular grid: the top cells, what becomes of each, and all of it side by side.
#include "core/irregular_grid/irregular_grid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/binning.h"
#include "core/grid/cell_lists.h"
#include "core/grid/duplicates.h"
#include "core/grid/sizing.h"
#include "core/irregular_grid/stages.h"

namespace onepass {
namespace {

/// Top cells an axis, at most: so that the pad of core/grid/binning.h, in which triangles are
/// brought to them, is the larger one.
constexpr uint32_t kTopMost = 512;
static_assert(kTopMost * kLatticePad < kBinningPad);

/// Cubes of equal size over the object's box, by the rule for uniform grids.
void lay_lattice(IrregularGrid& grid, const Object& object, double top_density) {
    grid.bounds = padded_bounds(object_bounds(object));
    const uvec3 dims = grid_resolution(grid.bounds, object.triangles.size(),
                                       {.density = top_density, .max_cells_per_axis = kTopMost});
    const dvec3 extent = dvec3(grid.bounds.upper) - dvec3(grid.bounds.lower);
    int widest = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (extent[axis] > extent[widest]) widest = axis;
    }
    const double top_edge = extent[widest] / dims[widest];
    for (int axis = 0; axis < 3; ++axis) {
        const double cells = std::ceil(extent[axis] / top_edge);
        grid.top_dims[axis] = std::clamp(static_cast<uint32_t>(cells), 1u, dims[widest]);
    }
    grid.depth = static_cast<uint32_t>(std::bit_width(kLatticeMost / dims[widest]) - 1);
    grid.edge = std::ldexp(top_edge, -static_cast<int>(grid.depth));
}

CellLists list_by_top_cell(const Object& object, const IrregularGrid& grid) {
    const uvec3& dims = grid.top_dims;
    const double top_per_unit = std::ldexp(1.0 / grid.edge, -static_cast<int>(grid.depth));
    const CellFrame frame{dvec3(grid.bounds.lower), dvec3(top_per_unit), dims};
    const std::vector<uint8_t> is_dropped = later_duplicates(object);
    return list_by_cell(static_cast<uint32_t>(object.triangles.size()),
                        uint64_t{dims.x} * dims.y * dims.z, [&](uint32_t triangle, auto&& emit) {
                            if (!is_dropped.empty() && is_dropped[triangle] != 0) return;
                            const uvec3& corners = object.triangles[triangle];
                            const std::array<dvec3, 3> vertices = {
                                frame.to_cells(object.positions[corners.x]),
                                frame.to_cells(object.positions[corners.y]),
                                frame.to_cells(object.positions[corners.z])};
                            for_each_overlapped_row(vertices, dims, emit);
                        });
}

void check_names(const char* what, uint64_t count, uint64_t most) {
    if (count <= most) return;
    throw Error({.where = "irregular grid",
                 .got = fmt::format("{} {}", count, what),
                 .expected = fmt::format("at most {}", most),
                 .remedy = "Lower its density, or split the object."});
}

/// Where each top cell's share begins, and at the end the whole length.
struct Places {
    std::vector<uint64_t> node;
    std::vector<uint64_t> cell;
    std::vector<uint64_t> reference;
};

Places places_of(const std::vector<Subtree>& trees) {
    Places places{{trees.size()}, {0}, {0}};
    for (const Subtree& tree : trees) {
        places.node.push_back(places.node.back() + tree.nodes.size());
        places.cell.push_back(places.cell.back() + tree.cells.size());
        places.reference.push_back(places.reference.back() + tree.references.size());
    }
    check_names("nodes", places.node.back(), IrregularNode::kMostFirst);
    check_names("cells", places.cell.back(), IrregularNode::kMostFirst);
    check_names("references", places.reference.back(), kMaxReferences);
    return places;
}

void put_side_by_side(const std::vector<Subtree>& trees, IrregularGrid& grid) {
    const Places places = places_of(trees);
    grid.nodes.resize(places.node.back());
    grid.cells.resize(places.cell.back());
    grid.references.resize(places.reference.back());
    tbb::parallel_for(size_t{0}, trees.size(), [&](size_t i) {
        const auto first_node = static_cast<uint32_t>(places.node[i]);
        const auto first_cell = static_cast<uint32_t>(places.cell[i]);
        const auto first_reference = static_cast<uint32_t>(places.reference[i]);
        const auto moved = [&](IrregularNode node) {
            node.first += node.bits > 0 ? first_node : first_cell;
            return node;
        };
        const Subtree& tree = trees[i];
        grid.nodes[i] = moved(tree.root);
        std::transform(tree.nodes.begin(), tree.nodes.end(), grid.nodes.begin() + first_node,
                       moved);
        std::transform(tree.cells.begin(), tree.cells.end(), grid.cells.begin() + first_cell,
                       [&](IrregularCell cell) {
                           cell.first += first_reference;
                           return cell;
                       });
        std::copy(tree.references.begin(), tree.references.end(),
                  grid.references.begin() + first_reference);
    });
}

}  // namespace

uint32_t IrregularGrid::cell_at(uvec3 place) const {
    uint32_t shift = depth;
    const uvec3 top = place >> shift;
    IrregularNode node = nodes[top.x + size_t{top_dims.x} * (top.y + size_t{top_dims.y} * top.z)];
    while (node.bits > 0) {
        shift -= node.bits;
        const uvec3 part = (place >> shift) & ((1u << node.bits) - 1);
        node = nodes[node.first + part.x + ((part.y + (part.z << node.bits)) << node.bits)];
    }
    return node.first;
}

IrregularGrid build_irregular_grid(const Object& object, const IrregularGridSettings& settings) {
    check_names("triangles", object.triangles.size(), kNoId - 1);
    if (object.triangles.empty()) {
        throw Error({.where = fmt::format("object '{}'", object.name),
                     .got = "no triangle",
                     .expected = "at least 1",
                     .remedy = "Remove empty objects."});
    }

    // The top cells, each with its triangles.
    IrregularGrid grid;
    lay_lattice(grid, object, settings.top_density);
    const CellLists lists = list_by_top_cell(object, grid);

    // Each by itself: divided, then merged.
    std::vector<Subtree> trees(lists.cell_begin.size() - 1);
    tbb::parallel_for(size_t{0}, trees.size(), [&](size_t i) {
        const auto top = static_cast<uint32_t>(i);
        const uvec3 place(top % grid.top_dims.x, top / grid.top_dims.x % grid.top_dims.y,
                          top / grid.top_dims.x / grid.top_dims.y);
        const auto first = lists.references.begin();
        trees[i] = divide_cube(object, grid, settings, place << grid.depth, grid.depth,
                               {first + lists.cell_begin[i], first + lists.cell_begin[i + 1]});
        merge_cells(trees[i], settings.cell_cost);
    });

    // Over their borders: expanded.
    put_side_by_side(trees, grid);
    expand_cells(grid, settings.expansions);
    return grid;
}

}  // namespace onepass
