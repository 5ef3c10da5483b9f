// Figures for a paper: every record list and every chart as CSV, and a gnuplot script a chart.
//
// Texts only: who writes them to a folder, and runs gnuplot, is the command line's business. A list
// of records becomes a table by walking its JSON, so that a new record type needs nothing here.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "compare/results.h"

namespace onepass::report {

inline constexpr std::string_view kScriptSuffix = ".gnuplot";

struct TextFile {
    std::string name;
    std::string text;
};

/// All files of the figures, names unlike each other.
///
/// CSV as RFC 4180 has it: a heading, a line a record, text quoted where it must be. A list of
/// samples is one field, its numbers apart by blanks. "run" is the place of the record's file among
/// `runs`, from 1. The script NAME.gnuplot reads NAME.csv beside it and writes NAME.svg.
std::vector<TextFile> figure_files(const std::vector<Results>& runs,
                                   const std::vector<std::filesystem::path>& folders);

}  // namespace onepass::report
