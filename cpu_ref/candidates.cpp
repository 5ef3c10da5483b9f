// The box trees of the candidate search: median splits over triangles and over instances.
//
// Traversal stands in the header, because it is a template over its visitor.
#include "cpu_ref/candidates.h"

#include <algorithm>
#include <numeric>

namespace onepass {

namespace {

/// Few enough that a leaf costs about as much as a node, enough to keep the tree small.
constexpr uint32_t kLeafItems = 4;

int widest_axis(const vec3& extent) {
    if (extent.x >= extent.y && extent.x >= extent.z) return 0;
    return extent.y >= extent.z ? 1 : 2;
}

/// Fills node `index` with items [first, first + count), splitting until a leaf is small.
void build_node(BoxTree& tree, std::span<const Bounds> boxes, uint32_t index, uint32_t first,
                uint32_t count) {
    Bounds bounds;
    Bounds centres;
    for (uint32_t i = first; i < first + count; ++i) {
        bounds.extend(boxes[tree.items[i]]);
        centres.extend(boxes[tree.items[i]].centre());
    }
    tree.nodes[index] = {bounds.lower, first, bounds.upper, count};
    if (count <= kLeafItems) return;

    // Half of the items by centroid; equal centroids are split by whatever order they have.
    const int axis = widest_axis(centres.extent());
    const uint32_t half = count / 2;
    const auto begin = tree.items.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](uint32_t a, uint32_t b) {
        return boxes[a].centre()[axis] < boxes[b].centre()[axis];
    });
    const auto children = static_cast<uint32_t>(tree.nodes.size());
    tree.nodes.resize(tree.nodes.size() + 2);
    tree.nodes[index].first = children;
    tree.nodes[index].count = 0;
    build_node(tree, boxes, children, first, half);
    build_node(tree, boxes, children + 1, first + half, count - half);
}

/// The nearest floats outside a double interval.
float rounded_down(double x) {
    const auto f = static_cast<float>(x);
    return double{f} <= x ? f : std::nextafter(f, -kInfinity);
}
float rounded_up(double x) { return -rounded_down(-x); }

}  // namespace

BoxTree build_box_tree(std::span<const Bounds> boxes) {
    BoxTree tree;
    tree.items.resize(boxes.size());
    std::iota(tree.items.begin(), tree.items.end(), 0u);
    tree.nodes.resize(1);
    build_node(tree, boxes, 0, 0, static_cast<uint32_t>(boxes.size()));
    return tree;
}

CandidateSearch::CandidateSearch(ScenePtr scene) : scene_(std::move(scene)) {
    // One tree an object, shared by its instances.
    for (const Object& object : scene_->objects) {
        std::vector<Bounds> boxes(object.triangles.size());
        for (size_t i = 0; i < boxes.size(); ++i) {
            for (int corner = 0; corner < 3; ++corner) {
                boxes[i].extend(object.positions[object.triangles[i][corner]]);
            }
        }
        object_trees_.push_back(build_box_tree(boxes));
    }

    // The instances' world boxes, from the roots.
    std::vector<Bounds> boxes;
    for (const Instance& instance : scene_->instances) {
        const BoxTree::Node& root = object_trees_[instance.object].nodes[0];
        Placement placement;
        placement.map = DAffine(instance.world_from_object);
        for (int k = 0; k < 3; ++k) placement.abs_columns[k] = glm::abs(placement.map[k]);
        const dvec3 largest = glm::max(glm::abs(dvec3(root.lower)), glm::abs(dvec3(root.upper)));
        placement.pad =
            kRoundingPad *
            (placement.abs_columns[0] * largest.x + placement.abs_columns[1] * largest.y +
             placement.abs_columns[2] * largest.z + glm::abs(placement.map[3]));
        const WorldBox b = world_box(placement, root.lower, root.upper);
        boxes.push_back(
            {vec3(rounded_down(b.lower.x), rounded_down(b.lower.y), rounded_down(b.lower.z)),
             vec3(rounded_up(b.upper.x), rounded_up(b.upper.y), rounded_up(b.upper.z))});
        magnitude_ = std::max(magnitude_, double{boxes.back().magnitude()});
        placements_.push_back(placement);
    }
    instance_tree_ = build_box_tree(boxes);
}

}  // namespace onepass
