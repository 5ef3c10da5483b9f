#include "gpu_glsl/pack/flat_grid_buffers.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/duplicates.h"
#include "core/grid/two_level_grid.h"
#include "core/storage_order.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

const Object& object_of(const Scene& scene, const Instance& instance) {
    return scene.objects[instance.object];
}

std::vector<uint32_t> in_order_of_storage(const Object& object) {
    const RawVector<uint32_t> slots = storage_slots(object, object_bounds(object));
    std::vector<uint32_t> triangles(slots.size());
    for (uint32_t i = 0; i < slots.size(); ++i) triangles[slots[i]] = i;
    return triangles;
}

/// All triangles but those that equal a lower one, in the order of storage.
std::vector<uint32_t> without_duplicates(const Object& object) {
    const std::vector<uint8_t> is_dropped = later_duplicates(object);
    std::vector<uint32_t> listed;
    for (const uint32_t i : in_order_of_storage(object)) {
        if (is_dropped.empty() || is_dropped[i] == 0) listed.push_back(i);
    }
    return listed;
}

/// Calls visit(index, inst_id, prim_id) for each triangle of the list, in parallel.
template <class Visit>
void for_each_triangle(const FlatGrid& flat, const Scene& scene, const Visit& visit) {
    for (uint32_t inst_id = 0; inst_id < scene.instances.size(); ++inst_id) {
        const std::vector<uint32_t>& listed = flat.listed[scene.instances[inst_id].object];
        constexpr size_t kTrianglesATask = 1 << 12;
        tbb::parallel_for(tbb::blocked_range<size_t>(0, listed.size(), kTrianglesATask),
                          [&](const auto& range) {
                              for (size_t k = range.begin(); k != range.end(); ++k) {
                                  visit(flat.first[inst_id] + k, inst_id, listed[k]);
                              }
                          });
    }
}

/// Where a triangle's corners stand in the world, less `from`.
std::array<dvec3, 3> world_corners(const Scene& scene, uint32_t inst_id, uint32_t prim_id,
                                   const dvec3& from) {
    const Instance& instance = scene.instances[inst_id];
    const Object& object = object_of(scene, instance);
    std::array<dvec3, 3> corners;
    for (int v = 0; v < 3; ++v) {
        const vec3& p = object.positions[object.triangles[prim_id][v]];
        corners[static_cast<size_t>(v)] = world_point(instance.world_from_object, p, from);
    }
    return corners;
}

/// The same in the frame, from the centre: right to 2^-51 of the frame's unit.
std::array<dvec3, 3> corners_in_frame(const FlatGrid& flat, const Scene& scene, uint32_t inst_id,
                                      uint32_t prim_id) {
    std::array<dvec3, 3> corners = world_corners(scene, inst_id, prim_id, flat.frame.origin);
    for (dvec3& p : corners) p = p * flat.frame.scale - flat.centre;
    return corners;
}

struct WorldBox {
    dvec3 lower{kInfinity};
    dvec3 upper{-kInfinity};

    void extend(const WorldBox& other) {
        lower = glm::min(lower, other.lower);
        upper = glm::max(upper, other.upper);
    }
};

WorldBox world_box(const FlatGrid& flat, const Scene& scene) {
    tbb::combinable<WorldBox> boxes;
    for_each_triangle(flat, scene, [&](size_t, uint32_t inst_id, uint32_t prim_id) {
        WorldBox& box = boxes.local();
        for (const dvec3& p : world_corners(scene, inst_id, prim_id, dvec3(0.0))) {
            box.extend({p, p});
        }
    });
    WorldBox box;
    boxes.combine_each([&](const WorldBox& part) { box.extend(part); });
    return box;
}

/// Its origin is the float nearest to the middle of the scene. That may be far from there beside a
/// small scene far out, and so the centre in the frame is what everything is counted from.
void place_frame(FlatGrid& flat, const Scene& scene) {
    const WorldBox box = world_box(flat, scene);
    const dvec3 middle = 0.5 * box.lower + 0.5 * box.upper;
    const dvec3 extent = box.upper - box.lower;
    flat.frame.origin = dvec3(vec3(middle));
    flat.frame.scale = frame_scale(std::max({extent.x, extent.y, extent.z}));
    flat.centre = dvec3(vec3((middle - flat.frame.origin) * flat.frame.scale));
}

/// The triangles in the frame, their corners rounded to floats: what the cells' lists are made of.
/// A corner is within half the extent of the centre, and so it moves by 2^-25 of the extent at
/// most, on each axis.
Object mesh_in_frame(const FlatGrid& flat, const Scene& scene) {
    Object mesh;
    mesh.name = "all instances";
    mesh.positions.resize(3 * flat.first.back());
    mesh.triangles.resize(flat.first.back());
    for_each_triangle(flat, scene, [&](size_t at, uint32_t inst_id, uint32_t prim_id) {
        const std::array<dvec3, 3> p = corners_in_frame(flat, scene, inst_id, prim_id);
        for (size_t v = 0; v < p.size(); ++v) mesh.positions[3 * at + v] = vec3(p[v]);
        mesh.triangles[at] = static_cast<uint32_t>(3 * at) + uvec3(0, 1, 2);
    });
    return mesh;
}

