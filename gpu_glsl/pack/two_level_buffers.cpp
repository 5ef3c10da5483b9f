#include "gpu_glsl/pack/two_level_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/empty_space.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

/// Where each grid's share of a buffer begins, and at the end the whole length.
template <class Count>
std::vector<uint64_t> starts_of(const std::vector<UniformGrid>& grids, const Count& count) {
    std::vector<uint64_t> starts = {0};
    for (const UniformGrid& grid : grids) starts.push_back(starts.back() + count(grid));
    return starts;
}

/// Of a triangle: those of its vertices, and its own number.
constexpr int kCornersWords = 4;

/// What the shader decodes is what core/grid encodes.
constexpr bool same_empty_cube_edges() {
    for (size_t code = 0; code < kEmptyCubeEdges.size(); ++code) {
        if (1 + code * (code + 1) / 2 != kEmptyCubeEdges[code]) return false;
    }
    return true;
}
static_assert(same_empty_cube_edges());

static_assert(kEmptyCell == kEmptyCellBit);
static_assert(kListPadsACell * kBinningPad == 1.0);

/// Turns the references of a grid into words (shared/grid_buffers_layout.h).
void references_to_words(UniformGrid& grid, std::span<const uint32_t> slots) {
    constexpr size_t kCellsATask = 1 << 14;
    tbb::parallel_for(tbb::blocked_range<uint64_t>(0, grid.cell_count(), kCellsATask),
                      [&](const auto& range) {
                          // All lists but their ends, which are then set right.
                          const uint32_t* const begins = grid.cell_begin.data();
                          const uint32_t last = begins[range.end()];
                          for (uint32_t k = begins[range.begin()]; k < last; ++k) {
                              uint32_t& word = grid.references[k];
                              word = (slots.empty() ? word : slots[word]) | kMoreReferences;
                          }
                          for (uint64_t i = range.begin(); i != range.end(); ++i) {
                              if (begins[i] == begins[i + 1]) continue;
                              grid.references[begins[i + 1] - 1] &= ~kMoreReferences;
                          }
                      });
}

/// Turns the cells of a grid, whose references begin at `first_reference`, into words.
void cells_to_words(UniformGrid& grid, uint64_t first_reference) {
    const auto base = static_cast<uint32_t>(first_reference);
    const EmptyCubes cubes(grid);
    grid.cell_begin.pop_back();
    constexpr size_t kRowsATask = 64;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, size_t{grid.dims.y} * grid.dims.z, kRowsATask),
                      [&](const auto& range) {
                          std::vector<uint32_t> empty(grid.dims.x);
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              cubes.row_words(static_cast<uint32_t>(i % grid.dims.y),
                                              static_cast<uint32_t>(i / grid.dims.y), empty.data());
                              uint32_t* const row = &grid.cell_begin[grid.dims.x * i];
                              for (uint32_t x = 0; x < grid.dims.x; ++x) {
                                  row[x] = empty[x] != 0 ? empty[x] : base + row[x];
                              }
                          }
                      });
}

/// The arrays of all grids end to end. Each is given up as it is taken over; a single one is not
/// even copied.
RawVector<uint32_t> joined(std::vector<UniformGrid>& grids,
                           RawVector<uint32_t> UniformGrid::*array) {
    if (grids.size() == 1) return std::move(grids.front().*array);
    size_t size = 0;
    for (const UniformGrid& grid : grids) size += (grid.*array).size();
    RawVector<uint32_t> all;
    all.reserve(size + 1);
    all.resize(size);
    auto out = all.begin();
    for (UniformGrid& grid : grids) {
        out = std::copy((grid.*array).begin(), (grid.*array).end(), out);
        give_back(grid.*array);
    }
    return all;
}

void check_index_range(const char* what, uint64_t count) {
    if (count < kMoreReferences) return;
    throw Error({.where = "packing grids into buffers",
                 .got = fmt::format("{} {}", count, what),
                 .expected = fmt::format("fewer than {}: an index has 31 bits", kMoreReferences),
                 .remedy = "Lower --param density, or split the scene."});
}

