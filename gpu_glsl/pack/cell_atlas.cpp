#include "gpu_glsl/pack/cell_atlas.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/two_level_layout.h"

uint64_t volume(uvec3 box) { return uint64_t{box.x} * box.y * box.z; }

/// Blocks on each axis that a grid of `cells` cells takes.
uvec3 blocks_of(uvec3 cells) { return (cells + uvec3(kBlockCells - 1)) / uvec3(kBlockCells); }

bool within(uvec3 size, uint32_t limit) {
    return size.x <= limit && size.y <= limit && size.z <= limit;
}

/// Tries to place all grids, the largest first.
std::optional<ObjectPlaces> try_to_place(std::span<const UniformGrid> objects, uvec3 size) {
    std::vector<size_t> order(objects.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return objects[a].cell_count() > objects[b].cell_count();
    });
    ObjectPlaces places;
    places.size = size;
    places.corners.resize(objects.size());
    places.blocks = BlockAllocator(size / uvec3(kBlockCells));
    for (const size_t k : order) {
        const uvec3 box = blocks_of(objects[k].dims);
        const auto corner = places.blocks.allocate(box);
        if (!corner) return std::nullopt;
        places.corners[k] = *corner * uvec3(kBlockCells);
        places.used = glm::max(places.used, *corner + box);
    }
    return places;
}

[[noreturn]] void throw_too_large(const std::string& what, uint64_t blocks, uvec3 largest,
                                  uint32_t limit) {
    throw Error({"texture 'cells'",
                 fmt::format("{} {} blocks of {}^3 cells, the largest grid {} x {} x {} cells",
                             what, blocks, kBlockCells, largest.x, largest.y, largest.z),
                 fmt::format("a fit in {0} x {0} x {0} cells", limit),
                 "Lower --param density or top_density, or raise --param atlas."});
}

}  // namespace

uint64_t block_count(uvec3 dims) { return volume(blocks_of(dims)); }

ObjectPlaces place_object_grids(std::span<const UniformGrid> objects, uint32_t limit) {
    uint64_t blocks_needed = 0;
    uvec3 largest(1);
    for (const UniformGrid& grid : objects) {
        blocks_needed += volume(blocks_of(grid.dims));
        largest = glm::max(largest, grid.dims);
    }
    uvec3 size(kBlockCells);
    for (int axis = 0; within(size, limit); axis = (axis + 1) % 3) {
        if (volume(size / uvec3(kBlockCells)) >= blocks_needed) {
            if (auto places = try_to_place(objects, size)) return *std::move(places);
        }
        size[axis] *= 2;
    }
    throw_too_large(fmt::format("{} object grids that fill", objects.size()), blocks_needed,
                    largest, limit);
}

TopPlace place_top_grid(const ObjectPlaces& objects, uvec3 dims, uint32_t limit) {
    const uvec3 box = blocks_of(dims);
    if (const auto free = objects.blocks.find(box)) {
        return {*free * uvec3(kBlockCells), objects.size};
    }
    std::optional<TopPlace> best;
    for (const int axis : {0, 1, 2}) {
        uvec3 corner(0);
        corner[axis] = objects.used[axis];
        uvec3 size = objects.size;
        for (int i = 0; i < 3; ++i) {
            size[i] =
                std::max(size[i], std::bit_ceil((corner[i] + box[i]) * uint32_t{kBlockCells}));
        }
        if (!within(size, limit) || (best && volume(best->size) <= volume(size))) continue;
        best = TopPlace{corner * uvec3(kBlockCells), size};
    }
    if (best) return *best;
    throw_too_large("a top-level grid beside object grids that fill", objects.blocks.used_blocks(),
                    dims, limit);
}

}  // namespace onepass