/// From the corners as they are, not as mesh_in_frame() rounds them. That they are wrong by d =
/// 2^-51 moves a weight, for points in the triangle or next to it, by less than 4 d of the record's
/// sum A + B + 1: nothing beside 22 or 45 * 2^-24 of it, the bounds of the test (lib/triangle).
RawVector<uint32_t> pack_planes(const FlatGrid& flat, const Scene& scene, PlanesForm form) {
    const size_t a_record = planes_words(form);
    RawVector<uint32_t> planes(a_record * flat.first.back());
    for_each_triangle(flat, scene, [&](size_t at, uint32_t inst_id, uint32_t prim_id) {
        const std::array<dvec3, 3> p = corners_in_frame(flat, scene, inst_id, prim_id);
        put_barycentric_planes(&planes[a_record * at], form, p[0], p[1], p[2]);
    });
    return planes;
}

/// `slots`: of each object's triangles, in the tables that decisions rest on.
TextureData pack_names(const FlatGrid& flat, const Scene& scene,
                       std::span<const RawVector<uint32_t>> slots, const TextureLimits& limits) {
    TextureData names = make_word_buffer("flat_names", "triangles", flat.first.back(), 2, limits);
    for_each_triangle(flat, scene, [&](size_t at, uint32_t inst_id, uint32_t prim_id) {
        names.words[2 * at] = inst_id;
        names.words[2 * at + 1] = slots[scene.instances[inst_id].object][prim_id];
    });
    return names;
}

std::vector<UniformData> flat_uniforms(const FlatGrid& flat) {
    const UniformGrid& grid = flat.grid;
    return {{"flat_origin", vec3(flat.frame.origin)},
            {"flat_scale", static_cast<float>(flat.frame.scale)},
            {"flat_centre", vec3(flat.centre)},
            {"flat_lower", grid.bounds.lower},
            {"flat_upper", grid.bounds.upper},
            {"flat_cell", vec3(grid.cell_size())},
            {"flat_cells_per_unit", vec3(1.0 / grid.cell_size())},
            {"flat_dims", vec3(grid.dims)}};
}

/// What frames and instances are packed from: grids of one cell where those of `grid` lie.
TwoLevelGrid grids_around(const Scene& scene) {
    TwoLevelGrid around;
    around.instance_boxes = instance_bounds(scene);
    around.top = build_box_grid(around.instance_boxes, {.resolution = uvec3(1)});
    for (const Object& object : scene.objects) {
        UniformGrid& grid = around.objects.emplace_back();
        grid.bounds = padded_bounds(object_bounds(object));
        grid.cell_begin = {0, 1};
        grid.references = {0};
    }
    return around;
}

[[noreturn]] void refuse(uint64_t triangles, uint64_t most, size_t bytes) {
    throw Error(
        {.where = "one grid over the triangles of all instances",
         .got = fmt::format("{} triangles", triangles),
         .expected = fmt::format("at most {}, with {} bytes each in one buffer", most, bytes),
         .remedy = "Use `grid`, which keeps an object once, however many instances it has."});
}

}  // namespace

FlatGrid build_flat_grid(const Scene& scene, const GridSizing& sizing) {
    const auto start = std::chrono::steady_clock::now();
    FlatGrid flat;
    flat.listed.resize(scene.objects.size());
    tbb::parallel_for(size_t{0}, scene.objects.size(),
                      [&](size_t k) { flat.listed[k] = without_duplicates(scene.objects[k]); });
    flat.first = {0};
    for (const Instance& instance : scene.instances) {
        flat.first.push_back(flat.first.back() + flat.listed[instance.object].size());
    }
    place_frame(flat, scene);
    flat.grid = build_triangle_grid(mesh_in_frame(flat, scene), sizing);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    flat.build_ms = elapsed.count();
    return flat;
}

void check_flat_grid_fits(const Scene& scene, const TextureLimits& limits, BufferKind kind,
                          PlanesForm form) {
    const size_t bytes = planes_words(form) * sizeof(uint32_t);
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) {
        triangles += object_of(scene, instance).triangles.size();
    }
    // While the grid is built, corners are numbered in 32 bits.
    constexpr uint64_t kMostTriangles = (uint64_t{1} << 32) / 3;
    const uint64_t most = std::min<uint64_t>(
        kMostTriangles, kind == BufferKind::block ? limits.max_block / bytes
                                                  : limits.max_buffer / (bytes / sizeof(vec4)));
    if (triangles > most) refuse(triangles, most, bytes);
}

TwoLevelBuffers pack_flat_grid_buffers(const Scene& scene, FlatGrid flat,
                                       const TextureLimits& limits, BufferKind kind,
                                       PlanesForm form) {
    // What decisions rest on.
    TwoLevelBuffers packed = pack_two_level_buffers(scene, grids_around(scene), limits, kind, form);
    ShaderInputs& inputs = packed.inputs;

    // What the walk reads.
    UniformGrid& grid = flat.grid;
    packed.object_cells = grid.cell_count();
    packed.object_references = grid.references.size();
    const std::vector<UniformData> uniforms = flat_uniforms(flat);
    inputs.uniforms.insert(inputs.uniforms.end(), uniforms.begin(), uniforms.end());
    grid_to_words(grid, 0);
    grid.references.push_back(0);  // read, though not used, behind the last list
    inputs.texture("cells") =
        word_buffer_of("cells", "cells", std::move(grid.cell_begin), limits, kind);
    inputs.texture("references") =
        word_buffer_of("references", "references", std::move(grid.references), limits, kind);
    inputs.texture("planes") =
        word_buffer_of("planes", "triangles", pack_planes(flat, scene, form), limits, kind, 4);
    inputs.textures.push_back(pack_names(flat, scene, packed.slots, limits));

    packed.stats = {{"triangles", static_cast<double>(flat.first.back()), "of all instances"},
                    {"cells", static_cast<double>(packed.object_cells), ""},
                    {"references", static_cast<double>(packed.object_references), ""}};
    for (const TextureData& texture : inputs.textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    return packed;
}

}  // namespace onepass