void put(float* texel, const dvec3& v) {
    for (int c = 0; c < 3; ++c) texel[c] = static_cast<float>(v[c]);
}

/// A position in the frame of its object's grid: exact.
vec3 in_frame(const vec3& position, const GridFrame& frame) {
    return vec3((dvec3(position) - frame.origin) * frame.scale);
}

/// All objects' positions in the frames of their grids, a texel each.
RawVector<float> pack_vertices(const Scene& scene, std::span<const GridFrame> frames,
                               const std::vector<uint64_t>& first_vertex) {
    RawVector<float> vertices(4 * first_vertex.back());
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const std::vector<vec3>& positions = scene.objects[k].positions;
        float* const out = vertices.data() + 4 * first_vertex[k];
        tbb::parallel_for(tbb::blocked_range<size_t>(0, positions.size(), 1 << 14),
                          [&](const auto& range) {
                              for (size_t i = range.begin(); i != range.end(); ++i) {
                                  const vec3 p = in_frame(positions[i], frames[k]);
                                  for (size_t axis = 0; axis < 3; ++axis) {
                                      out[4 * i + axis] = p[static_cast<int>(axis)];
                                  }
                                  out[4 * i + 3] = 0.0f;
                              }
                          });
    }
    return vertices;
}

struct PackedTriangles {
    RawVector<uint32_t> corners;  ///< indices of vertices, and the triangle's own
    RawVector<uint32_t> planes;   ///< from the centres of their grids
};

PackedTriangles pack_triangles(const Scene& scene, const std::vector<UniformGrid>& grids,
                               std::span<const RawVector<uint32_t>> slots,
                               std::span<const GridFrame> frames,
                               const std::vector<uint64_t>& first_triangle,
                               const std::vector<uint64_t>& first_vertex, PlanesForm form) {
    const size_t a_record = planes_words(form);
    PackedTriangles packed{RawVector<uint32_t>(kCornersWords * first_triangle.back()),
                           RawVector<uint32_t>(a_record * first_triangle.back())};
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Object& object = scene.objects[k];
        const dvec3 centre = centre_in(grids[k].bounds, frames[k]);
        tbb::parallel_for(
            tbb::blocked_range<size_t>(0, object.triangles.size(), 1 << 12),
            [&](const auto& range) {
                // What a triangle is read from and written to is asked for while others are packed:
                // it is not near that of the one before.
                constexpr size_t kAhead = 16;
                for (size_t i = range.begin(); i != range.end(); ++i) {
                    if (i + kAhead < object.triangles.size()) {
                        const uvec3 ahead = object.triangles[i + kAhead];
                        for (int v = 0; v < 3; ++v) __builtin_prefetch(&object.positions[ahead[v]]);
                        const size_t slot = first_triangle[k] + slots[k][i + kAhead];
                        __builtin_prefetch(&packed.planes[a_record * slot], 1);
                    }
                    const size_t at = first_triangle[k] + slots[k][i];
                    uint32_t* const corners = &packed.corners[kCornersWords * at];
                    std::array<dvec3, 3> p;
                    for (size_t v = 0; v < p.size(); ++v) {
                        const uint32_t corner = object.triangles[i][static_cast<int>(v)];
                        corners[v] = static_cast<uint32_t>(first_vertex[k] + corner);
                        p[v] = dvec3(in_frame(object.positions[corner], frames[k])) - centre;
                    }
                    corners[3] = static_cast<uint32_t>(i);
                    put_barycentric_planes(&packed.planes[a_record * at], form, p[0], p[1], p[2]);
                }
            });
    }
    return packed;
}

