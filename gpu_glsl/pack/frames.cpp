// Exact frames: subtraction and scaling that round nothing, and maps in twice float's digits.
#include "gpu_glsl/pack/frames.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

/// a + b = sum + rest, exactly. Source: Knuth; Moller 1965.
struct ExactSum {
    double sum;
    double rest;
};
ExactSum exact_sum(double a, double b) {
    const double sum = a + b;
    const double b_taken = sum - a;
    return {sum, (a - (sum - b_taken)) + (b - b_taken)};
}

/// The determinant of the linear part, to 2^-52 of itself.
///
/// A product of two floats is exact in double. It is cut into two parts that are exact times the
/// third float, and all twelve parts are added together with what each sum leaves over. What is
/// lost is below 144 * 2^-106 of the six products' sizes, and is_invertible() lets them cancel to
/// 2^-43 of that at most.
/// Source: Veltkamp 1968 (the cut); Neumaier 1974 (the sum).
double sharp_determinant(const Affine& m) {
    constexpr double kCut = 0x1p27 + 1.0;
    double sum = 0.0;
    double rest = 0.0;
    const auto add = [&](double product, double third) {
        const double scaled = kCut * product;
        const double leading = scaled - (scaled - product);
        for (const double part : {leading * third, (product - leading) * third}) {
            const ExactSum next = exact_sum(sum, part);
            sum = next.sum;
            rest += next.rest;
        }
    };
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        add(double{m[1][j]} * m[2][k], m[0][i]);
        add(double{m[1][k]} * m[2][j], -double{m[0][i]});
    }
    return sum + rest;
}

/// The rows of the inverse of the linear part, each number right to 2^-51 of itself: the cross
/// products of the columns, whose products are exact, over the determinant.
std::array<dvec3, 3> inverse_rows(const Affine& m) {
    const double determinant = sharp_determinant(m);
    std::array<dvec3, 3> rows;
    for (int i = 0; i < 3; ++i) {
        rows[i] = glm::cross(dvec3(m[(i + 1) % 3]), dvec3(m[(i + 2) % 3])) / determinant;
    }
    return rows;
}

}  // namespace

dvec3 frame_origin(const Bounds& bounds) {
    dvec3 origin(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = bounds.lower[axis];
        const double upper = bounds.upper[axis];
        const bool is_far =
            lower > 0.0 ? upper <= 2.0 * lower : upper < 0.0 && lower >= 2.0 * upper;
        if (is_far) origin[axis] = lower;
    }
    return origin;
}

double frame_scale(double largest) {
    // Beyond this the numbers of a plain transform would leave the range of float.
    constexpr int kMostBinaryPlaces = 100;
    const int exponent = largest > 0.0 ? std::ilogb(largest) + 1 : -kMostBinaryPlaces;
    return std::ldexp(1.0, -std::clamp(exponent, -kMostBinaryPlaces, kMostBinaryPlaces));
}

GridFrame object_frame(const Bounds& bounds) {
    GridFrame frame{.origin = frame_origin(bounds)};
    const dvec3 size = glm::max(glm::abs(dvec3(bounds.lower) - frame.origin),
                                glm::abs(dvec3(bounds.upper) - frame.origin));
    frame.scale = frame_scale(std::max({size.x, size.y, size.z}));
    return frame;
}

dvec3 centre_in(const Bounds& box, const GridFrame& frame) {
    const dvec3 twice = dvec3(box.lower) + dvec3(box.upper);
    return dvec3(vec3((0.5 * twice - frame.origin) * frame.scale));
}

dvec3 world_point(const Affine& world_from_object, const vec3& point, const dvec3& from) {
    dvec3 result;
    for (int axis = 0; axis < 3; ++axis) {
        // Products of floats are exact in double; what each sum leaves over is kept.
        double sum = -from[axis];
        double rest = 0.0;
        const auto add = [&](double term) {
            const ExactSum next = exact_sum(sum, term);
            sum = next.sum;
            rest += next.rest;
        };
        add(world_from_object[3][axis]);
        for (int k = 0; k < 3; ++k) add(double{world_from_object[k][axis]} * point[k]);
        result[axis] = sum + rest;
    }
    return result;
}

void put_instance_rows(float* out, const Affine& world_from_object, const GridFrame& frame) {
    constexpr int kRows = 3;
    static_assert(kInstanceRowTexels == 2 * kRows);
    const std::array<dvec3, 3> inverse = inverse_rows(world_from_object);
    for (int row = 0; row < kRows; ++row) {
        float* const leading = out + 4 * row;
        float* const trailing = out + 4 * (row + kRows);
        for (int column = 0; column < 3; ++column) {
            const double value = inverse[row][column] * frame.scale;
            leading[column] = static_cast<float>(value);
            trailing[column] = static_cast<float>(value - leading[column]);
        }
        leading[3] = world_from_object[3][row];
        trailing[3] = static_cast<float>(frame.origin[row] * frame.scale);
    }
}

}  // namespace onepass
