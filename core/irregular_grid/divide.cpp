// Division: cubes of the lattice into smaller ones, as long as the triangles become fewer by it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "core/irregular_grid/stages.h"
#include "core/raw_vector.h"

namespace onepass {
namespace {

/// A cube is divided by this power of two an axis at most; where that leaves many triangles, its
/// parts are divided again.
constexpr uint32_t kMostBits = 3;

/// References that a cube may be divided into, for each that it has: where many triangles lie on
/// top of each other, or meet in a point, division would pay down to the lattice and never end.
constexpr double kMostGrowth = 32.0;

/// A triangle's directions along which a box may be apart from it, and how far it reaches in each,
/// widened by the half extents of the boxes that are asked for.
///
/// Any vector is a valid direction, however it was rounded, because all three corners are projected
/// onto the same; so degenerate triangles need no case of their own.
/// Source: Akenine-Moller 2001.
class Separation {
  public:
    Separation(const std::array<dvec3, 3>& corners, const dvec3& half) {
        for (int k = 0; k < 3; ++k) {
            const dvec3 edge = corners[(k + 1) % 3] - corners[k];
            add(corners, half, dvec3(0.0, edge.z, -edge.y));
            add(corners, half, dvec3(-edge.z, 0.0, edge.x));
            add(corners, half, dvec3(edge.y, -edge.x, 0.0));
        }
        add(corners, half, glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    }

    bool parts(const dvec3& centre) const {
        return std::any_of(axes_.begin(), axes_.end(), [&](const Axis& axis) {
            const double at = glm::dot(axis.direction, centre);
            return at < axis.lower || at > axis.upper;
        });
    }

  private:
    struct Axis {
        dvec3 direction;
        double lower, upper;
    };

    void add(const std::array<dvec3, 3>& corners, const dvec3& half, const dvec3& direction) {
        const double a = glm::dot(direction, corners[0]);
        const double b = glm::dot(direction, corners[1]);
        const double c = glm::dot(direction, corners[2]);
        const double radius = glm::dot(glm::abs(direction), half);
        axes_[count_++] = {direction, std::min({a, b, c}) - radius, std::max({a, b, c}) + radius};
    }

    std::array<Axis, 10> axes_;
    size_t count_ = 0;
};

/// The parts of a cube on each axis, and who reaches into them.
struct Division {
    uint32_t bits = 0;
    std::vector<uint32_t> begins;  ///< of the parts' lists, one more than parts
    std::vector<uint32_t> references;

    uint32_t count() const { return 1u << (3 * bits); }
};

class Divider {
  public:
    Divider(const Object& object, const IrregularGrid& grid, const IrregularGridSettings& settings)
        : object_(object),
          lower_(grid.bounds.lower),
          lattice_per_unit_(1.0 / grid.edge),
          pad_(dvec3(grid.dims()) * kLatticePad),
          settings_(settings) {}

    /// `room`: references that may come of it, if it is divided.
    Subtree divide(uvec3 lower, uint32_t size_bits, std::vector<uint32_t> references,
                   double room) const {
        const uint32_t bits = bits_for(references.size(), size_bits);
        if (bits == 0) return cell(lower, size_bits, std::move(references));
        const Division division = distribute(lower, size_bits, bits, references);
        const auto count = static_cast<double>(division.references.size());
        if (count > room || !pays(division, references.size())) {
            return cell(lower, size_bits, std::move(references));
        }
        give_back(references);

        // The parts by themselves, then side by side.
        constexpr size_t kReferencesATask = 1 << 14;
        std::vector<Subtree> parts(division.count());
        const auto divide_part = [&](uint32_t part) {
            const auto begin = division.references.begin() + division.begins[part];
            const auto end = division.references.begin() + division.begins[part + 1];
            const double share = static_cast<double>(end - begin) / std::max(count, 1.0);
            parts[part] = divide(lower + (place_of(part, bits) << (size_bits - bits)),
                                 size_bits - bits, {begin, end}, room * share);
        };
        if (division.references.size() > kReferencesATask) {
            tbb::parallel_for(0u, division.count(), divide_part);
        } else {
            for (uint32_t part = 0; part < division.count(); ++part) divide_part(part);
        }
        return joined(parts, bits);
    }

  private:
    /// The paper's rule for a number of cells, as a power of two an axis.
    uint32_t bits_for(size_t references, uint32_t size_bits) const {
        if (references < 2) return 0;
        const double cells_an_axis = std::cbrt(settings_.density * static_cast<double>(references));
        const double bits =
            std::clamp(std::round(std::log2(cells_an_axis)), 1.0, static_cast<double>(kMostBits));
        return std::min(static_cast<uint32_t>(bits), size_bits);
    }

    /// Of 4^bits parts that a ray through an even division would meet, it meets one for each layer
    /// of full ones. What is empty is counted as one step, because it is merged later: it weighs as
    /// much as the step to the undivided cube.
    bool pays(const Division& division, size_t undivided) const {
        double cost = 0.0;
        for (uint32_t part = 0; part < division.count(); ++part) {
            const uint32_t count = division.begins[part + 1] - division.begins[part];
            if (count > 0) cost += count + settings_.cell_cost;
        }
        return cost <
               std::ldexp(static_cast<double>(undivided), 2 * static_cast<int>(division.bits));
    }

    static uvec3 place_of(uint32_t part, uint32_t bits) {
        const uint32_t mask = (1u << bits) - 1;
        return uvec3(part & mask, (part >> bits) & mask, part >> (2 * bits));
    }

    static Subtree cell(uvec3 lower, uint32_t size_bits, std::vector<uint32_t> references) {
        const uvec3 last = lower + uvec3((1u << size_bits) - 1);
        Subtree tree;
        tree.cells = {{lower, last, 0, static_cast<uint32_t>(references.size())}};
        tree.references = std::move(references);
        return tree;
    }

