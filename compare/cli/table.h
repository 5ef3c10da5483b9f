// Tables for the terminal: first column to the left, all others to the right.
#pragma once

#include <string>
#include <vector>

namespace onepass::cli {

/// Rows are as long as the first one, which is the heading.
std::string format_table(const std::vector<std::vector<std::string>>& rows,
                         const std::string& indent = "  ");

/// Like format_table, with every column to the left: for text.
std::string format_list(const std::vector<std::vector<std::string>>& rows,
                        const std::string& indent = "  ");

}  // namespace onepass::cli
