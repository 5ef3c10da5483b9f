// Merging: pairs of neighbours that make a box together, axis by axis, while that pays.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "core/irregular_grid/stages.h"

namespace onepass {
namespace {

/// A round over the three axes that leaves more than this share of the cells is the last.
/// Source: Perard-Gayot et al. 2017 (alpha).
constexpr double kAlpha = 0.995;

class Merger {
  public:
    Merger(Subtree& tree, double cell_cost)
        : tree_(tree), cell_cost_(cell_cost), into_(tree.cells.size()), alive_(tree.cells.size()) {
        for (size_t i = 0; i < alive_.size(); ++i) into_[i] = alive_[i] = static_cast<uint32_t>(i);
    }

    void run() {
        size_t before = 0;
        do {
            before = alive_.size();
            for (int axis = 0; axis < 3; ++axis) merge_along(axis);
        } while (static_cast<double>(alive_.size()) <= kAlpha * static_cast<double>(before));
        compact();
    }

  private:
    std::span<const uint32_t> list_of(const IrregularCell& cell) const {
        return std::span(tree_.references).subspan(cell.first, cell.count);
    }

    /// Cells whose lower corners lie on a line along the axis follow each other in this order, and
    /// a neighbour of the same cross-section is the next.
    uint64_t order_key(uint32_t cell, int axis) const {
        const uvec3& lower = tree_.cells[cell].lower;
        return uint64_t{lower[(axis + 1) % 3]} << 32 | uint64_t{lower[(axis + 2) % 3]} << 16 |
               lower[axis];
    }

    static bool make_a_box(const IrregularCell& a, const IrregularCell& b, int axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        return a.last[axis] + 1 == b.lower[axis] && a.lower[u] == b.lower[u] &&
               a.last[u] == b.last[u] && a.lower[v] == b.lower[v] && a.last[v] == b.last[v];
    }

    double cost_of(const IrregularCell& cell) const {
        return expected_cost(cell.lower, cell.last, cell.count, cell_cost_);
    }

    /// Each cell with the next, once a pass: so that boxes grow on all axes alike.
    void merge_along(int axis) {
        order_.clear();
        for (const uint32_t cell : alive_) order_.emplace_back(order_key(cell, axis), cell);
        std::sort(order_.begin(), order_.end());
        alive_.clear();
        for (size_t i = 0; i < order_.size(); ++i) {
            const uint32_t cell = order_[i].second;
            alive_.push_back(cell);
            if (i + 1 < order_.size() && merge(cell, order_[i + 1].second, axis)) ++i;
        }
    }

    bool merge(uint32_t first, uint32_t second, int axis) {
        IrregularCell& a = tree_.cells[first];
        const IrregularCell& b = tree_.cells[second];
        if (!make_a_box(a, b, axis)) return false;
        united_.clear();
        std::ranges::set_union(list_of(a), list_of(b), std::back_inserter(united_));
        const double united = expected_cost(a.lower, b.last, united_.size(), cell_cost_);
        if (united > cost_of(a) + cost_of(b)) return false;

        if (united_.size() == b.count) {
            a.first = b.first;
        } else if (united_.size() != a.count) {
            a.first = static_cast<uint32_t>(tree_.references.size());
            tree_.references.insert(tree_.references.end(), united_.begin(), united_.end());
        }
        a.count = static_cast<uint32_t>(united_.size());
        a.last = b.last;
        into_[second] = first;
        return true;
    }

    /// Leaves out the cells and lists that are no more.
    void compact() {
        std::sort(alive_.begin(), alive_.end());
        Subtree merged;
        std::vector<uint32_t> place(tree_.cells.size());
        for (const uint32_t cell : alive_) {
            place[cell] = static_cast<uint32_t>(merged.cells.size());
            IrregularCell kept = tree_.cells[cell];
            const auto list = list_of(kept);
            kept.first = static_cast<uint32_t>(merged.references.size());
            merged.cells.push_back(kept);
            merged.references.insert(merged.references.end(), list.begin(), list.end());
        }
        const auto moved = [&](IrregularNode node) {
            if (node.bits > 0) return node;
            while (into_[node.first] != node.first) node.first = into_[node.first];
            return IrregularNode{0, place[node.first]};
        };
        merged.root = moved(tree_.root);
        merged.nodes.reserve(tree_.nodes.size());
        for (const IrregularNode& node : tree_.nodes) merged.nodes.push_back(moved(node));
        tree_ = std::move(merged);
    }

    Subtree& tree_;
    double cell_cost_;
    std::vector<uint32_t> into_;   // the cell that each became part of
    std::vector<uint32_t> alive_;  // those that are part of no other
    std::vector<std::pair<uint64_t, uint32_t>> order_;
    std::vector<uint32_t> united_;
};

}  // namespace

void merge_cells(Subtree& tree, double cell_cost) { Merger(tree, cell_cost).run(); }

}  // namespace onepass