TextureData pack_grid_frames(const std::vector<UniformGrid>& grids, const TextureLimits& limits) {
    TextureData frames =
        make_float_buffer("grid_frames", "grids", grids.size() * kGridFrameTexels, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        const UniformGrid& grid = grids[k];
        const GridFrame frame = object_frame(grid.bounds);
        const dvec3 cell = grid.cell_size() * frame.scale;
        const dvec3 centre = centre_in(grid.bounds, frame);
        float* const out = &frames.texels[4 * kGridFrameTexels * k];
        put(out, (dvec3(grid.bounds.lower) - frame.origin) * frame.scale - centre);
        put(out + 4, (dvec3(grid.bounds.upper) - frame.origin) * frame.scale - centre);
        put(out + 8, cell);
        put(out + 12, 1.0 / cell);
        put(out + 16, centre);
    }
    return frames;
}

TextureData pack_grid_numbers(const std::vector<UniformGrid>& grids,
                              const std::vector<uint64_t>& first_cell,
                              const std::vector<uint64_t>& first_triangle,
                              const TextureLimits& limits) {
    TextureData numbers =
        make_word_buffer("grid_numbers", "grids", grids.size() * kGridNumberTexels, 4, limits);
    for (size_t k = 0; k < grids.size(); ++k) {
        uint32_t* out = &numbers.words[4 * kGridNumberTexels * k];
        for (int axis = 0; axis < 3; ++axis) out[axis] = grids[k].dims[axis];
        out[3] = static_cast<uint32_t>(first_cell[k]);
        out[4] = static_cast<uint32_t>(first_triangle[k]);
    }
    return numbers;
}

TextureData pack_instance_rows(const Scene& scene, std::span<const Affine> world_from_object,
                               std::span<const GridFrame> frames, const TextureLimits& limits) {
    constexpr size_t kFloats = 4 * kInstanceRowTexels;
    RawVector<float> rows(kFloats * world_from_object.size());
    constexpr size_t kInstancesATask = 512;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, world_from_object.size(), kInstancesATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              put_instance_rows(&rows[kFloats * i], world_from_object[i],
                                                frames[scene.instances[i].object]);
                          }
                      });
    return float_buffer_of("instance_rows", "instances", std::move(rows), limits,
                           BufferKind::texture);
}

/// `origin`: of the top level's frame, where no coordinate is larger than twice the extent.
/// Rounding to floats moves a corner by an ulp of the extent at most: 1/16 of the pad at 1,024
/// cells an axis.
TextureData pack_instance_boxes(std::span<const Bounds> boxes, const dvec3& origin,
                                const dvec3& top_cell, const TextureLimits& limits) {
    TextureData packed =
        make_float_buffer("instance_boxes", "instances", boxes.size() * kInstanceBoxTexels, limits);
    const dvec3 pad = kBinningPad * top_cell;
    for (size_t i = 0; i < boxes.size(); ++i) {
        float* const out = &packed.texels[4 * kInstanceBoxTexels * i];
        put(out, dvec3(boxes[i].lower) - origin - pad);
        put(out + 4, dvec3(boxes[i].upper) - origin + pad);
    }
    return packed;
}

TextureData pack_instance_grids(const Scene& scene, const TextureLimits& limits) {
    TextureData grids =
        make_word_buffer("instance_grids", "instances", scene.instances.size(), 1, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        grids.words[i] = scene.instances[i].object;
    }
    return grids;
}

}  // namespace

void grid_to_words(UniformGrid& grid, uint64_t first_reference, std::span<const uint32_t> slots) {
    references_to_words(grid, slots);
    cells_to_words(grid, first_reference);
}

ShaderInputs pack_top_buffers(const Scene& scene, std::span<const Affine> world_from_object,
                              std::span<const Bounds> boxes, UniformGrid top,
                              std::span<const GridFrame> frames, const TextureLimits& limits) {
    grid_to_words(top, 0);
    TextureData cells = word_buffer_of("top_cells", "cells", std::move(top.cell_begin), limits,
                                       BufferKind::texture);
    TextureData references = word_buffer_of("top_references", "references",
                                            std::move(top.references), limits, BufferKind::texture);

    ShaderInputs inputs;
    inputs.textures.push_back(std::move(cells));
    inputs.textures.push_back(std::move(references));
    inputs.textures.push_back(pack_instance_rows(scene, world_from_object, frames, limits));
    const dvec3 origin = frame_origin(top.bounds);
    inputs.textures.push_back(pack_instance_boxes(boxes, origin, top.cell_size(), limits));
    inputs.uniforms = {{"top_frame", vec3(origin)},
                       {"top_lower", vec3(dvec3(top.bounds.lower) - origin)},
                       {"top_upper", vec3(dvec3(top.bounds.upper) - origin)},
                       {"top_cell", vec3(top.cell_size())},
                       {"top_cells_per_unit", vec3(1.0 / top.cell_size())},
                       {"top_dims", vec3(top.dims)}};
    return inputs;
}

