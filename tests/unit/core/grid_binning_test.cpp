// Triangle binning against an exact reference that shares nothing with it: the triangle is clipped
// by the cell's six half-spaces in rational arithmetic (Sutherland & Hodgman 1974).
//
// Complete: a triangle that touches the closed cell is referenced by it. Tight: a triangle that
// stays clear of the cell widened by kAllowedExcess is not.
#include <array>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include "core/grid/uniform_grid.h"

namespace onepass {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using ExactPoint = std::array<Rational, 3>;
using Polygon = std::vector<ExactPoint>;

/// The builder widens cells by kBinningPad; as much again leaves room for its rounding, for the
/// near-parallel axes of slivers, and for the sharp corners of an obtuse widening.
constexpr double kAllowedExcess = 2.0 * kBinningPad;

/// The part of a convex polygon with sign * (p[axis] - limit) <= 0; empty only if there is none.
Polygon clip(const Polygon& polygon, int axis, int sign, const Rational& limit) {
    Polygon result;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const ExactPoint& a = polygon[i];
        const ExactPoint& b = polygon[(i + 1) % polygon.size()];
        const Rational a_outside = sign * (a[axis] - limit);
        const Rational b_outside = sign * (b[axis] - limit);
        if (a_outside <= 0) result.push_back(a);
        if ((a_outside < 0 && b_outside > 0) || (a_outside > 0 && b_outside < 0)) {
            const Rational s = a_outside / (a_outside - b_outside);
            ExactPoint crossing;
            for (int k = 0; k < 3; ++k) crossing[k] = a[k] + s * (b[k] - a[k]);
            result.push_back(crossing);
        }
    }
    return result;
}

/// True if the polygon, in cell units, meets the closed cell widened by `excess` cells.
bool touches_cell(Polygon polygon, const uvec3& cell, double excess) {
    for (int axis = 0; axis < 3; ++axis) {
        polygon = clip(polygon, axis, -1, Rational(cell[axis]) - Rational(excess));
        polygon = clip(polygon, axis, +1, Rational(cell[axis] + 1) + Rational(excess));
    }
    return !polygon.empty();
}

/// The triangle in exact cell units: cell i spans bounds.lower + i * extent / dims.
Polygon in_cell_units(const UniformGrid& grid, const Object& object, size_t primitive) {
    Polygon polygon(3);
    for (int corner = 0; corner < 3; ++corner) {
        const vec3& p = object.positions[object.triangles[primitive][corner]];
        for (int axis = 0; axis < 3; ++axis) {
            const Rational lower(grid.bounds.lower[axis]);
            const Rational extent = Rational(grid.bounds.upper[axis]) - lower;
            polygon[corner][axis] = (Rational(p[axis]) - lower) * grid.dims[axis] / extent;
        }
    }
    return polygon;
}

std::vector<uvec3> all_cells(const uvec3& dims) {
    std::vector<uvec3> cells;
    for (uint32_t z = 0; z < dims.z; ++z) {
        for (uint32_t y = 0; y < dims.y; ++y) {
            for (uint32_t x = 0; x < dims.x; ++x) cells.emplace_back(x, y, z);
        }
    }
    return cells;
}

/// How many (cell, triangle) pairs are wrong, each way, and the first of them in words.
struct BinningErrors {
    size_t missing = 0;
    size_t excess = 0;
    size_t references = 0;
    std::string first;
};

BinningErrors compare_with_exact(const Object& object, const UniformGrid& grid) {
    BinningErrors errors;
    errors.references = grid.references.size();
    std::set<std::pair<uint64_t, uint32_t>> referenced;
    for (const uvec3& cell : all_cells(grid.dims)) {
        for (const uint32_t i : grid.cell_references(cell)) {
            referenced.emplace(grid.cell_index(cell), i);
        }
    }
    for (uint32_t i = 0; i < object.triangles.size(); ++i) {
        const Polygon polygon = in_cell_units(grid, object, i);
        for (const uvec3& cell : all_cells(grid.dims)) {
            const bool has = referenced.contains({grid.cell_index(cell), i});
            const bool missing = !has && touches_cell(polygon, cell, 0.0);
            const bool excess = has && !touches_cell(polygon, cell, kAllowedExcess);
            errors.missing += missing;
            errors.excess += excess;
            if ((missing || excess) && errors.first.empty()) {
                errors.first = (missing ? "missing: triangle " : "excess: triangle ") +
                               std::to_string(i) + ", cell " + std::to_string(cell.x) + " " +
                               std::to_string(cell.y) + " " + std::to_string(cell.z);
            }
        }
    }
    return errors;
}

