#include "gpu_glsl/pack/bvh_buffers.h"

#include <array>
#include <bit>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/sizing.h"
#include "gpu_glsl/pack/barycentric_planes.h"
#include "gpu_glsl/pack/frames.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/bvh_layout.h"
#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

// The stack of lib/bvh/descent.glsl.
static_assert(kBvhMostDepth + kBvhMostTopDepth <= 64);
static_assert(kBvhMostLeaf < kBvhSlot);

/// A child's box in the frame, and its reference, with the tree's nodes and slots beginning at
/// these places.
void put_child(uint32_t* out, const BvhChild& child, const GridFrame& frame, uint32_t first_node,
               uint32_t first_slot) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto coordinate = [&](const vec3& p) {
            const double q = (double{p[axis]} - frame.origin[axis]) * frame.scale;
            return std::bit_cast<uint32_t>(static_cast<float>(q));
        };
        out[axis] = coordinate(child.box.lower);
        out[axis + 3] = coordinate(child.box.upper);
    }
    out[6] = child.is_leaf() ? kBvhLeaf + kBvhSlot * (first_slot + child.first) + child.count
                             : first_node + child.first;
}

void put_nodes(uint32_t* out, const Bvh& bvh, const GridFrame& frame, uint32_t first_node,
               uint32_t first_slot) {
    constexpr size_t kWords = 4 * kBvhNodeTexels;
    constexpr size_t kChildWords = 7;
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, bvh.nodes.size(), 1 << 12), [&](const auto& range) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                for (size_t side = 0; side < 2; ++side) {
                    put_child(out + kWords * i + kChildWords * side, bvh.nodes[i].children[side],
                              frame, first_node, first_slot);
                }
            }
        });
}

/// An object's corners and planes in the order of the leaves, and the triangle in each slot.
void put_triangles(float* corners, float* planes, uint32_t* primitives, const Object& object,
                   const Bvh& bvh, const GridFrame& frame) {
    const dvec3 centre = centre_in(bvh.bounds, frame);
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, bvh.primitives.size(), 1 << 12), [&](const auto& range) {
            for (size_t slot = range.begin(); slot != range.end(); ++slot) {
                const uint32_t prim_id = bvh.primitives[slot];
                primitives[slot] = prim_id;
                std::array<dvec3, 3> stored;  // from the centre
                for (size_t v = 0; v < stored.size(); ++v) {
                    float* const out = corners + 4 * (kBvhTriangleTexels * slot + v);
                    const dvec3 p(object.positions[object.triangles[prim_id][static_cast<int>(v)]]);
                    const dvec3 q = (p - frame.origin) * frame.scale;
                    for (int axis = 0; axis < 3; ++axis) {
                        out[axis] = static_cast<float>(q[axis]);
                        stored[v][axis] = double{out[axis]} - centre[axis];
                    }
                }
                put_barycentric_planes(planes + 4 * kBvhPlanesTexels * slot, stored[0], stored[1],
                                       stored[2]);
            }
        });
}

/// Where one object's share of the buffers begins.
struct Place {
    uint64_t node = 0;
    uint64_t slot = 0;
};

std::vector<Place> places_of(const std::vector<Bvh>& trees) {
    std::vector<Place> places(1);
    for (const Bvh& tree : trees) {
        places.push_back(
            {places.back().node + tree.nodes.size(), places.back().slot + tree.primitives.size()});
    }
    return places;
}

/// References have 27 bits for a slot and 31 for a node, of which there are fewer.
void check_slots(uint64_t slots) {
    constexpr uint64_t kMost = kBvhLeaf / kBvhSlot;
    if (slots <= kMost) return;
    throw Error({"buffer 'bvh_primitives'", std::to_string(slots) + " triangles",
                 "at most " + std::to_string(kMost), "Use a grid, or a smaller scene."});
}

