#include "gpu_glsl/pack/bvh_buffers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "core/grid/sizing.h"
#include "gpu_glsl/pack/frames.h"

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/bvh_layout.h"
#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

// The stack of lib/bvh/descent.glsl: both trees' nodes put aside, and an end below each.
static_assert(kBvhMostDepth + kBvhMostTopDepth + 2 <= BVH_STACK_ENTRIES);
static_assert(kBvhMostLeaf < kBvhSlot);

/// What a tree lies in: its own frame, and there a box around it. All boxes are counted from its
/// centre.
struct Surroundings {
    GridFrame frame;
    Bounds bounds;
    dvec3 centre{0.0};

    /// A point of the object, exact or to 2^-52 of itself.
    dvec3 place(const vec3& p) const { return (dvec3(p) - frame.origin) * frame.scale - centre; }
};

/// The frame and the padded box of the grid that `grid` would build, so that rays are moved to the
/// same places and decided on alike.
Surroundings surroundings_of(const Bvh& tree) {
    const Bounds bounds = padded_bounds(tree.bounds);
    const GridFrame frame = object_frame(bounds);
    return {frame, bounds, centre_in(bounds, frame)};
}

/// Of the tree over instances: the frame's origin is the scene's centre.
Surroundings surroundings_of_top(const Bvh& tree) {
    const Bounds bounds = padded_bounds(tree.bounds);
    const dvec3 extent = dvec3(bounds.upper) - dvec3(bounds.lower);
    const dvec3 middle = 0.5 * dvec3(bounds.lower) + 0.5 * dvec3(bounds.upper);
    const double scale = frame_scale(std::max({extent.x, extent.y, extent.z}));
    return {{dvec3(vec3(middle)), scale}, bounds, dvec3(0.0)};
}

vec3 rounded_down(const dvec3& p) {
    vec3 q(p);
    for (int axis = 0; axis < 3; ++axis) {
        if (double{q[axis]} > p[axis]) q[axis] = std::nextafter(q[axis], -kInfinity);
    }
    return q;
}

vec3 rounded_up(const dvec3& p) { return -rounded_down(-p); }

/// A child's box, and its reference, with the tree's nodes and slots beginning at these places.
void put_child(uint32_t* out, const BvhChild& child, const Surroundings& around,
               uint32_t first_node, uint32_t first_slot) {
    const vec3 lower = rounded_down(around.place(child.box.lower));
    const vec3 upper = rounded_up(around.place(child.box.upper));
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = std::bit_cast<uint32_t>(lower[axis]);
        out[axis + 3] = std::bit_cast<uint32_t>(upper[axis]);
    }
    out[6] = child.is_leaf() ? kBvhSlot * (first_slot + child.first) + child.count
                             : kBvhInner + first_node + child.first;
}

void put_nodes(uint32_t* out, const Bvh& bvh, const Surroundings& around, uint32_t first_node,
               uint32_t first_slot) {
    constexpr size_t kWords = 4 * kBvhNodeTexels;
    constexpr size_t kChildWords = 7;
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, bvh.nodes.size(), 1 << 12), [&](const auto& range) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                for (size_t side = 0; side < 2; ++side) {
                    put_child(out + kWords * i + kChildWords * side, bvh.nodes[i].children[side],
                              around, first_node, first_slot);
                }
            }
        });
}

/// An object's corners and planes in the order of the leaves, and the triangle in each slot.
void put_triangles(float* corners, uint32_t* planes, PlanesForm form, uint32_t* primitives,
                   const Object& object, const Bvh& bvh, const Surroundings& around) {
    const GridFrame& frame = around.frame;
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
                        stored[v][axis] = static_cast<double>(out[axis]) - around.centre[axis];
                    }
                }
                put_barycentric_planes(planes + planes_words(form) * slot, form, stored[0],
                                       stored[1], stored[2]);
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
    constexpr uint64_t kMost = kBvhInner / kBvhSlot;
    if (slots <= kMost) return;
    throw Error({"buffer 'bvh_primitives'", std::to_string(slots) + " triangles",
                 "at most " + std::to_string(kMost), "Use a grid, or a smaller scene."});
}

