// Exact frames: subtraction and scaling that round nothing, and maps in twice float's digits.
#include "gpu_glsl/pack/frames.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace onepass {
namespace {

#include "gpu_glsl/shaders/shared/grid_buffers_layout.h"

/// The inverse of the linear part, with the 64 digits of x86's long double: its rows are the cross
/// products of the columns, which are exact but for the last rounding, over the determinant, which
/// loses what a nearly singular map cancels.
using LongRow = std::array<long double, 3>;
std::array<LongRow, 3> inverse_rows(const Affine& m) {
    const auto at = [&](int column, int row) -> long double { return m[column % 3][row % 3]; };
    std::array<LongRow, 3> rows;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            rows[i][j] = at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1);
        }
    }
    const long double determinant =
        rows[0][0] * at(0, 0) + rows[0][1] * at(0, 1) + rows[0][2] * at(0, 2);
    for (LongRow& row : rows) {
        for (long double& value : row) value /= determinant;
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

GridFrame object_frame(const Bounds& bounds) {
    GridFrame frame{.origin = frame_origin(bounds)};
    const dvec3 size = glm::max(glm::abs(dvec3(bounds.lower) - frame.origin),
                                glm::abs(dvec3(bounds.upper) - frame.origin));
    // Beyond this the numbers of a plain transform would leave the range of float.
    constexpr int kMostBinaryPlaces = 100;
    const int exponent = std::ilogb(std::max({size.x, size.y, size.z})) + 1;
    frame.scale = std::ldexp(1.0, -std::clamp(exponent, -kMostBinaryPlaces, kMostBinaryPlaces));
    return frame;
}

void put_instance_rows(float* out, const Affine& world_from_object, const GridFrame& frame) {
    constexpr int kRows = 3;
    static_assert(kInstanceRowTexels == 2 * kRows);
    const std::array<LongRow, 3> inverse = inverse_rows(world_from_object);
    for (int row = 0; row < kRows; ++row) {
        float* const leading = out + 4 * row;
        float* const trailing = out + 4 * (row + kRows);
        for (int column = 0; column < 3; ++column) {
            const long double value = inverse[row][column] * frame.scale;
            leading[column] = static_cast<float>(value);
            trailing[column] = static_cast<float>(value - leading[column]);
        }
        leading[3] = world_from_object[3][row];
        trailing[3] = static_cast<float>(frame.origin[row] * frame.scale);
    }
}

}  // namespace onepass
