// The triangles that a ray may touch, found conservatively: what the judges look at.
//
// Independent of every tracer and every judge: no intersection is decided here, only "cannot touch
// its box" against "may". A box tree an object, one over the instances, and boxes carried into the
// world instead of rays into objects, so that no matrix is ever inverted.
//
// Why nothing is lost. (1) Tree boxes of objects hold float vertices exactly. (2) A box (centre c,
// half extents h) goes to the world as M c +- |M| h, which holds every image of a point of the box
// in real arithmetic. (3) A moved ray (o + a) + t (d + b) with |a_k| <= A, |b_k| <= B touches the
// box at t >= 0 only if t (d_k + B) >= lower_k - A - o_k and t (d_k - B) <= upper_k + A - o_k hold
// for each axis k: six half-lines in t, whose intersection with [tmin, tmax] is tested. (4) Every
// sum above takes a handful of double roundings of numbers no larger than the scene's and the ray's
// coordinates; A is widened by kRoundingPad of those, each quotient in t by kQuotientPad of itself.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/catalogue.h"
#include "cpu_ref/ray_spread.h"

namespace onepass {

/// Of the coordinates: 32 roundings of 2^-53. The longest chain is about a dozen.
inline constexpr double kRoundingPad = 0x1p-48;
/// Of a t: reciprocal, product and the sum d_k +- B, each at most 2^-53 off.
inline constexpr double kQuotientPad = 0x1p-50;

/// Six half-lines in t, made ready for one ray and all boxes.
class SpreadSlabs {
  public:
    /// `magnitude`: the largest absolute coordinate of any box to be asked about.
    SpreadSlabs(const SpreadRay& ray, double magnitude)
        : org_(ray.org),
          tmin_(ray.tmin),
          widening_(ray.org_reach +
                    kRoundingPad * (magnitude + largest_component(ray.org) + ray.org_reach)) {
        // A slope of 0 becomes a tiny one of the sign that keeps its half-line open: the test gets
        // weaker by nothing, and no infinity arises whose padding would be NaN and cut nothing off.
        constexpr double kLeast = 1e-100;
        for (int k = 0; k < 3; ++k) {
            const double lower_slope = ray.dir[k] + ray.dir_reach;
            const double upper_slope = ray.dir[k] - ray.dir_reach;
            lower_[k] = 1.0 / (std::abs(lower_slope) < kLeast ? kLeast : lower_slope);
            upper_[k] = 1.0 / (std::abs(upper_slope) < kLeast ? -kLeast : upper_slope);
        }
    }

    /// Where some ray of the spread may enter the box, at or after tmin; +inf if none does at
    /// t <= tmax.
    double entry(const dvec3& box_lower, const dvec3& box_upper, double tmax) const {
        double enter = tmin_;
        double leave = tmax;
        for (int k = 0; k < 3; ++k) {
            const double from = (box_lower[k] - widening_ - org_[k]) * lower_[k];
            const double to = (box_upper[k] + widening_ - org_[k]) * upper_[k];
            if (lower_[k] > 0.0) {
                clip_below(from, enter);
            } else {
                clip_above(from, leave);
            }
            if (upper_[k] > 0.0) {
                clip_above(to, leave);
            } else {
                clip_below(to, enter);
            }
        }
        return enter <= leave ? enter : std::numeric_limits<double>::infinity();
    }

  private:
    static void clip_below(double bound, double& enter) {
        const double padded = bound - std::abs(bound) * kQuotientPad;
        if (padded > enter) enter = padded;
    }
    static void clip_above(double bound, double& leave) {
        const double padded = bound + std::abs(bound) * kQuotientPad;
        if (padded < leave) leave = padded;
    }

    dvec3 org_;
    double tmin_;
    double widening_;
    dvec3 lower_{0.0};  ///< reciprocal slopes of the half-lines at the lower sides
    dvec3 upper_{0.0};
};

/// A binary tree of boxes in one array; the root is node 0.
struct BoxTree {
    struct Node {
        vec3 lower;
        uint32_t first = 0;  ///< leaf: of `items`; inner: its children are first and first + 1
        vec3 upper;
        uint32_t count = 0;  ///< items of a leaf; 0 for an inner node
    };
    static constexpr int kMaxDepth = 48;  ///< median splits halve 2^32 items in less
    std::vector<Node> nodes;
    std::vector<uint32_t> items;
};

/// Splits at the median centroid of the widest axis. Cost: O(n log^2 n) at worst.
BoxTree build_box_tree(std::span<const Bounds> boxes);

/// Finds the triangles of a scene that a ray, or any ray of a spread around it, may touch.
class CandidateSearch {
  public:
    /// Cost: O(n log n) in the triangles of all objects; memory 64 bytes a triangle or less.
    explicit CandidateSearch(ScenePtr scene);