TextureData pack_instance_rows(const Scene& scene, const std::vector<Surroundings>& around,
                               const TextureLimits& limits) {
    TextureData rows = make_float_buffer("instance_rows", "instances",
                                         scene.instances.size() * kInstanceRowTexels, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        put_instance_rows(&rows.texels[4 * kInstanceRowTexels * i], instance.world_from_object,
                          around[instance.object].frame);
    }
    return rows;
}

TextureData pack_boxes(const Scene& scene, const std::vector<Surroundings>& around,
                       const TextureLimits& limits) {
    TextureData boxes =
        make_float_buffer("bvh_boxes", "instances", scene.instances.size() * kBvhBoxTexels, limits);
    float* out = boxes.texels.data();
    for (const Instance& instance : scene.instances) {
        const Surroundings& own = around[instance.object];
        for (const dvec3& p :
             {own.centre, own.place(own.bounds.lower), own.place(own.bounds.upper)}) {
            for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(p[axis]);
            out += 4;
        }
    }
    return boxes;
}

std::vector<UniformData> top_uniforms(const Surroundings& top) {
    return {{"top_centre", vec3(top.frame.origin)},
            {"top_scale", static_cast<float>(top.frame.scale)},
            {"top_lower", rounded_down(top.place(top.bounds.lower))},
            {"top_upper", rounded_up(top.place(top.bounds.upper))}};
}

}  // namespace

BvhBuffers pack_bvh_buffers(const Scene& scene, const TwoLevelBvh& bvh, const TextureLimits& limits,
                            BufferKind kind, PlanesForm form) {
    // The objects.
    const std::vector<Place> places = places_of(bvh.objects);
    check_slots(places.back().slot);
    TextureData nodes = make_word_buffer("bvh_nodes", "nodes", places.back().node * kBvhNodeTexels,
                                         4, limits, kind);
    TextureData vertices = make_float_buffer("bvh_vertices", "triangles",
                                             places.back().slot * kBvhTriangleTexels, limits, kind);
    TextureData planes = make_word_buffer(
        "bvh_planes", "triangles", places.back().slot * planes_words(form) / 4, 4, limits, kind);
    TextureData primitives =
        make_word_buffer("bvh_primitives", "triangles", places.back().slot, 1, limits, kind);
    std::vector<Surroundings> around;
    for (size_t k = 0; k < scene.objects.size(); ++k) {
        const Bvh& tree = bvh.objects[k];
        const Place& at = places[k];
        around.push_back(surroundings_of(tree));
        put_nodes(&nodes.words[4 * kBvhNodeTexels * at.node], tree, around.back(),
                  static_cast<uint32_t>(at.node), static_cast<uint32_t>(at.slot));
        put_triangles(&vertices.texels[4 * kBvhTriangleTexels * at.slot],
                      &planes.words[planes_words(form) * at.slot], form, &primitives.words[at.slot],
                      scene.objects[k], tree, around.back());
    }

    // The instances and the tree over them.
    TextureData roots =
        make_word_buffer("bvh_roots", "instances", scene.instances.size(), 1, limits);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        roots.words[i] = kBvhInner + static_cast<uint32_t>(places[scene.instances[i].object].node);
    }
    TextureData top_nodes = make_word_buffer("bvh_top_nodes", "nodes",
                                             bvh.top.nodes.size() * kBvhNodeTexels, 4, limits);
    const Surroundings top = surroundings_of_top(bvh.top);
    put_nodes(top_nodes.words.data(), bvh.top, top, 0, 0);
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
    textures.push_back(pack_instance_rows(scene, around, limits));
    textures.push_back(pack_boxes(scene, around, limits));
    packed.inputs.uniforms = top_uniforms(top);
    for (const TextureData& texture : textures) {
        packed.stats.push_back({texture.name + "_bytes", static_cast<double>(texture.bytes()), ""});
    }
    packed.stats.push_back({"triangles", static_cast<double>(places.back().slot), "unique"});
    packed.stats.push_back(
        {"nodes", static_cast<double>(places.back().node + bvh.top.nodes.size()), "of all trees"});
    return packed;
}

}  // namespace onepass
