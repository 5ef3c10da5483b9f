// Bounding volume hierarchies: binary trees of boxes over primitives, for the `bvh` strategy.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bounds.h"
#include "core/scene.h"

namespace onepass {

/// What a node says of one of its two children. A leaf holds primitives[first] ..
/// primitives[first + count - 1]; count 0: an inner node, nodes[first].
struct BvhChild {
    Bounds box;
    uint32_t first = 0;
    uint32_t count = 0;

    bool is_leaf() const { return count > 0; }
    bool operator==(const BvhChild&) const = default;
};

/// An inner node. It holds its children's boxes, so that one fetch decides where to go next.
struct BvhNode {
    std::array<BvhChild, 2> children;

    bool operator==(const BvhNode&) const = default;
};

/// A tree of at least one node: nodes[0] is the root, and each node stands before those below it.
/// A single primitive is a leaf on both sides of the root.
struct Bvh {
    Bounds bounds;
    std::vector<BvhNode> nodes;
    std::vector<uint32_t> primitives;  ///< in the leaves' order; each once
    uint32_t depth = 0;                ///< inner nodes on the longest way down

    bool operator==(const Bvh&) const = default;
};

/// How a tree is made. Costs are relative to each other.
struct BvhSettings {
    uint32_t bins = 16;       ///< tried splits an axis, and one
    uint32_t most_leaf = 4;   ///< primitives a leaf holds at most; 1 to kBvhMostLeaf
    double step_cost = 1.0;   ///< of a node: two boxes
    double test_cost = 1.0;   ///< of a primitive
    uint32_t most_depth = 0;  ///< of inner nodes; 0: kBvhMostDepth

    bool operator==(const BvhSettings&) const = default;
};

inline constexpr uint32_t kBvhMostLeaf = 15;
/// No tree is deeper: where the heuristic would go deeper, ranges are halved instead. So a stack of
/// this many entries suffices for every scene.
inline constexpr uint32_t kBvhMostDepth = 40;

/// Builds a tree by the surface area heuristic, evaluated at the borders of equal bins of the
/// boxes' centres.
///
/// Cost:   O(n log n) time, 112 bytes a box while it is built; parallel, the same bits for any
///         thread count.
/// Throws: Error if there is no box, if one is empty or not finite, if there are more than 2^27, or
///         if a setting is out of its range.
/// Source: Wald 2007; MacDonald & Booth 1990.
Bvh build_bvh(std::span<const Bounds> boxes, const BvhSettings& settings);

/// Boxes of an object's triangles, exact.
std::vector<Bounds> triangle_bounds(const Object& object);

/// One tree over instances, and one an object over its triangles. A triangle with the very three
/// corners of one of a lower index is in no tree (core/grid/duplicates.h).
struct TwoLevelBvh {
    Bvh top;                   ///< world space
    std::vector<Bvh> objects;  ///< object space
    double build_ms = 0.0;     ///< wall time of the build
};

/// Depths of `objects` and of `top` together stay below kBvhMostDepth + kBvhMostTopDepth.
/// Throws: as build_bvh.
TwoLevelBvh build_two_level_bvh(const Scene& scene, const BvhSettings& settings);

/// Of a tree over instances: fewer than 2^24 of them.
inline constexpr uint32_t kBvhMostTopDepth = 24;

}  // namespace onepass
