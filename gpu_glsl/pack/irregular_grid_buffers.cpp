#include "gpu_glsl/pack/irregular_grid_buffers.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"
#include "gpu_glsl/shaders/shared/irregular_grid_layout.h"

static_assert(kNodeBits == IrregularNode::kBits);
static_assert(kLatticeMost == kPlacesMask + 1);

/// Where one object's share of the buffers begins.
struct Place {
    uint64_t node = 0;
    uint64_t cell = 0;
    uint64_t reference = 0;
};

std::vector<Place> places_of(const std::vector<IrregularGrid>& grids) {
    std::vector<Place> places(1);
    for (const IrregularGrid& grid : grids) {
        const Place& last = places.back();
        places.push_back({last.node + grid.nodes.size(), last.cell + grid.cells.size(),
                          last.reference + grid.references.size()});
    }
    return places;
}

void check_names(const char* what, uint64_t count, uint64_t most) {
    if (count <= most) return;
    throw Error({.where = "packing irregular grids into buffers",
                 .got = fmt::format("{} {}", count, what),
                 .expected = fmt::format("at most {}: what a word can name", most),
                 .remedy = "Lower --param density, or split the scene."});
}

/// Calls put(i) for each i below `count`, in parallel.
template <class Put>
void for_each(size_t count, const Put& put) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1 << 14), [&](const auto& range) {
        for (size_t i = range.begin(); i != range.end(); ++i) put(i);
    });
}

void put_nodes(uint32_t* out, const IrregularGrid& grid, const Place& at) {
    for_each(grid.nodes.size(), [&](size_t i) {
        const IrregularNode& node = grid.nodes[i];
        const auto first = static_cast<uint32_t>(node.bits > 0 ? at.node : at.cell);
        out[i] = (first + node.first) << kNodeBits | node.bits;
    });
}

void put_cells(uint32_t* out, const IrregularGrid& grid, const Place& at) {
    const uvec3 dims = grid.dims();
    for_each(grid.cells.size(), [&](size_t i) {
        const IrregularCell& cell = grid.cells[i];
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t beyond = dims[axis] - 1 - cell.last[axis];
            out[4 * i + static_cast<size_t>(axis)] = cell.lower[axis] | (beyond << kBeyondShift);
        }
        const auto first = static_cast<uint32_t>(at.reference) + cell.first;
        out[4 * i + 3] = cell.count == 0 ? kEmptyCell : first;
    });
}

/// `slots`: of the triangles, in the tables.
void put_references(uint32_t* out, const IrregularGrid& grid, std::span<const uint32_t> slots) {
    for_each(grid.cells.size(), [&](size_t i) {
        const IrregularCell& cell = grid.cells[i];
        for (uint32_t k = 0; k < cell.count; ++k) {
            const bool is_last = k + 1 == cell.count;
            const uint32_t slot = slots[grid.references[cell.first + k]];
            out[cell.first + k] = slot | (is_last ? 0 : kMoreReferences);
        }
    });
}

/// What the walk reads of a grid's lattice: the frame keeps the box, the rest becomes the
/// lattice's.
void put_lattice(float* frame_texels, uint32_t* numbers, const IrregularGrid& grid,
                 const Place& at) {
    const double edge = grid.edge * object_frame(grid.bounds).scale;
    for (int axis = 0; axis < 3; ++axis) {
        frame_texels[8 + axis] = static_cast<float>(edge);
        frame_texels[12 + axis] = static_cast<float>(1.0 / edge);
        numbers[axis] = grid.dims()[axis];
    }
    numbers[3] = static_cast<uint32_t>(at.node);
    numbers[5] = grid.depth;
}

}  // namespace

TwoLevelIrregularGrid build_two_level_irregular_grid(const Scene& scene,
                                                     const IrregularGridSettings& settings,
                                                     const GridSizing& top,
                                                     const std::vector<double>& densities) {
    const auto start = std::chrono::steady_clock::now();
    TwoLevelSizing sizing;
    for (const double density : densities) sizing.objects.push_back({.density = density});
    check_object_count(sizing, scene.objects.size());
    TwoLevelIrregularGrid grid;
    grid.objects.resize(scene.objects.size());
    tbb::parallel_for(size_t{0}, scene.objects.size(), [&](size_t k) {
        IrregularGridSettings own = settings;
        if (!densities.empty()) own.density = densities[k];
        grid.objects[k] = build_irregular_grid(scene.objects[k], own);
    });
    grid.around.instance_boxes = instance_bounds(scene);
    grid.around.top = build_box_grid(grid.around.instance_boxes, top);
    for (const IrregularGrid& object : grid.objects) {
        UniformGrid& around = grid.around.objects.emplace_back();
        around.bounds = object.bounds;
        around.cell_begin = {0, 1};
        around.references = {0};
    }
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    grid.build_ms = elapsed.count();
    return grid;
}

TwoLevelBuffers pack_irregular_grid_buffers(const Scene& scene, TwoLevelIrregularGrid grid,
                                            const TextureLimits& limits, BufferKind kind,
                                            PlanesForm form) {
    // The tables of the irregular grids.
    const std::vector<Place> places = places_of(grid.objects);
    check_names("nodes", places.back().node, IrregularNode::kMostFirst);
    check_names("cells", places.back().cell, IrregularNode::kMostFirst);
    check_names("references", places.back().reference, kMoreReferences - 1);
    TextureData nodes = make_word_buffer("nodes", "nodes", places.back().node, 1, limits);
    TextureData cells = make_word_buffer("cells", "cells", places.back().cell, 4, limits);
    TextureData references =
        make_word_buffer("references", "references", places.back().reference + 1, 1, limits);
    for (size_t k = 0; k < grid.objects.size(); ++k) {
        put_nodes(&nodes.words[places[k].node], grid.objects[k], places[k]);
        put_cells(&cells.words[4 * places[k].cell], grid.objects[k], places[k]);
    }

    // All else as the two-level grid has it, around grids of one cell, which these take the place
    // of.
    const uint64_t top_cells = grid.around.top.cell_count();
    const uint64_t top_references = grid.around.top.references.size();
    TwoLevelBuffers packed =
        pack_two_level_buffers(scene, std::move(grid.around), limits, kind, form);
    ShaderInputs& inputs = packed.inputs;
    for (size_t k = 0; k < grid.objects.size(); ++k) {
        put_references(references.words.data() + places[k].reference, grid.objects[k],
                       packed.slots[k]);
    }
    inputs.texture("cells") = std::move(cells);
    inputs.texture("references") = std::move(references);
    inputs.textures.push_back(std::move(nodes));
    for (size_t k = 0; k < grid.objects.size(); ++k) {
        put_lattice(&inputs.texture("grid_frames").texels[4 * kGridFrameTexels * k],
                    &inputs.texture("grid_numbers").words[4 * kGridNumberTexels * k],
                    grid.objects[k], places[k]);
    }

    packed.object_cells = places.back().cell;
    packed.object_references = places.back().reference;
    packed.stats.clear();
    for (const TextureData& texture : inputs.textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    uint64_t triangles = 0;
    for (const Object& object : scene.objects) triangles += object.triangles.size();
    const auto add_stat = [&](const char* name, uint64_t value, const char* note) {
        packed.stats.push_back({name, static_cast<double>(value), note});
    };
    add_stat("triangles", triangles, "unique");
    add_stat("nodes", places.back().node, "of all objects");
    add_stat("cells", packed.object_cells + top_cells, "of all grids");
    add_stat("references", packed.object_references + top_references, "of all grids");
    return packed;
}

}  // namespace onepass
