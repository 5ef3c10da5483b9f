// --sizing and --costs: where commands take the sizes of grids from.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "compare/auto_sizing.h"
#include "compare/cli/options.h"
#include "compare/cli/session.h"

namespace onepass::cli {

/// --sizing auto|FILE and --costs RESULT.json.
struct SizingOptions {
    std::string sizing;              ///< empty: the strategies' parameters say
    std::vector<std::string> costs;  ///< result files of `tune`, for auto
};
void add_sizing_options(CLI::App& command, SizingOptions& options);
/// --costs alone.
void add_costs_option(CLI::App& command, SizingOptions& options);

/// The strategies with the sizes that this scene gets. Those without grids, and all if no sizing is
/// asked for, are as they were.
///
/// Auto counts a sample of the rays of these kinds from this camera, and says on stderr what it
/// chose.
/// Throws: Error if --param states a size as well; as size_from and read_sizing_file; as auto_size.
std::vector<SelectedStrategy> sized(const Session& session, const OpenScene& open,
                                    std::vector<SelectedStrategy> strategies,
                                    const SizingOptions& options,
                                    const std::vector<std::string>& ray_kinds, uint32_t camera);

/// TracerRecord::sizing of a strategy that sized() went over.
std::string sizing_name(const TracerInfo& info, const SizingOptions& options);

/// The costs by which auto chooses: fitted to the files of --costs where they hold this tracer;
/// else those that are known. Throws: Error if there are none.
CostModel costs_for(const std::string& tracer, const SizingOptions& options);

/// Auto's choice for a sample. Throws: Error if nobody counts for the strategy or its costs are not
/// known; as choose_sizes.
AutoSizing auto_size(const Session& session, const ScenePtr& scene,
                     const SelectedStrategy& strategy, std::span<const Ray> sample,
                     const CostModel& costs);

/// "density 16, top density 1.2", "own sizes 4,32x32x32, top density 1.2".
std::string size_text(const GridSize& size);

}  // namespace onepass::cli
