// The builder: ranges of boxes, split in place, from the root down.
//
// Determinism: bins hold counts and boxes, whose sums and unions do not depend on their order, and
// a subtree's nodes have their room before it is built: n primitives have at most n - 1 inner
// nodes. Afterwards the room that was not needed is closed.
#include "core/bvh/bvh.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include "core/error.h"
#include "core/grid/duplicates.h"

namespace onepass {
namespace {

/// Where a primitive is, and which one it is.
struct Item {
    Bounds box;
    uint32_t id = 0;

    float centre(int axis) const { return 0.5f * box.lower[axis] + 0.5f * box.upper[axis]; }
};

/// Ranges above this are binned, and their halves built, by several threads.
constexpr size_t kItemsATask = 4096;
constexpr uint32_t kMostBins = 32;
/// Leaves are addressed with 27 bits (gpu_glsl/pack/bvh_buffers.h).
constexpr size_t kMostPrimitives = size_t{1} << 27;

/// Half the surface.
double area(const Bounds& box) {
    const dvec3 e = dvec3(box.upper) - dvec3(box.lower);
    return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// The boxes of a range, and the box of their centres.
struct Extent {
    Bounds boxes;
    Bounds centres;

    void extend(const Item& item) {
        boxes.extend(item.box);
        centres.extend(vec3(item.centre(0), item.centre(1), item.centre(2)));
    }
    void extend(const Extent& other) {
        boxes.extend(other.boxes);
        centres.extend(other.centres);
    }
};

struct Bin {
    Bounds box;
    uint32_t count = 0;

    void extend(const Bin& other) {
        box.extend(other.box);
        count += other.count;
    }
};
using Bins = std::array<std::array<Bin, kMostBins>, 3>;

/// Which bin a centre falls into. Monotonic in the centre, whatever rounding does.
struct BinFrame {
    vec3 lower{0.0f};
    vec3 bins_per_unit{0.0f};
    uint32_t bins = 0;

    BinFrame(const Bounds& centres, uint32_t bin_count) : lower(centres.lower), bins(bin_count) {
        for (int axis = 0; axis < 3; ++axis) {
            const float extent = centres.upper[axis] - centres.lower[axis];
            const float scale = static_cast<float>(bin_count) / extent;
            bins_per_unit[axis] = std::isfinite(scale) ? scale : 0.0f;
        }
    }
    /// False where all centres fall into one bin, or nearly so that bins could not tell them apart.
    bool splits(int axis) const { return bins_per_unit[axis] > 0.0f; }
    uint32_t bin_of(const Item& item, int axis) const {
        const float bin = (item.centre(axis) - lower[axis]) * bins_per_unit[axis];
        return std::min(static_cast<uint32_t>(std::max(bin, 0.0f)), bins - 1);
    }
};

struct Split {
    int axis = 0;
    uint32_t bin = 0;  ///< the first on the right side
    double cost = 0.0;
};

class Builder {
  public:
    Builder(std::span<const Bounds> boxes, const BvhSettings& settings)
        : settings_(settings),
          most_depth_(settings.most_depth == 0 ? kBvhMostDepth : settings.most_depth) {
        items_.resize(boxes.size());
        for (size_t i = 0; i < boxes.size(); ++i) {
            items_[i] = {boxes[i], static_cast<uint32_t>(i)};
        }
        nodes_.resize(std::max<size_t>(boxes.size(), 2) - 1);
    }

    Bvh build() {
        const Extent whole = extent_of(0, items_.size());
        if (items_.size() == 1) {
            const BvhChild leaf{whole.boxes, 0, 1};
            nodes_[0] = {{leaf, leaf}};
        } else {
            build_range(0, items_.size(), 0, 0, whole);
        }

        Bvh bvh;
        bvh.bounds = whole.boxes;
        close_gaps(bvh);
        bvh.primitives.reserve(items_.size());
        for (const Item& item : items_) bvh.primitives.push_back(item.id);
        return bvh;
    }

  private:
    using Range = tbb::blocked_range<size_t>;

    Extent extent_of(size_t first, size_t last) const {
        const auto add = [&](const Range& range, Extent extent) {
            for (size_t i = range.begin(); i != range.end(); ++i) extent.extend(items_[i]);
            return extent;
        };
        const auto join = [](Extent a, const Extent& b) {
            a.extend(b);
            return a;
        };
        if (last - first <= kItemsATask) return add(Range(first, last), {});
        return tbb::parallel_reduce(Range(first, last, kItemsATask), Extent(), add, join);
    }

    Bins bins_of(size_t first, size_t last, const BinFrame& frame) const {
        const auto add = [&](const Range& range, Bins bins) {
            for (size_t i = range.begin(); i != range.end(); ++i) {
                for (int axis = 0; axis < 3; ++axis) {
                    bins[axis][frame.bin_of(items_[i], axis)].extend({items_[i].box, 1});
                }
            }
            return bins;
        };
        const auto join = [&](Bins a, const Bins& b) {
            for (int axis = 0; axis < 3; ++axis) {
                for (uint32_t k = 0; k < frame.bins; ++k) a[axis][k].extend(b[axis][k]);
            }
            return a;
        };
        if (last - first <= kItemsATask) return add(Range(first, last), Bins{});
        return tbb::parallel_reduce(Range(first, last, kItemsATask), Bins{}, add, join);
    }

    /// The cheapest split between two bins; equal costs go to the lower axis, then bin. Nothing if
    /// all centres are in one place.
    std::optional<Split> best_split(const Bins& bins, const BinFrame& frame,
                                    double whole_area) const {
        std::optional<Split> best;
        for (int axis = 0; axis < 3; ++axis) {
            if (!frame.splits(axis)) continue;
            // The cost of everything from a bin on, from the right.
            std::array<double, kMostBins> right_cost{};
            Bin right;
            for (uint32_t k = frame.bins - 1; k > 0; --k) {
                right.extend(bins[axis][k]);
                right_cost[k] = right.count > 0 ? area(right.box) * right.count : kNoSplit;
            }
            Bin left;
            for (uint32_t k = 1; k < frame.bins; ++k) {
                left.extend(bins[axis][k - 1]);
                if (left.count == 0 || right_cost[k] == kNoSplit) continue;
                const double tests = area(left.box) * left.count + right_cost[k];
                // Boxes without area: all splits cost nothing, and the middle one is best.
                const double share = whole_area > 0.0 ? tests / whole_area : 0.0;
                const double cost = settings_.step_cost + settings_.test_cost * share;
                if (!best || cost < best->cost) best = Split{axis, k, cost};
            }
        }
        return best;
    }

    /// True if a subtree may only halve its ranges from here on, to keep within the depth.
    bool must_halve(size_t count, uint32_t depth) const {
        return depth + static_cast<uint32_t>(std::bit_width(count - 1)) >= most_depth_;
    }

    /// Reorders the range and returns where its right side begins; nothing: make it a leaf.
    std::optional<size_t> split(size_t first, size_t last, uint32_t depth, const Extent& extent) {
        const size_t count = last - first;
        const bool may_be_leaf = depth > 0 && count <= settings_.most_leaf;
        const size_t middle = first + count / 2;
        if (must_halve(count, depth)) {
            if (may_be_leaf) return std::nullopt;
            halve(first, middle, last, extent);
            return middle;
        }
        // A few primitives fill a few bins.
        const auto enough = static_cast<uint32_t>(std::min<size_t>(count + 2, settings_.bins));
        const BinFrame frame(extent.centres, enough);
        const std::optional<Split> best =
            best_split(bins_of(first, last, frame), frame, area(extent.boxes));
        const double leaf_cost = settings_.test_cost * static_cast<double>(count);
        if (may_be_leaf && (!best || best->cost >= leaf_cost)) return std::nullopt;
        if (!best) return middle;  // all centres in one place: any halves are as good

        const auto right = std::partition(
            items_.begin() + static_cast<ptrdiff_t>(first),
            items_.begin() + static_cast<ptrdiff_t>(last),
            [&](const Item& item) { return frame.bin_of(item, best->axis) < best->bin; });
        return static_cast<size_t>(right - items_.begin());
    }

    /// Halves along the longest axis of the centres; equal centres by their numbers.
    void halve(size_t first, size_t middle, size_t last, const Extent& extent) {
        const vec3 size = extent.centres.extent();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        const auto at = [&](size_t i) { return items_.begin() + static_cast<ptrdiff_t>(i); };
        std::nth_element(at(first), at(middle), at(last), [&](const Item& a, const Item& b) {
            const float ca = a.centre(axis);
            const float cb = b.centre(axis);
            return ca < cb || (ca == cb && a.id < b.id);
        });
    }

    /// The tree of a range, whose nodes stand at nodes_[node] and after it.
    BvhChild build_range(size_t first, size_t last, size_t node, uint32_t depth,
                         const Extent& extent) {
        const std::optional<size_t> middle =
            last - first == 1 ? std::nullopt : split(first, last, depth, extent);
        if (!middle) {
            return {extent.boxes, static_cast<uint32_t>(first),
                    static_cast<uint32_t>(last - first)};
        }
        // The left side's nodes follow their parent; they are at most its primitives less one.
        std::array<BvhChild, 2>& children = nodes_[node].children;
        const auto left = [&] {
            children[0] =
                build_range(first, *middle, node + 1, depth + 1, extent_of(first, *middle));
        };
        const auto right = [&] {
            children[1] = build_range(*middle, last, node + (*middle - first), depth + 1,
                                      extent_of(*middle, last));
        };
        if (last - first > kItemsATask) {
            tbb::parallel_invoke(left, right);
        } else {
            left();
            right();
        }
        return {extent.boxes, static_cast<uint32_t>(node), 0};
    }

    /// Copies the nodes that are in use, each before its left subtree, and that before the right.
    void close_gaps(Bvh& bvh) const {
        struct Visit {
            uint32_t node;    ///< in nodes_
            uint32_t parent;  ///< in bvh.nodes
            int side;
            uint32_t depth;
        };
        std::vector<Visit> visits = {{0, 0, 0, 1}};
        while (!visits.empty()) {
            const Visit visit = visits.back();
            visits.pop_back();
            const auto place = static_cast<uint32_t>(bvh.nodes.size());
            if (place > 0) bvh.nodes[visit.parent].children[visit.side].first = place;
            bvh.nodes.push_back(nodes_[visit.node]);
            bvh.depth = std::max(bvh.depth, visit.depth);
            for (const int side : {1, 0}) {
                const BvhChild& child = bvh.nodes[place].children[side];
                if (!child.is_leaf()) visits.push_back({child.first, place, side, visit.depth + 1});
            }
        }
    }

    static constexpr double kNoSplit = -1.0;

    BvhSettings settings_;
    uint32_t most_depth_;
    std::vector<Item> items_;
    std::vector<BvhNode> nodes_;
};

bool is_finite(const vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check(std::span<const Bounds> boxes, const BvhSettings& settings) {
    const auto refuse = [](const std::string& what, const std::string& got,
                           const std::string& expected, const std::string& remedy) {
        throw Error({.where = "bounding volume hierarchy, " + what,
                     .got = got,
                     .expected = expected,
                     .remedy = remedy});
    };
    if (boxes.empty() || boxes.size() > kMostPrimitives) {
        refuse("primitives", fmt::format("{}", boxes.size()),
               fmt::format("1 to {}", kMostPrimitives),
               "Remove empty objects; split those that are too large.");
    }
    for (size_t i = 0; i < boxes.size(); ++i) {
        const Bounds& box = boxes[i];
        if (is_finite(box.lower) && is_finite(box.upper) && !box.empty()) continue;
        refuse(fmt::format("box {}", i),
               fmt::format("({}, {}, {}) to ({}, {}, {})", box.lower.x, box.lower.y, box.lower.z,
                           box.upper.x, box.upper.y, box.upper.z),
               "finite bounds, lower <= upper", "Remove or mend what has this box.");
    }
    if (settings.bins < 2 || settings.bins > kMostBins) {
        refuse("bins", fmt::format("{}", settings.bins), fmt::format("2 to {}", kMostBins),
               "16 is usual.");
    }
    if (settings.most_leaf < 1 || settings.most_leaf > kBvhMostLeaf) {
        refuse("leaf size", fmt::format("{}", settings.most_leaf),
               fmt::format("1 to {}", kBvhMostLeaf), "4 is usual.");
    }
    if (!(settings.step_cost > 0.0) || !(settings.test_cost > 0.0)) {
        refuse("costs", fmt::format("{} and {}", settings.step_cost, settings.test_cost),
               "numbers above 0", "They are relative to each other: 1 and 1 are usual.");
    }
    const uint32_t most = settings.most_depth == 0 ? kBvhMostDepth : settings.most_depth;
    const auto least = static_cast<uint32_t>(std::bit_width(boxes.size() - 1));
    if (most > kBvhMostDepth || most < least) {
        refuse("depth", fmt::format("{}", most), fmt::format("{} to {}", least, kBvhMostDepth),
               "Allow for halving all primitives, down to one.");
    }
}

/// Over an object's triangles, but for those that equal one before them.
Bvh build_object_bvh(const Object& object, const BvhSettings& settings) {
    std::vector<Bounds> boxes = triangle_bounds(object);
    const std::vector<uint8_t> is_dropped = later_duplicates(object);
    if (is_dropped.empty()) return build_bvh(boxes, settings);

    std::vector<uint32_t> kept;
    for (uint32_t i = 0; i < boxes.size(); ++i) {
        if (is_dropped[i] != 0) continue;
        boxes[kept.size()] = boxes[i];
        kept.push_back(i);
    }
    boxes.resize(kept.size());
    Bvh bvh = build_bvh(boxes, settings);
    for (uint32_t& primitive : bvh.primitives) primitive = kept[primitive];
    return bvh;
}

}  // namespace

Bvh build_bvh(std::span<const Bounds> boxes, const BvhSettings& settings) {
    check(boxes, settings);
    return Builder(boxes, settings).build();
}

std::vector<Bounds> triangle_bounds(const Object& object) {
    std::vector<Bounds> boxes(object.triangles.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, boxes.size(), kItemsATask),
                      [&](const auto& range) {
                          for (size_t i = range.begin(); i != range.end(); ++i) {
                              const uvec3& corners = object.triangles[i];
                              for (int k = 0; k < 3; ++k) {
                                  boxes[i].extend(object.positions[corners[k]]);
                              }
                          }
                      });
    return boxes;
}

TwoLevelBvh build_two_level_bvh(const Scene& scene, const BvhSettings& settings) {
    const auto start = std::chrono::steady_clock::now();
    TwoLevelBvh bvh;
    bvh.objects.resize(scene.objects.size());
    tbb::parallel_for(size_t{0}, scene.objects.size(), [&](size_t k) {
        bvh.objects[k] = build_object_bvh(scene.objects[k], settings);
    });
    BvhSettings top = settings;
    top.most_depth = kBvhMostTopDepth;
    bvh.top = build_bvh(instance_bounds(scene), top);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    bvh.build_ms = elapsed.count();
    return bvh;
}

}  // namespace onepass