TextureData pack_instances(const Scene& scene, const TwoLevelBvh& bvh,
                           const std::vector<GridFrame>& frames, const TextureLimits& limits) {
    TextureData rows = make_float_buffer("bvh_instances", "instances",
                                         scene.instances.size() * kBvhInstanceTexels, limits);
    static_assert(kBvhInstanceTexels == kInstanceRowTexels + 3);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const GridFrame& frame = frames[instance.object];
        const Bounds& box = bvh.objects[instance.object].bounds;
        float* const out = &rows.texels[4 * kBvhInstanceTexels * i];
        put_instance_rows(out, instance.world_from_object, frame);
        for (int axis = 0; axis < 3; ++axis) {
            const auto coordinate = [&](const vec3& p) {
                return static_cast<float>((double{p[axis]} - frame.origin[axis]) * frame.scale);
            };
            out[4 * kInstanceRowTexels + axis] = coordinate(box.lower);
            out[4 * kInstanceRowTexels + 4 + axis] = coordinate(box.upper);
            out[4 * kInstanceRowTexels + 8 + axis] =
                static_cast<float>(centre_in(box, frame)[axis]);
        }
    }
    return rows;
}

}  // namespace

BvhBuffers pack_bvh_buffers(const Scene& scene, const TwoLevelBvh& bvh,
                            const TextureLimits& limits) {
    // The objects.
    const std::vector<Place> places = places_of(bvh.objects);
    check_slots(places.back().slot);
    TextureData nodes =
        make_word_buffer("bvh_nodes", "nodes", places.back().node * kBvhNodeTexels, 4, limits);
    TextureData vertices = make_float_buffer("bvh_vertices", "triangles",
                                             places.back().slot * kBvhTriangleTexels, limits);
    TextureData planes =
        make_float_buffer("bvh_planes", "triangles", places.back().slot * kBvhPlanesTexels, limits);
    TextureData primitives =
        make_word_buffer("bvh_primitives", "triangles", places.back().slot, 1, limits);
    std::vector<GridFrame> frames;
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Bvh& tree = bvh.objects[k];
        const Place& at = places[k];
        frames.push_back(object_frame(padded_bounds(tree.bounds)));
        put_nodes(&nodes.words[4 * kBvhNodeTexels * at.node], tree, frames.back(),
                  static_cast<uint32_t>(at.node), static_cast<uint32_t>(at.slot));
        put_triangles(&vertices.texels[4 * kBvhTriangleTexels * at.slot],
                      &planes.texels[4 * kBvhPlanesTexels * at.slot], &primitives.words[at.slot],
                      scene.objects[k], tree, frames.back());
    }

    // The instances and the tree over them, which is in the world as it is.
    TextureData roots =
        make_word_buffer("bvh_roots", "instances", scene.instances.size(), 1, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        roots.words[i] = static_cast<uint32_t>(places[scene.instances[i].object].node);
    }
    TextureData top_nodes = make_word_buffer("bvh_top_nodes", "nodes",
                                             bvh.top.nodes.size() * kBvhNodeTexels, 4, limits);
    put_nodes(top_nodes.words.data(), bvh.top, {}, 0, 0);
    TextureData top_instances =
        make_word_buffer("bvh_top_instances", "instances", bvh.top.primitives.size(), 1, limits);
    top_instances.words.assign(bvh.top.primitives.begin(), bvh.top.primitives.end());

    BvhBuffers packed;
    std::deque<TextureData>& textures = packed.inputs.textures;
    textures.push_back(std::move(nodes));
    textures.push_back(std::move(vertices));
    textures.push_back(std::move(planes));
    textures.push_back(std::move(primitives));
    textures.push_back(std::move(roots));
    textures.push_back(std::move(top_nodes));
    textures.push_back(std::move(top_instances));
    textures.push_back(pack_instances(scene, bvh, frames, limits));
    for (const TextureData& texture : textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    packed.stats.push_back({"triangles", static_cast<double>(places.back().slot), "unique"});
    packed.stats.push_back(
        {"nodes", static_cast<double>(places.back().node + bvh.top.nodes.size()), "of all trees"});
    return packed;
}

}  // namespace onepass
