#include "gpu_glsl/pack/reference_lists.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {

ListPlaces ListRows::lay(const UniformGrid& grid) {
    ListPlaces first(grid.cell_count());
    for (uint64_t cell = 0; cell < first.size(); ++cell) {
        const uint32_t count = grid.cell_begin[cell + 1] - grid.cell_begin[cell];
        if (column_ + count > width_) {
            ++row_;
            column_ = 0;
        }
        first[cell] = static_cast<uint32_t>(column_ + width_ * row_);
        column_ += count;
    }
    return first;
}

uint32_t longest_list(const UniformGrid& grid) {
    uint32_t longest = 0;
    for (uint64_t i = 0; i < grid.cell_count(); ++i) {
        longest = std::max(longest, grid.cell_begin[i + 1] - grid.cell_begin[i]);
    }
    return longest;
}

ListLayout choose_list_layout(std::span<const UniformGrid> objects, const UniformGrid& top,
                              uint32_t max_side, bool room_to_grow, uvec2 least) {
    uint64_t references = top.references.size();
    uint32_t longest = longest_list(top);
    for (const UniformGrid& grid : objects) {
        references += grid.references.size();
        longest = std::max(longest, longest_list(grid));
    }

    const auto least_square = static_cast<uint64_t>(std::sqrt(static_cast<double>(references)));
    uint64_t width =
        std::bit_ceil(std::max({uint64_t{longest}, least_square, uint64_t{16}, uint64_t{least.x}}));
    width = std::min<uint64_t>(width, max_side);
    for (; longest <= width && width <= max_side; width *= 2) {
        ListLayout layout;
        layout.width = static_cast<uint32_t>(width);
        ListRows object_rows(layout.width);
        for (const UniformGrid& grid : objects) layout.objects.push_back(object_rows.lay(grid));
        const uint64_t first_top_row = object_rows.end_row();
        if (first_top_row >= max_side) continue;
        layout.first_top_row = static_cast<uint32_t>(first_top_row);

        ListRows top_rows(layout.width, layout.first_top_row);
        layout.top = top_rows.lay(top);
        const uint64_t end = std::max(top_rows.end_row(), first_top_row + 1);
        if (end > max_side) continue;
        const uint64_t wanted = room_to_grow ? end + (end - first_top_row) : end;
        layout.rows = static_cast<uint32_t>(
            std::min<uint64_t>(std::max<uint64_t>(wanted, least.y), max_side));
        return layout;
    }
    throw Error({"texture 'references'",
                 fmt::format("{} references, {} in the longest list", references, longest),
                 fmt::format("lists within rows of {0} texels, and at most {0} rows", max_side),
                 "Use --param address=float, or lower --param density."});
}

}  // namespace onepass
