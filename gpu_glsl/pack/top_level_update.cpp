#include "gpu_glsl/pack/top_level_update.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/shading.h"
#include "gpu_glsl/pack/reference_lists.h"
#include "gpu_glsl/pack/shading_tables.h"

namespace onepass {
namespace {

/// Instances at their new places.
struct MovedInstances {
    std::vector<Bounds> boxes;  ///< in the world
    RawVector<Affine> object_from_world;
};

/// What validate() asks of an instance's transform and box. Throws: Error naming the instance.
void check_moved(const Scene& scene, size_t index, const Affine& m, const Bounds& box) {
    const vec3 extent = box.extent();
    const bool finite =
        std::isfinite(extent.x) && std::isfinite(extent.y) && std::isfinite(extent.z);
    if (finite && is_invertible(m)) return;
    throw Error({fmt::format("instance {} '{}', moved", index, scene.instances[index].name),
                 finite ? "a transform that flattens space" : "a box of infinite size, or NaN",
                 "a transform that can be inverted, and a box whose size is a finite float",
                 "Keep its scales finite and away from 0 throughout the animation."});
}

/// The same numbers, bit by bit, as instance_bounds() and packing have from a scene; but from the
/// objects' boxes, without a look at a vertex.
MovedInstances move_instances(const Scene& scene, std::span<const Bounds> object_boxes,
                              std::span<const Affine> world_from_object) {
    if (world_from_object.size() != scene.instances.size()) {
        throw Error({"moving instances", fmt::format("{} transforms", world_from_object.size()),
                     fmt::format("{}, one an instance", scene.instances.size()),
                     "Give those of instance_transforms()."});
    }
    MovedInstances moved;
    moved.boxes.resize(world_from_object.size());
    moved.object_from_world.resize(world_from_object.size());
    constexpr size_t kInstancesATask = 512;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, world_from_object.size(), kInstancesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              const Affine& m = world_from_object[i];
                              moved.boxes[i] =
                                  transform_bounds(m, object_boxes[scene.instances[i].object]);
                              check_moved(scene, i, m, moved.boxes[i]);
                              moved.object_from_world[i] = Affine(inverse(m));
                          }
                      });
    return moved;
}

Bounds bounds_of(std::span<const Bounds> boxes) {
    Bounds bounds;
    for (const Bounds& box : boxes) bounds.extend(box);
    return bounds;
}

TexelBox whole_texture(TextureData texture) {
    return {.texture = std::move(texture.name),
            .size = texture.size,
            .texels = std::move(texture.texels)};
}

}  // namespace

MovingTopLevel::MovingTopLevel(ScenePtr scene, TwoLevelGrid grid, const GridSizing& top_sizing,
                               TwoLevelPlaces places, const TwoLevelTexturesOptions& options)
    : scene_(std::move(scene)),
      object_grids_(std::move(grid.objects)),
      top_sizing_(top_sizing),
      places_(std::move(places)),
      options_(options) {
    for (const Object& object : scene_->objects) object_boxes_.push_back(object_bounds(object));
    for (const UniformGrid& object : object_grids_) {
        object_cells_ += object.cell_count();
        object_references_ += object.references.size();
        longest_object_list_ = std::max(longest_object_list_, longest_list(object));
    }
}

TopLevelMove MovingTopLevel::plan(std::span<const Affine> world_from_object) const {
    const MovedInstances moved = move_instances(*scene_, object_boxes_, world_from_object);
    const UniformGrid top = build_box_grid(moved.boxes, top_sizing_);

    // The top level: into the room it has, or all grids into more room.
    TopLevelMove move;
    if (auto boxes = pack_top_grid(top, places_, options_)) {
        move.changes.boxes = std::move(*boxes);
    } else {
        GridTextures grids = pack_grids(*scene_, object_grids_, top, options_, places_);
        move.changes.remade = std::move(grids.textures);
        move.stats = std::move(grids.stats);
        move.repacked = std::make_unique<TwoLevelPlaces>(std::move(grids.places));
    }

    // The instances.
    const TwoLevelPlaces& places = move.repacked ? *move.repacked : places_;
    move.changes.boxes.push_back(
        whole_texture(pack_instances(*scene_, moved.object_from_world, places)));
    move.changes.boxes.push_back(
        whole_texture(pack_shading_instances(*scene_, moved.object_from_world, options_.limits)));
    move.changes.uniforms = {{"ray_offset", secondary_offset(bounds_of(moved.boxes))}};

    move.stats.push_back({"cells", static_cast<double>(object_cells_ + top.cell_count()), ""});
    move.stats.push_back(
        {"references", static_cast<double>(object_references_ + top.references.size()), ""});
    move.stats.push_back({"longest_list",
                          static_cast<double>(std::max(longest_object_list_, longest_list(top))),
                          ""});
    return move;
}

void MovingTopLevel::commit(TopLevelMove& move) {
    if (move.repacked) places_ = std::move(*move.repacked);
}

MovingTopBuffers::MovingTopBuffers(ScenePtr scene, const GridSizing& top_sizing,
                                   const TwoLevelBuffers& packed, const TextureLimits& limits)
    : scene_(std::move(scene)),
      frames_(packed.frames),
      top_sizing_(top_sizing),
      limits_(limits),
      object_cells_(packed.object_cells),
      object_references_(packed.object_references) {
    for (const Object& object : scene_->objects) object_boxes_.push_back(object_bounds(object));
}

TopLevelMove MovingTopBuffers::plan(std::span<const Affine> world_from_object) const {
    const MovedInstances moved = move_instances(*scene_, object_boxes_, world_from_object);
    UniformGrid top = build_box_grid(moved.boxes, top_sizing_);
    TopLevelMove move;
    move.stats.push_back({"cells", static_cast<double>(object_cells_ + top.cell_count()), ""});
    move.stats.push_back(
        {"references", static_cast<double>(object_references_ + top.references.size()), ""});

    ShaderInputs inputs =
        pack_top_buffers(*scene_, world_from_object, moved.boxes, std::move(top), frames_, limits_);
    for (const TextureData& texture : inputs.textures) {
        move.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    move.changes.remade = std::move(inputs.textures);
    move.changes.uniforms = std::move(inputs.uniforms);
    move.changes.boxes.push_back(
        whole_texture(pack_shading_instances(*scene_, moved.object_from_world, limits_)));
    move.changes.uniforms.push_back({"ray_offset", secondary_offset(bounds_of(moved.boxes))});
    return move;
}

}  // namespace onepass