    /// Calls visit(inst_id, prim_id) -> double for every triangle that may be touched at a t in
    /// [ray.tmin, ray.tmax]; what visit returns replaces tmax from then on (return it unchanged to
    /// see all). Nearer boxes come first, but the order of triangles is otherwise unspecified.
    ///
    /// The ray must be traceable (is_traceable). A superset: a visited triangle need not be hit.
    template <class Visit>
    void visit(const SpreadRay& ray, Visit&& visit_triangle) const;

    /// The largest absolute coordinate of the instances' world boxes.
    double magnitude() const { return magnitude_; }
    const Scene& scene() const { return *scene_; }

  private:
    /// A box of the frame of `map` in the world.
    struct WorldBox {
        dvec3 lower;
        dvec3 upper;
    };
    struct Placement {
        DAffine map;
        std::array<dvec3, 3> abs_columns;
        dvec3 pad{0.0};  ///< the roundings of world_box, from the largest coordinates of the object
    };

    static WorldBox world_box(const Placement& placement, const vec3& lower, const vec3& upper);

    /// Depth first, nearer child first. box(lower, upper) -> WorldBox; leaf(item).
    template <class Box, class Leaf>
    static void descend(const BoxTree& tree, const SpreadSlabs& slabs, const double& tmax,
                        const Box& box, const Leaf& leaf);

    ScenePtr scene_;
    std::vector<BoxTree> object_trees_;
    std::vector<Placement> placements_;  ///< one an instance
    BoxTree instance_tree_;              ///< float boxes, rounded outwards
    double magnitude_ = 0.0;
};

inline CandidateSearch::WorldBox CandidateSearch::world_box(const Placement& placement,
                                                            const vec3& lower, const vec3& upper) {
    const dvec3 centre = 0.5 * (dvec3(lower) + dvec3(upper));
    const dvec3 half = 0.5 * (dvec3(upper) - dvec3(lower));
    const dvec3 world_centre = transform_point(placement.map, centre);
    const dvec3 world_half = placement.abs_columns[0] * half.x + placement.abs_columns[1] * half.y +
                             placement.abs_columns[2] * half.z + placement.pad;
    return {world_centre - world_half, world_centre + world_half};
}

template <class Box, class Leaf>
void CandidateSearch::descend(const BoxTree& tree, const SpreadSlabs& slabs, const double& tmax,
                              const Box& box, const Leaf& leaf) {
    struct Entry {
        uint32_t node;
        double enter;
    };
    const auto enter = [&](uint32_t index) {
        const BoxTree::Node& node = tree.nodes[index];
        const WorldBox b = box(node.lower, node.upper);
        return slabs.entry(b.lower, b.upper, tmax);
    };
    std::array<Entry, BoxTree::kMaxDepth + 2> stack;
    size_t size = 0;
    const auto push = [&](uint32_t node, double at) {
        if (at <= tmax && at < std::numeric_limits<double>::infinity()) stack[size++] = {node, at};
    };
    push(0, enter(0));
    while (size > 0) {
        const Entry top = stack[--size];
        if (top.enter > tmax) continue;
        const BoxTree::Node& node = tree.nodes[top.node];
        if (node.count > 0) {
            for (uint32_t i = 0; i < node.count; ++i) leaf(tree.items[node.first + i]);
            continue;
        }
        const double left = enter(node.first);
        const double right = enter(node.first + 1);
        const bool left_first = left <= right;
        push(left_first ? node.first + 1 : node.first, left_first ? right : left);
        push(left_first ? node.first : node.first + 1, left_first ? left : right);
    }
}

template <class Visit>
void CandidateSearch::visit(const SpreadRay& ray, Visit&& visit_triangle) const {
    const SpreadSlabs slabs(ray, magnitude_);
    double tmax = ray.tmax;
    const auto as_it_is = [](const vec3& lower, const vec3& upper) {
        return WorldBox{dvec3(lower), dvec3(upper)};
    };
    descend(instance_tree_, slabs, tmax, as_it_is, [&](uint32_t inst_id) {
        const uint32_t object_id = scene_->instances[inst_id].object;
        const Object& object = scene_->objects[object_id];
        const Placement& placement = placements_[inst_id];
        const auto to_world = [&](const vec3& lower, const vec3& upper) {
            return world_box(placement, lower, upper);
        };
        descend(object_trees_[object_id], slabs, tmax, to_world, [&](uint32_t prim_id) {
            const uvec3 triangle = object.triangles[prim_id];
            Bounds bounds;
            for (int corner = 0; corner < 3; ++corner) {
                bounds.extend(object.positions[triangle[corner]]);
            }
            const WorldBox b = to_world(bounds.lower, bounds.upper);
            const double at = slabs.entry(b.lower, b.upper, tmax);
            if (at <= tmax && at < std::numeric_limits<double>::infinity()) {
                tmax = visit_triangle(inst_id, prim_id);
            }
        });
    });
}

}  // namespace onepass