TwoLevelBuffers pack_two_level_buffers(const Scene& scene, TwoLevelGrid grid,
                                       const TextureLimits& limits, BufferKind kind,
                                       PlanesForm form) {
    // What lies where.
    std::vector<UniformGrid>& grids = grid.objects;
    const std::vector<uint64_t> first_cell =
        starts_of(grids, [](const UniformGrid& g) { return g.cell_count(); });
    const std::vector<uint64_t> first_reference =
        starts_of(grids, [](const UniformGrid& g) { return uint64_t{g.references.size()}; });
    std::vector<uint64_t> first_triangle = {0};
    std::vector<uint64_t> first_vertex = {0};
    for (const Object& object : scene.objects) {
        first_triangle.push_back(first_triangle.back() + object.triangles.size());
        first_vertex.push_back(first_vertex.back() + object.positions.size());
    }
    check_index_range("cells", first_cell.back());
    check_index_range("references", first_reference.back());
    check_index_range("triangles", 3 * first_triangle.back());
    check_index_range("vertices", first_vertex.back());
    std::vector<Affine> world_from_object;
    for (const Instance& instance : scene.instances) {
        world_from_object.push_back(instance.world_from_object);
    }

    TwoLevelBuffers packed;
    for (const UniformGrid& object : grids) packed.frames.push_back(object_frame(object.bounds));
    packed.object_cells = first_cell.back();
    packed.object_references = first_reference.back();
    packed.stats = {
        {"triangles", static_cast<double>(first_triangle.back()), "unique"},
        {"cells", static_cast<double>(packed.object_cells + grid.top.cell_count()), "of all grids"},
        {"references", static_cast<double>(packed.object_references + grid.top.references.size()),
         "of all grids"}};

    // The grids become buffers in place.
    packed.slots.resize(grids.size());
    tbb::parallel_for(size_t{0}, grids.size(), [&](size_t k) {
        packed.slots[k] = storage_slots(scene.objects[k], grids[k].bounds);
    });
    for (size_t k = 0; k < grids.size(); ++k) {
        grid_to_words(grids[k], first_reference[k], packed.slots[k]);
    }
    const auto add = [&](TextureData texture) {
        packed.inputs.textures.push_back(std::move(texture));
    };
    add(word_buffer_of("cells", "cells", joined(grids, &UniformGrid::cell_begin), limits, kind));
    RawVector<uint32_t> references = joined(grids, &UniformGrid::references);
    references.push_back(0);  // read, though not used, behind the last list (strategies/grid.glsl)
    add(word_buffer_of("references", "references", std::move(references), limits, kind));
    PackedTriangles triangles = pack_triangles(scene, grids, packed.slots, packed.frames,
                                               first_triangle, first_vertex, form);
    add(word_buffer_of("planes", "triangles", std::move(triangles.planes), limits, kind, 4));
    add(word_buffer_of("corners", "triangles", std::move(triangles.corners), limits, kind,
                       kCornersWords));
    add(float_buffer_of("vertices", "vertices", pack_vertices(scene, packed.frames, first_vertex),
                        limits, kind));
    add(pack_grid_frames(grids, limits));
    add(pack_grid_numbers(grids, first_cell, first_triangle, limits));
    add(pack_instance_grids(scene, limits));
    packed.inputs.append(pack_top_buffers(scene, world_from_object, grid.instance_boxes,
                                          std::move(grid.top), packed.frames, limits));
    for (const TextureData& texture : packed.inputs.textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    return packed;
}

}  // namespace onepass