    static Subtree joined(const std::vector<Subtree>& parts, uint32_t bits) {
        Subtree tree;
        tree.root = {bits, 0};
        size_t nodes = parts.size();
        size_t cells = 0;
        size_t references = 0;
        for (const Subtree& part : parts) {
            nodes += part.nodes.size();
            cells += part.cells.size();
            references += part.references.size();
        }
        tree.nodes.reserve(nodes);
        tree.cells.reserve(cells);
        tree.references.reserve(references);
        tree.nodes.resize(parts.size());
        for (size_t i = 0; i < parts.size(); ++i) tree.nodes[i] = append(tree, parts[i]);
        return tree;
    }

    /// Where the root of a part comes to be.
    static IrregularNode append(Subtree& tree, const Subtree& part) {
        const auto first_node = static_cast<uint32_t>(tree.nodes.size());
        const auto first_cell = static_cast<uint32_t>(tree.cells.size());
        const auto first_reference = static_cast<uint32_t>(tree.references.size());
        const auto moved = [&](IrregularNode node) {
            node.first += node.bits > 0 ? first_node : first_cell;
            return node;
        };
        for (const IrregularNode& node : part.nodes) tree.nodes.push_back(moved(node));
        for (IrregularCell cell : part.cells) {
            cell.first += first_reference;
            tree.cells.push_back(cell);
        }
        tree.references.insert(tree.references.end(), part.references.begin(),
                               part.references.end());
        return moved(part.root);
    }

    /// Calls visit(part) for each part, widened by the pad, that the triangle reaches into.
    template <class Visit>
    void for_each_part(uint32_t triangle, uvec3 lower, uint32_t part_bits, uint32_t bits,
                       Visit&& visit) const {
        std::array<dvec3, 3> corners;
        for (int k = 0; k < 3; ++k) {
            const vec3& p = object_.positions[object_.triangles[triangle][k]];
            corners[static_cast<size_t>(k)] =
                (dvec3(p) - lower_) * lattice_per_unit_ - dvec3(lower);
        }
        const double size = std::ldexp(1.0, static_cast<int>(part_bits));
        const dvec3 least = glm::min(corners[0], glm::min(corners[1], corners[2])) - pad_;
        const dvec3 most = glm::max(corners[0], glm::max(corners[1], corners[2])) + pad_;
        uvec3 first;
        uvec3 end;
        int wide_axes = 0;
        for (int axis = 0; axis < 3; ++axis) {
            // Clamped before the conversion, which truncates: floor() of what is not negative.
            const double last_part = (1u << bits) - 1;
            first[axis] = static_cast<uint32_t>(std::clamp(least[axis] / size, 0.0, last_part));
            end[axis] = static_cast<uint32_t>(std::clamp(most[axis] / size, 0.0, last_part));
            wide_axes += first[axis] < end[axis];
        }
        const auto index = [&](uvec3 part) {
            return part.x + ((part.y + (part.z << bits)) << bits);
        };
        // A triangle is connected: it meets every part of a range that is wide along one axis only,
        // unless it lies beside the cube and was clamped into it.
        const double cube = std::ldexp(size, static_cast<int>(bits));
        const bool is_inside = glm::all(glm::greaterThanEqual(least, dvec3(0.0))) &&
                               glm::all(glm::lessThan(most, dvec3(cube)));
        if (is_inside && wide_axes <= 1) {
            for_each_place(first, end, [&](uvec3 part) { visit(index(part)); });
            return;
        }
        const Separation separation(corners, 0.5 * dvec3(size) + pad_);
        for_each_place(first, end, [&](uvec3 part) {
            if (!separation.parts((dvec3(part) + 0.5) * size)) visit(index(part));
        });
    }

    template <class Visit>
    static void for_each_place(uvec3 first, uvec3 last, Visit&& visit) {
        for (uint32_t z = first.z; z <= last.z; ++z) {
            for (uint32_t y = first.y; y <= last.y; ++y) {
                for (uint32_t x = first.x; x <= last.x; ++x) visit(uvec3(x, y, z));
            }
        }
    }

    /// Lists by part: ascending, as `references` are.
    Division distribute(uvec3 lower, uint32_t size_bits, uint32_t bits,
                        const std::vector<uint32_t>& references) const {
        Division division{bits, std::vector<uint32_t>((1u << (3 * bits)) + 1, 0), {}};
        std::vector<std::pair<uint32_t, uint32_t>> found;  // part, triangle
        found.reserve(2 * references.size());
        for (const uint32_t triangle : references) {
            for_each_part(triangle, lower, size_bits - bits, bits, [&](uint32_t part) {
                ++division.begins[part + 1];
                found.emplace_back(part, triangle);
            });
        }
        std::partial_sum(division.begins.begin(), division.begins.end(), division.begins.begin());
        std::vector<uint32_t> next(division.begins.begin(), division.begins.end() - 1);
        division.references.resize(found.size());
        for (const auto& [part, triangle] : found) division.references[next[part]++] = triangle;
        return division;
    }

    const Object& object_;
    dvec3 lower_;
    double lattice_per_unit_;
    dvec3 pad_;  // in lattice cells
    const IrregularGridSettings& settings_;
};

}  // namespace

Subtree divide_cube(const Object& object, const IrregularGrid& grid,
                    const IrregularGridSettings& settings, uvec3 lower, uint32_t size_bits,
                    std::vector<uint32_t> references) {
    const double room = kMostGrowth * static_cast<double>(references.size());
    return Divider(object, grid, settings).divide(lower, size_bits, std::move(references), room);
}

}  // namespace onepass
