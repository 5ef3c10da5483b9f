// The figures of `onepass report --figures`: text files from the library, and gnuplot to draw them.
#pragma once

#include <filesystem>
#include <vector>

#include "compare/results.h"

namespace onepass::cli {

/// Writes the CSV files and the gnuplot scripts into `folder` and has gnuplot make an SVG of each
/// script. Without gnuplot the SVGs are missing, which stderr says.
/// Throws: Error if the folder cannot be written, or gnuplot refuses a script.
void write_figures(const std::vector<Results>& runs,
                   const std::vector<std::filesystem::path>& folders,
                   const std::filesystem::path& folder);

}  // namespace onepass::cli
