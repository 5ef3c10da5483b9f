#include "compare/cli/table.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass::cli {
namespace {

std::string format_rows(const std::vector<std::vector<std::string>>& rows,
                        const std::string& indent, bool numbers) {
    std::vector<size_t> widths(rows.empty() ? 0 : rows.front().size());
    for (const auto& row : rows) {
        ONEPASS_CHECK_EQ(row.size(), widths.size());
        for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line = indent;
        for (size_t c = 0; c < row.size(); ++c) {
            const bool right = numbers && c > 0;
            line += right ? fmt::format("  {:>{}}", row[c], widths[c])
                          : fmt::format("{}{:<{}}", c ? "  " : "", row[c], widths[c]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

}  // namespace

std::string format_table(const std::vector<std::vector<std::string>>& rows,
                         const std::string& indent) {
    return format_rows(rows, indent, true);
}

std::string format_list(const std::vector<std::vector<std::string>>& rows,
                        const std::string& indent) {
    return format_rows(rows, indent, false);
}

}  // namespace onepass::cli
