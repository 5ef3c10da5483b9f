// The page generator: one self-contained HTML file from the data of any number of runs.
//
// Reads Results values and the pictures beside them, nothing else: no scene, no tracer, no GPU, no
// network. The page's frame, style and charts are the real files page.html, page.css and page.js of
// this folder, embedded into the library at build time together with Chart.js.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compare/results.h"

namespace onepass {

/// The largest page that is written: it must still travel by e-mail and open at once.
inline constexpr size_t kReportMaxBytes = 20u << 20;

/// The page for `runs`; `folders[i]` is where run i's pictures lie.
///
/// Runs are merged by scene name, so the files of check, bench and tune make one page. Without
/// JavaScript everything but the charts can be read.
/// Throws: Error if there is no run, a picture is missing or no PNG, or the page would exceed
/// kReportMaxBytes.
std::string render_report(const std::vector<Results>& runs,
                          const std::vector<std::filesystem::path>& folders);

}  // namespace onepass