void expect_exact(const Object& object, const uvec3& resolution) {
    const BinningErrors errors =
        compare_with_exact(object, build_triangle_grid(object, {.resolution = resolution}));
    EXPECT_EQ(errors.missing, 0u) << object.name << ", " << errors.first;
    EXPECT_EQ(errors.excess, 0u) << object.name << ", " << errors.first;
    EXPECT_GE(errors.references, object.triangles.size());
}

/// A soup of separate triangles; the first one is a segment between the corners of [-1, 1]^3, which
/// fixes the grid's box.
class Soup {
  public:
    explicit Soup(std::string name) {
        object_.name = std::move(name);
        add(vec3(-1.0f), vec3(1.0f), vec3(1.0f));
    }
    void add(const vec3& a, const vec3& b, const vec3& c) {
        const uint32_t first = static_cast<uint32_t>(object_.positions.size());
        object_.positions.insert(object_.positions.end(), {a, b, c});
        object_.triangles.emplace_back(first, first + 1, first + 2);
    }
    const Object& object() const { return object_; }

  private:
    Object object_;
};

class Random {
  public:
    float in(float lower, float upper) {
        return std::uniform_real_distribution<float>(lower, upper)(engine_);
    }
    uint32_t below(uint32_t n) {
        return std::uniform_int_distribution<uint32_t>(0, n - 1)(engine_);
    }
    vec3 point(float radius = 1.0f) {
        const float x = in(-radius, radius);
        const float y = in(-radius, radius);
        return vec3(x, y, in(-radius, radius));
    }

  private:
    std::mt19937 engine_{20060101};
};

Object random_triangles(float size, int count) {
    Soup soup("random triangles of size " + std::to_string(size));
    Random random;
    for (int i = 0; i < count; ++i) {
        const vec3 centre = random.point(1.0f - size);
        soup.add(centre + random.point(size), centre + random.point(size),
                 centre + random.point(size));
    }
    return soup.object();
}

/// On the box of Soup, padded to 1 + 2^-19, the planes of a grid of 8 cells are floats exactly.
constexpr uint32_t kExactDims = 8;
float cell_plane(uint32_t i) { return (1.0f + 0x1p-19f) * (float(i) / 4.0f - 1.0f); }

TEST(TriangleBinning, is_exact_for_small_triangles) {
    expect_exact(random_triangles(0.1f, 150), uvec3(7, 6, 5));
}

TEST(TriangleBinning, is_exact_for_triangles_of_a_few_cells) {
    expect_exact(random_triangles(0.4f, 80), uvec3(5, 7, 6));
}

TEST(TriangleBinning, is_exact_for_triangles_as_large_as_the_box) {
    expect_exact(random_triangles(0.99f, 40), uvec3(6, 5, 7));
}

TEST(TriangleBinning, is_exact_on_very_uneven_resolutions) {
    expect_exact(random_triangles(0.5f, 30), uvec3(1, 40, 3));
    expect_exact(random_triangles(0.5f, 30), uvec3(60, 1, 2));
    expect_exact(random_triangles(0.5f, 30), uvec3(2, 3, 50));
    expect_exact(random_triangles(0.5f, 10), uvec3(1));
}

TEST(TriangleBinning, is_exact_for_slivers) {
    Soup soup("slivers");
    Random random;
    for (const float width : {1e-2f, 1e-4f, 1e-6f, 1e-8f}) {
        for (int i = 0; i < 12; ++i) {
            const vec3 a = random.point(0.9f);
            const vec3 b = random.point(0.9f);
            soup.add(a, b, a + (b - a) * random.in(0.0f, 1.0f) + random.point(width));
        }
    }
    expect_exact(soup.object(), uvec3(6, 7, 5));
}

TEST(TriangleBinning, is_exact_for_points_and_segments) {
    Soup soup("points and segments");
    Random random;
    for (int i = 0; i < 20; ++i) {
        const vec3 a = random.point();
        const vec3 b = random.point();
        soup.add(a, a, a);
        soup.add(a, b, b);
        soup.add(a, b, 0.5f * (a + b));  // on the line, or one rounding beside it
    }
    for (int axis = 0; axis < 3; ++axis) {
        vec3 end(0.1f);
        end[axis] = 0.9f;
        soup.add(vec3(0.1f), end, end);
    }
    expect_exact(soup.object(), uvec3(5, 6, 7));
}

