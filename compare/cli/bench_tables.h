// What `onepass bench` prints of its records: tables for a terminal.
#pragma once

#include <cstdio>

#include "compare/results.h"

namespace onepass::cli {

/// One case (scene and rays) after the other: speeds with their errors and verdicts, the pairs, the
/// counters, the time to image, the pace of the device.
void print_bench(const Results& results, std::FILE* out);

}  // namespace onepass::cli