TEST(TriangleBinning, finds_both_sides_for_triangles_that_lie_in_a_cell_plane) {
    Soup soup("in cell planes");
    Random random;
    for (int i = 0; i < 30; ++i) {
        const int axis = i % 3;
        std::array<vec3, 3> corners;
        const float plane = cell_plane(1 + random.below(kExactDims - 1));
        for (vec3& p : corners) {
            p = random.point();
            p[axis] = plane;
        }
        soup.add(corners[0], corners[1], corners[2]);
    }
    expect_exact(soup.object(), uvec3(kExactDims));

    // The reference itself must see both sides, or the check above would be an empty one.
    const UniformGrid grid = build_triangle_grid(soup.object(), {.resolution = uvec3(kExactDims)});
    const Polygon first = in_cell_units(grid, soup.object(), 1);
    EXPECT_EQ(denominator(first[0][0]), 1) << "the triangle does not lie in a cell plane";
}

TEST(TriangleBinning, finds_all_cells_for_triangles_with_vertices_on_cell_corners) {
    Soup soup("vertices on cell corners");
    Random random;
    const auto corner = [&] {
        return vec3(cell_plane(1 + random.below(7)), cell_plane(1 + random.below(7)),
                    cell_plane(1 + random.below(7)));
    };
    for (int i = 0; i < 20; ++i) {
        const vec3 c = corner();
        soup.add(c, c + vec3(0.05f), c + vec3(0.05f, 0.02f, 0.01f));  // one octant, one corner
        soup.add(c, corner(), random.point());
        soup.add(c, corner(), corner());
    }
    soup.add(vec3(cell_plane(3)), vec3(cell_plane(3)), vec3(cell_plane(3)));  // touches 8 cells
    expect_exact(soup.object(), uvec3(kExactDims));
}

TEST(TriangleBinning, is_exact_far_from_the_origin_and_at_extreme_scales) {
    const Object unit = random_triangles(0.4f, 40);
    const auto placed = [&](float scale, float offset, const std::string& name) {
        Object object = unit;
        object.name = name;
        for (vec3& p : object.positions) p = p * scale + vec3(offset, -offset, 0.5f * offset);
        return object;
    };
    expect_exact(placed(1.0f, 1e6f, "a million extents from the origin"), uvec3(6, 5, 7));
    expect_exact(placed(1e3f, 1e6f, "a thousand extents from the origin"), uvec3(6, 5, 7));
    expect_exact(placed(1e-30f, 0.0f, "tiny"), uvec3(6, 5, 7));
    expect_exact(placed(1e-42f, 0.0f, "denormal"), uvec3(6, 5, 7));
    expect_exact(placed(1e30f, 0.0f, "huge"), uvec3(6, 5, 7));
    expect_exact(placed(1e38f, 0.0f, "near the largest float"), uvec3(6, 5, 7));
}

TEST(TriangleBinning, is_exact_for_flat_objects_and_single_triangles) {
    Object quad;
    quad.name = "quad";
    quad.positions = {vec3(0, 1, 0), vec3(2, 1, 0), vec3(2, 1, 2), vec3(0, 1, 2)};
    quad.triangles = {uvec3(0, 1, 2), uvec3(0, 2, 3)};
    expect_exact(quad, uvec3(6, 1, 6));
    expect_exact(quad, uvec3(5, 4, 3));

    Object single;
    single.name = "single triangle";
    single.positions = {vec3(0, 0, 0), vec3(3, 1, 0), vec3(1, 2, 5)};
    single.triangles = {uvec3(0, 1, 2)};
    expect_exact(single, uvec3(7, 6, 9));

    Object point = single;
    point.name = "single point";
    point.positions.assign(3, vec3(0.0f));
    expect_exact(point, uvec3(3, 2, 1));
}

TEST(TriangleBinning, references_fewer_cells_than_the_boxes_of_slanted_triangles) {
    Soup soup("one slanted triangle");
    soup.add(vec3(-0.9f), vec3(0.9f, -0.9f, 0.9f), vec3(-0.9f, 0.9f, 0.9f));
    const UniformGrid grid = build_triangle_grid(soup.object(), {.resolution = uvec3(32)});
    // Its box covers nearly all 32^3 cells; a surface covers a few times 32^2.
    EXPECT_LT(grid.references.size(), 4u * 32u * 32u);
}

}  // namespace
}  // namespace onepass
